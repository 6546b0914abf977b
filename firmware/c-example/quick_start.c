#include "leafbrdf.h"

#include <stdio.h>

int quick_start(void) {
    lb_leaf laurel = {.k_lambert = 0.04f, .n = 1.22f, .sigma = 0.078f, .normalization = LB_BOUSQUET_2005};
    float brdf; /* sr^-1; light and view at 60 degrees, opposite each other */
    lb_status status = lb_brdf_from_degrees(&laurel, 60.0f, 60.0f, 180.0f, &brdf);
    if (status != LB_OK) {
        fprintf(stderr, "%s\n", lb_status_text(status));
        return 1;
    }
    return brdf > 1.26f && brdf < 1.28f ? 0 : 1; /* 1.2621: 1.2494 of the lobe, 0.0127 of the interior */
}
