/*
 * leafbrdf: the leaf BRDF of Bousquet et al. (2005), its hemispherical integral and its inversion, in single precision.
 *
 * Generated from firmware/leafbrdf-c/src by cbindgen; do not edit. `LEAFBRDF_BLESS=1 cargo test -p leafbrdf-c` makes it anew.
 *
 * - Functions return an `lb_status`: LB_OK, or what is wrong. On any other status the outputs keep what they held (only
 *   lb_fit_bands writes every band, each with a status of its own).
 * - No globals, no heap, no locks: every function may be called from any thread or interrupt with its own arguments.
 * - A null pointer gives LB_ERR_NULL. Any other pointer must point to as many values as the function says; outputs and
 *   workspace must not overlap the inputs.
 * - Units: angles in degrees where the name says `_deg`, BRDF in sr^-1, wavelengths in nm. Azimuth 180 degrees is the
 *   forward, specular side.
 */

#ifndef LEAFBRDF_H
#define LEAFBRDF_H

#include <stdint.h>
#include <stddef.h>

/**
 * Floats in an lb_workspace.
 */
#define LB_WORKSPACE_FLOATS 182

/**
 * The most steps of the search for one band, 40 a start from 4 starts; a step is one pass over the directions, and one more
 * pass comes before them all.
 */
#define LB_BAND_MOST_STEPS 160

/**
 * Bit of lb_band.at_bound: k_lambert is at its lower bound and held there.
 */
#define LB_AT_LOWER_K_LAMBERT 1

/**
 * Bit of lb_band.at_bound: k_lambert is at its upper bound.
 */
#define LB_AT_UPPER_K_LAMBERT 2

/**
 * Bit of lb_band.at_bound: n is at its lower bound.
 */
#define LB_AT_LOWER_N 4

/**
 * Bit of lb_band.at_bound: n is at its upper bound.
 */
#define LB_AT_UPPER_N 8

/**
 * Bit of lb_band.at_bound: sigma is at its lower bound.
 */
#define LB_AT_LOWER_SIGMA 16

/**
 * Bit of lb_band.at_bound: sigma is at its upper bound.
 */
#define LB_AT_UPPER_SIGMA 32

/**
 * The most steps of lb_fit_cab, over both its starts; a step is at most two passes over the wavelengths.
 */
#define LB_CAB_MOST_STEPS 80

/**
 * First wavelength of the slice of PROSPECT-D that is built in, nm.
 */
#define LB_SLICE_FIRST_NM 400

/**
 * Step of the slice, nm.
 */
#define LB_SLICE_STEP_NM 5

/**
 * Bands of the slice: 400, 405, ... 1000 nm, 4.4 KB of flash.
 */
#define LB_SLICE_BANDS 121

/**
 * Constant of the specular term as printed in the paper's Eq. 10, 2 pi^2. Fitted values of the paper belong to it.
 */
#define LB_BOUSQUET_2005 0

/**
 * Constant of the specular term as derived from Eqs 5, 6 and 9, 4 pi: energy-conserving.
 */
#define LB_COOK_TORRANCE 1

/**
 * What a function says of its call: `LB_OK`, or what was wrong with an argument.
 */
typedef int32_t lb_status;

/**
 * The directions of a measurement, prepared: three arrays of `count` values each, usually constant tables in flash.
 */
typedef struct lb_directions {
  /**
   * lb_direction.cos_theta_a of every direction.
   */
  const float *cos_theta_a;
  /**
   * lb_direction.tan2_alpha of every direction.
   */
  const float *tan2_alpha;
  /**
   * lb_direction.lobe_weight of every direction.
   */
  const float *lobe_weight;
  /**
   * Number of directions.
   */
  uint32_t count;
} lb_directions;

/**
 * Where the three parameters are sought: -1 <= k_lambert <= 2, 1.0001 <= n <= 100, 1e-4 <= sigma <= 10, each lower < upper.
 */
