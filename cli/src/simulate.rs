//! Simulated measurements: the five-parameter leaf (Eq. 18) on a goniometer, with noise.
//!
//! | room | what |
//! |---|---|
//! | `goniometer` | the directions of a campaign |
//! | `leaves` | laurel, beech and hazel: n and σ of Table 4, an interior of ours |
//! | `noise` | what an instrument adds, from a seed |
//!
//! Everything here gives the same file on every machine: the random numbers come from integer arithmetic, and values are
//! rounded to what an instrument records, 10⁻⁶ sr⁻¹, which is coarser by 10⁸ than the differences between the elementary
//! functions of two systems.

mod goniometer;
mod leaves;
mod noise;

pub use goniometer::{SOURCES_DEG, paper_directions};
pub use leaves::{PresetLeaf, presets};
pub use noise::{Gauss, Noise};

use std::f64::consts::PI;
use std::fmt;
use std::ops::RangeInclusive;

use leafbrdf_core::{Angle, DomainError, Geometry, Grade, Illumination, Normalization, Surface};
use leafbrdf_prospect::{LeafParams, Prospect, Version, table};

use crate::measurement::{Azimuth, Direction, Layout, Measurement, Metadata, Quantity};

/// Values are rounded to one part in this many, sr⁻¹.
const STEPS_PER_SR: f64 = 1e6;

/// Why a leaf cannot be simulated.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// A parameter of the surface, or an angle.
    Surface(DomainError),
    /// A parameter of the leaf's interior.
    Interior(leafbrdf_prospect::Error),
    /// Wavelengths that the table of PROSPECT does not have.
    Wavelengths {
        /// First wavelength asked for, nm.
        first: u16,
        /// Last wavelength asked for, nm.
        last: u16,
    },
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SimulationError::Surface(error) => error.fmt(f),
            SimulationError::Interior(error) => error.fmt(f),
            SimulationError::Wavelengths { first, last } => {
                write!(f, "wavelengths {first} to {last} nm: PROSPECT has 400 to 2500 nm, first before last")
            }
        }
    }
}

impl std::error::Error for SimulationError {}

impl From<DomainError> for SimulationError {
    fn from(error: DomainError) -> Self {
        SimulationError::Surface(error)
    }
}

impl From<leafbrdf_prospect::Error> for SimulationError {
    fn from(error: leafbrdf_prospect::Error) -> Self {
        SimulationError::Interior(error)
    }
}

/// A leaf whose diffuse part comes from PROSPECT-D: the true values behind a simulated measurement.
#[derive(Clone, Debug)]
pub struct CoupledLeaf {
    /// The surface, with its convention for K.
    pub surface: Surface<f64>,
    /// Wavelengths, nm, 1 nm apart.
    pub wavelengths_nm: Vec<f64>,
    /// k_L(λ) = R_prospect(λ) − DHRF_spec(n, σ, 0°) (Eq. 17).
    pub k_lambert: Vec<f64>,
    /// DHRF_spec(n, σ, 0°).
    pub dhrf_specular: f64,
}

impl CoupledLeaf {
    /// k_L of every wavelength from the interior and the surface (Eqs 15–17).
    ///
    /// Where the interior absorbs strongly and n is large, k_L may come out negative, which no reflectance is: see
    /// [`negative`](Self::negative).
    ///
    /// # Errors
    /// Parameters of the interior outside PROSPECT's limits, wavelengths outside 400–2500 nm.
    pub fn new(
        surface: Surface<f64>,
        interior: &LeafParams<f64>,
        wavelengths_nm: RangeInclusive<u16>,
    ) -> Result<Self, SimulationError> {
        let (first, last) = (*wavelengths_nm.start(), *wavelengths_nm.end());
        let outside = SimulationError::Wavelengths { first, last };
        let place = |nm: u16| usize::from(nm).checked_sub(400);
        let (Some(from), Some(to)) = (place(first), place(last)) else { return Err(outside) };
        let view = table::full(Version::D).bands(from..to + 1).filter(|view| !view.is_empty()).ok_or(outside)?;

        let (mut reflectance, mut transmittance) = (vec![0.0; view.len()], vec![0.0; view.len()]);
        Prospect::new(view).spectrum(interior, &mut reflectance, &mut transmittance)?;
        let zenith = Illumination::new(Angle::from_degrees(0.0))?;
        let dhrf_specular = surface.dhrf(&zenith, Grade::E10);
        Ok(CoupledLeaf {
            surface,
            wavelengths_nm: view.wavelengths().iter().collect(),
            k_lambert: reflectance.iter().map(|r| r - dhrf_specular).collect(),
            dhrf_specular,
        })
    }

