//! BRDF_diff: light that entered the leaf and came back (Eq. 4).

use crate::{Geometry, Real};

/// The directional shape of the diffuse term: BRDF_diff = k_L · shape.
pub trait Diffuse<T: Real>: Copy {
    /// BRDF_diff/k_L in sr⁻¹.
    fn shape(self, geometry: &Geometry<T>) -> T;

    /// ∫ shape cosθ_v dΩ_v: DHRF of the diffuse term for k_L = 1, at the given cos θ_s.
    fn hemispherical(self, cos_theta_s: T) -> T;
}

/// The paper's diffuse term: k_L/π, whatever the directions (Eq. 4); its DHRF is k_L exactly (Eq. 13).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lambert;

impl<T: Real> Diffuse<T> for Lambert {
    #[inline(always)]
    fn shape(self, _geometry: &Geometry<T>) -> T {
        T::lit(core::f64::consts::FRAC_1_PI)
    }

    #[inline(always)]
    fn hemispherical(self, _cos_theta_s: T) -> T {
        T::ONE
    }
}
