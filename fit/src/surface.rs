//! One surface for the whole leaf: n and σ (with options: the diffuse term's a and b, and the leaf's tilt) shared by every
//! wavelength, k_L(λ) eliminated in each.
//!
//! ```text
//! BRDF(λ, direction) = cosθ_s'/cosθ_s · (k_L(λ) · shape(direction; a, b) + BRDF_spec(direction; n, σ))
//! ```
//!
//! Neither shape nor lobe depends on λ, so 400 or 2101 bands are rotated without loss into no more rows than there are directions
//! ([`moments`]), and everything after that costs nothing a band: a scan of the whole box, then a Newton search from every
//! valley ([`search()`]). k_L is not bounded in the elimination (a bound would hide that the lobe is too large): values below 0
//! and outside Table 3 are counted and reported.
//!
//! # For other fits
//!
//! - [`LeafModel`]: per direction, diffuse shape and lobe with exact derivatives over [n, σ, a, b, t_x, t_y, e] (angles in
//!   radians), the [`DirectionalModel`] that everything else takes;
//! - [`Profile`]: χ² with k_L eliminated, gradient and normal matrix, at any parameters, over caller-owned memory;
//! - [`Moments`] and [`Group`]: what it is the χ² of. Rows may be bands as measured (gain 1), or rotations of them
//!   ([`compress()`]); `Spectra` builds them for a whole leaf, with k_L free in every band, or bound to a few known spectra;
//! - [`search()`], [`polish`]: the global search, or one search from a start, over any subset of the parameters with bounds and
//!   priors ([`SearchOptions`]);
//! - `fit_surface` (feature `std`): all of it for one leaf, with standard errors.

pub mod model;
pub mod moments;
pub mod profile;
pub mod search;

#[cfg(feature = "std")]
mod errors;
#[cfg(feature = "std")]
mod leaf;
#[cfg(feature = "std")]
mod options;
#[cfg(feature = "std")]
mod robust;
#[cfg(feature = "std")]
mod settle;
#[cfg(feature = "std")]
mod spectra;

pub use model::{DiffuseKind, DirectionValue, DirectionalModel, FacetKind, LeafModel, NAMES, PARAMETERS};
pub use moments::{Group, Moments, compress};
pub use profile::{Derivatives, Place, Profile};
pub use search::{Prior, ScanSize, SearchOptions, Treatment, Valley, Valleys, polish, search};

#[cfg(feature = "std")]
pub use errors::{Errors, Knowledge};
#[cfg(feature = "std")]
pub use leaf::{SurfaceBand, SurfaceData, SurfaceFit, fit_surface};
#[cfg(feature = "std")]
pub use options::SurfaceOptions;
#[cfg(feature = "std")]
pub(crate) use settle::settle;
#[cfg(feature = "std")]
pub use spectra::Spectra;
