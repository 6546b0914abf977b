/*
 * A few thousand evaluations through leafbrdf.h. Every input is an integer times a power of two, or a quotient of two such
 * numbers: there is nothing for a compiler to round in its own way (a fused multiply-add, say), so C and Rust start from the same
 * bits on every machine. The results of each block are hashed, statuses included.
 */
#include "agreement.h"
#include "leafbrdf.h"

#include <string.h>

enum { BLOCKS = 16, POINTS = 256, DIRECTIONS = 41 };

/* Numerical Recipes' linear congruential generator; the low bits are its weak ones. */
static uint32_t next(uint32_t *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static float below(uint32_t *state, uint32_t bound, float step) { return (float)(next(state) % bound) * step; }

/* FNV-1a */
static void hash_word(uint32_t *hash, uint32_t word) {
    for (int i = 0; i < 4; i++) {
        *hash = (*hash ^ (word & 0xffu)) * 16777619u;
        word >>= 8;
    }
}

static void hash_float(uint32_t *hash, float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    hash_word(hash, value == value ? bits : 0x7fc00000u); /* one NaN is as good as another */
}

static void hash_value(uint32_t *hash, lb_status status, float value) {
    hash_word(hash, (uint32_t)status);
    if (status == LB_OK) {
        hash_float(hash, value);
    }
}

/* A leaf, now and then an impossible one. */
static lb_leaf leaf(uint32_t *state) {
    lb_leaf leaf;
    leaf.k_lambert = below(state, 1030, 1.0f / 1024.0f);
    leaf.n = 1.0f + below(state, 2048, 1.0f / 1024.0f);
    leaf.sigma = below(state, 1024, 1.0f / 1024.0f);
    leaf.normalization = next(state) % 2 == 0 ? LB_BOUSQUET_2005 : LB_COOK_TORRANCE;
    return leaf;
}

/* sin and cos of 2 atan(t), t = i/128 */
static void pair(uint32_t *state, float *sin, float *cos) {
    float t = below(state, 128, 1.0f / 128.0f);
    float t2 = t * t;
    *sin = 2.0f * t / (1.0f + t2);
    *cos = (1.0f - t2) / (1.0f + t2);
}

static lb_cosines cosines(uint32_t *state) {
    lb_cosines at;
    pair(state, &at.sin_theta_s, &at.cos_theta_s);
    pair(state, &at.sin_theta_v, &at.cos_theta_v);
    at.cos_phi_v = below(state, 2049, 1.0f / 1024.0f) - 1.0f;
    return at;
}

static void points(uint32_t *state, uint32_t block, agreement_print *print) {
    enum { BRDF, GRADIENT, DEGREES, DIRECTION, FRESNEL, KINDS };
    static const char *const names[KINDS] = {"brdf", "gradient", "degrees", "direction", "fresnel"};
    uint32_t hash[KINDS];
    for (int kind = 0; kind < KINDS; kind++) {
        hash[kind] = 2166136261u;
    }
    for (int point = 0; point < POINTS; point++) {
        lb_leaf one = leaf(state);
        lb_cosines at = cosines(state);
        float theta_s = below(state, 5800, 1.0f / 64.0f), theta_v = below(state, 5800, 1.0f / 64.0f);
        float phi_v = below(state, 11521, 1.0f / 32.0f);
        float cos_theta_a = below(state, 1025, 1.0f / 1024.0f);
        float value = 0;
        lb_gradient gradient = {0, 0, 0, 0};
        lb_direction direction = {0, 0, 0};

        lb_status status = lb_brdf(&one, &at, &value);
        hash_value(&hash[BRDF], status, value);

        status = lb_brdf_gradient(&one, &at, &gradient);
        hash_value(&hash[GRADIENT], status, gradient.value);
        hash_value(&hash[GRADIENT], status, gradient.d_k_lambert);
        hash_value(&hash[GRADIENT], status, gradient.d_n);
        hash_value(&hash[GRADIENT], status, gradient.d_sigma);

        status = lb_brdf_from_degrees(&one, theta_s, theta_v, phi_v, &value);
        hash_value(&hash[DEGREES], status, value);

        status = lb_direction_from_degrees(theta_s, theta_v, phi_v, one.normalization, &direction);
        hash_value(&hash[DIRECTION], status, direction.cos_theta_a);
        hash_value(&hash[DIRECTION], status, direction.tan2_alpha);
        hash_value(&hash[DIRECTION], status, direction.lobe_weight);
        if (status == LB_OK) {
            status = lb_brdf_at(&one, &direction, &value);
            hash_value(&hash[DIRECTION], status, value);
        }

        status = lb_fresnel(one.n, cos_theta_a, &value);
        hash_value(&hash[FRESNEL], status, value);
    }
    for (int kind = 0; kind < KINDS; kind++) {
        print(names[kind], block, hash[kind]);
    }
}

static void hemisphere(uint32_t *state, uint32_t block, agreement_print *print) {
    uint32_t hash = 2166136261u;
    for (int point = 0; point < 8; point++) {
        lb_leaf one = leaf(state);
        float value = 0;
        lb_status status = lb_dhrf(&one, below(state, 5800, 1.0f / 64.0f), &value);
        hash_value(&hash, status, value);
    }
    print("dhrf", block, hash);
}

static void inversion(uint32_t *state, uint32_t block, agreement_print *print) {
    float cos_theta_a[DIRECTIONS], tan2_alpha[DIRECTIONS], lobe_weight[DIRECTIONS];
    float brdf[DIRECTIONS], weight[DIRECTIONS];
    lb_directions directions = {cos_theta_a, tan2_alpha, lobe_weight, DIRECTIONS};
    lb_workspace workspace;
    lb_band band = {0};
    uint32_t hash = 2166136261u;
    lb_leaf one = leaf(state);
    one.k_lambert = one.k_lambert > 1.0f ? 1.0f : one.k_lambert;
    one.sigma += 1.0f / 32.0f;
    for (int i = 0; i < DIRECTIONS; i++) {
        /* one after the other: C leaves the order of arguments open */
        float theta_s = below(state, 60, 1.0f);
        float theta_v = below(state, 70, 1.0f);
        float phi_v = below(state, 360, 1.0f);
        lb_direction direction = {0, 0, 0};
        lb_status status = lb_direction_from_degrees(theta_s, theta_v, phi_v, LB_BOUSQUET_2005, &direction);
        hash_word(&hash, (uint32_t)status);
        cos_theta_a[i] = direction.cos_theta_a;
        tan2_alpha[i] = direction.tan2_alpha;
        lobe_weight[i] = direction.lobe_weight;
        status = lb_brdf_at(&one, &direction, &brdf[i]);
        hash_value(&hash, status, brdf[i]);
        brdf[i] += below(state, 64, 1.0f / 65536.0f); /* what an instrument adds */
        weight[i] = i % 8 == 7 ? 0.0f : 1.0f;
    }
    lb_status status = lb_fit_band(&directions, brdf, weight, NULL, &workspace, &band);
    hash_value(&hash, status, band.k_lambert);
    hash_value(&hash, status, band.n);
    hash_value(&hash, status, band.sigma);
    hash_value(&hash, status, band.k_lambert_se);
    hash_value(&hash, status, band.n_se);
    hash_value(&hash, status, band.sigma_se);
    hash_value(&hash, status, band.rmse);
    hash_word(&hash, band.n_obs);
    hash_word(&hash, band.at_bound);
    hash_word(&hash, band.iterations);
    hash_word(&hash, band.converged);
    print("fit", block, hash);
}

static void interior(uint32_t *state, uint32_t block, agreement_print *print) {
    uint32_t hash = 2166136261u;
    float reflectance[LB_SLICE_BANDS], transmittance[LB_SLICE_BANDS], wavelengths[8], k_lambert[8];
    lb_interior inside;
    lb_leaf surface = {0.0f, 1.5f, 0.25f, LB_BOUSQUET_2005};
    lb_cab cab = {0};
    inside.n_struct = 1.0f + below(state, 1024, 1.0f / 1024.0f);
    inside.cab = below(state, 100, 1.0f);
    inside.car = below(state, 20, 1.0f);
    inside.cant = below(state, 4, 1.0f);
    inside.cbrown = below(state, 8, 1.0f / 64.0f);
    inside.cw = below(state, 32, 1.0f / 1024.0f);
    inside.cm = below(state, 16, 1.0f / 1024.0f);
    lb_status status = lb_prospect_slice(&inside, 0, LB_SLICE_BANDS, reflectance, transmittance);
    hash_word(&hash, (uint32_t)status);
    for (int band = 0; band < LB_SLICE_BANDS; band++) {
        hash_float(&hash, reflectance[band]);
        hash_float(&hash, transmittance[band]);
    }
    print("prospect", block, hash);

    hash = 2166136261u;
    for (int i = 0; i < 8; i++) {
        int band = 20 + 12 * i;
        wavelengths[i] = (float)(LB_SLICE_FIRST_NM + LB_SLICE_STEP_NM * band);
        k_lambert[i] = reflectance[band];
    }
    status = lb_fit_cab(&surface, wavelengths, k_lambert, 8, &inside, 0.25f, &cab);
    hash_value(&hash, status, cab.n_struct);
    hash_value(&hash, status, cab.cab);
    hash_value(&hash, status, cab.n_struct_se);
    hash_value(&hash, status, cab.cab_se);
    hash_value(&hash, status, cab.dhrf_specular);
    hash_value(&hash, status, cab.rmse);
    hash_word(&hash, cab.iterations);
    hash_word(&hash, cab.converged);
    print("cab", block, hash);
}

void agreement(agreement_print *print) {
    uint32_t state = 20051u;
    for (uint32_t block = 0; block < BLOCKS; block++) {
        points(&state, block, print);
        hemisphere(&state, block, print);
        inversion(&state, block, print);
        interior(&state, block, print);
    }
}