typedef struct lb_bounds {
  /**
   * Least k_L; 0.01 in the paper's Table 3.
   */
  float k_lambert_lower;
  /**
   * Greatest k_L; 0.99.
   */
  float k_lambert_upper;
  /**
   * Least n; 1.1.
   */
  float n_lower;
  /**
   * Greatest n; 5.
   */
  float n_upper;
  /**
   * Least sigma; 0.01.
   */
  float sigma_lower;
  /**
   * Greatest sigma; 1.
   */
  float sigma_upper;
} lb_bounds;

/**
 * Memory that the inversion of a band works in, the caller's: on the stack, static, or shared between tasks that take turns.
 * Its contents do not matter before, and mean nothing after.
 */
typedef struct lb_workspace {
  /**
   * Not for use.
   */
  float memory[LB_WORKSPACE_FLOATS];
} lb_workspace;

/**
 * What the inversion of one wavelength finds.
 */
typedef struct lb_band {
  /**
   * Lambert coefficient k_L.
   */
  float k_lambert;
  /**
   * Refractive index of the surface, under the normalization of the directions.
   */
  float n;
  /**
   * Roughness of the surface.
   */
  float sigma;
  /**
   * Standard error of k_L; NaN where k_L is at a bound or the data do not determine it.
   */
  float k_lambert_se;
  /**
   * Standard error of n; NaN as above.
   */
  float n_se;
  /**
   * Standard error of sigma; NaN as above.
   */
  float sigma_se;
  /**
   * Root mean square of measured - modelled BRDF, sr^-1 where every weight is 1.
   */
  float rmse;
  /**
   * Values that counted (weight > 0).
   */
  uint32_t n_obs;
  /**
   * Which parameters sit at a bound: LB_AT_... added up.
   */
  uint32_t at_bound;
  /**
   * Steps of the search, over all its starts: passes over the directions.
   */
  uint32_t iterations;
  /**
   * 1 where the search arrived at a minimum, 0 where it ran out of steps.
   */
  uint32_t converged;
  /**
   * LB_OK, or why this band has no result (then nothing else in this struct is meaningful).
   */
  lb_status status;
} lb_band;

/**
 * A leaf at one wavelength: a Lambertian interior under a specular surface.
 */
typedef struct lb_leaf {
  /**
   * Lambert coefficient k_L, unitless, 0 to 1.
   */
  float k_lambert;
  /**
   * Refractive index of the surface, unitless, 1 to 16384.
   */
  float n;
  /**
   * Roughness of the surface, unitless, 2^-30 to 1024: facets are spread as exp(-tan^2(alpha)/sigma^2).
   */
  float sigma;
  /**
   * LB_BOUSQUET_2005 or LB_COOK_TORRANCE. An n fitted under one means nothing under the other.
   */
  uint32_t normalization;
} lb_leaf;

/**
 * The interior of a leaf: PROSPECT-D's structure and contents.
 */
typedef struct lb_interior {
  /**
   * N, number of plates, 1 to 10.
   */
  float n_struct;
  /**
   * C_ab, chlorophylls a + b, ug cm^-2, 0 to 300.
   */
  float cab;
  /**
   * C_car, carotenoids, ug cm^-2, 0 to 100.
   */
  float car;
  /**
   * C_ant, anthocyanins, ug cm^-2, 0 to 200.
   */
  float cant;
  /**
   * C_brown, brown pigments, arbitrary units, 0 to 10.
   */
  float cbrown;
  /**
   * C_w, equivalent water thickness, cm, 0 to 1.
   */
  float cw;
  /**
   * C_m, dry matter, g cm^-2, 0 to 0.2.
   */
  float cm;
} lb_interior;

/**
 * What lb_fit_cab finds.
 */
