//! The main job: from a measured leaf to its parameters, and from these to the files of `DIR/LEAF`.
//!
//! | room | what |
//! |---|---|
//! | `select` | which wavelengths and directions take part |
//! | `bands` | k_L, n, σ at each wavelength: the inversion, `bands.csv`, `dhrf.csv` |
//! | `surface` | one n, σ for the leaf and k_L at each wavelength |
//! | `prospect` | structure and contents from hemispherical spectra |
//! | `leaf` | surface and interior of the whole leaf |
//! | `summary` | `summary.json`: the leaf as a whole, and what the user should be warned of |
//! | `leaves` | `leaves.csv`: one row a leaf |
//! | `tables`, `json` | what the models' `bands.csv`, `dhrf.csv` and `summary.json` have in common |

mod bands;
mod json;
mod leaf;
mod leaves;
mod prospect;
mod select;
mod summary;
mod surface;
mod tables;

pub use bands::{BandsOutcome, fit_bands, write_bands};
pub use leaf::{LeafOutcome, fit_leaf};
pub use leaves::{LeafRecord, LeafValues, write_records};
pub use prospect::{ProspectOptions, ProspectOutcome, fit_prospect};
pub use select::{Selected, Selection, WavelengthRange};
pub use summary::Summary;
pub use surface::{SurfaceOutcome, fit_surface};

use std::fmt;

/// Why a leaf could not be fitted: in the words that the user reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FitFailure(
    /// The sentence.
    pub String,
);

impl fmt::Display for FitFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for FitFailure {}

impl From<leafbrdf_fit::FitError> for FitFailure {
    fn from(error: leafbrdf_fit::FitError) -> Self {
        FitFailure(error.to_string())
    }
}
