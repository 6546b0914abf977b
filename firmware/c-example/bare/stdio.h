/* As much of <stdio.h> as the C program needs, for a board without a C library: bare.c. */
#ifndef BARE_STDIO_H
#define BARE_STDIO_H

typedef struct console FILE;
extern FILE *const stdout;
extern FILE *const stderr;

/* %s, %u, %lx and %08lx; others end the program with status 4. */
int fprintf(FILE *stream, const char *format, ...) __attribute__((format(printf, 2, 3)));
int printf(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
