//! D: how facet normals are spread around the leaf normal (Eq. 9).

use crate::Real;

mod ggx;
pub use ggx::{Ggx, ggx, ggx_log_slopes};

/// A facet density and its exact derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetSlopes<T> {
    /// D, sr⁻¹.
    pub value: T,
    /// ∂D/∂σ, sr⁻¹.
    pub d_sigma: T,
    /// ∂D/∂tan²α, sr⁻¹.
    pub d_tan2_alpha: T,
}

/// A distribution of facet slopes: the density D(α; σ) of facet normals, in sr⁻¹, with ∫ D cosα dΩ = 1.
pub trait Facets<T: Real>: Copy {
    /// D(α; σ).
    fn density(self, tan2_alpha: T, sigma: T) -> T;

    /// D with ∂D/∂σ and ∂D/∂tan²α.
    fn density_with_slopes(self, tan2_alpha: T, sigma: T) -> FacetSlopes<T>;

    /// D and ∂D/∂σ.
    #[inline(always)]
    fn density_with_slope(self, tan2_alpha: T, sigma: T) -> (T, T) {
        let FacetSlopes { value, d_sigma, .. } = self.density_with_slopes(tan2_alpha, sigma);
        (value, d_sigma)
    }
}

/// The paper's distribution (Eq. 9): slopes are Gaussian, D ∝ exp(−tan²α/σ²)/(σ² cos⁴α).
///
/// D falls monotonically with α exactly while σ ≤ 1/√2 (the paper says σ < 0.7).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Beckmann;

/// Beckmann's facet density `D(α; σ)`, in sr⁻¹, normalised: ∫ D cosα dΩ = 1 over the hemisphere.
///
/// Eq. 9 with c = 1/π. Takes tan²α, which [`Geometry`](crate::Geometry) gets from the half vector, because 1 − cos²α
/// loses digits near the specular direction.
///
/// - `tan2_alpha`: squared tangent of the facet tilt, ≥ 0, unitless.
/// - `sigma`: slope roughness, > 0, unitless: rms slope over both axes (the one-axis rms slope is smaller by √2);
///   checked by [`Surface::new`](crate::Surface::new).
///
/// Facing the viewer squarely, only the prefactor is left:
///
/// ```
/// let d = leafbrdf_core::facet::beckmann(0.0_f64, 0.5);
/// assert!((d - 4.0 / core::f64::consts::PI).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn beckmann<T: Real>(tan2_alpha: T, sigma: T) -> T {
    // one division, and only by σ²: a loop over directions takes it out
    let inv_sigma2 = T::ONE / sigma.squared();

    // 1 / cos⁴α = (1 + tan²α)²
    let sec4_alpha = (T::ONE + tan2_alpha).squared();

    //      exp(−tan²α / σ²)
    // D = ──────────────────
    //       π σ² cos⁴α
    (-tan2_alpha * inv_sigma2).exp() * sec4_alpha * (inv_sigma2 * T::lit(core::f64::consts::FRAC_1_PI))
}

/// ∂ ln D/∂σ and ∂² ln D/∂σ² of Beckmann's density: 2 tan²α/σ³ − 2/σ and 2/σ² − 6 tan²α/σ⁴.
#[inline(always)]
pub fn beckmann_log_slopes<T: Real>(tan2_alpha: T, sigma: T) -> (T, T) {
    let inv_sigma = T::ONE / sigma;
    // in units of 1/σ: x = tan²α/σ²
    let x = tan2_alpha * inv_sigma.squared();
    (T::TWO * (x - T::ONE) * inv_sigma, (T::TWO - T::lit(6.0) * x) * inv_sigma.squared())
}

/// σ, prepared for the exponential of [`beckmann`] at many facets, with its slope: for a device's fit, which moves in ln σ.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Falloff<T> {
    /// what turns tan²α into the unit of `Real::decay`
    per_tan2_alpha: T,
}

impl<T: Real> Falloff<T> {
    /// D = GAIN⁻¹ κ · (1 + tan²α)² · [`at`](Self::at), κ = 1/(πσ²).
    pub const GAIN: f64 = T::DECAY_GAIN;

    /// From 1/σ².
    #[inline(always)]
    pub fn new(inv_sigma2: T) -> Self {
        Falloff { per_tan2_alpha: inv_sigma2 * T::lit(1.0 / T::DECAY_UNIT) }
    }

    /// `GAIN` · exp(−tan²α/σ²), and ∂ ln D/∂ ln σ = 2 tan²α/σ² − 2.
    #[inline(always)]
    pub fn at(self, tan2_alpha: T) -> (T, T) {
        let x = tan2_alpha * self.per_tan2_alpha;
        (x.decay(), x * T::lit(2.0 * T::DECAY_UNIT) - T::TWO)
    }
}

impl<T: Real> Facets<T> for Beckmann {
    #[inline(always)]
    fn density(self, tan2_alpha: T, sigma: T) -> T {
        beckmann(tan2_alpha, sigma)
    }

    #[inline(always)]
    fn density_with_slopes(self, tan2_alpha: T, sigma: T) -> FacetSlopes<T> {
        let value = beckmann(tan2_alpha, sigma);
        // Far in the tail D underflows to 0 before the logarithmic slopes overflow, and 0 · ∞ would be NaN.
        if !(value > T::ZERO) {
            return FacetSlopes { value, d_sigma: T::ZERO, d_tan2_alpha: T::ZERO };
        }
        let (log_slope, _) = beckmann_log_slopes(tan2_alpha, sigma);
        FacetSlopes {
            value,
            d_sigma: value * log_slope,
            // ∂ ln D/∂tan²α
            d_tan2_alpha: value * (T::TWO / (T::ONE + tan2_alpha) - T::ONE / sigma.squared()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Falloff, beckmann, beckmann_log_slopes};
    use crate::real::device::F32;

    #[test]
    fn the_falloff_is_that_of_the_density() {
        for (tan2_alpha, sigma) in [(0.0, 0.3), (0.02, 0.1), (0.4, 0.29), (3.0, 1.0), (8.0, 0.5_f64)] {
            let inv_sigma2 = 1.0 / (sigma * sigma);
            let kappa = inv_sigma2 * core::f64::consts::FRAC_1_PI * (1.0 + tan2_alpha) * (1.0 + tan2_alpha);
            let (expected, log_slope) = (beckmann(tan2_alpha, sigma), beckmann_log_slopes(tan2_alpha, sigma).0 * sigma);
            let close = |(value, slope): (f64, f64), gain: f64, tolerance: f64| {
                assert!((kappa * value / gain / expected - 1.0).abs() < tolerance, "{tan2_alpha} {sigma}: {value:e}");
                assert!(
                    (slope - log_slope).abs() < tolerance * (2.0 + log_slope.abs()),
                    "{tan2_alpha} {sigma}: {slope}"
                );
            };
            close(Falloff::new(inv_sigma2).at(tan2_alpha), Falloff::<f64>::GAIN, 1e-14);
            let (value, slope) = Falloff::new(F32(inv_sigma2 as f32)).at(F32(tan2_alpha as f32));
            close((f64::from(value.0), f64::from(slope.0)), Falloff::<F32>::GAIN, 1e-5);
        }
    }
}
