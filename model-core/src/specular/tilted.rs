//! BRDF_spec of a leaf that is tilted in its holder, as an instrument with a level reference panel measures it.

use super::{Surface, projection};
use crate::Real;
use crate::facet::Facets;
use crate::fresnel::Index;
use crate::geometry::{TiltSlopes, Tilted};
use crate::masking::Masking;

/// BRDF_spec of a tilted leaf, cosθ_s'/cosθ_s included, and its exact derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TiltedSpecularGradient<T> {
    /// The value, sr⁻¹.
    pub value: T,
    /// ∂/∂n, sr⁻¹.
    pub d_n: T,
    /// ∂/∂σ, sr⁻¹.
    pub d_sigma: T,
    /// ∂/∂t_x, sr⁻¹ rad⁻¹.
    pub d_in_plane: T,
    /// ∂/∂t_y, sr⁻¹ rad⁻¹.
    pub d_lateral: T,
}

impl<T: Real, I: Index<T>, D: Facets<T>, G: Masking<T>> Surface<T, I, D, G> {
    /// cosθ_s'/cosθ_s · BRDF_spec about the tilted normal, sr⁻¹.
    #[inline(always)]
    pub fn brdf_tilted(&self, tilted: &Tilted<T>) -> T {
        tilted.factor() * self.brdf(tilted.geometry())
    }

    /// The same with its exact derivatives by n, σ and both angles of the tilt, one pass.
    ///
    /// By the tilt: at a kink of V-cavity masking, the slope of one side.
    #[inline(always)]
    pub fn brdf_tilted_with_gradient(&self, tilted: &Tilted<T>) -> TiltedSpecularGradient<T> {
        let geometry = tilted.geometry();
        let (f, f_n) = self.index.fresnel_with_slope(geometry.cos_theta_a());
        let d = self.facets.density_with_slopes(geometry.tan2_alpha(), self.sigma);
        let g = self.masking.masking_with_slopes(geometry, self.sigma);
        // cosθ_s' cancels between the factor and the projection: 4π/K · 1/(4 cosθ_s cosθ_v')
        let scale = tilted.factor() * projection(geometry, self.normalization);
        let weight = g.value * scale;
        let reflected = f * scale;
        let value = f * (d.value * weight);
        let by_tilt = |slopes: &TiltSlopes<T>| {
            let d_masking = g.d_cos_theta_s * slopes.cos_theta_s + g.d_cos_theta_v * slopes.cos_theta_v;
            (f * weight) * (d.d_tan2_alpha * slopes.tan2_alpha) + reflected * (d.value * d_masking)
                - value * (slopes.cos_theta_v / geometry.cos_theta_v())
        };
        TiltedSpecularGradient {
            value,
            d_n: f_n * (d.value * weight),
            d_sigma: (f * weight) * d.d_sigma + reflected * (d.value * g.d_sigma),
            d_in_plane: by_tilt(tilted.d_in_plane()),
            d_lateral: by_tilt(tilted.d_lateral()),
        }
    }
}
