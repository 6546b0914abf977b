//! PROSPECT inverted: a leaf's structure and contents from its reflectance, its transmittance, or both.
//!
//! min over the free parameters of χ² = Σ ω (R_measured − R_modelled)² + Σ ω (T_measured − T_modelled)², any subset of N and the
//! contents being free and the rest held. Derivatives are exact ([`Prospect::jacobian`]); the normal equations are gathered
//! block by block in memory that the caller lends, so the heart of it needs no heap.
//!
//! | room | what |
//! |---|---|
//! | `axis` | a parameter between its bounds → a number in [0, 1] that the model answers evenly |
//! | `misfit` | χ² with derivatives |
//! | `solve` | several deterministic starts, the best minimum |
//! | `report` | standard errors, correlations, what the spectra cannot tell |
//! | `prior` | N from reflectance alone |
//! | `leaf` | with `std`: free parameters as a list |
//!
//! # What reflectance alone can tell
//!
//! Without noise, everything: every parameter of every version comes back from 400–2500 nm. With white noise of 0.005 (PROSPECT-D,
//! median standard errors over 1,000 random leaves, R alone against R and T; `examples/hemispherical.rs`):
//!
//! | | N | C_ab | C_car | C_ant | C_brown | C_w | C_m | correlation N, C_m |
//! |---|---|---|---|---|---|---|---|---|
//! | 400–2500 nm, R and T | 0.001 | 0.3 | 0.5 | 0.2 | 0.005 | 5e-5 | 5e-5 | 0.01 |
//! | 400–2500 nm, R | 0.006 | 0.4 | 0.7 | 0.2 | 0.007 | 7e-5 | 2e-4 | 0.93 |
//! | 400–1000 nm, R and T | 0.002 | 0.3 | 0.5 | 0.2 | 0.008 | 0.001 | 2e-4 | 0.02 |
//! | 400–1000 nm, R | 0.3 | 4 | 2 | 1 | 0.04 | 0.003 | 0.007 | 1.00 |
//!
//! Without the short-wave infrared, R alone cannot tell scattering from dry matter: N and C_m lean on each other and C_m has an error as
//! large as itself; up to 700 nm hardly anything is known in every fifth leaf, which [`Identifiability`](crate::Identifiability) says
//! of each parameter. [`n_prior`] holds N instead. A reflectance that is 2 % too bright moves N by 5 % and C_m by 4 %; with
//! a transmittance equally too bright N stays (0.3 %), and C_m, whose absorption is what is left of the light, falls by 16 %.

mod axis;
#[cfg(feature = "std")]
mod leaf;
mod misfit;
mod prior;
mod report;
mod solve;

use core::fmt;

use leafbrdf_core::Real;
use leafbrdf_prospect::{LeafParams, Parameter, Prospect};

use crate::bounds::Interval;

#[cfg(feature = "std")]
pub use leaf::{Estimate, LeafFit, LeafFitOptions, default_free, fit_leaf};
pub use prior::{PriorN, n_prior};
pub use report::{HemisphericalFit, OtherMinimum, Residuals};
pub use solve::{HemisphericalOptions, fit, starts, workspace_len};

/// One measured spectrum, a value for each band of the model's table.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a, T> {
    /// Fractions, one a band; any finite number where the weight is 0.
    pub values: &'a [T],
    /// ω: 1/sd², or relative weights; 0 for missing values. Without it every value counts the same.
    pub weights: Option<&'a [T]>,
}

/// What was measured of a leaf; at least one of the two.
#[derive(Clone, Copy, Debug)]
pub struct Spectra<'a, T> {
    /// Directional-hemispherical reflectance, fractions.
    pub reflectance: Option<Measured<'a, T>>,
    /// Directional-hemispherical transmittance, fractions.
    pub transmittance: Option<Measured<'a, T>>,
}

impl<'a, T: Real> Spectra<'a, T> {
    /// Both, or either, with their names.
    pub(crate) fn each(&self) -> [(&'static str, Option<Measured<'a, T>>); 2] {
        [("reflectance", self.reflectance), ("transmittance", self.transmittance)]
    }

    /// The number of values that count, after a check of all of them.
    pub(crate) fn check(&self, bands: usize) -> Result<usize, HemisphericalError> {
        let mut n_obs = 0;
        for (what, measured) in self.each() {
            let Some(Measured { values, weights }) = measured else { continue };
            for (what, slice) in [(what, Some(values)), ("weights", weights)] {
                let Some(slice) = slice else { continue };
                if slice.len() != bands {
                    return Err(HemisphericalError::Length { what, found: slice.len(), expected: bands });
                }
                if let Some(index) = slice.iter().position(|x| !x.is_finite()) {
                    return Err(HemisphericalError::NotFinite { what, index });
                }
            }
            n_obs += match weights {
                None => bands,
                Some(weights) => {
                    if let Some(index) = weights.iter().position(|w| *w < T::ZERO) {
                        return Err(HemisphericalError::NotFinite { what: "weights (negative)", index });
                    }
                    weights.iter().filter(|w| **w > T::ZERO).count()
                }
            };
        }
        if n_obs == 0 { Err(HemisphericalError::NothingMeasured) } else { Ok(n_obs) }
    }
}

