//! What becomes of a parameter: sought within bounds, with or without a prior, or held.

use leafbrdf_core::Real;

use crate::bounds::Interval;

/// What is known of a parameter before the measurement: a normal distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior<T> {
    /// Its mean.
    pub mean: T,
    /// Its standard deviation, > 0.
    pub sd: T,
}

/// What becomes of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Treatment<T> {
    /// Sought within bounds.
    Free {
        /// The bounds.
        bounds: Interval<T>,
        /// What is known beforehand.
        prior: Option<Prior<T>>,
    },
    /// Held at a value.
    Held(T),
}

impl<T: Real> Treatment<T> {
    /// Sought within bounds, nothing known beforehand.
    pub const fn within(lower: T, upper: T) -> Self {
        Treatment::Free { bounds: Interval::new(lower, upper), prior: None }
    }

    /// Is it sought?
    pub const fn is_free(&self) -> bool {
        matches!(self, Treatment::Free { .. })
    }

    /// The prior of a free parameter.
    pub const fn prior(&self) -> Option<Prior<T>> {
        match self {
            Treatment::Free { prior, .. } => *prior,
            Treatment::Held(_) => None,
        }
    }

    /// Where a scan of other parameters leaves it: the prior mean, else 0 or the bound nearest to it.
    pub(super) fn resting(&self) -> T {
        match self {
            Treatment::Held(value) => *value,
            Treatment::Free { bounds, prior } => bounds.clip(prior.map_or(T::ZERO, |prior| prior.mean)),
        }
    }
}
