#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "std")]
extern crate std;

mod angle;
mod error;
pub mod real;

pub use angle::Angle;
pub use error::DomainError;
#[cfg(any(feature = "std", feature = "libm"))]
pub use real::Portable;
pub use real::Real;
