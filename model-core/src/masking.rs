//! G: shadowing and masking of one facet by its neighbours (Eq. 7).

use crate::{Geometry, Real};

mod smith;
pub use smith::{Smith, smith};
pub(crate) use smith::{ellipsoid, sine2};

/// A masking function and its exact derivatives; those by the cosines hold θ_a, as a tilt of the leaf does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaskingSlopes<T> {
    /// G, unitless.
    pub value: T,
    /// ∂G/∂σ; 0 where G does not depend on roughness.
    pub d_sigma: T,
    /// ∂G/∂cosθ_s.
    pub d_cos_theta_s: T,
    /// ∂G/∂cosθ_v.
    pub d_cos_theta_v: T,
}

/// A shadowing–masking function G ∈ [0, 1], symmetric in source and view.
pub trait Masking<T: Real>: Copy {
    /// G with its derivatives by σ and by the two cosines.
    fn masking_with_slopes(self, geometry: &Geometry<T>, sigma: T) -> MaskingSlopes<T>;

    /// G and ∂G/∂σ.
    #[inline(always)]
    fn masking_with_slope(self, geometry: &Geometry<T>, sigma: T) -> (T, T) {
        let MaskingSlopes { value, d_sigma, .. } = self.masking_with_slopes(geometry, sigma);
        (value, d_sigma)
    }

    /// G.
    #[inline(always)]
    fn masking(self, geometry: &Geometry<T>, sigma: T) -> T {
        self.masking_with_slopes(geometry, sigma).value
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
    fn masking_with_slopes(self, geometry: &Geometry<T>, _sigma: T) -> MaskingSlopes<T> {
        let value = v_cavity(geometry);
        let (mut d_cos_theta_s, mut d_cos_theta_v) = (T::ZERO, T::ZERO);
        // On the plateau G stands still; at its edge, and where both cosines are equal, this is the slope of one side.
        if value < T::ONE {
            let (cos_s, cos_v) = (geometry.cos_theta_s(), geometry.cos_theta_v());
            let inverse = T::ONE / geometry.cos_theta_a().squared();
            let (small, large) = ((T::TWO * cos_s.min(cos_v) + cos_s.max(cos_v)) * inverse, cos_s.min(cos_v) * inverse);
            (d_cos_theta_s, d_cos_theta_v) = if cos_s <= cos_v { (small, large) } else { (large, small) };
        }
        MaskingSlopes { value, d_sigma: T::ZERO, d_cos_theta_s, d_cos_theta_v }
    }

    #[inline(always)]
    fn masking_with_slope(self, geometry: &Geometry<T>, _sigma: T) -> (T, T) {
        (v_cavity(geometry), T::ZERO)
    }
}
