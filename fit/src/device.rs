//! One band on a microcontroller: k_L, n and σ with standard errors, no heap, 1 KB of caller's memory, a bounded number of steps.
//!
//! The whole-leaf solver keeps the lobe of every grid point and direction in a table; a device has no room for it. Here
//! one pass over the directions builds the sums from which χ² follows for 16 σ times any n (`device/scan.rs`); the best
//! one or two valleys then start the same Newton search as on a server ([`BandSolver`] without a scan), which ends with the same
//! standard errors, correlations and verdicts.
//!
//! A firmware
//!
//! 1. computes the terms of its directions once ([`DirectionTerms::at_cosines`](leafbrdf_core::DirectionTerms::at_cosines) or
//!    [`at_degrees`](leafbrdf_core::DirectionTerms::at_degrees)) into three arrays: [`Directions`];
//! 2. calls [`fit_band`] for each band with a [`Workspace`] of its own, static or on the stack: [`Workspace::BYTES`].
//!
//! ```
//! use leafbrdf_core::{DirectionTerms, Normalization, Surface, real::device::F32};
//! use leafbrdf_fit::device::{Workspace, fit_band};
//! use leafbrdf_fit::{Band, BandOptions, Directions};
//!
//! // beech of Table 4 in the red, seen at 12 angles under a lamp at 45°
//! let beech = Surface::new(F32(1.56), F32(0.29))?;
//! let (mut cos_theta_a, mut tan2_alpha, mut weight) = ([F32(0.0); 12], [F32(0.0); 12], [F32(0.0); 12]);
//! let mut brdf = [F32(0.0); 12];
//! for i in 0..12 {
//!     let (theta_s, theta_v, phi_v) = (F32(45.0), F32(6.0 * i as f32), F32(180.0));
//!     let terms = DirectionTerms::at_degrees(theta_s, theta_v, phi_v, Normalization::Bousquet2005)?;
//!     (cos_theta_a[i], tan2_alpha[i], weight[i]) = (terms.cos_theta_a, terms.tan2_alpha, terms.weight);
//!     brdf[i] = F32(0.03 / 3.141_592_7) + beech.brdf_at_degrees(theta_s, theta_v, phi_v)?;
//! }
//! let directions = Directions { cos_theta_a: &cos_theta_a, tan2_alpha: &tan2_alpha, weight: &weight };
//! let band = Band { brdf: &brdf, weight: &[F32(1.0); 12] };
//! let mut workspace = Workspace::new();
//! let fit = fit_band(directions, band, &BandOptions::table_3(), &mut workspace)?.expect("12 values");
//! let [k_lambert, n, sigma] = fit.parameters;
//! assert!((k_lambert.0 - 0.03).abs() < 1e-3 && (n.0 - 1.56).abs() < 1e-3 && (sigma.0 - 0.29).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod scan;

use leafbrdf_core::Real;

use crate::FitError;
use crate::band::{Band, BandFit, BandOptions, BandSolver, Directions};

pub use scan::Workspace;

/// Fits one band.
///
/// - `directions`: the terms of every direction, of one length with the band's values.
/// - `band`: BRDF in sr⁻¹ and weights, 0 for a missing value.
/// - `options`: bounds, tolerance, the limit on steps; `starts` is the most valleys that are polished.
/// - `workspace`: any content; nothing is kept in it from call to call.
///
/// `None` where fewer than 3 values count.
///
/// # Errors
/// [`FitError`] for bounds out of order, slices of different lengths, values that are not finite, negative weights.
#[inline]
pub fn fit_band<T: Real>(
    directions: Directions<'_, T>,
    band: Band<'_, T>,
    options: &BandOptions<T>,
    workspace: &mut Workspace<T>,
) -> Result<Option<BandFit<T>>, FitError> {
    let mut solver = BandSolver::<T, 1>::new(directions, *options, None)?;
    band.check(directions.len())?;
    let starts = workspace.starts(directions, band, &options.bounds);
    let wanted = starts.get(..options.starts.max(1)).unwrap_or(starts);
    solver.fit(band, wanted)
}
