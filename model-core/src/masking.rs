//! G: shadowing and masking of one facet by its neighbours (Eq. 7).

use crate::{Geometry, Real};

/// A shadowing–masking function G ∈ [0, 1], symmetric in source and view.
pub trait Masking<T: Real>: Copy {
    /// G and ∂G/∂σ; the slope is 0 where G does not depend on roughness.
    fn masking_with_slope(self, geometry: &Geometry<T>, sigma: T) -> (T, T);

    /// G.
    #[inline(always)]
    fn masking(self, geometry: &Geometry<T>, sigma: T) -> T {
        self.masking_with_slope(geometry, sigma).0
    }
}

/// The paper's masking (Eq. 7): long symmetric V-shaped grooves (Torrance and Sparrow 1967), whatever the roughness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VCavity;

/// G = min(1, 2 cosα cosθ_v/cosθ_a, 2 cosα cosθ_s/cosθ_a), unitless (Eq. 7).
///
/// With cosα = (cosθ_s + cosθ_v)/(2 cosθ_a) this is min(1, (cosθ_s + cosθ_v) min(cosθ_s, cosθ_v)/cos²θ_a).
///
/// ```
/// use leafbrdf_core::{masking, Angle, Geometry};
/// // at normal incidence and view a facet stands free
/// let nadir = Geometry::from_angles(
///     Angle::from_degrees(0.0_f64), Angle::from_degrees(0.0), Angle::from_degrees(0.0))?;
/// assert_eq!(masking::v_cavity(&nadir), 1.0);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[inline(always)]
pub fn v_cavity<T: Real>(geometry: &Geometry<T>) -> T {
    let (cos_s, cos_v) = (geometry.cos_theta_s(), geometry.cos_theta_v());
    let edge = (cos_s + cos_v) * cos_s.min(cos_v) / geometry.cos_theta_a().squared();
    edge.min(T::ONE)
}

impl<T: Real> Masking<T> for VCavity {
    #[inline(always)]
    fn masking_with_slope(self, geometry: &Geometry<T>, _sigma: T) -> (T, T) {
        (v_cavity(geometry), T::ZERO)
    }
}
