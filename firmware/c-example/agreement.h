/* Evaluations of everything, on inputs that C and Rust make alike: see agreement.c and ../example/src/agreement.rs. */
#ifndef AGREEMENT_H
#define AGREEMENT_H

#include <stdint.h>

/* Takes a result: what it is of, which block, and the hash of the block's bits. */
typedef void agreement_print(const char *name, uint32_t block, uint32_t hash);

void agreement(agreement_print *print);

#endif
