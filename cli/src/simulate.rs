//! Simulated measurements: the five-parameter leaf (Eq. 18) on a goniometer, with noise.
//!
//! | room | what |
//! |---|---|
//! | `goniometer` | the directions of the paper's campaign |
//! | `leaves` | laurel, beech and hazel: n and σ of Table 4, an interior of ours |
//! | `surface` | facets and diffuse terms, chosen at run time |
//! | `coupled` | the whole leaf: its parameters and the k_L(λ) that follows |
//! | `instrument` | what is recorded of it: tilt, loss at grazing views |
//! | `noise` | what an instrument adds, from a seed |
//! | `truth` | the true k_L(λ), n and σ as a table |
//!
//! Everything here gives the same file on every machine: the random numbers come from integer arithmetic, and values are
//! rounded to what an instrument records, 10⁻⁶ sr⁻¹, which is coarser by 10⁸ than the differences between the elementary
//! functions of two systems.
//!
//! ```
//! use leafbrdf::measurement::Metadata;
//! use leafbrdf::simulate::{Instrument, LeafModel, Noise, paper_directions, presets};
//! let [laurel, ..] = presets();
//! let leaf = LeafModel::of_preset(&laurel)?.at(&[670.0])?;
//! let mut noise = Noise::new(0.0, 0.0, 1);
//! let measured = Instrument::new(paper_directions()).measure(&leaf, "laurel", Metadata::new(), &mut noise)?;
//! let brightest = measured.values.iter().copied().fold(0.0, f64::max);
//! assert!(brightest > 0.9 && brightest < 1.3); // §3.2 prints 1.1 sr⁻¹
//! # Ok::<(), leafbrdf::simulate::SimulationError>(())
//! ```

mod coupled;
mod goniometer;
mod instrument;
mod leaves;
mod noise;
mod surface;
mod truth;

pub use coupled::{CoupledLeaf, LeafModel};
pub use goniometer::{SOURCES_DEG, paper_directions};
pub use instrument::Instrument;
pub use leaves::{PresetLeaf, presets};
pub use noise::{Gauss, Noise};
pub use surface::{AnyDiffuse, AnySurface, FacetKind};
pub use truth::write_truth;

use std::fmt;

use leafbrdf_core::DomainError;

/// Why a leaf cannot be simulated.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SimulationError {
    /// A parameter of the surface, or an angle.
    Surface(DomainError),
    /// A parameter of the leaf's interior, or a wavelength that PROSPECT does not have.
    Interior(leafbrdf_prospect::Error),
    /// The tilt puts source or view below the leaf's horizon in every direction.
    NothingSeen,
    /// Standard deviations are asked for, and there is no noise.
    NoNoise,
}

impl fmt::Display for SimulationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SimulationError::Surface(error) => error.fmt(f),
            SimulationError::Interior(error) => error.fmt(f),
            SimulationError::NothingSeen => {
                f.write_str("the tilt puts source or view below the leaf's horizon in every direction: tilt it less")
            }
            SimulationError::NoNoise => f.write_str("without noise there is no standard deviation to write"),
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
