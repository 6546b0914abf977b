//! The leaf as a pile of N plates (Stokes 1862), N real: reflectance, transmittance, absorptance and their slopes.
//!
//! With M = N − 1, D² = (1+r+t)(1+r−t)(1−r+t)(1−r−t) and sinh L = D/2t, Stokes' equations for the M lower plates read
//! R_sub = 2 r Q/G, T_sub = 1/G, where Q = sinh(ML)/D, G = (1 + r² − t²) Q + cosh ML. Joined with the upper plate:
//!
//! T = T_top/H,  R = R_top + 2 r t Q T,  H = (1 − r² − t²) Q + cosh ML.
//!
//! Q → M/2t as D → 0 (no absorption), so that nothing special happens there, nor at N = 1 (Q = 0, H = 1). To keep
//! strong absorption in range everything is multiplied by y = e^(−ML).

use leafbrdf_core::Real;

use crate::both::{numbers, single};
use crate::interface::ln_1p;
use crate::plate::{Plate, PlateSlope};

/// What becomes of the light that falls on a leaf at one wavelength: fractions, unitless.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optics<T> {
    /// Hemispherical reflectance R.
    pub reflectance: T,
    /// Hemispherical transmittance T.
    pub transmittance: T,
    /// Absorptance 1 − R − T, computed without cancellation.
    pub absorptance: T,
}

/// Slopes of reflectance and transmittance at one wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slopes<T> {
    /// ∂R/∂K, ∂T/∂K: by the absorption coefficient of one layer, N held.
    pub dr_dk: T,
    /// See [`Slopes::dr_dk`].
    pub dt_dk: T,
    /// ∂R/∂N, ∂T/∂N: by the number of plates, K held.
    pub dr_dn: T,
    /// See [`Slopes::dr_dn`].
    pub dt_dn: T,
}

/// Smallest 1 − r − t that enters D: far below what changes any result, and large enough that D > 0 also in `f32`.
const LEAST_ABSORPTION: f64 = 1e-30;

/// What the pile is made of, from one plate.
#[derive(Clone, Copy)]
pub(crate) struct Pair<T> {
    /// D, and 1 − r² − t².
    pub d: T,
    pub z: T,
    /// 1/2t.
    pub half_t: T,
    /// e^L − 1.
    pub growth: T,
}

impl<T: Real> Pair<T> {
    #[inline(always)]
    pub(crate) fn new(plate: &Plate<T>) -> Self {
        let Plate { r, t, .. } = *plate;
        let a = plate.a.max(T::lit(LEAST_ABSORPTION));
        let d = ((T::ONE + r + t) * (T::ONE + r - t) * (T::ONE - r + t) * a).sqrt();
        // t may underflow to 0 under extreme absorption. L then only enters y, which multiplies a transmittance of 0.
        let half_t = T::HALF / t.max(T::lit(8.0) / T::MAX);
        // e^L − 1 = ((1−t)² − r² + D)/2t, the first two terms as (1−r−t)(1+r−t)
        let growth = (a * (T::ONE + r - t) + d) * half_t;
        Pair { d, z: (T::ONE - r) * (T::ONE + r) - t.squared(), half_t, growth }
    }
}

/// How light fades on its way down the M lower plates.
#[derive(Clone, Copy)]
pub(crate) struct Decay<T> {
    /// L, y = e^(−ML) and y − 1.
    pub l: T,
    pub y: T,
    pub y_less_one: T,
}

impl<T: Real> Decay<T> {
    /// L from e^L − 1.
    #[inline(always)]
    pub(crate) fn rate(growth: T) -> T {
        ln_1p(growth)
    }

    #[inline(always)]
    pub(crate) fn new(l: T, m: T) -> Self {
        let (y, y_less_one) = exp_and_m1(-(m * l));
        Decay { l, y, y_less_one }
    }

    /// 1 − y² = 2 y sinh ML.
    #[inline(always)]
    fn odd(&self) -> T {
        -(self.y_less_one * (T::ONE + self.y))
    }

    /// 1 + y² = 2 y cosh ML.
    #[inline(always)]
    fn even(&self) -> T {
        T::ONE + self.y.squared()
    }
}

/// The two reciprocals of a pile, from one division.
#[derive(Clone, Copy)]
pub(crate) struct Reciprocals<T> {
    /// 1/(Z (1−y²) + D (1+y²)) = 1/(2 D y H).
    pub h: T,
    /// 1/D.
    pub d: T,
}

impl<T: Real> Reciprocals<T> {
    #[inline(always)]
    pub(crate) fn new(pair: &Pair<T>, decay: &Decay<T>) -> Self {
        let h = pair.z * decay.odd() + pair.d * decay.even();
        let both = T::ONE / (pair.d * h);
        Reciprocals { h: pair.d * both, d: h * both }
    }
}

