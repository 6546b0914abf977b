//! BRDF_spec = F · D · G / (4 cosθ_s cosθ_v), under either of the two normalisations (Eqs 6, 10).

use crate::facet::{Beckmann, Facets, beckmann, beckmann_log_slopes};
use crate::fresnel::{Absorbing, Dielectric, Index};
use crate::masking::{Masking, VCavity, v_cavity};
use crate::{DhrfGradient, DomainError, Geometry, Grade, Hemispherical, Illumination, Real, domain};

mod ggx;
mod tilted;
pub use ggx::{GgxSurface, GgxTerms};
pub use tilted::TiltedSpecularGradient;

/// The constant K of Eq. 10, BRDF_spec = F G exp(−tan²α/σ²) / (K cosθ_s cosθ_v σ² cos⁴α): two conventions exist.
///
/// Eqs 5, 6 and 9 of the paper give 4π; Eq. 10 as printed has 2π², so its lobe is smaller by 2/π = 0.6366, and the paper's
/// fitted values (Table 4) belong to it. An index fitted under one convention means nothing under the other: the same
/// reflectance at normal incidence is n = 1.56 under 2π² and 1.42 under 4π. See `docs/model.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Normalization {
    /// K = 2π², Eq. 10 as printed. Used by Bousquet et al. 2005 and Deng et al. 2025.
    #[default]
    Bousquet2005,
    /// K = 4π, as derived: energy-conserving (DHRF ≤ 1 for F ≡ 1). Used by PROSPECULAR (2023) and MADLM (2025).
    CookTorrance,
}

impl Normalization {
    /// 4π/K: the factor on F D G/(4 cosθ_s cosθ_v), D normalised. 2/π or 1.
    ///
    /// ```
    /// use leafbrdf_core::Normalization;
    /// let factor: f64 = Normalization::Bousquet2005.factor();
    /// assert!((factor - 0.6366).abs() < 1e-4);
    /// ```
    #[inline(always)]
    pub fn factor<T: Real>(self) -> T {
        match self {
            Normalization::Bousquet2005 => T::lit(core::f64::consts::FRAC_2_PI),
            Normalization::CookTorrance => T::ONE,
        }
    }

    /// The convention's name in files and on the command line: `bousquet2005` or `cook-torrance`.
    pub const fn name(self) -> &'static str {
        match self {
            Normalization::Bousquet2005 => "bousquet2005",
            Normalization::CookTorrance => "cook-torrance",
        }
    }
}

/// BRDF_spec and its exact derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularGradient<T> {
    /// BRDF_spec, sr⁻¹.
    pub value: T,
    /// ∂BRDF_spec/∂n, sr⁻¹.
    pub d_n: T,
    /// ∂BRDF_spec/∂σ, sr⁻¹.
    pub d_sigma: T,
}

/// BRDF_spec with its first and second derivatives with respect to n and σ, for Newton's method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpecularHessian<T> {
    /// BRDF_spec, sr⁻¹.
    pub value: T,
    /// ∂/∂n.
    pub d_n: T,
    /// ∂/∂σ.
    pub d_sigma: T,
    /// ∂²/∂n².
    pub d_n_n: T,
    /// ∂²/∂n∂σ.
    pub d_n_sigma: T,
    /// ∂²/∂σ².
    pub d_sigma_sigma: T,
}

/// All that one pair of directions contributes to the paper's BRDF_spec: computed once, shared by every wavelength and
/// every trial value of n and σ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionTerms<T> {
    /// cos θ_a.
    pub cos_theta_a: T,
    /// tan²α.
    pub tan2_alpha: T,
    /// G/(K/π cosθ_s cosθ_v): BRDF_spec = F · D · weight, unitless.
    pub weight: T,
}

impl<T: Real> DirectionTerms<T> {
    /// The terms of a direction under a convention for K, masking by V-cavities (Eq. 7).
    pub fn new(geometry: &Geometry<T>, normalization: Normalization) -> Self {
        DirectionTerms {
            cos_theta_a: geometry.cos_theta_a(),
            tan2_alpha: geometry.tan2_alpha(),
            weight: v_cavity(geometry) * projection(geometry, normalization),
        }
    }