typedef struct lb_cab {
  /**
   * N, number of plates; sought from 1 to 5.
   */
  float n_struct;
  /**
   * C_ab, chlorophylls a + b, ug cm^-2; sought from 0 to 150.
   */
  float cab;
  /**
   * Standard error of N; NaN where N is at a bound or the data do not determine it.
   */
  float n_struct_se;
  /**
   * Standard error of C_ab, ug cm^-2; NaN as above.
   */
  float cab_se;
  /**
   * DHRF_spec of the surface at normal incidence, which was added to k_L.
   */
  float dhrf_specular;
  /**
   * Root mean square of measured - modelled reflectance, a fraction.
   */
  float rmse;
  /**
   * Steps of the search, over all its starts.
   */
  uint32_t iterations;
  /**
   * 1 where the search arrived at a minimum, 0 where it ran out of steps.
   */
  uint32_t converged;
} lb_cab;

/**
 * One pair of directions, prepared: three numbers that lb_brdf_at and (as arrays) the fit read.
 */
typedef struct lb_direction {
  /**
   * Cosine of the incidence angle on the facet.
   */
  float cos_theta_a;
  /**
   * Squared tangent of the facet's tilt.
   */
  float tan2_alpha;
  /**
   * pi G/(K cos theta_s cos theta_v), the constant K of the normalization included.
   */
  float lobe_weight;
} lb_direction;

/**
 * Sines and cosines of one pair of directions, as an instrument with fixed directions keeps them in a table.
 */
typedef struct lb_cosines {
  /**
   * cos theta_s, above 0: illumination zenith angle.
   */
  float cos_theta_s;
  /**
   * sin theta_s, 0 to 1.
   */
  float sin_theta_s;
  /**
   * cos theta_v, above 0: viewing zenith angle.
   */
  float cos_theta_v;
  /**
   * sin theta_v, 0 to 1.
   */
  float sin_theta_v;
  /**
   * cos phi_v, -1 to 1: viewing azimuth from the illumination; -1 is the forward, specular side.
   */
  float cos_phi_v;
} lb_cosines;

/**
 * BRDF and its exact derivatives, sr^-1.
 */
typedef struct lb_gradient {
  /**
   * BRDF.
   */
  float value;
  /**
   * dBRDF/dk_L.
   */
  float d_k_lambert;
  /**
   * dBRDF/dn.
   */
  float d_n;
  /**
   * dBRDF/dsigma.
   */
  float d_sigma;
} lb_gradient;

/**
 * Done; the outputs are written.
 */
#define LB_OK 0

/**
 * A pointer is null.
 */
#define LB_ERR_NULL 1

/**
 * theta_s is outside 0 <= theta_s < 90 degrees, or its sine and cosine do not belong together.
 */
#define LB_ERR_THETA_S 2

/**
 * theta_v is outside 0 <= theta_v < 90 degrees, or its sine and cosine do not belong together.
 */
#define LB_ERR_THETA_V 3

/**
 * phi_v is outside -360 <= phi_v <= 360 degrees, or its cosine outside -1 to 1.
 */
#define LB_ERR_PHI_V 4

/**
 * The cosine of the incidence angle on the facet is outside 0 to 1.
 */
#define LB_ERR_THETA_A 5

/**
 * k_lambert is outside 0 <= k_lambert <= 1.
 */
#define LB_ERR_K_LAMBERT 6

/**
 * n is outside 1 <= n <= 16384.
 */
#define LB_ERR_N 7

/**
 * sigma is outside 2^-30 <= sigma <= 1024.
 */
#define LB_ERR_SIGMA 8

/**
 * normalization is neither LB_BOUSQUET_2005 nor LB_COOK_TORRANCE.
 */
#define LB_ERR_NORMALIZATION 9

/**
 * Bounds are out of order or outside the model's domain.
 */
#define LB_ERR_BOUNDS 10

/**
 * A measured value, a weight or a direction is not finite, or a weight is negative.
 */
#define LB_ERR_DATA 11

/**
 * Fewer values than free parameters count.
 */
#define LB_ERR_TOO_FEW 12

/**
 * A count is 0, or leads beyond the table.
 */
#define LB_ERR_COUNT 13

/**
 * A parameter of PROSPECT is impossible, or probably in another unit.
 */