/// What to invert: the model on the bands that were measured, the spectra, and the parameters that are held.
#[derive(Clone, Copy, Debug)]
pub struct HemisphericalProblem<'a, T> {
    /// The model on a table with one band a measured wavelength.
    pub model: Prospect<'a, T>,
    /// The measurement.
    pub spectra: Spectra<'a, T>,
    /// Values of the parameters that are not free; those of free ones do not matter.
    pub held: LeafParams<T>,
}

/// A parameter that is sought, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Free<T> {
    /// Which one.
    pub parameter: Parameter,
    /// Its bounds, in the parameter's unit, inside [`Parameter::limits`].
    pub bounds: Interval<T>,
}

impl<T: Real> Free<T> {
    /// A parameter in the bounds that hold every leaf of the usual data bases with room to spare: N 1–5, C_ab 0–150, C_car 0–40,
    /// C_ant 0–60 µg cm⁻², C_brown 0–4, C_w 0–0.12 cm, C_m 0–0.06, C_prot 0–0.008, C_cbc 0–0.06 g cm⁻².
    pub fn new(parameter: Parameter) -> Self {
        let (lower, upper) = match parameter {
            Parameter::NStruct => (1.0, 5.0),
            Parameter::Cab => (0.0, 150.0),
            Parameter::Car => (0.0, 40.0),
            Parameter::Cant => (0.0, 60.0),
            Parameter::Cbrown => (0.0, 4.0),
            Parameter::Cw => (0.0, 0.12),
            Parameter::Cm | Parameter::Cbc => (0.0, 0.06),
            Parameter::Prot => (0.0, 0.008),
        };
        Free { parameter, bounds: Interval::new(T::lit(lower), T::lit(upper)) }
    }

    /// Are the bounds in order, and inside what the model accepts?
    pub(crate) fn check(&self) -> Result<(), HemisphericalError> {
        let (lowest, highest) = self.parameter.limits();
        let Interval { lower, upper } = self.bounds;
        // both ends as the model compares them, in double precision
        if lower < upper && lower.to_f64() >= lowest && upper.to_f64() <= highest {
            Ok(())
        } else {
            Err(HemisphericalError::Bounds { parameter: self.parameter })
        }
    }
}

/// Input that no inversion can start from. A search that stops early is an answer, not an error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum HemisphericalError {
    /// What the model refuses: a held value outside its limits, a constituent the version lacks, dry matter twice.
    Model(leafbrdf_prospect::Error),
    /// Bounds out of order or outside [`Parameter::limits`].
    Bounds {
        /// Of which parameter.
        parameter: Parameter,
    },
    /// A parameter stands twice among the free ones.
    Twice {
        /// Which one.
        parameter: Parameter,
    },
    /// No parameter is free.
    NothingFree,
    /// Neither reflectance nor transmittance has a value that counts.
    NothingMeasured,
    /// A slice has the wrong length.
    Length {
        /// The slice.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have (for the workspace: the least).
        expected: usize,
    },
    /// A value or weight that is no finite number, or a negative weight.
    NotFinite {
        /// The slice.
        what: &'static str,
        /// The place in it, from 0.
        index: usize,
    },
    /// No band near 1131 nm or 800 nm to take N from.
    NoPlateau,
}

impl fmt::Display for HemisphericalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            HemisphericalError::Model(error) => error.fmt(f),
            HemisphericalError::Bounds { parameter } => {
                let (lowest, highest) = parameter.limits();
                write!(f, "bounds of {}: expected {lowest} ≤ lower < upper ≤ {highest}", parameter.name())
            }
            HemisphericalError::Twice { parameter } => {
                write!(f, "{} is free twice: expected each parameter once", parameter.name())
            }
            HemisphericalError::NothingFree => f.write_str("no parameter is free: expected at least one"),
            HemisphericalError::NothingMeasured => {
                f.write_str("no usable value: expected reflectance, transmittance, or both")
            }
            HemisphericalError::Length { what, found, expected } => {
                write!(f, "{what} has {found} values: expected {expected}")
            }
            HemisphericalError::NotFinite { what, index } => write!(
                f,
                "{what} has a value that is not a finite number at place {index} (from 0): give missing values weight 0"
            ),
            HemisphericalError::NoPlateau => f.write_str(
                "n_struct cannot be taken from this spectrum: expected reflectance near 1131 nm, or near 800 nm; leave n_struct free, \
                 or hold it at a value of your own",
            ),
        }
    }
}

impl core::error::Error for HemisphericalError {}

impl From<leafbrdf_prospect::Error> for HemisphericalError {
    fn from(error: leafbrdf_prospect::Error) -> Self {
        HemisphericalError::Model(error)
    }
}
