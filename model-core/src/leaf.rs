//! The leaf: BRDF = BRDF_diff + BRDF_spec (Eq. 3).

use crate::diffuse::{Diffuse, Lambert};
use crate::facet::{Beckmann, Facets};
use crate::fresnel::{Dielectric, Index};
use crate::masking::{Masking, VCavity};
use crate::{DomainError, Geometry, Real, Surface};

mod tilted;
pub use tilted::{TiltedDiffuseGradient, TiltedLeafGradient};

/// BRDF of a leaf and its exact derivatives with respect to the three parameters of §4.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeafGradient<T> {
    /// BRDF, sr⁻¹.
    pub value: T,
    /// ∂BRDF/∂k_L, sr⁻¹.
    pub d_k_lambert: T,
    /// ∂BRDF/∂n, sr⁻¹.
    pub d_n: T,
    /// ∂BRDF/∂σ, sr⁻¹.
    pub d_sigma: T,
}

/// A leaf at one wavelength: Lambert coefficient k_L under a specular surface.
///
/// ```
/// use leafbrdf_core::{Angle, Geometry, Leaf, Surface};
/// // a leaf seen and lit at nadir, far in the near infrared: BRF is k_L plus the lobe
/// let zenith = Angle::from_degrees(0.0_f64);
/// let nadir = Geometry::from_angles(zenith, zenith, zenith)?;
/// let beech = Leaf::new(0.45, Surface::new(1.56, 0.29)?)?;
/// assert!((beech.brf(&nadir) - 0.5406).abs() < 5e-4);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf<T, I = Dielectric<T>, D = Beckmann, G = VCavity, L = Lambert> {
    k_lambert: T,
    surface: Surface<T, I, D, G>,
    diffuse: L,
}

impl<T: Real, I: Index<T>, D: Facets<T>, G: Masking<T>> Leaf<T, I, D, G> {
    /// A Lambertian interior of coefficient k_L under `surface`.
    ///
    /// # Errors
    /// [`DomainError`] unless 0 ≤ k_L ≤ 1.
    pub fn new(k_lambert: T, surface: Surface<T, I, D, G>) -> Result<Self, DomainError> {
        Leaf::with_diffuse(k_lambert, surface, Lambert)
    }
}

impl<T: Real, I: Index<T>, D: Facets<T>, G: Masking<T>, L: Diffuse<T>> Leaf<T, I, D, G, L> {
    /// The same with another shape of the diffuse term.
    ///
    /// # Errors
    /// [`DomainError`] unless 0 ≤ k_L ≤ 1.
    pub fn with_diffuse(k_lambert: T, surface: Surface<T, I, D, G>, diffuse: L) -> Result<Self, DomainError> {
        if !(k_lambert >= T::ZERO && k_lambert <= T::ONE) {
            return Err(DomainError::new("k_lambert", "0 ≤ k_L ≤ 1"));
        }
        Ok(Leaf { k_lambert, surface, diffuse })
    }

    /// k_L.
    pub fn k_lambert(&self) -> T {
        self.k_lambert
    }

    /// The surface.
    pub fn surface(&self) -> &Surface<T, I, D, G> {
        &self.surface
    }

    /// The shape of the diffuse term.
    pub fn diffuse(&self) -> L {
        self.diffuse
    }

    /// BRDF_diff in sr⁻¹ (Eq. 4).
    #[inline(always)]
    pub fn brdf_diffuse(&self, geometry: &Geometry<T>) -> T {
        self.k_lambert * self.diffuse.shape(geometry)
    }

    /// BRDF in sr⁻¹ (Eq. 3).
    #[inline(always)]
    pub fn brdf(&self, geometry: &Geometry<T>) -> T {
        self.brdf_diffuse(geometry) + self.surface.brdf(geometry)
    }

    /// BRF = π · BRDF, unitless.
    #[inline(always)]
    pub fn brf(&self, geometry: &Geometry<T>) -> T {
        T::PI * self.brdf(geometry)
    }

    /// BRDF and its exact derivatives with respect to k_L, n and σ, one pass.
    #[inline(always)]
    pub fn brdf_with_gradient(&self, geometry: &Geometry<T>) -> LeafGradient<T> {
        let specular = self.surface.brdf_with_gradient(geometry);
        let shape = self.diffuse.shape(geometry);
        LeafGradient {
            value: self.k_lambert * shape + specular.value,
            d_k_lambert: shape,
            d_n: specular.d_n,
            d_sigma: specular.d_sigma,
        }
    }
}
