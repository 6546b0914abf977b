//! One band on a microcontroller: k_L, n and σ with standard errors, no heap, 0.7 KB of caller's memory, a bounded number of steps.
//!
//! The whole-leaf solver ([`BandSolver`](crate::BandSolver)) keeps the lobe of every grid point and direction in a table, and takes steps by
//! exact second derivatives; a device has no room for either. Here
//!
//! - one pass over the directions builds the sums from which χ² follows for 16 σ times any n (`device/scan.rs`);
//! - from every valley that is not much shallower than the deepest, steps of Gauss and Newton lead to its minimum (`device/search.rs`), one pass
//!   over the directions a step, k_L at its best inside its bounds for each;
//! - the normal matrix of the last step gives the standard errors (`device/report.rs`), by the server's rules.
//!
//! Minimum and errors are the server's: in single precision within 0.1 standard errors for 1,200 leaves with noise, half of them with a second lobe that the
//! model does not have; within 0.2 where a bound of k_L leaves residuals as large as the lobe, for there the steps shorten slowly. Of 3,000 such bands
//! none ended more than 0.3 % of χ² above the server's optimum (`tests/device.rs`).
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

mod lobe;
mod report;
mod scan;
mod search;

use leafbrdf_core::Real;

use crate::FitError;
use crate::band::{Band, BandOptions, Directions};
use crate::bounds::Interval;
use lobe::{Data, Sums};
use scan::{Ladder, RUNGS};
use search::{Point, Problem};

pub use report::Fit;

/// What the inversion works in: the caller's memory, so that a firmware decides where it lies.
#[derive(Clone, Debug)]
pub struct Workspace<T> {
    sums: [Sums<T>; RUNGS],
    /// χ² of every rung at its best n, and n² − 1 there
    cost: [(T, T); RUNGS + 1],
    points: [Point<T>; 3],
}

impl<T: Real> Default for Workspace<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Workspace<T> {
    /// Its size; 728 bytes in single precision.
    pub const BYTES: usize = size_of::<Self>();

    /// A workspace; what it holds does not matter.
    pub const fn new() -> Self {
        Workspace { sums: [Sums::ZERO; RUNGS], cost: [(T::ZERO, T::ZERO); RUNGS + 1], points: [Point::ZERO; 3] }
    }
}

/// The share of the tolerance that these steps stop at: what one leaves is a share of what it gained, not its square.
const SHARE: f64 = 0.02;

/// Valleys of the scan are searched up to this many times the depth of the deepest: the scan's n and σ are coarse.
const CLOSE: f64 = 16.0;

/// Fits one band.
///
/// - `directions`: the terms of every direction, of one length with the band's values.
/// - `band`: BRDF in sr⁻¹ and weights, 0 for a missing value.
/// - `options`: bounds, tolerance, the limit on steps a start; `starts` is the most valleys that are searched.
/// - `workspace`: any content; nothing is kept in it from call to call.
///
/// `None` where fewer than 3 values count.
///
/// # Errors
/// [`FitError`] for bounds out of order, slices of different lengths, values that are not finite or whose squares are not, negative
/// weights.
#[inline(always)]
pub fn fit_band<T: Real>(
    directions: Directions<'_, T>,
    band: Band<'_, T>,
    options: &BandOptions<T>,
    workspace: &mut Workspace<T>,
) -> Result<Option<Fit<T>>, FitError> {
    options.bounds.check()?;
    let expected = directions.len();
    let check = |what, slice: &[T]| {
        if slice.len() != expected {
            return Err(FitError::Length { what, found: slice.len(), expected });
        }
        match not_finite(slice) {
            Some(index) => Err(FitError::NotFinite { what, index }),
            None => Ok(()),
        }
    };
    check("cos_theta_a", directions.cos_theta_a)?;
    check("tan2_alpha", directions.tan2_alpha)?;
    check("weight", directions.weight)?;
    check("brdf", band.brdf)?;
    check("weight", band.weight)?;
    let (mut total, mut sum, mut n_obs) = (T::ZERO, T::ZERO, 0);
    for (index, (y, w)) in band.brdf.iter().zip(band.weight).enumerate() {
        if *w > T::ZERO {
            n_obs += 1;
            total += *w;
            sum += *w * *y;
        } else if *w < T::ZERO {
            return Err(FitError::NotFinite { what: "weight (negative)", index });
        }
    }
    if n_obs < 3 {
        return Ok(None);
    }
    let bounds = &options.bounds;
    let inv_pi = T::lit(core::f64::consts::FRAC_1_PI);
    let e = |n: T| (n - T::ONE) * (n + T::ONE);
    let mean = sum / total;
    let problem = Problem {
        data: &Data { directions, band },
        total,
        a: Interval::new(bounds.k_lambert.lower * inv_pi, bounds.k_lambert.upper * inv_pi),
        e: Interval::new(e(bounds.n.lower), e(bounds.n.upper)),
        sigma: bounds.sigma,
        enough: T::lit(SHARE) * options.tolerance,
        most: options.max_iterations,
        mean,
    };
    let ladder = Ladder::new(&bounds.sigma);
    let (least, spread) = workspace.scan(&problem, &ladder);
    let rounding = (spread + total * mean.squared()) * T::EPSILON.squared();
    let (mut iterations, mut converged, mut starts) = (0, false, 0);
    let Workspace { sums: [sums, ..], cost, points: [here, there, best] } = workspace;
    let (mut here, mut there, mut best) = (here, there, best);
    let (mut before, mut sigma2) = (T::MAX, ladder.sigma2);
    for pair in cost.windows(2) {
        let [(cost, e), (after, _)] = *pair else { continue };
        if cost <= before && cost < after && cost <= T::lit(CLOSE) * least && starts < options.starts.max(1) {
            let (looks, arrived) = problem.search(e, sigma2.sqrt(), rounding, sums, &mut here, &mut there);
            iterations += looks;
            if starts == 0 || here.cost < best.cost {
                core::mem::swap(&mut here, &mut best);
                converged = arrived;
            }
            starts += 1;
        }
        before = cost;
        sigma2 *= ladder.shrink;
    }
    if starts == 0 {
        // no χ² is a number: the squares of such values are none
        return Err(FitError::NotFinite { what: "chi2", index: 0 });
    }
    Ok(Some(Fit { iterations, converged, ..Fit::new(best, &problem, n_obs, options) }))
}

/// The place of the first value that is no number, or infinite.
#[inline(never)]
fn not_finite<T: Real>(values: &[T]) -> Option<usize> {
    values.iter().position(|x| !x.is_finite())
}
