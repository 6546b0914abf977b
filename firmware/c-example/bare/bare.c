/*
 * A RISC-V board without a C library, as QEMU's `virt` is one: start, memcpy and memset, a printf as small as it gets, and a
 * console and an exit by semihosting.
 */
#include "stdio.h"
#include "string.h"

#include <stdarg.h>
#include <stdint.h>

extern int main(void);

/* The debugger's call: a breakpoint between two instructions that do nothing, none of them compressed. */
static uint32_t call_host(uint32_t operation, const void *argument) {
    register uint32_t a0 __asm("a0") = operation;
    register const void *a1 __asm("a1") = argument;
    __asm volatile(".option push\n .option norvc\n .balign 16\n slli zero, zero, 0x1f\n ebreak\n srai zero, zero, 7\n .option pop"
                   : "+r"(a0)
                   : "r"(a1)
                   : "memory");
    return a0;
}

enum { SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026 };

static void leave(int status) {
    const uint32_t reason[2] = {APPLICATION_EXIT, (uint32_t)status};
    for (;;) {
        call_host(SYS_EXIT_EXTENDED, reason);
    }
}

__attribute__((used)) void run(void) {
    leave(main());
}

__attribute__((used, aligned(4))) void trapped(void) {
    leave(3);
}

__attribute__((naked, used, section(".start"))) void start(void) {
    __asm volatile(".option arch, +zicsr\n la sp, __stack\n la t0, trapped\n csrw mtvec, t0\n j run");
}

/* both streams are the host's console */
FILE *const stdout = 0;
FILE *const stderr = 0;

static int print(const char *format, va_list values) {
    char line[128];
    unsigned length = 0;
    for (; *format != '\0' && length + 12 < sizeof line; format++) {
        if (*format != '%') {
            line[length++] = *format;
            continue;
        }
        const int wide = format[1] == '0' && format[2] == '8';
        format += wide ? 3 : 1;
        if (*format == 's') {
            for (const char *word = va_arg(values, const char *); *word != '\0' && length + 12 < sizeof line; word++) {
                line[length++] = *word;
            }
        } else if (*format == 'u' || (*format == 'l' && format[1] == 'x')) {
            const uint32_t base = *format == 'u' ? 10 : 16;
            uint32_t number = base == 10 ? va_arg(values, unsigned) : (uint32_t)va_arg(values, unsigned long);
            char digits[10];
            int count = 0;
            do {
                digits[count++] = "0123456789abcdef"[number % base];
                number /= base;
            } while (number != 0 || (wide && count < 8));
            while (count > 0) {
                line[length++] = digits[--count];
            }
            format += base == 16;
        } else {
            leave(4);
        }
    }
    line[length] = '\0';
    call_host(SYS_WRITE0, line);
    return (int)length;
}

int fprintf(FILE *stream, const char *format, ...) {
    (void)stream;
    va_list values;
    va_start(values, format);
    const int length = print(format, values);
    va_end(values);
    return length;
}

int printf(const char *format, ...) {
    va_list values;
    va_start(values, format);
    const int length = print(format, values);
    va_end(values);
    return length;
}

void *memcpy(void *to, const void *from, size_t count) {
    unsigned char *out = to;
    for (const unsigned char *in = from; count > 0; count--) {
        *out++ = *in++;
    }
    return to;
}

void *memset(void *to, int byte, size_t count) {
    for (unsigned char *out = to; count > 0; count--) {
        *out++ = (unsigned char)byte;
    }
    return to;
}