/// The leaf from its parts.
#[inline(always)]
pub(crate) fn optics<T: Real>(
    plate: &Plate<T>,
    pair: &Pair<T>,
    decay: &Decay<T>,
    reciprocals: &Reciprocals<T>,
) -> Optics<T> {
    // T_top/(2 D y H)
    let scaled = plate.t_top * reciprocals.h;
    // cosh ML − 1 = (1−y)²/2y
    let held = plate.a * (T::ONE + plate.r + plate.t) * decay.odd() + pair.d * decay.y_less_one.squared();
    Optics {
        reflectance: plate.r_top + T::TWO * plate.r * plate.t * decay.odd() * scaled,
        transmittance: T::TWO * pair.d * decay.y * scaled,
        absorptance: plate.a_top + held * scaled,
    }
}

/// Reflectance, transmittance and absorptance of a leaf of 1 + `m` plates.
#[inline(always)]
pub(crate) fn leaf<T: Real>(plate: &Plate<T>, m: T) -> Optics<T> {
    let pair = Pair::new(plate);
    let decay = Decay::new(Decay::rate(pair.growth), m);
    optics(plate, &pair, &decay, &Reciprocals::new(&pair, &decay))
}

/// The exact slopes of the leaf, from the same parts.
#[inline(always)]
pub(crate) fn slopes<T: Real>(
    plate: &Plate<T>,
    slope: PlateSlope<T>,
    pair: &Pair<T>,
    decay: &Decay<T>,
    reciprocals: &Reciprocals<T>,
    m: T,
    series: &SlopeSeries<T>,
) -> Slopes<T> {
    let Plate { r, t, .. } = *plate;
    let y = decay.y;
    let d_inverse = reciprocals.d;
    // y Q, y cosh ML and 1/(y H)
    let q = T::HALF * decay.odd() * d_inverse;
    let cosh = T::HALF * decay.even();
    let h_inverse = T::TWO * pair.d * reciprocals.h;
    let transmittance = plate.t_top * y * h_inverse;

    // ∂/∂N at constant K: Q' = (L/D) cosh ML, (cosh ML)' = L D Q, and cosh² − D²Q² = 1 leaves one term in R'.
    let l_by_d = decay.l * d_inverse;
    let h_n = pair.z * l_by_d * cosh + decay.l * pair.d * q;
    let dt_dn = -(transmittance * h_n * h_inverse);
    let dr_dn = T::TWO * r * t * plate.t_top * l_by_d * (y * h_inverse).squared();

    // ∂/∂K at constant N. With e = D dL/dK:  Q' = V e − Q t'/t,  (cosh ML)' = M Q e,  V = (M cosh ML − 2t cosh L · Q)/D².
    let e = -(slope.log_t * pair.z + T::TWO * r * slope.r);
    let v = series.v(pair, decay, plate, m, q, cosh, d_inverse);
    let q_k = v * e - q * slope.log_t;
    let z_k = -(T::TWO * (r * slope.r + t.squared() * slope.log_t));
    let h_k = (z_k * q + pair.z * q_k + m * q * e) * h_inverse;
    let dt_dk = transmittance * (slope.log_t - h_k);
    let dr_dk =
        slope.r_top + T::TWO * t * plate.t_top * h_inverse * (slope.r * q + r * v * e + r * q * (slope.log_t - h_k));
    Slopes { dr_dk, dt_dk, dr_dn, dt_dn }
}

/// A pile of equal plates under isotropic light, not joined with another upper plate: reflectance, transmittance and slopes.
#[derive(Clone, Copy)]
pub(crate) struct Pile<T> {
    pub r: T,
    pub t: T,
    pub slopes: Slopes<T>,
}

/// `m` ≥ 0 equal plates: R = 2 r Q/G, T = 1/G. `plate` is one whose two faces are alike.
#[inline(always)]
pub(crate) fn pile<T: Real>(plate: &Plate<T>, slope: PlateSlope<T>, m: T, series: &SlopeSeries<T>) -> Pile<T> {
    let pair = Pair::new(plate);
    let decay = Decay::new(Decay::rate(pair.growth), m);
    pile_of(plate, slope, &pair, &decay, m, series)
}