    /// The number of wavelengths at which k_L is negative: there the interior and the surface do not go together.
    pub fn negative(&self) -> usize {
        self.k_lambert.iter().filter(|k_l| **k_l < 0.0).count()
    }

    /// BRDF in sr⁻¹ as a goniometer would record it (Eq. 18), noise included, rounded to 10⁻⁶ sr⁻¹.
    ///
    /// # Errors
    /// Directions at or below the horizon.
    pub fn measure(
        &self,
        name: &str,
        metadata: Metadata,
        directions: &[Direction],
        noise: &mut Noise,
    ) -> Result<Measurement, SimulationError> {
        let deg = Angle::from_degrees;
        let specular = directions
            .iter()
            .map(|d| {
                let geometry = Geometry::from_angles(deg(d.theta_s_deg), deg(d.theta_v_deg), deg(d.phi_v_deg))?;
                Ok(self.surface.brdf(&geometry))
            })
            .collect::<Result<Vec<f64>, DomainError>>()?;
        let values = self.k_lambert.iter().flat_map(|k_l| specular.iter().map(move |lobe| k_l / PI + lobe));
        Ok(Measurement {
            name: name.to_string(),
            sample: Some(name.to_string()),
            metadata,
            quantity: Quantity::Brdf,
            layout: Layout::Wide,
            azimuth: Azimuth::Forward180,
            wavelengths_nm: self.wavelengths_nm.clone(),
            directions: directions.to_vec(),
            values: values.map(|brdf| (noise.on(brdf) * STEPS_PER_SR).round() / STEPS_PER_SR).collect(),
            sd: None,
        })
    }

    /// The convention for K of n and σ.
    pub fn normalization(&self) -> Normalization {
        self.surface.normalization()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interior() -> LeafParams<f64> {
        LeafParams { cab: 40.0, car: 10.0, cw: 0.01, cm: 0.009, ..LeafParams::with_n_struct(1.5) }
    }

    #[test]
    fn lambert_coefficient_and_specular_dhrf_add_up_to_prospects_reflectance() {
        let surface = Surface::new(1.56, 0.29).unwrap();
        let leaf = CoupledLeaf::new(surface, &interior(), 480..=879).unwrap();
        assert_eq!((leaf.wavelengths_nm.len(), leaf.wavelengths_nm[0], leaf.wavelengths_nm[399]), (400, 480.0, 879.0));
        let model = Prospect::new(table::full(Version::D));
        for (nm, k_l) in leaf.wavelengths_nm.iter().zip(&leaf.k_lambert) {
            let r = model.band(&interior(), *nm as usize - 400).unwrap().reflectance;
            // both sides f64: the kernel and the single band agree to rounding
            assert!((k_l + leaf.dhrf_specular - r).abs() < 1e-14, "{nm} nm");
        }
    }

    #[test]
    fn a_surface_brighter_than_the_whole_leaf_is_counted() {
        // n = 3 reflects 16 % at normal incidence under K = 2π², more than a green leaf in the red
        let leaf = CoupledLeaf::new(Surface::new(3.0, 0.1).unwrap(), &interior(), 480..=879).unwrap();
        assert!(leaf.negative() > 100 && leaf.negative() < 400);
    }

    #[test]
    fn impossible_input_is_refused_by_name() {
        let surface = Surface::new(1.5, 0.3).unwrap();
        let error = |interior, range| CoupledLeaf::new(surface, &interior, range).unwrap_err().to_string();
        assert!(error(interior(), 300..=800).contains("400 to 2500 nm"));
        assert!(error(interior(), 800..=2501).contains("400 to 2500 nm"));
        assert!(error(interior(), RangeInclusive::new(800, 700)).contains("400 to 2500 nm"));
        assert!(error(LeafParams { cm: 9.0, ..interior() }, 480..=879).contains("cm"));
    }
}
