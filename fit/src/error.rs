//! What a fit can refuse. A search that stops early is an answer, not an error: see `Termination`.

use core::fmt;

use leafbrdf_core::DomainError;

/// Input that no fit can start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FitError {
    /// Bounds out of order or outside the model's domain.
    Bounds {
        /// The parameter.
        parameter: &'static str,
        /// What its bounds must satisfy.
        expected: &'static str,
    },
    /// Two slices that must have one length have two.
    Length {
        /// The slice.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A measured value, weight or direction term that is not finite.
    NotFinite {
        /// The slice.
        what: &'static str,
        /// The place in it, from 0.
        index: usize,
    },
    /// A parameter outside the model's domain.
    Domain(DomainError),
}

impl fmt::Display for FitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FitError::Bounds { parameter, expected } => write!(f, "bounds of {parameter}: expected {expected}"),
            FitError::Length { what, found, expected } => {
                write!(f, "{what} has {found} values: expected {expected}")
            }
            FitError::NotFinite { what, index } => write!(
                f,
                "{what} has a value that is not a finite number at place {index} (from 0): give missing values weight 0"
            ),
            FitError::Domain(error) => error.fmt(f),
        }
    }
}

impl core::error::Error for FitError {}

impl From<DomainError> for FitError {
    fn from(error: DomainError) -> Self {
        FitError::Domain(error)
    }
}
