//! The one error of the constructors: a parameter outside its domain.

use core::fmt;

/// A parameter outside its domain: which one, and what is allowed.
///
/// Constructors check, equations trust: after a successful `new`, nothing can fail. NaN is outside every domain.
///
/// ```
/// use leafbrdf_core::Surface;
/// let error = Surface::new(1.4, -0.1).unwrap_err();
/// assert_eq!(error.parameter, "sigma");
/// assert_eq!(error.to_string(), "sigma is outside its domain: expected 2^-30 ≤ sigma ≤ 2^10");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct DomainError {
    /// The parameter's name, as in the paper and in `docs/model.md`.
    pub parameter: &'static str,
    /// The range it must lie in, with its unit where it has one.
    pub expected: &'static str,
}

impl DomainError {
    pub(crate) const fn new(parameter: &'static str, expected: &'static str) -> Self {
        DomainError { parameter, expected }
    }
}

impl fmt::Display for DomainError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.parameter)?;
        f.write_str(" is outside its domain: expected ")?;
        f.write_str(self.expected)
    }
}

impl core::error::Error for DomainError {}
