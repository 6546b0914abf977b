//! From the leaf's interior to the diffuse term under its surface: k_L(λ), four ways (§4.6, Eqs 15–18).
//!
//! Every coupling is linear in PROSPECT's reflectance R and in what the surface takes away:
//!
//! | coupling | k_L(λ) | whose |
//! |---|---|---|
//! | `Bousquet` | R − DHRF_spec(n, σ, 0°) | Bousquet et al. 2005, Eq. 17 |
//! | `Prospecular` | d = R − (1 − t_av(40°, n(λ))) | Li et al. 2023 (PROSPECULAR); its surface has the index coefficient · n(λ) |
//! | `Offset` | R + b | as Jay et al. 2016 (PROCOSINE) |
//! | `GainOffset` | g d + b | gain and flat offset left to the data |
//!
//! Whichever it is, BRDF = k_L/π + BRDF_spec (Eq. 18). k_L may come out negative where the interior absorbs strongly and the
//! surface is bright: no reflectance is, so it is reported ([`CoupledLeaf::negative`]) and neither hidden nor clipped.

use leafbrdf_core::{Angle, DhrfGradient, DomainError, Geometry, Grade, Illumination, Real, Surface};

use crate::error::Error;
use crate::model::{Prospect, plates_with_slopes};
use crate::params::{LeafParams, Parameter};
use crate::plate::Interface;

/// How PROSPECT's reflectance becomes the diffuse term k_L.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Coupling {
    /// k_L = R − DHRF_spec(n, σ, 0°) (Eq. 17): what the rough surface reflects at normal incidence is no part of the diffuse light.
    #[default]
    Bousquet,
    /// k_L = R − (1 − t_av(40°, n(λ))): PROSPECT's own first-surface reflection is taken off, and the surface's put in its place.
    Prospecular,
    /// k_L = R + b, b one number for all wavelengths.
    Offset,
    /// k_L = g (R − (1 − t_av(40°, n(λ)))) + b: gain and flat offset beside the first-surface reflection.
    GainOffset,
}

/// What a coupling needs beside the interior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link<T> {
    /// DHRF_spec(n, σ, 0°), unitless ([`Coupling::Bousquet`]).
    pub dhrf_specular: T,
    /// g, unitless ([`Coupling::GainOffset`]).
    pub gain: T,
    /// b, unitless ([`Coupling::Offset`], [`Coupling::GainOffset`]).
    pub offset: T,
}

impl<T: Real> Default for Link<T> {
    /// A surface that reflects nothing, gain 1, offset 0.
    fn default() -> Self {
        Link { dhrf_specular: T::ZERO, gain: T::ONE, offset: T::ZERO }
    }
}

/// k_L with its exact derivatives by everything it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiffuseTerm<T> {
    /// k_L, unitless; negative where interior and surface do not go together.
    pub k_lambert: T,
    /// ∂k_L/∂R: multiplies PROSPECT's own derivatives.
    pub d_reflectance: T,
    /// ∂k_L/∂DHRF_spec(0°).
    pub d_dhrf_specular: T,
    /// ∂k_L/∂g.
    pub d_gain: T,
    /// ∂k_L/∂b.
    pub d_offset: T,
}

impl Coupling {
    /// Every coupling.
    pub const ALL: [Coupling; 4] = [Coupling::Bousquet, Coupling::Prospecular, Coupling::Offset, Coupling::GainOffset];

