//! D with a heavy tail: GGX, the distribution of Trowbridge and Reitz (1975).

use super::{FacetSlopes, Facets};
use crate::Real;

/// GGX (Trowbridge and Reitz 1975; named by Walter et al. 2007): D = σ²/(π q²), q = 1 − (1 − σ²) cos²α.
///
/// The facets' slopes are those of an ellipsoid, and their mean square is infinite: σ is the slope below which half of the
/// projected area lies, not an rms slope. A σ fitted with Beckmann's density means something else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ggx;

/// GGX facet density `D(α; σ)`, in sr⁻¹, normalised: ∫ D cosα dΩ = 1 over the hemisphere.
///
/// Takes tan²α, as [`beckmann`](super::beckmann) does: q = cos²α (tan²α + σ²) has nothing to cancel, however small σ is.
///
/// - `tan2_alpha`: squared tangent of the facet tilt, ≥ 0, unitless.
/// - `sigma`: slope roughness, > 0, unitless; checked by [`Surface::ggx`](crate::Surface::ggx).
///
/// Facing the viewer squarely, only the prefactor is left, as with Beckmann's:
///
/// ```
/// let d = leafbrdf_core::facet::ggx(0.0_f64, 0.5);
/// assert!((d - 4.0 / core::f64::consts::PI).abs() < 1e-15);
/// ```
#[inline(always)]
pub fn ggx<T: Real>(tan2_alpha: T, sigma: T) -> T {
    let sigma2 = sigma.squared();

    //        σ²          σ²   ⎛  1 + tan²α  ⎞²
    // D = ──────── =    ──── ⎜ ─────────── ⎟
    //       π q²          π    ⎝ tan²α + σ² ⎠
    let ratio = (T::ONE + tan2_alpha) / (tan2_alpha + sigma2);
    (sigma2 * T::lit(core::f64::consts::FRAC_1_PI)) * ratio.squared()
}

/// ∂ ln D/∂σ and ∂² ln D/∂σ² of the GGX density: (2/σ) (tan²α − σ²)/(tan²α + σ²) and
/// −2/σ² − 4 (tan²α − σ²)/(tan²α + σ²)².
#[inline(always)]
pub fn ggx_log_slopes<T: Real>(tan2_alpha: T, sigma: T) -> (T, T) {
    let sigma2 = sigma.squared();
    let inverse = T::ONE / (tan2_alpha + sigma2);
    let contrast = (tan2_alpha - sigma2) * inverse;
    (T::TWO * contrast / sigma, -(T::TWO / sigma2 + T::lit(4.0) * (contrast * inverse)))
}

impl<T: Real> Facets<T> for Ggx {
    #[inline(always)]
    fn density(self, tan2_alpha: T, sigma: T) -> T {
        ggx(tan2_alpha, sigma)
    }

    #[inline(always)]
    fn density_with_slopes(self, tan2_alpha: T, sigma: T) -> FacetSlopes<T> {
        let sigma2 = sigma.squared();
        let inverse = T::ONE / (tan2_alpha + sigma2);
        let ratio = (T::ONE + tan2_alpha) * inverse;
        let value = (sigma2 * T::lit(core::f64::consts::FRAC_1_PI)) * ratio.squared();
        FacetSlopes {
            value,
            d_sigma: value * (T::TWO * (tan2_alpha - sigma2) * inverse / sigma),
            // ∂ ln D/∂tan²α = 2/(1 + tan²α) − 2/(tan²α + σ²), over one denominator
            d_tan2_alpha: value * (T::TWO * (sigma2 - T::ONE) * inverse / (T::ONE + tan2_alpha)),
        }
    }
}
