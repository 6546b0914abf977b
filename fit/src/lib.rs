#![doc = include_str!("../README.md")]
#![no_std]
// Small fixed matrices are indexed by row and column, as in the equations.
#![allow(clippy::needless_range_loop)]

#[cfg(any(feature = "std", test))]
extern crate std;

pub mod band;
mod bounds;
pub mod device;
mod error;
pub mod hemispherical;
#[cfg(feature = "std")]
pub mod leaf;
#[cfg(feature = "std")]
mod leaf_bands;
mod linear;
#[cfg(feature = "std")]
mod matrix;
pub mod solver;
pub mod surface;

pub use band::{Band, BandFit, BandOptions, BandSolver, Directions, Identifiability, Start, Valley};
pub use bounds::{AtBound, BandBounds, Interval};
pub use error::FitError;
#[cfg(feature = "std")]
pub use leaf_bands::{BandResult, LeafBandsOptions, LeafData, fit_bands, why_no_error};
pub use solver::Termination;