    /// Name on the command line and in files: `bousquet`, `prospecular`, `offset`, `gain-offset`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Coupling::Bousquet => "bousquet",
            Coupling::Prospecular => "prospecular",
            Coupling::Offset => "offset",
            Coupling::GainOffset => "gain-offset",
        }
    }

    /// The coupling of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Coupling> {
        Coupling::ALL.into_iter().find(|coupling| coupling.name() == name)
    }

    /// Does k_L depend on the surface, through DHRF_spec(n, σ, 0°)?
    #[must_use]
    pub const fn takes_surface(self) -> bool {
        matches!(self, Coupling::Bousquet)
    }

    /// k_L in one band.
    ///
    /// - `reflectance`: R of PROSPECT, a fraction.
    /// - `t_alpha`: t_av(40°, n(λ)), unitless ([`View::t_alpha`](crate::table::View::t_alpha)).
    ///
    /// ```
    /// use leafbrdf_prospect::{Coupling, Link};
    /// // near infrared: half of the light comes back, of which a surface of n = 1.5 reflects 4 % (K = 4π)
    /// let under = Coupling::Bousquet.diffuse(0.5_f64, 0.96, &Link { dhrf_specular: 0.04, ..Link::default() });
    /// assert!((under.k_lambert - 0.46).abs() < 1e-15 && under.d_dhrf_specular == -1.0);
    /// ```
    #[inline(always)]
    #[must_use]
    pub fn diffuse<T: Real>(self, reflectance: T, t_alpha: T, link: &Link<T>) -> DiffuseTerm<T> {
        let first_surface = T::ONE - t_alpha;
        let plain = DiffuseTerm {
            k_lambert: reflectance,
            d_reflectance: T::ONE,
            d_dhrf_specular: T::ZERO,
            d_gain: T::ZERO,
            d_offset: T::ZERO,
        };
        match self {
            Coupling::Bousquet => {
                DiffuseTerm { k_lambert: reflectance - link.dhrf_specular, d_dhrf_specular: -T::ONE, ..plain }
            }
            Coupling::Prospecular => DiffuseTerm { k_lambert: reflectance - first_surface, ..plain },
            Coupling::Offset => DiffuseTerm { k_lambert: reflectance + link.offset, d_offset: T::ONE, ..plain },
            Coupling::GainOffset => {
                let d = reflectance - first_surface;
                DiffuseTerm {
                    k_lambert: link.gain * d + link.offset,
                    d_reflectance: link.gain,
                    d_gain: d,
                    d_offset: T::ONE,
                    ..plain
                }
            }
        }
    }
}

/// The refractive index of the leaf's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SurfaceIndex<T> {
    /// n, the same at every wavelength (§4.3).
    Constant(T),
    /// A coefficient on the tabulated index of leaf material, coefficient · n(λ): PROSPECULAR's.
    Scaled(T),
}

impl<T: Real> SurfaceIndex<T> {
    /// The index over a plate of these faces, and its derivative by the number in [`SurfaceIndex`].
    #[must_use]
    pub fn at(self, faces: Interface<T>) -> (T, T) {
        match self {
            SurfaceIndex::Constant(n) => (n, T::ONE),
            SurfaceIndex::Scaled(coefficient) => {
                // t₂₁ = t₉₀/n²
                let material = (faces.t_90 / faces.t_21).sqrt();
                (coefficient * material, material)
            }
        }
    }
}

/// The whole leaf: PROSPECT's interior under a rough surface (Eq. 18).
///
/// ```
/// use leafbrdf_core::{Angle, Geometry, Surface};
/// use leafbrdf_prospect::{CoupledLeaf, Coupling, LeafParams, Prospect, SurfaceIndex, Version, table};
/// let interior = LeafParams { cab: 40.0, car: 10.0, cw: 0.01, cm: 0.005, ..LeafParams::with_n_struct(1.6) };
/// let model = Prospect::new(table::full(Version::D));
/// let beech = CoupledLeaf::new(model, interior, Coupling::Bousquet, Surface::new(1.56, 0.29)?);
///
/// // seen and lit from above, at 800 nm: k_L is what PROSPECT gives less 3 % of surface reflection
/// let zenith = Angle::from_degrees(0.0_f64);
/// let nadir = Geometry::from_angles(zenith, zenith, zenith)?;
/// let leaf = beech.band(400, &nadir)?;
/// let r = model.band(&interior, 400)?.reflectance;
/// assert!((r - leaf.diffuse.k_lambert - 0.03).abs() < 0.002);
/// assert!(leaf.brdf > leaf.diffuse.k_lambert / core::f64::consts::PI);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct CoupledLeaf<'a, T> {
    model: Prospect<'a, T>,
    interior: LeafParams<T>,
    coupling: Coupling,
    surface: Surface<T>,
    index: SurfaceIndex<T>,
    gain: T,
    offset: T,
}

/// The leaf in one band and direction, with exact derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoupledBand<T> {
    /// k_L and what it depends on.
    pub diffuse: DiffuseTerm<T>,
    /// BRDF, sr⁻¹.
    pub brdf: T,
    /// ∂BRDF/∂n: by n, or by the coefficient where the index is [`SurfaceIndex::Scaled`]; DHRF_spec's part included.
    pub d_n: T,
    /// ∂BRDF/∂σ, DHRF_spec's part included.
    pub d_sigma: T,
    /// ∂BRDF/∂g.
    pub d_gain: T,
    /// ∂BRDF/∂b.
    pub d_offset: T,
    /// ∂BRDF/∂ each of [`Parameter::ALL`], per unit of the parameter; 0 for what the version lacks.
    pub d_interior: [T; Parameter::ALL.len()],
}

