//! Surfaces and diffuse terms chosen at run time.

use leafbrdf_core::{
    Diffuse, DomainError, Geometry, GgxSurface, Grade, Illumination, Lambert, Normalization, P1, Surface,
};

/// The facets of a leaf's surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum FacetKind {
    /// Beckmann facets, V-cavity masking: the paper's (Eqs 7, 9)
    #[default]
    Beckmann,
    /// GGX facets, Smith masking: a lobe with a tail
    Ggx,
}

impl FacetKind {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            FacetKind::Beckmann => "beckmann",
            FacetKind::Ggx => "ggx",
        }
    }

    /// The convention for K where none is asked for: the printed one for the paper's facets; GGX is normalised.
    pub fn usual_normalization(self) -> Normalization {
        match self {
            FacetKind::Beckmann => Normalization::Bousquet2005,
            FacetKind::Ggx => Normalization::CookTorrance,
        }
    }
}

/// A surface of either kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnySurface {
    /// The paper's.
    Beckmann(Surface<f64>),
    /// GGX–Smith.
    Ggx(GgxSurface<f64>),
}

impl AnySurface {
    /// A surface of index n and roughness σ.
    ///
    /// # Errors
    /// n < 1, σ ≤ 0 and the like, by the parameter's name.
    pub fn new(kind: FacetKind, n: f64, sigma: f64, normalization: Normalization) -> Result<Self, DomainError> {
        Ok(match kind {
            FacetKind::Beckmann => AnySurface::Beckmann(Surface::new(n, sigma)?.with_normalization(normalization)),
            FacetKind::Ggx => AnySurface::Ggx(Surface::ggx(n, sigma)?.with_normalization(normalization)),
        })
    }

    /// Which facets.
    pub fn kind(&self) -> FacetKind {
        match self {
            AnySurface::Beckmann(_) => FacetKind::Beckmann,
            AnySurface::Ggx(_) => FacetKind::Ggx,
        }
    }

    /// n.
    pub fn n(&self) -> f64 {
        match self {
            AnySurface::Beckmann(surface) => surface.index().n(),
            AnySurface::Ggx(surface) => surface.index().n(),
        }
    }

    /// σ.
    pub fn sigma(&self) -> f64 {
        match self {
            AnySurface::Beckmann(surface) => surface.sigma(),
            AnySurface::Ggx(surface) => surface.sigma(),
        }
    }

    /// The convention for K of n and σ.
    pub fn normalization(&self) -> Normalization {
        match self {
            AnySurface::Beckmann(surface) => surface.normalization(),
            AnySurface::Ggx(surface) => surface.normalization(),
        }
    }

    /// BRDF_spec, sr⁻¹.
    pub fn brdf(&self, geometry: &Geometry<f64>) -> f64 {
        match self {
            AnySurface::Beckmann(surface) => surface.brdf(geometry),
            AnySurface::Ggx(surface) => surface.brdf(geometry),
        }
    }

    /// DHRF_spec, unitless.
    pub fn dhrf(&self, source: &Illumination<f64>) -> f64 {
        match self {
            AnySurface::Beckmann(surface) => surface.dhrf(source, Grade::E10),
            AnySurface::Ggx(surface) => surface.dhrf(source, Grade::E10),
        }
    }
}

/// A diffuse term of either kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyDiffuse {
    /// k_L/π (Eq. 4).
    Lambert,
    /// With a bowl, of which k_L is the DHRF at normal incidence.
    P1(P1<f64>),
}

impl AnyDiffuse {
    /// BRDF_diff/k_L, sr⁻¹.
    pub fn shape(&self, geometry: &Geometry<f64>) -> f64 {
        match self {
            AnyDiffuse::Lambert => Lambert.shape(geometry),
            AnyDiffuse::P1(bowl) => bowl.shape(geometry),
        }
    }

    /// DHRF_diff/k_L at cos θ_s.
    pub fn hemispherical(&self, cos_theta_s: f64) -> f64 {
        match self {
            AnyDiffuse::Lambert => 1.0,
            AnyDiffuse::P1(bowl) => bowl.hemispherical(cos_theta_s),
        }
    }
}
