//! What one direction contributes: the diffuse term for k_L = 1 and the lobe, with derivatives over [n, σ, a, b, t_x, t_y, e].
//!
//! The equations are `leafbrdf_core`'s; this page only says which of them are asked for, and in which order the derivatives
//! stand.

use leafbrdf_core::diffuse::{Diffuse, Lambert, P1, P2};
use leafbrdf_core::facet::Facets;
use leafbrdf_core::masking::Masking;
use leafbrdf_core::{Angle, Dielectric, DirectionVectors, DomainError, Normalization, Real, Surface, Tilt};

/// How many parameters a surface has: n, σ, a, b, t_x, t_y, e.
pub const PARAMETERS: usize = 7;

/// The place of n, the refractive index.
pub const N: usize = 0;
/// The place of σ, the roughness.
pub const SIGMA: usize = 1;
/// The place of a, the bowl of the diffuse term.
pub const DIFFUSE_A: usize = 2;
/// The place of b, the asymmetry of the diffuse term.
pub const DIFFUSE_B: usize = 3;
/// The place of t_x, the tilt in the plane of incidence, radians.
pub const TILT_IN_PLANE: usize = 4;
/// The place of t_y, the tilt across it, radians.
pub const TILT_LATERAL: usize = 5;
/// The place of e, how much the diffuse term knows of the angle through which the light turned.
pub const DIFFUSE_E: usize = 6;

/// The parameters' names in files, angles in degrees there.
pub const NAMES: [&str; PARAMETERS] = ["n", "sigma", "p1_a", "p1_b", "tilt_in_plane_deg", "tilt_lateral_deg", "p2_e"];

/// BRDF = k_L · `diffuse` + `specular` in one direction, with derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionValue<T> {
    /// BRDF_diff for k_L = 1, sr⁻¹.
    pub diffuse: T,
    /// BRDF_spec, sr⁻¹.
    pub specular: T,
    /// ∂diffuse/∂[n, σ, a, b, t_x, t_y, e].
    pub d_diffuse: [T; PARAMETERS],
    /// ∂specular/∂[n, σ, a, b, t_x, t_y, e].
    pub d_specular: [T; PARAMETERS],
}

impl<T: Real> DirectionValue<T> {
    /// No light.
    pub const fn dark() -> Self {
        DirectionValue {
            diffuse: T::ZERO,
            specular: T::ZERO,
            d_diffuse: [T::ZERO; PARAMETERS],
            d_specular: [T::ZERO; PARAMETERS],
        }
    }
}

/// A surface seen in a fixed list of directions, whatever its equations.
pub trait DirectionalModel<T> {
    /// How many directions there are.
    fn directions(&self) -> usize;

    /// Tells `set`, direction by direction, [diffuse for k_L = 1, specular] in sr⁻¹ at [n, σ, a, b, t_x, t_y, e].
    ///
    /// # Errors
    /// [`DomainError`] where the surface is outside its domain, or a direction below the tilted leaf's horizon.
    fn values(&self, x: &[T; PARAMETERS], set: impl FnMut([T; 2])) -> Result<(), DomainError>;

    /// The same with derivatives.
    ///
    /// # Errors
    /// As [`values`](Self::values).
    fn derivatives(&self, x: &[T; PARAMETERS], set: impl FnMut(DirectionValue<T>)) -> Result<(), DomainError>;
}

/// How facet slopes are distributed, and which masking goes with it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FacetKind {
    /// Beckmann's slopes and V-cavities: the paper's (Eqs 7, 9).
    #[default]
    Beckmann,
    /// GGX with Smith's masking: a lobe with a tail.
    Ggx,
}

impl FacetKind {
    /// The kind's name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            FacetKind::Beckmann => "beckmann",
            FacetKind::Ggx => "ggx",
        }
    }
}

/// The directional shape of the diffuse term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DiffuseKind {
    /// k_L/π: the paper's (Eq. 4).
    #[default]
    Lambert,
    /// A bowl a and an asymmetry b: see [`P1`].
    P1,
    /// The same, and e: see [`P2`].
    P2,
}

impl DiffuseKind {
    /// The kind's name in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            DiffuseKind::Lambert => "lambert",
            DiffuseKind::P1 => "p1",
            DiffuseKind::P2 => "p2",
        }
    }
}

/// The leaf of `leafbrdf_core` in a list of directions.
#[derive(Clone, Copy, Debug)]
pub struct LeafModel<'a, T> {
    /// The directions, in the instrument's frame.
    pub directions: &'a [DirectionVectors<T>],
    /// Distribution of facets, and masking.
    pub facets: FacetKind,
    /// Shape of the diffuse term; a, b and e are looked at only where it has them.
    pub diffuse: DiffuseKind,
    /// The constant K that n and σ belong to.
    pub normalization: Normalization,
}