impl<'a, T: Real> CoupledLeaf<'a, T> {
    /// An interior under a surface; gain 1, offset 0, the surface's index at every wavelength.
    ///
    /// The interior is checked where a band is computed.
    #[must_use]
    pub fn new(model: Prospect<'a, T>, interior: LeafParams<T>, coupling: Coupling, surface: Surface<T>) -> Self {
        let index = SurfaceIndex::Constant(surface.index().n());
        CoupledLeaf { model, interior, coupling, surface, index, gain: T::ONE, offset: T::ZERO }
    }

    /// With gain g and offset b, which two of the couplings use.
    #[must_use]
    pub fn with_gain_and_offset(mut self, gain: T, offset: T) -> Self {
        (self.gain, self.offset) = (gain, offset);
        self
    }

    /// With an index that follows the tabulated one of leaf material: coefficient · n(λ), as in PROSPECULAR.
    #[must_use]
    pub fn with_scaled_index(mut self, coefficient: T) -> Self {
        self.index = SurfaceIndex::Scaled(coefficient);
        self
    }

    /// k_L and BRDF in one band of the model's table, with derivatives by every parameter.
    ///
    /// DHRF_spec is taken with grade E10 (relative error below 10⁻¹⁰).
    ///
    /// # Errors
    ///
    /// Those of [`Prospect::band`]; [`Error::SurfaceIndex`] where coefficient · n(λ) is below 1.
    pub fn band(&self, band: usize, geometry: &Geometry<T>) -> Result<CoupledBand<T>, Error> {
        let (faces, k, n_struct) = self.model.plate(&self.interior, band)?;
        let (n, n_slope) = self.index.at(faces);
        let outside = |_: DomainError| Error::SurfaceIndex { value: n.to_f64() };
        let surface =
            Surface::new(n, self.surface.sigma()).map_err(outside)?.with_normalization(self.surface.normalization());
        let dhrf = if self.coupling.takes_surface() {
            surface.dhrf_with_gradient(&Illumination::new(Angle::from_radians(T::ZERO)).map_err(outside)?, Grade::E10)
        } else {
            DhrfGradient { value: T::ZERO, d_n: T::ZERO, d_sigma: T::ZERO }
        };
        let (optics, slopes) = plates_with_slopes(faces, k, n_struct);
        let link = Link { dhrf_specular: dhrf.value, gain: self.gain, offset: self.offset };
        let diffuse = self.coupling.diffuse(optics.reflectance, faces.t_alpha, &link);
        let lobe = surface.brdf_with_gradient(geometry);

        let inv_pi = T::lit(core::f64::consts::FRAC_1_PI);
        let mut d_interior = self.model.chain(band, k, n_struct, slopes.dr_dk, slopes.dr_dn);
        for slope in &mut d_interior {
            *slope = inv_pi * diffuse.d_reflectance * *slope;
        }
        Ok(CoupledBand {
            diffuse,
            brdf: inv_pi * diffuse.k_lambert + lobe.value,
            d_n: n_slope * (inv_pi * diffuse.d_dhrf_specular * dhrf.d_n + lobe.d_n),
            d_sigma: inv_pi * diffuse.d_dhrf_specular * dhrf.d_sigma + lobe.d_sigma,
            d_gain: inv_pi * diffuse.d_gain,
            d_offset: inv_pi * diffuse.d_offset,
            d_interior,
        })
    }

    /// Is k_L negative in this band? There the surface alone reflects more than the whole leaf.
    ///
    /// # Errors
    ///
    /// As [`CoupledLeaf::band`].
    pub fn negative(&self, band: usize) -> Result<bool, Error> {
        let zenith = Angle::from_radians(T::ZERO);
        let nadir =
            Geometry::from_angles(zenith, zenith, zenith).map_err(|_| Error::SurfaceIndex { value: f64::NAN })?;
        Ok(self.band(band, &nadir)?.diffuse.k_lambert < T::ZERO)
    }
}
