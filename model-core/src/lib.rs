#![doc = include_str!("../README.md")]
#![no_std]

#[cfg(feature = "std")]
extern crate std;

mod angle;
mod dhrf;
pub mod diffuse;
mod direct;
#[doc(hidden)]
pub mod domain;
mod error;
pub mod facet;
pub mod fresnel;
mod geometry;
mod leaf;
pub mod masking;
pub mod real;
mod specular;

pub use angle::Angle;
pub use dhrf::{DhrfGradient, Grade, Hemispherical, Illumination};
pub use diffuse::{Diffuse, DiffuseSlopes, Lambert, P1, P2};
#[doc(hidden)]
pub use direct::{Degrees, Pair, Refused, half_vector};
pub use error::DomainError;
pub use facet::{Beckmann, FacetSlopes, Facets, Ggx};
pub use fresnel::{Absorbing, Dielectric, Index, Polarized};
pub use geometry::{DirectionCosines, DirectionVectors, Geometry, Tilt, TiltSlopes, Tilted};
pub use leaf::{Leaf, LeafGradient, TiltedDiffuseGradient, TiltedLeafGradient};
pub use masking::{Masking, MaskingSlopes, Smith, VCavity};
#[cfg(any(feature = "std", feature = "libm"))]
pub use real::Portable;
pub use real::Real;
pub use specular::{
    DirectionTerms, GgxSurface, GgxTerms, Normalization, SpecularGradient, SpecularHessian, Surface,
    TiltedSpecularGradient,
};
