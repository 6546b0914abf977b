/*
 * The C interface at work: what a firmware engineer would write first, then the evaluations that must have the same bits in C and
 * in Rust, on the host and on every device. ../c-example/run builds and runs it.
 */
#include "agreement.h"
#include "leafbrdf.h"

#include <stdio.h>

static void print(const char *name, uint32_t block, uint32_t hash) {
    printf("%s %u %08lx\n", name, (unsigned)block, (unsigned long)hash);
}

/* Laurel (Table 4) in the mirror direction at 60 degrees: 1.25 sr^-1. */
static int first_ten_lines(void) {
    lb_leaf laurel = {.k_lambert = 0.04f, .n = 1.22f, .sigma = 0.078f, .normalization = LB_BOUSQUET_2005};
    float brdf;
    lb_status status = lb_brdf_from_degrees(&laurel, 60.0f, 60.0f, 180.0f, &brdf);
    if (status != LB_OK) {
        fprintf(stderr, "%s\n", lb_status_text(status));
        return 1;
    }
    return brdf > 1.2f && brdf < 1.3f ? 0 : 1;
}

int main(void) {
    if (first_ten_lines() != 0 || lb_brdf(NULL, NULL, NULL) != LB_ERR_NULL) {
        return 1;
    }
    agreement(print);
    return 0;
}
