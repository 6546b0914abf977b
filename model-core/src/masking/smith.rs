//! G of a random rough surface: Smith (1967), for GGX facets, with height and view correlated.

use super::{Masking, MaskingSlopes};
use crate::{Geometry, Real};

/// Smith's masking for [`Ggx`](crate::facet::Ggx) facets: G = 1/(1 + Λ_s + Λ_v), where a facet that is high for the
/// source is high for the view too (Smith 1967; Ross, Dion and Potvin 2005; Heitz 2014).
///
/// Unlike the paper's V-shaped grooves it depends on the roughness and has no kink.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Smith;

/// 1 − cos²θ; the maximum absorbs rounding only, where a cosine came out above 1.
#[inline(always)]
pub(crate) fn sine2<T: Real>(cosine: T) -> T {
    (T::ONE - cosine.squared()).max(T::ZERO)
}

/// r_u = √(c² + σ² (1 − c²)) ≥ c: the projected area of the facets' ellipsoid for a direction of cosine c.
#[inline(always)]
pub(crate) fn ellipsoid<T: Real>(cosine: T, sigma: T) -> T {
    (cosine.squared() + sigma.squared() * sine2(cosine)).sqrt()
}

/// G = 2 cosθ_s cosθ_v/W with W = cosθ_v r_s + cosθ_s r_v and r_u = √(cos²θ_u + σ² sin²θ_u), unitless.
///
/// - `sigma`: roughness, > 0, unitless; checked by [`Surface::ggx`](crate::Surface::ggx).
///
/// ```
/// use leafbrdf_core::{masking, Angle, Geometry};
/// // at normal incidence and view a facet stands free, however rough the surface
/// let nadir = Geometry::from_angles(
///     Angle::from_degrees(0.0_f64), Angle::from_degrees(0.0), Angle::from_degrees(0.0))?;
/// assert_eq!(masking::smith(&nadir, 0.5), 1.0);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[inline(always)]
pub fn smith<T: Real>(geometry: &Geometry<T>, sigma: T) -> T {
    let (cos_s, cos_v) = (geometry.cos_theta_s(), geometry.cos_theta_v());
    let w = cos_v * ellipsoid(cos_s, sigma) + cos_s * ellipsoid(cos_v, sigma);
    // the minimum absorbs rounding
    (T::TWO * (cos_s * cos_v) / w).min(T::ONE)
}

impl<T: Real> Masking<T> for Smith {
    #[inline(always)]
    fn masking_with_slopes(self, geometry: &Geometry<T>, sigma: T) -> MaskingSlopes<T> {
        let (cos_s, cos_v) = (geometry.cos_theta_s(), geometry.cos_theta_v());
        let (r_s, r_v) = (ellipsoid(cos_s, sigma), ellipsoid(cos_v, sigma));
        let inverse_w = T::ONE / (cos_v * r_s + cos_s * r_v);
        let value = (T::TWO * (cos_s * cos_v) * inverse_w).min(T::ONE);
        // r_u ∂r_u/∂σ = σ sin²θ_u
        let w_sigma = sigma * (cos_v * sine2(cos_s) / r_s + cos_s * sine2(cos_v) / r_v);
        // ∂G/∂c_s: W − c_s (c_v ∂r_s/∂c_s + r_v) = c_v (r_s − c_s ∂r_s/∂c_s) = c_v σ²/r_s, free of cancellation
        let steepness = T::TWO * (sigma * inverse_w).squared();
        MaskingSlopes {
            value,
            d_sigma: -(value * w_sigma * inverse_w),
            d_cos_theta_s: steepness * cos_v.squared() / r_s,
            d_cos_theta_v: steepness * cos_s.squared() / r_v,
        }
    }

    #[inline(always)]
    fn masking(self, geometry: &Geometry<T>, sigma: T) -> T {
        smith(geometry, sigma)
    }
}
