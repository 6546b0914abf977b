//! What no inversion can start from, in words.

use core::fmt;

use leafbrdf_prospect::table::{FIRST_NM, LAST_NM};

use crate::FitError;

/// Input that no inversion can start from. A search that stops early is an answer, not an error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum LeafError {
    /// What the surface fit refuses.
    Surface(FitError),
    /// What PROSPECT refuses.
    Interior(leafbrdf_prospect::Error),
    /// No usable value between 400 and 2500 nm.
    NothingMeasured {
        /// First and last wavelength of the data, nm.
        first: f64,
        /// See `first`.
        last: f64,
    },
    /// The recipe has a grid of wavelengths of its own, of which the data have none.
    NoRecipeWavelength,
    /// Bounds out of order, or outside what the model accepts.
    Bounds {
        /// Of which parameter.
        name: &'static str,
        /// Lowest and highest value accepted.
        lowest: f64,
        /// See `lowest`.
        highest: f64,
    },
    /// A treatment for something that is no parameter of interior or coupling: those of the surface stand in its own options.
    Place {
        /// The place.
        place: usize,
    },
    /// Facets without a hemispherical integral for this coupling, or a start outside the model's domain.
    Model,
}

impl fmt::Display for LeafError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            LeafError::Surface(error) => error.fmt(f),
            LeafError::Interior(error) => error.fmt(f),
            LeafError::NothingMeasured { first, last } => write!(
                f,
                "no usable value from {FIRST_NM} to {LAST_NM} nm, where PROSPECT is known: the data have {first} to {last} nm"
            ),
            LeafError::NoRecipeWavelength => f.write_str(
                "none of the wavelengths that the recommended method fits (every 10 nm from 410 nm) is among the data: use \
                 --method joint, which takes all wavelengths as they are",
            ),
            LeafError::Bounds { name, lowest, highest } => {
                write!(f, "bounds of {name}: expected {lowest} ≤ lower < upper ≤ {highest}")
            }
            LeafError::Place { place } => write!(f, "no parameter of interior or coupling has place {place}"),
            LeafError::Model => f.write_str("the model cannot be evaluated at any start: see the bounds of n and sigma"),
        }
    }
}

impl core::error::Error for LeafError {}

impl From<FitError> for LeafError {
    fn from(error: FitError) -> Self {
        LeafError::Surface(error)
    }
}

impl From<leafbrdf_prospect::Error> for LeafError {
    fn from(error: leafbrdf_prospect::Error) -> Self {
        LeafError::Interior(error)
    }
}
