//! The exponential integral, and what a plate transmits: τ(K) = 2 E₃(K).

use leafbrdf_core::Real;

use crate::both::{numbers, single};

/// Exponential integral E₁(x) = ∫ₓ^∞ e⁻ᵗ/t dt.
///
/// - `x`: > 0. Zero gives +∞, a negative number or NaN gives NaN.
///
/// Fixed work for every argument: for x < 1, E₁ = −ln x plus a polynomial of degree 13; else e⁻ˣ/(x + 2) times a polynomial of degree 24
/// in 6/(x + 2) − 1. Accuracy in `f64`: 1e-14 relative for 1e-300 < x < 700 (`tests/precision.rs`).
///
/// # Example
///
/// The Gompertz constant is e E₁(1):
///
/// ```
/// use leafbrdf_prospect::expint::e1;
/// assert!((1f64.exp() * e1(1.0_f64) - 0.596_347_362_323_194_1).abs() < 1e-15);
/// ```
pub fn e1<T: Real>(x: T) -> T {
    if x < T::ONE {
        return horner(&E1_THIN, const { &single(E1_THIN) }, x + x - T::ONE) - x.ln();
    }
    let inverse = T::ONE / (x + T::TWO);
    (-x).exp() * inverse * horner(&E1_THICK, const { &single(E1_THICK) }, T::lit(6.0) * inverse - T::ONE)
}

/// What one passage through an elementary layer leaves of isotropic light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission<T> {
    /// τ(K) = (1−K) e⁻ᴷ + K² E₁(K) = 2 E₃(K), in [0, 1].
    pub tau: T,
    /// 1 − τ, without cancellation at small K.
    pub absorbed: T,
}

/// Absorption coefficient at which the two expansions of [`transmission`] meet.
pub(crate) const THICK: f64 = 2.0;

/// Transmission of isotropic light through an absorbing layer, τ(K) (Jacquemoud & Baret 1990), unitless.
///
/// - `k`: absorption coefficient K of the layer, unitless, ≥ 0.
///
/// Accuracy in `f64`: τ 1e-15 absolute and 5e-14 relative, 1 − τ 2e-15 relative.
///
/// # Example
///
/// Isotropic light travels on average twice the thickness, so a weak absorber takes 2K:
///
/// ```
/// use leafbrdf_prospect::expint::transmission;
/// assert!((transmission(1e-9_f64).absorbed / 2e-9 - 1.0).abs() < 1e-7);
/// assert_eq!(transmission(0.0_f64).tau, 1.0);
/// ```
#[inline(always)]
pub fn transmission<T: Real>(k: T) -> Transmission<T> {
    transmission_either(k, k_ln_k(k))
}

/// [`transmission`] from K ln K; two selects rather than a branch, so that a loop over bands vectorises.
#[inline(always)]
pub(crate) fn transmission_either<T: Real>(k: T, k_ln_k: T) -> Transmission<T> {
    let thin = transmission_thin(k, k_ln_k);
    let thick = transmission_thick(k);
    let is_thin = k < T::lit(THICK);
    Transmission {
        tau: if is_thin { thin.tau } else { thick.tau },
        absorbed: if is_thin { thin.absorbed } else { thick.absorbed },
    }
}

/// τ for K < 2: 1 − τ = K (K ln K + polynomial).
#[inline(always)]
pub(crate) fn transmission_thin<T: Real>(k: T, k_ln_k: T) -> Transmission<T> {
    let absorbed = k * (k_ln_k + horner(&ABSORBED_THIN, const { &single(ABSORBED_THIN) }, k - T::ONE));
    Transmission { tau: T::ONE - absorbed, absorbed }
}

/// τ for K ≥ 2: e⁻ᴷ/(K + 3.5) times a polynomial.
#[inline(always)]
pub(crate) fn transmission_thick<T: Real>(k: T) -> Transmission<T> {
    let tau = T::TWO * (-k).exp() * scaled_e3(k);
    Transmission { tau, absorbed: T::ONE - tau }
}

/// (dτ/dK)/τ = −E₂(K)/E₃(K) = −2 E₂/τ: finite for every K, −2 at K = 0 and −1 at infinity.
///
/// - `k`: absorption coefficient, ≥ 0; `tau`: [`transmission`] of it.
#[inline(always)]
pub fn transmission_log_slope<T: Real>(k: T, tau: T) -> T {
    log_slope(k, k_ln_k(k), T::ONE / tau)
}

/// [`transmission_log_slope`] from K ln K and 1/τ, which the loop over bands has already.
#[inline(always)]
pub(crate) fn log_slope<T: Real>(k: T, k_ln_k: T, tau_inverse: T) -> T {
    let thin = log_slope_thin(k, k_ln_k, tau_inverse);
    let thick = log_slope_thick(k);
    if k < T::lit(THICK) { thin } else { thick }
}

/// −2 E₂(K)/τ for K < 2, E₂ = K ln K + polynomial.
#[inline(always)]
pub(crate) fn log_slope_thin<T: Real>(k: T, k_ln_k: T, tau_inverse: T) -> T {
    let e2 = k_ln_k + horner(&E2_THIN, const { &single(E2_THIN) }, k - T::ONE);
    -(e2 + e2) * tau_inverse
}

