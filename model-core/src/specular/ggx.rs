//! The GGX–Smith surface: BRDF_spec = F · D/(2W).

use super::{Normalization, SpecularGradient, Surface};
use crate::facet::{Ggx, ggx, ggx_log_slopes};
use crate::fresnel::{Dielectric, Index};
use crate::masking::{Smith, ellipsoid, sine2};
use crate::{DomainError, Geometry, Real};

/// A surface of GGX facets with Smith's masking.
pub type GgxSurface<T, I = Dielectric<T>> = Surface<T, I, Ggx, Smith>;

impl<T: Real> GgxSurface<T> {
    /// GGX facets, Smith's masking, a real index: the surface for leaves whose lobe has a tail.
    ///
    /// Normalised as derived ([`Normalization::CookTorrance`], factor 1): there is no printed convention to follow. An
    /// explicit [`with_normalization`](Surface::with_normalization) is honoured.
    ///
    /// # Errors
    /// [`DomainError`] unless 1 ≤ n ≤ 2¹⁴ and 2⁻³⁰ ≤ σ ≤ 2¹⁰.
    ///
    /// ```
    /// use leafbrdf_core::{Angle, Geometry, Surface};
    /// // lit and seen at nadir: F(0) D(0)/4 = 0.04 / (4 π σ²)
    /// let zenith = Angle::from_degrees(0.0_f64);
    /// let nadir = Geometry::from_angles(zenith, zenith, zenith)?;
    /// let brdf = Surface::ggx(1.5, 0.2)?.brdf(&nadir);
    /// assert!((brdf - 0.04 / (0.16 * core::f64::consts::PI)).abs() < 1e-15);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    pub fn ggx(n: T, sigma: T) -> Result<Self, DomainError> {
        let surface = Surface::with_parts(Dielectric::new(n)?, sigma, Ggx, Smith)?;
        Ok(surface.with_normalization(Normalization::CookTorrance))
    }
}

/// All that one pair of directions contributes to the GGX–Smith BRDF_spec: computed once, shared by every wavelength and
/// every trial value of n and σ; from a level or from a tilted leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GgxTerms<T> {
    /// cos θ_a.
    pub cos_theta_a: T,
    /// tan²α.
    pub tan2_alpha: T,
    /// cos θ_s.
    pub cos_theta_s: T,
    /// cos θ_v.
    pub cos_theta_v: T,
    /// BRDF_spec = F D weight/(2W): 4π/K, times cosθ_s'/cosθ_s where the leaf is tilted.
    pub weight: T,
}

impl<T: Real> GgxTerms<T> {
    /// The terms of a direction; the convention is [`Normalization::CookTorrance`] unless the caller wants it otherwise.
    #[inline(always)]
    pub fn new(geometry: &Geometry<T>, normalization: Normalization) -> Self {
        GgxTerms {
            cos_theta_a: geometry.cos_theta_a(),
            tan2_alpha: geometry.tan2_alpha(),
            cos_theta_s: geometry.cos_theta_s(),
            cos_theta_v: geometry.cos_theta_v(),
            weight: normalization.factor(),
        }
    }

    /// BRDF_spec in sr⁻¹ at this direction; n and σ as in [`Surface::ggx`], checked by the caller.
    #[inline(always)]
    pub fn brdf(&self, index: impl Index<T>, sigma: T) -> T {
        let (cos_s, cos_v) = (self.cos_theta_s, self.cos_theta_v);
        let w = cos_v * ellipsoid(cos_s, sigma) + cos_s * ellipsoid(cos_v, sigma);
        index.fresnel(self.cos_theta_a) * (ggx(self.tan2_alpha, sigma) * self.weight) / (T::TWO * w)
    }

    /// BRDF_spec with its exact derivatives by n and σ, one pass.
    #[inline(always)]
    pub fn brdf_with_gradient(&self, index: impl Index<T>, sigma: T) -> SpecularGradient<T> {
        let (cos_s, cos_v) = (self.cos_theta_s, self.cos_theta_v);
        let (r_s, r_v) = (ellipsoid(cos_s, sigma), ellipsoid(cos_v, sigma));
        let inverse_w = T::ONE / (cos_v * r_s + cos_s * r_v);
        let (f, f_n) = index.fresnel_with_slope(self.cos_theta_a);
        let d = ggx(self.tan2_alpha, sigma) * (self.weight * T::HALF) * inverse_w;
        let (log_slope, _) = ggx_log_slopes(self.tan2_alpha, sigma);
        // ∂ ln W/∂σ
        let w_sigma = sigma * inverse_w * (cos_v * sine2(cos_s) / r_s + cos_s * sine2(cos_v) / r_v);
        let value = f * d;
        SpecularGradient { value, d_n: f_n * d, d_sigma: value * (log_slope - w_sigma) }
    }
}