#define LB_ERR_INTERIOR 14

/**
 * A wavelength is outside the slice of PROSPECT, or they do not rise.
 */
#define LB_ERR_WAVELENGTH 15

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Inverts the measurements of one wavelength for k_L, n and sigma: least squares inside bounds (Eq. 11).
 *
 * - directions: prepared directions.
 * - brdf: measured BRDF, sr^-1, one value a direction.
 * - weight: one a value: 1, or relative weights; 0 for a missing value.
 * - bounds: null for those of the paper's Table 3.
 * - workspace: memory of the caller.
 *
 * LB_ERR_TOO_FEW where fewer than 3 values count. A search that stops early is an answer: see `converged`.
 *
 * # Safety
 * `brdf` and `weight` point to `directions->count` values, or are null; so do the arrays of `directions`. Nothing else uses
 * `workspace` during the call.
 */
lb_status lb_fit_band(const struct lb_directions *directions,
                      const float *brdf,
                      const float *weight,
                      const struct lb_bounds *bounds,
                      struct lb_workspace *workspace,
                      struct lb_band *band);

/**
 * Inverts several wavelengths measured at the same directions, one after the other.
 *
 * - brdf: band_count x count values, band after band.
 * - weight: count values, for all bands.
 * - bands: results, one a band, each with its own status.
 *
 * Everything else as in lb_fit_band. Returns LB_OK where every band has a result, else the status of the last one that has not.
 *
 * # Safety
 * As lb_fit_band, with `brdf` pointing to `band_count` x `count` values and `bands` to room for `band_count` results.
 */
lb_status lb_fit_bands(const struct lb_directions *directions,
                       const float *brdf,
                       const float *weight,
                       uint32_t band_count,
                       const struct lb_bounds *bounds,
                       struct lb_workspace *workspace,
                       struct lb_band *bands);

/**
 * Chlorophyll content of a leaf whose surface is known: N and C_ab from k_L at a few wavelengths (Eqs 16 to 18: the
 * interior's reflectance is k_L + DHRF_spec(n, sigma, 0)), the other contents held as given.
 *
 * - surface: n, sigma and their normalization; k_lambert is not looked at.
 * - wavelengths_nm: inside the slice, in any order; between its bands the table is interpolated. Some in the red edge
 *   (700 to 740 nm) and some in the near infrared, or C_ab and N stay unknown.
 * - k_lambert: k_L at these wavelengths, one value each; more than 2.
 * - bands: their number.
 * - held: the other contents; its n_struct and cab are not looked at, but must lie in their ranges.
 * - car_per_cab: C_car = car_per_cab x C_ab, 0 to 10, added to held's car; 0.25 is usual in green leaves, 0 ties nothing.
 *
 * Bounded: at most LB_CAB_MOST_STEPS steps.
 *
 * # Safety
 * `wavelengths_nm` and `k_lambert` point to `bands` values, or are null.
 */
lb_status lb_fit_cab(const struct lb_leaf *surface,
                     const float *wavelengths_nm,
                     const float *k_lambert,
                     uint32_t bands,
                     const struct lb_interior *held,
                     float car_per_cab,
                     struct lb_cab *cab);

/**
 * Prepares one pair of directions from angles in degrees (ranges as in lb_brdf_from_degrees).
 *
 * - normalization: LB_BOUSQUET_2005 or LB_COOK_TORRANCE; n and sigma fitted with these directions belong to it.
 */
lb_status lb_direction_from_degrees(float theta_s_deg,
                                    float theta_v_deg,
                                    float phi_v_deg,
                                    uint32_t normalization,
                                    struct lb_direction *direction);

/**
 * Prepares one pair of directions from sines and cosines.
 */
lb_status lb_direction_from_cosines(const struct lb_cosines *at,
                                    uint32_t normalization,
                                    struct lb_direction *direction);

/**
 * BRDF of a leaf in sr^-1 at a prepared direction: the cheapest way. The direction's normalization holds; that of the
 * leaf must be a valid one, and is not looked at otherwise. The direction is not checked.
 */