    /// BRDF_spec in sr⁻¹ at this direction (Eq. 10); n and σ as in [`Surface::new`], checked by the caller.
    #[inline(always)]
    pub fn brdf(&self, index: Dielectric<T>, sigma: T) -> T {
        index.fresnel(self.cos_theta_a) * (beckmann(self.tan2_alpha, sigma) * self.weight)
    }

    /// BRDF_spec with its first and second derivatives, one pass.
    #[inline(always)]
    pub fn brdf_to_second_order(&self, index: Dielectric<T>, sigma: T) -> SpecularHessian<T> {
        let [f, f_n, f_nn] = index.fresnel_to_second_order(self.cos_theta_a);
        let d = beckmann(self.tan2_alpha, sigma) * self.weight;
        let (log_slope, log_curvature) = beckmann_log_slopes(self.tan2_alpha, sigma);
        let d_sigma = d * log_slope;
        SpecularHessian {
            value: f * d,
            d_n: f_n * d,
            d_sigma: f * d_sigma,
            d_n_n: f_nn * d,
            d_n_sigma: f_n * d_sigma,
            // D'' = D ((ln D)'² + (ln D)'')
            d_sigma_sigma: f * (d_sigma * log_slope + d * log_curvature),
        }
    }
}

/// A leaf surface: refractive index, roughness and the normalisation they belong to.
///
/// The facet distribution and the masking are type parameters; the paper's are the defaults.
///
/// ```
/// use leafbrdf_core::{Angle, Geometry, Surface};
/// // laurel (Table 4) in the mirror direction at 60°: the paper measured a peak of about 1.1 to 1.2 sr⁻¹ (§3.1)
/// let deg = Angle::from_degrees;
/// let mirror = Geometry::from_angles(deg(60.0), deg(60.0), deg(180.0))?;
/// let laurel = Surface::new(1.22_f64, 0.078)?;
/// assert!((laurel.brdf(&mirror) - 1.25).abs() < 0.01);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface<T, I = Dielectric<T>, D = Beckmann, G = VCavity> {
    index: I,
    sigma: T,
    normalization: Normalization,
    facets: D,
    masking: G,
}

impl<T: Real> Surface<T> {
    /// The paper's surface: real index n, roughness σ, Beckmann facets, V-cavity masking, K = 2π².
    ///
    /// # Errors
    /// [`DomainError`] unless 1 ≤ n ≤ 2¹⁴ and 2⁻³⁰ ≤ σ ≤ 2¹⁰ (outside, σ² leaves the range of `f32`).
    pub fn new(n: T, sigma: T) -> Result<Self, DomainError> {
        Surface::with_parts(Dielectric::new(n)?, sigma, Beckmann, VCavity)
    }
}

impl<T: Real> Surface<T, Absorbing<T>> {
    /// The same with a complex index n + iκ.
    ///
    /// # Errors
    /// [`DomainError`] unless 1 ≤ n ≤ 2¹⁴, 0 ≤ κ ≤ 10⁴ and 2⁻³⁰ ≤ σ ≤ 2¹⁰.
    pub fn absorbing(n: T, kappa: T, sigma: T) -> Result<Self, DomainError> {
        Surface::with_parts(Absorbing::new(n, kappa)?, sigma, Beckmann, VCavity)
    }
}

impl<T: Real, I: Index<T>, D: Facets<T>, G: Masking<T>> Surface<T, I, D, G> {
    /// Any index, facet distribution and masking.
    ///
    /// # Errors
    /// [`DomainError`] unless 2⁻³⁰ ≤ σ ≤ 2¹⁰.
    pub fn with_parts(index: I, sigma: T, facets: D, masking: G) -> Result<Self, DomainError> {
        if !sigma.is_within(domain::SIGMA[0], domain::SIGMA[1]) {
            return Err(DomainError::new("sigma", "2^-30 ≤ sigma ≤ 2^10"));
        }
        Ok(Surface { index, sigma, normalization: Normalization::default(), facets, masking })
    }

