#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "std")]
extern crate std;

mod angle;
mod dhrf;
pub mod diffuse;
mod error;
pub mod facet;
pub mod fresnel;
mod geometry;
mod leaf;
pub mod masking;
pub mod real;
mod specular;

pub use angle::Angle;
pub use dhrf::{DhrfGradient, Grade, Illumination};
pub use diffuse::{Diffuse, Lambert};
pub use error::DomainError;
pub use facet::{Beckmann, Facets};
pub use fresnel::{Absorbing, Dielectric, Index, Polarized};
pub use geometry::{DirectionCosines, Geometry};
pub use leaf::{Leaf, LeafGradient};
pub use masking::{Masking, VCavity};
#[cfg(any(feature = "std", feature = "libm"))]
pub use real::Portable;
pub use real::Real;
pub use specular::{DirectionTerms, Normalization, SpecularGradient, SpecularHessian, Surface};
