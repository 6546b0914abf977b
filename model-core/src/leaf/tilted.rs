//! BRDF of a tilted leaf: all that a fit with an analytic Jacobian needs.

use super::Leaf;
use crate::Real;
use crate::diffuse::{Diffuse, DiffuseSlopes};
use crate::facet::Facets;
use crate::fresnel::Index;
use crate::geometry::Tilted;
use crate::masking::Masking;
use crate::specular::TiltedSpecularGradient;

/// BRDF of a tilted leaf, cosθ_s'/cosθ_s included, and its exact derivatives by every parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedLeafGradient<T> {
    /// cosθ_s'/cosθ_s · BRDF about the tilted normal, sr⁻¹.
    pub value: T,
    /// ∂/∂k_L, sr⁻¹.
    pub d_k_lambert: T,
    /// ∂/∂n, sr⁻¹.
    pub d_n: T,
    /// ∂/∂σ, sr⁻¹.
    pub d_sigma: T,
    /// ∂/∂a of the diffuse term; 0 where it is Lambert's.
    pub d_a: T,
    /// ∂/∂b, likewise.
    pub d_b: T,
    /// ∂/∂e of [`P2`](crate::P2); 0 for the other terms.
    pub d_e: T,
    /// ∂/∂t_x, sr⁻¹ rad⁻¹.
    pub d_in_plane: T,
    /// ∂/∂t_y, sr⁻¹ rad⁻¹.
    pub d_lateral: T,
}

/// The shape of a tilted leaf's diffuse term, cosθ_s'/cosθ_s included: BRDF_diff = k_L · value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedDiffuseGradient<T> {
    /// The shape, sr⁻¹.
    pub value: T,
    /// ∂/∂a.
    pub d_a: T,
    /// ∂/∂b.
    pub d_b: T,
    /// ∂/∂e.
    pub d_e: T,
    /// ∂/∂t_x, sr⁻¹ rad⁻¹.
    pub d_in_plane: T,
    /// ∂/∂t_y, sr⁻¹ rad⁻¹.
    pub d_lateral: T,
}

impl<T: Real> Tilted<T> {
    /// cosθ_s'/cosθ_s · shape of a diffuse term about the tilted normal, sr⁻¹, with its exact derivatives.
    #[inline(always)]
    pub fn diffuse_with_gradient(&self, diffuse: impl Diffuse<T>) -> TiltedDiffuseGradient<T> {
        let DiffuseSlopes { value, d_a, d_b, d_e, d_cos_theta_s, d_cos_theta_v } =
            diffuse.shape_with_slopes(self.geometry());
        let factor = self.factor();
        let (x, y) = (self.d_in_plane(), self.d_lateral());
        TiltedDiffuseGradient {
            value: factor * value,
            d_a: factor * d_a,
            d_b: factor * d_b,
            d_e: factor * d_e,
            d_in_plane: factor * (d_cos_theta_s * x.cos_theta_s + d_cos_theta_v * x.cos_theta_v) + x.factor * value,
            d_lateral: factor * (d_cos_theta_s * y.cos_theta_s + d_cos_theta_v * y.cos_theta_v) + y.factor * value,
        }
    }
}

impl<T: Real, I: Index<T>, D: Facets<T>, G: Masking<T>, L: Diffuse<T>> Leaf<T, I, D, G, L> {
    /// cosθ_s'/cosθ_s · BRDF about the tilted normal, sr⁻¹: what an instrument with a level reference panel measures.
    #[inline(always)]
    pub fn brdf_tilted(&self, tilted: &Tilted<T>) -> T {
        tilted.factor() * self.brdf(tilted.geometry())
    }

    /// The same with its exact derivatives by k_L, n, σ, the diffuse term's a and b, and both angles of the tilt.
    #[inline(always)]
    pub fn brdf_tilted_with_gradient(&self, tilted: &Tilted<T>) -> TiltedLeafGradient<T> {
        let TiltedSpecularGradient { value, d_n, d_sigma, d_in_plane, d_lateral } =
            self.surface.brdf_tilted_with_gradient(tilted);
        let shape = tilted.diffuse_with_gradient(self.diffuse);
        let k = self.k_lambert;
        TiltedLeafGradient {
            value: k * shape.value + value,
            d_k_lambert: shape.value,
            d_n,
            d_sigma,
            d_a: k * shape.d_a,
            d_b: k * shape.d_b,
            d_e: k * shape.d_e,
            d_in_plane: k * shape.d_in_plane + d_in_plane,
            d_lateral: k * shape.d_lateral + d_lateral,
        }
    }
}