/// [`pile`] from its parts.
#[inline(always)]
pub(crate) fn pile_of<T: Real>(
    plate: &Plate<T>,
    slope: PlateSlope<T>,
    pair: &Pair<T>,
    decay: &Decay<T>,
    m: T,
    series: &SlopeSeries<T>,
) -> Pile<T> {
    let Plate { r, t, .. } = *plate;
    let y = decay.y;
    let d_inverse = T::ONE / pair.d;
    // y Q, y cosh ML, y G and its reciprocal
    let q = T::HALF * decay.odd() * d_inverse;
    let cosh = T::HALF * decay.even();
    let g = (T::ONE - t) * (T::ONE + t) + r.squared();
    let inverse = T::ONE / (g * q + cosh);
    let reflectance = T::TWO * r * q * inverse;
    let transmittance = y * inverse;

    // by m at constant K, as in `slopes`
    let l_by_d = decay.l * d_inverse;
    let g_m = g * l_by_d * cosh + decay.l * pair.d * q;
    let dr_dn = T::TWO * r * l_by_d * (y * inverse).squared();
    let dt_dn = -(transmittance * g_m * inverse);

    // by K at constant m
    let e = -(slope.log_t * pair.z + T::TWO * r * slope.r);
    let v = series.v(pair, decay, plate, m, q, cosh, d_inverse);
    let q_k = v * e - q * slope.log_t;
    let prefactor_k = T::TWO * (r * slope.r - t.squared() * slope.log_t);
    let g_k = (prefactor_k * q + g * q_k + m * q * e) * inverse;
    let dt_dk = -(transmittance * g_k);
    let dr_dk = T::TWO * inverse * (slope.r * q + r * (q_k - q * g_k));
    Pile { r: reflectance, t: transmittance, slopes: Slopes { dr_dk, dt_dk, dr_dn, dt_dn } }
}

/// Terms kept of the series of V.
const TERMS: usize = 8;

/// Series of d(sinh ML/sinh L)/d(sinh²L)/M in q = sinh²L, for one N.
///
/// sinh ML/sinh L = M Σ aₖ qᵏ, a₀ = 1, aₖ₊₁ = aₖ (M² − (2k+1)²)/((2k+2)(2k+3)).
#[derive(Clone, Copy)]
pub(crate) struct SlopeSeries<T> {
    /// (k + 1) aₖ₊₁.
    terms: [T; TERMS],
    /// Below this q the series is used; (1 + M²) q < 0.01 leaves a remainder below 1e-17.
    largest: T,
}

impl<T: Real> SlopeSeries<T> {
    pub(crate) fn new(m: T) -> Self {
        let mut terms = [T::ZERO; TERMS];
        let mut a = T::ONE;
        let mut k = T::ZERO;
        for term in &mut terms {
            let odd = k + k + T::ONE;
            a = a * (m - odd) * (m + odd) / ((odd + T::ONE) * (odd + T::TWO));
            k += T::ONE;
            *term = a * k;
        }
        SlopeSeries { terms, largest: T::lit(0.01) / (T::ONE + m.squared()) }
    }

    /// y V, from y Q, y cosh ML and 1/D.
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn v(&self, pair: &Pair<T>, decay: &Decay<T>, plate: &Plate<T>, m: T, q: T, cosh: T, d_inverse: T) -> T {
        let Plate { r, t, .. } = *plate;
        let b = (T::ONE - r) * (T::ONE + r) + t.squared();
        // V loses its digits as D → 0; there it is M B/(4t³) Σ k aₖ q^(k−1), q = sinh²L.
        let sinh2_l = (pair.d * pair.half_t).squared();
        let v_series = m * b * T::TWO * pair.half_t * pair.half_t.squared() * decay.y * self.sum(sinh2_l);
        let v_plain = (m * cosh - b * q) * d_inverse.squared();
        if sinh2_l < self.largest { v_series } else { v_plain }
    }

    #[inline(always)]
    fn sum(&self, q: T) -> T {
        let mut sum = T::ZERO;
        for term in self.terms.iter().rev() {
            sum = sum * q + *term;
        }
        sum
    }
}

/// eˣ and eˣ − 1 for x ≤ 0, each to nearly full relative precision (1e-15 in `f64`).
#[inline(always)]
fn exp_and_m1<T: Real>(x: T) -> (T, T) {
    // Taylor to degree 11 where eˣ − 1 would cancel; both are computed, so that a loop over bands vectorises.
    let near = x.max(T::lit(-0.125));
    let mut sum = T::ZERO;
    for coefficient in numbers::<T, 11>(&EXP_M1, const { &single(EXP_M1) }) {
        sum = sum * near + coefficient;
    }
    let exp = x.exp();
    let far = exp - T::ONE;
    (exp, if x > T::lit(-0.125) { near * sum } else { far })
}

/// 1/(k + 1)! for k = 10 … 0.
const EXP_M1: [f64; 11] = [
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
    1.0,
];
