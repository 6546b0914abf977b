/*
 * The C interface at work: what a firmware engineer would write first, then the evaluations that must have the same bits in C and
 * in Rust, on the host and on every device. c-example/run builds and runs it.
 */
#include "agreement.h"
#include "leafbrdf.h"

#include <stdio.h>

static void print(const char *name, uint32_t block, uint32_t hash) {
    printf("%s %u %08lx\n", name, (unsigned)block, (unsigned long)hash);
}

/* quick_start.c, the ten lines of the README */
int quick_start(void);

int main(void) {
    if (quick_start() != 0 || lb_brdf(NULL, NULL, NULL) != LB_ERR_NULL) {
        return 1;
    }
    agreement(print);
    return 0;
}
