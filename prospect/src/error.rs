//! What can be wrong with an input, in words that name the remedy.

use core::fmt;

use crate::params::{Parameter, Version};

/// An input that the model refuses.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A parameter is impossible, or probably in another unit.
    Outside {
        /// Which one.
        parameter: Parameter,
        /// Its value, in [`Parameter::unit`].
        value: f64,
    },
    /// A constituent that this version has no coefficients for is not 0.
    NotInVersion {
        /// Which one.
        parameter: Parameter,
        /// The version asked for.
        version: Version,
    },
    /// PROSPECT-PRO with C_m as well as C_prot or C_cbc: the same matter would absorb twice.
    DryMatterTwice,
    /// C_car is given, and also tied to C_ab.
    CarGivenAndTied,
    /// The ratio C_car/C_ab is negative, infinite or NaN.
    CarPerCab {
        /// The ratio.
        value: f64,
    },
    /// A surface's refractive index below 1, or not a number: for example a coefficient on the tabulated index that is too small.
    SurfaceIndex {
        /// The index.
        value: f64,
    },
    /// The share of the pigments in the upper stack of a two-layer leaf is not between 0 and 1.
    PigmentShare {
        /// The share.
        value: f64,
    },
    /// A slice has the wrong length.
    Length {
        /// What it is for.
        slice: &'static str,
        /// Length that fits.
        expected: usize,
        /// Length that it has.
        found: usize,
    },
    /// A wavelength outside the table, or not a number.
    Wavelength {
        /// The wavelength, nm.
        value: f64,
        /// First wavelength of the table, nm.
        first: f64,
        /// Last wavelength of the table, nm.
        last: f64,
    },
    /// A list of wavelengths that does not rise from one to the next.
    WavelengthOrder {
        /// Position, from 0, of the first one that does not.
        position: usize,
    },
    /// A sensor response that is negative, zero everywhere or not a number, or a width that is not positive.
    Response,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Error::Outside { parameter, value } => {
                let (lowest, highest) = parameter.limits();
                let (name, unit) = (parameter.name(), Unit(parameter.unit()));
                write!(f, "{name} = {value}{unit} is outside {lowest} to {highest}{unit}")?;
                match parameter.likely(value) {
                    Some((other, converted)) => write!(f, ": did you mean {value} {other} = {converted}{unit}?"),
                    None => Ok(()),
                }
            }
            Error::NotInVersion { parameter, version } => {
                write!(f, "PROSPECT-{} has no coefficients for {}: ", version.name(), parameter.name())?;
                f.write_str(match parameter {
                    Parameter::Cant => "use version D or PRO, or set it to 0",
                    _ => "use version PRO, or set it to 0",
                })
            }
            Error::DryMatterTwice => f.write_str(
                "cm and prot or cbc are both given: in PROSPECT-PRO dry matter is prot + cbc, so set cm to 0, \
                 or ask for both with `allow_cm_with_prot_cbc`",
            ),
            Error::CarGivenAndTied => f.write_str("car is given and also tied to cab: set it to 0, or untie it"),
            Error::CarPerCab { value } => {
                write!(f, "the ratio of car to cab is {value}: expected a finite number ≥ 0 (0.25 is usual)")
            }
            Error::SurfaceIndex { value } => {
                write!(f, "the refractive index of the surface is {value}: expected a number from 1 to 10000")
            }
            Error::PigmentShare { value } => {
                write!(f, "the upper stack's share of the pigments is {value}: expected a number from 0 to 1")
            }
            Error::Length { slice, expected, found } => {
                write!(f, "the slice for {slice} has {found} elements, expected {expected}")
            }
            Error::Wavelength { value, first, last } => {
                write!(f, "wavelength {value} nm is outside the table, {first} to {last} nm")
            }
            Error::WavelengthOrder { position } => {
                write!(f, "wavelengths must rise: number {position} (from 0) does not")
            }
            Error::Response => f.write_str("a sensor response must be ≥ 0, positive somewhere, with a width > 0"),
        }
    }
}

impl core::error::Error for Error {}

/// A unit with the space before it, or nothing.
struct Unit(&'static str);

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() { Ok(()) } else { write!(f, " {}", self.0) }
    }
}