    /// The same surface under the other convention for K. The numbers n and σ stay; the reflectance changes.
    pub fn with_normalization(mut self, normalization: Normalization) -> Self {
        self.normalization = normalization;
        self
    }

    /// The refractive index.
    pub fn index(&self) -> I {
        self.index
    }

    /// σ.
    pub fn sigma(&self) -> T {
        self.sigma
    }

    /// The convention for K.
    pub fn normalization(&self) -> Normalization {
        self.normalization
    }

    /// BRDF_spec in sr⁻¹ (Eq. 10).
    ///
    /// Accuracy against 40-digit values: 1e-12 relative in `f64`; 1e-5 in `f32` where tan²α/σ² < 14.
    #[inline(always)]
    pub fn brdf(&self, geometry: &Geometry<T>) -> T {
        let f = self.index.fresnel(geometry.cos_theta_a());
        let d = self.facets.density(geometry.tan2_alpha(), self.sigma);
        let g = self.masking.masking(geometry, self.sigma);
        f * (d * (g * projection(geometry, self.normalization)))
    }

    /// BRDF_spec and its exact derivatives with respect to n and σ, one pass.
    #[inline(always)]
    pub fn brdf_with_gradient(&self, geometry: &Geometry<T>) -> SpecularGradient<T> {
        let (f, f_n) = self.index.fresnel_with_slope(geometry.cos_theta_a());
        let (d, d_sigma) = self.facets.density_with_slope(geometry.tan2_alpha(), self.sigma);
        let (g, g_sigma) = self.masking.masking_with_slope(geometry, self.sigma);
        let projection = projection(geometry, self.normalization);
        let weight = g * projection;
        SpecularGradient {
            value: f * (d * weight),
            d_n: f_n * (d * weight),
            // F first: where there is no reflection there is no slope, however steep the lobe (0 · ∞ would be NaN)
            d_sigma: (f * weight) * d_sigma + (f * projection) * (d * g_sigma),
        }
    }
}

impl<T: Real, I: Index<T>, D: Facets<T>, G: Masking<T>> Surface<T, I, D, G>
where
    (D, G): Hemispherical<T>,
{
    /// DHRF_spec (Eq. 14), unitless: the share of the light from `source` that the surface reflects and that never enters
    /// the leaf. Under the surface's own convention for K.
    ///
    /// ```
    /// use leafbrdf_core::{Angle, Grade, Illumination, Surface};
    /// // beech (Table 4): lit at 60° nearly twice as much as at 8° (§4.4)
    /// let sun = Illumination::new(Angle::from_degrees(60.0_f64))?;
    /// let beech = Surface::new(1.56, 0.29)?;
    /// assert!((beech.dhrf(&sun, Grade::E10) - 0.0551).abs() < 1e-4);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    #[inline]
    pub fn dhrf(&self, source: &Illumination<T>, grade: Grade) -> T {
        self.normalization.factor::<T>() * <(D, G)>::dhrf(source, self.index, self.sigma, grade)
    }

    /// DHRF_spec with its exact derivatives with respect to n and σ, from the same nodes.
    #[inline]
    pub fn dhrf_with_gradient(&self, source: &Illumination<T>, grade: Grade) -> DhrfGradient<T> {
        let DhrfGradient { value, d_n, d_sigma } = <(D, G)>::dhrf_with_gradient(source, self.index, self.sigma, grade);
        let factor = self.normalization.factor::<T>();
        DhrfGradient { value: factor * value, d_n: factor * d_n, d_sigma: factor * d_sigma }
    }
}

/// 4π/K · 1/(4 cosθ_s cosθ_v).
#[inline(always)]
fn projection<T: Real>(geometry: &Geometry<T>, normalization: Normalization) -> T {
    normalization.factor::<T>() / (T::lit(4.0) * (geometry.cos_theta_s() * geometry.cos_theta_v()))
}