lb_status lb_brdf_at(const struct lb_leaf *leaf,
                     const struct lb_direction *at,
                     float *brdf);

/**
 * DHRF_spec (Eq. 14): the share of the light from theta_s that the surface reflects and that never enters the leaf,
 * unitless. The leaf's whole reflectance is k_lambert more (Eq. 12); k_lambert is not looked at here.
 *
 * - theta_s_deg: zenith angle of the illumination, 0 <= theta_s < 90 degrees.
 *
 * At most 180 evaluations of the Fresnel factor for any theta_s and sigma; relative error 2e-5, that of `Grade::E4d`, and what
 * single precision adds.
 *
 * Example: beech (n 1.56, sigma 0.29, LB_BOUSQUET_2005) at 60 degrees gives 0.0551.
 */
lb_status lb_dhrf(const struct lb_leaf *leaf,
                  float theta_s_deg,
                  float *dhrf_specular);

/**
 * Reflectance and transmittance of a leaf's interior in neighbouring bands of the slice, fractions (PROSPECT-D).
 *
 * - first_band: 0 is LB_SLICE_FIRST_NM, the next LB_SLICE_STEP_NM further.
 * - bands: how many, 1 to LB_SLICE_BANDS - first_band.
 * - reflectance, transmittance: room for so many values.
 *
 * # Safety
 * `reflectance` and `transmittance` point to room for `bands` values each that nothing else uses during the call, or are null.
 */
lb_status lb_prospect_slice(const struct lb_interior *interior,
                            uint32_t first_band,
                            uint32_t bands,
                            float *reflectance,
                            float *transmittance);

/**
 * What a status means, in one English sentence in ASCII: a constant string, never null.
 */
const char *lb_status_text(lb_status status);

/**
 * The version of this library, major * 65536 + minor * 256 + patch: 0.1.0 is 256.
 */
uint32_t lb_version(void);

/**
 * Fresnel factor of a facet (Eq. 8): the share of unpolarised light that it reflects, unitless, 0 to 1.
 *
 * - n: refractive index, 1 to 16384.
 * - cos_theta_a: cosine of the incidence angle on the facet, 0 to 1.
 *
 * Example: n = 1.5 at cos_theta_a = 1 gives 0.04.
 */
lb_status lb_fresnel(float n, float cos_theta_a, float *fresnel);

/**
 * BRDF of a leaf in sr^-1 (Eqs 3, 4, 10) from sines and cosines.
 *
 * Relative error below 1e-5 where tan^2(alpha)/sigma^2 < 14, 2.5e-5 below 80. That a sine and a cosine belong together
 * is not checked here (lb_brdf_gradient does).
 */
lb_status lb_brdf(const struct lb_leaf *leaf,
                  const struct lb_cosines *at,
                  float *brdf);

/**
 * BRDF and its exact derivatives with respect to k_L, n and sigma, sr^-1.
 */
lb_status lb_brdf_gradient(const struct lb_leaf *leaf,
                           const struct lb_cosines *at,
                           struct lb_gradient *gradient);

/**
 * BRDF of a leaf in sr^-1 from angles in degrees.
 *
 * - theta_s_deg, theta_v_deg: zenith angles of illumination and view, 0 <= theta < 90 degrees.
 * - phi_v_deg: azimuth of the view from the illumination, -360 to 360 degrees; 180 is the forward, specular side.
 *
 * Where directions are fixed, a table of lb_direction and lb_brdf_at are several times faster.
 *
 * Example: laurel (k_lambert 0, n 1.22, sigma 0.078, LB_BOUSQUET_2005) at 60, 60, 180 degrees gives 1.25 sr^-1.
 */
lb_status lb_brdf_from_degrees(const struct lb_leaf *leaf,
                               float theta_s_deg,
                               float theta_v_deg,
                               float phi_v_deg,
                               float *brdf);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* LEAFBRDF_H */
