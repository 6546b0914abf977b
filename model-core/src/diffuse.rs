//! BRDF_diff: light that entered the leaf and came back (Eq. 4).

use crate::{Geometry, Real};

mod p1;
mod p2;
pub use p1::P1;
pub use p2::P2;

/// The shape of a diffuse term and its exact derivatives, in sr⁻¹; those by the cosines hold θ_a, as a tilt of the leaf does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseSlopes<T> {
    /// BRDF_diff/k_L.
    pub value: T,
    /// ∂/∂a of [`P1`]; 0 for Lambert's term.
    pub d_a: T,
    /// ∂/∂b of [`P1`]; 0 for Lambert's term.
    pub d_b: T,
    /// ∂/∂e of [`P2`]; for the other terms 0.
    pub d_e: T,
    /// ∂/∂cosθ_s.
    pub d_cos_theta_s: T,
    /// ∂/∂cosθ_v.
    pub d_cos_theta_v: T,
}

/// The directional shape of the diffuse term: BRDF_diff = k_L · shape.
pub trait Diffuse<T: Real>: Copy {
    /// BRDF_diff/k_L in sr⁻¹.
    fn shape(self, geometry: &Geometry<T>) -> T;

    /// The same with its derivatives.
    fn shape_with_slopes(self, geometry: &Geometry<T>) -> DiffuseSlopes<T>;

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
    fn shape_with_slopes(self, geometry: &Geometry<T>) -> DiffuseSlopes<T> {
        DiffuseSlopes {
            value: self.shape(geometry),
            d_a: T::ZERO,
            d_b: T::ZERO,
            d_e: T::ZERO,
            d_cos_theta_s: T::ZERO,
            d_cos_theta_v: T::ZERO,
        }
    }

    #[inline(always)]
    fn hemispherical(self, _cos_theta_s: T) -> T {
        T::ONE
    }
}

#[inline(always)]
fn two_thirds<T: Real>() -> T {
    T::lit(2.0 / 3.0)
}
