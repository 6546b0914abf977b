#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "std")]
extern crate std;

mod absorption;
mod both;
mod coupling;
mod error;
pub mod expint;
pub mod interface;
mod kernel;
mod lanes;
mod model;
mod params;
mod plate;
pub mod sensor;
mod stack;
pub mod table;
mod two_layer;

pub use coupling::{CoupledBand, CoupledLeaf, Coupling, DiffuseTerm, Link, SurfaceIndex};
pub use error::Error;
pub use lanes::Lanes;
pub use model::{Jacobian, Prospect, plates, plates_with_slopes};
pub use params::{LeafParams, Parameter, Version};
pub use plate::Interface;
pub use stack::{Optics, Slopes};
pub use two_layer::TwoLayer;
