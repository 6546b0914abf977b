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

impl FitFailure {
    /// As many parameters as values: whatever was measured is met exactly, and the result says nothing about itself.
    ///
    /// - `values`: how many, and of what; `parameters`: how many that are not at a bound (or held by a prior); `remedy`: what to do.
    fn exact(values: &str, parameters: f64, names: &[&str], remedy: &str) -> Self {
        let count = if parameters.fract() == 0.0 { format!("{parameters}") } else { format!("{parameters:.1}") };
        FitFailure(format!(
            "no more values than parameters ({values} for {count} parameters: {}): any measurement would be fitted perfectly, and nothing is \
             left to tell how good the numbers are. {remedy}",
            names.join(", ")
        ))
    }
}

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