impl<T: Real> LeafModel<'_, T> {
    fn tilt(x: &[T; PARAMETERS]) -> Result<Tilt<T>, DomainError> {
        Tilt::new(Angle::from_radians(x[TILT_IN_PLANE]), Angle::from_radians(x[TILT_LATERAL]))
    }

    fn all_values<D: Facets<T>, G: Masking<T>>(
        &self,
        surface: Surface<T, Dielectric<T>, D, G>,
        diffuse: impl Diffuse<T>,
        tilt: &Tilt<T>,
        mut set: impl FnMut([T; 2]),
    ) -> Result<(), DomainError> {
        let surface = surface.with_normalization(self.normalization);
        for direction in self.directions {
            let seen = direction.about(tilt)?;
            set([seen.factor() * diffuse.shape(seen.geometry()), surface.brdf_tilted(&seen)]);
        }
        Ok(())
    }

    fn all_derivatives<D: Facets<T>, G: Masking<T>>(
        &self,
        surface: Surface<T, Dielectric<T>, D, G>,
        diffuse: impl Diffuse<T>,
        tilt: &Tilt<T>,
        mut set: impl FnMut(DirectionValue<T>),
    ) -> Result<(), DomainError> {
        let surface = surface.with_normalization(self.normalization);
        for direction in self.directions {
            let seen = direction.about(tilt)?;
            let p = surface.brdf_tilted_with_gradient(&seen);
            let s = seen.diffuse_with_gradient(diffuse);
            set(DirectionValue {
                diffuse: s.value,
                specular: p.value,
                d_diffuse: [T::ZERO, T::ZERO, s.d_a, s.d_b, s.d_in_plane, s.d_lateral, s.d_e],
                d_specular: [p.d_n, p.d_sigma, T::ZERO, T::ZERO, p.d_in_plane, p.d_lateral, T::ZERO],
            });
        }
        Ok(())
    }
}

impl<T: Real> DirectionalModel<T> for LeafModel<'_, T> {
    fn directions(&self) -> usize {
        self.directions.len()
    }

    fn values(&self, x: &[T; PARAMETERS], set: impl FnMut([T; 2])) -> Result<(), DomainError> {
        let tilt = Self::tilt(x)?;
        let [n, sigma, a, b, _, _, e] = *x;
        match (self.facets, self.diffuse) {
            (FacetKind::Beckmann, DiffuseKind::Lambert) => {
                self.all_values(Surface::new(n, sigma)?, Lambert, &tilt, set)
            }
            (FacetKind::Beckmann, DiffuseKind::P1) => {
                self.all_values(Surface::new(n, sigma)?, P1::new(a, b)?, &tilt, set)
            }
            (FacetKind::Ggx, DiffuseKind::Lambert) => self.all_values(Surface::ggx(n, sigma)?, Lambert, &tilt, set),
            (FacetKind::Beckmann, DiffuseKind::P2) => {
                self.all_values(Surface::new(n, sigma)?, P2::new(a, b, e)?, &tilt, set)
            }
            (FacetKind::Ggx, DiffuseKind::P1) => self.all_values(Surface::ggx(n, sigma)?, P1::new(a, b)?, &tilt, set),
            (FacetKind::Ggx, DiffuseKind::P2) => {
                self.all_values(Surface::ggx(n, sigma)?, P2::new(a, b, e)?, &tilt, set)
            }
        }
    }

    fn derivatives(&self, x: &[T; PARAMETERS], set: impl FnMut(DirectionValue<T>)) -> Result<(), DomainError> {
        let tilt = Self::tilt(x)?;
        let [n, sigma, a, b, _, _, e] = *x;
        match (self.facets, self.diffuse) {
            (FacetKind::Beckmann, DiffuseKind::Lambert) => {
                self.all_derivatives(Surface::new(n, sigma)?, Lambert, &tilt, set)
            }
            (FacetKind::Beckmann, DiffuseKind::P1) => {
                self.all_derivatives(Surface::new(n, sigma)?, P1::new(a, b)?, &tilt, set)
            }
            (FacetKind::Ggx, DiffuseKind::Lambert) => {
                self.all_derivatives(Surface::ggx(n, sigma)?, Lambert, &tilt, set)
            }
            (FacetKind::Ggx, DiffuseKind::P1) => {
                self.all_derivatives(Surface::ggx(n, sigma)?, P1::new(a, b)?, &tilt, set)
            }
            (FacetKind::Beckmann, DiffuseKind::P2) => {
                self.all_derivatives(Surface::new(n, sigma)?, P2::new(a, b, e)?, &tilt, set)
            }
            (FacetKind::Ggx, DiffuseKind::P2) => {
                self.all_derivatives(Surface::ggx(n, sigma)?, P2::new(a, b, e)?, &tilt, set)
            }
        }
    }
}