/// −E₂/E₃ for K ≥ 2, from K E₂ = e⁻ᴷ − 2 E₃ with e⁻ᴷ divided out, so that it survives underflow.
#[inline(always)]
pub(crate) fn log_slope_thick<T: Real>(k: T) -> T {
    (T::TWO - T::ONE / scaled_e3(k)) / k
}

/// eᴷ E₃(K) for K ≥ 2.
#[inline(always)]
fn scaled_e3<T: Real>(k: T) -> T {
    let inverse = T::ONE / (k + T::lit(3.5));
    inverse * horner(&E3_THICK, const { &single(E3_THICK) }, T::lit(11.0) * inverse - T::ONE)
}

/// K ln K, 0 at K = 0.
#[inline(always)]
pub(crate) fn k_ln_k<T: Real>(k: T) -> T {
    k * k.max(T::lit(1e-37)).ln()
}

/// Polynomial with the highest power first, its coefficients in both precisions.
#[inline(always)]
fn horner<T: Real, const N: usize>(double: &[f64; N], single: &[f32; N], z: T) -> T {
    let mut sum = T::ZERO;
    for c in numbers::<T, N>(double, single) {
        sum = sum * z + c;
    }
    sum
}

// Chebyshev interpolation in 60 digits, written by data/fit_expint.py.

/// (E₁(x) + ln x) on 0 ≤ x ≤ 1, in z = 2x − 1.
/// Relative truncation error 5.8e-19.
const E1_THIN: [f64; 14] = [
    9.518204875451783e-16,
    -2.6899169786567253e-14,
    7.037080962511791e-13,
    -1.7096548913113003e-11,
    3.8172114174287463e-10,
    -7.774613682905781e-09,
    1.4319708612520696e-07,
    -2.36082288702094e-06,
    3.4423125991168343e-05,
    -0.00043790563907271195,
    0.0047958926556568955,
    -0.04510200521552493,
    0.3934693402873666,
    -0.1333735857837845,
];

/// eˣ (x + 2) E₁(x) on x ≥ 1, in z = 6/(x + 2) − 1.
/// Relative truncation error 6.6e-16.
const E1_THICK: [f64; 25] = [
    2.6641491344528896e-08,
    4.133136701149172e-08,
    -5.920768724237972e-08,
    -6.957293802450029e-08,
    2.338813399463516e-07,
    3.7387687125889757e-07,
    2.2495489606280473e-07,
    5.845899612792523e-07,
    1.8279436361067734e-06,
    3.7146426367118783e-06,
    7.634049380536976e-06,
    1.6121790859096924e-05,
    3.5142998901629486e-05,
    7.484576685918179e-05,
    0.00016391877648335744,
    0.0003540052463566253,
    0.0007876288276454789,
    0.0017318392452306873,
    0.003948980118033615,
    0.008911917701134956,
    0.021210703497960098,
    0.049944964710809475,
    0.13029088159637459,
    0.33348270415564224,
    1.238073899406335,
];

/// ((1 − 2 E₃(x))/x − x ln x) on 0 ≤ x ≤ 2, in z = x − 1.
/// Relative truncation error 1.9e-16.
const ABSORBED_THIN: [f64; 15] = [
    -5.00221612351994e-14,
    8.217240570003217e-13,
    -1.2520789953424828e-11,
    1.813320101050887e-10,
    -2.454485384930224e-09,
    3.09244878181495e-08,
    -3.612464961848863e-07,
    3.898060881775191e-06,
    -3.875374495682509e-05,
    0.0003552230262270587,
    -0.003031936261939132,
    0.025052029400031987,
    -0.23575888234288464,
    -1.4836250520526357,
    0.7806160656044797,
];

/// (E₂(x) − x ln x) on 0 ≤ x ≤ 2, in z = x − 1.
/// Relative truncation error 7.4e-16.
const E2_THIN: [f64; 15] = [
    -3.5415614685989307e-13,
    5.4121317717401774e-12,
    -7.611235058483001e-11,
    1.0128366672149497e-09,
    -1.2502256511276185e-08,
    1.4235004728767236e-07,
    -1.4864490922093316e-06,
    1.4147257523205599e-05,
    -0.0001219948942452567,
    0.0009494078438157288,
    -0.006691783089282807,
    0.044040186276185146,
    -0.31606027941427883,
    -1.2193839343955202,
    0.14849550677592205,
];

/// eˣ (x + 3.5) E₃(x) on x ≥ 2, in z = 11/(x + 3.5) − 1.
/// Relative truncation error 8.5e-15.
const E3_THICK: [f64; 19] = [
    8.142409926298425e-09,
    7.3155375393246095e-09,
    4.3624534136364994e-09,
    2.1568757047496835e-08,
    1.1772490405741327e-07,
    2.010049543715532e-07,
    6.496449391015156e-07,
    1.3558821416446873e-06,
    4.533255627083991e-06,
    1.0000000795067797e-05,
    3.366104298673062e-05,
    7.886220235423472e-05,
    0.00027886414579101845,
    0.000692931938627355,
    0.002724877502531811,
    0.007242115831449811,
    0.03589069696137777,
    0.10428189714060508,
    1.0733739801021949,
];
