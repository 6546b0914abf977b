//! The inversion of one wavelength: k_L, n and sigma with standard errors.

use core::mem::MaybeUninit;

use leafbrdf_fit::device::{self, Fit};
use leafbrdf_fit::{AtBound, Band, BandBounds, BandOptions, Directions, FitError, Interval};

use crate::border::{numbers, slice, slice_mut, workspace as border_workspace};
use crate::number::{Number, float, number};
use crate::status::{LB_ERR_BOUNDS, LB_ERR_COUNT, LB_ERR_DATA, LB_ERR_NULL, LB_ERR_TOO_FEW, LB_OK, lb_status};

/// Floats in an lb_workspace.
pub const LB_WORKSPACE_FLOATS: usize = 182;

/// The most steps of the search for one band, 40 a start from 4 starts; a step is one pass over the directions, and one more
/// pass comes before them all.
pub const LB_BAND_MOST_STEPS: u32 = 160;

/// Bit of lb_band.at_bound: k_lambert is at its lower bound and held there.
pub const LB_AT_LOWER_K_LAMBERT: u32 = 1;
/// Bit of lb_band.at_bound: k_lambert is at its upper bound.
pub const LB_AT_UPPER_K_LAMBERT: u32 = 2;
/// Bit of lb_band.at_bound: n is at its lower bound.
pub const LB_AT_LOWER_N: u32 = 4;
/// Bit of lb_band.at_bound: n is at its upper bound.
pub const LB_AT_UPPER_N: u32 = 8;
/// Bit of lb_band.at_bound: sigma is at its lower bound.
pub const LB_AT_LOWER_SIGMA: u32 = 16;
/// Bit of lb_band.at_bound: sigma is at its upper bound.
pub const LB_AT_UPPER_SIGMA: u32 = 32;

/// Where the three parameters are sought: -1 <= k_lambert <= 2, 1.0001 <= n <= 100, 1e-4 <= sigma <= 10, each lower < upper.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_bounds {
    /// Least k_L; 0.01 in the paper's Table 3.
    pub k_lambert_lower: f32,
    /// Greatest k_L; 0.99.
    pub k_lambert_upper: f32,
    /// Least n; 1.1.
    pub n_lower: f32,
    /// Greatest n; 5.
    pub n_upper: f32,
    /// Least sigma; 0.01.
    pub sigma_lower: f32,
    /// Greatest sigma; 1.
    pub sigma_upper: f32,
}

/// What the inversion of one wavelength finds.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct lb_band {
    /// Lambert coefficient k_L.
    pub k_lambert: f32,
    /// Refractive index of the surface, under the normalization of the directions.
    pub n: f32,
    /// Roughness of the surface.
    pub sigma: f32,
    /// Standard error of k_L; NaN where k_L is at a bound or the data do not determine it.
    pub k_lambert_se: f32,
    /// Standard error of n; NaN as above.
    pub n_se: f32,
    /// Standard error of sigma; NaN as above.
    pub sigma_se: f32,
    /// Root mean square of measured - modelled BRDF, sr^-1 where every weight is 1.
    pub rmse: f32,
    /// Values that counted (weight > 0).
    pub n_obs: u32,
    /// Which parameters sit at a bound: LB_AT_... added up.
    pub at_bound: u32,
    /// Steps of the search, over all its starts: passes over the directions.
    pub iterations: u32,
    /// 1 where the search arrived at a minimum, 0 where it ran out of steps.
    pub converged: u32,
    /// LB_OK, or why this band has no result (then nothing else in this struct is meaningful).
    pub status: lb_status,
}

impl lb_bounds {
    /// The paper's.
    const TABLE_3: Self = lb_bounds {
        k_lambert_lower: 0.01,
        k_lambert_upper: 0.99,
        n_lower: 1.1,
        n_upper: 5.0,
        sigma_lower: 0.01,
        sigma_upper: 1.0,
    };
}

impl lb_band {
    #[inline(always)]
    fn new(fit: &Fit<Number>) -> Self {
        let [k_lambert, n, sigma] = fit.parameters;
        let (k_lambert, n, sigma) = (float(k_lambert), float(n), float(sigma));
        // one by one: a loop would keep the report in memory
        let error = |error: Option<Number>| error.map_or(f32::NAN, float);
        let [k_lambert_se, n_se, sigma_se] = fit.standard_errors;
        let (k_lambert_se, n_se, sigma_se) = (error(k_lambert_se), error(n_se), error(sigma_se));
        let [k_at, n_at, sigma_at] = fit.at_bound;
        let bits = |at, lower, upper| match at {
            AtBound::Free => 0,
            AtBound::Lower => lower,
            AtBound::Upper => upper,
        };
        lb_band {
            k_lambert,
            n,
            sigma,
            k_lambert_se,
            n_se,
            sigma_se,
            rmse: float(fit.rmse),
            n_obs: fit.n_obs as u32,
            at_bound: bits(k_at, LB_AT_LOWER_K_LAMBERT, LB_AT_UPPER_K_LAMBERT)
                | bits(n_at, LB_AT_LOWER_N, LB_AT_UPPER_N)
                | bits(sigma_at, LB_AT_LOWER_SIGMA, LB_AT_UPPER_SIGMA),
            iterations: fit.iterations,
            converged: u32::from(fit.converged),
            status: LB_OK,
        }
    }

    /// A band without a result.
    fn without(status: lb_status) -> Self {
        lb_band {
            k_lambert: f32::NAN,
            n: f32::NAN,
            sigma: f32::NAN,
            k_lambert_se: f32::NAN,
            n_se: f32::NAN,
            sigma_se: f32::NAN,
            rmse: f32::NAN,
            n_obs: 0,
            at_bound: 0,
            iterations: 0,
            converged: 0,
            status,
        }
    }
}

/// The directions of a measurement, prepared: three arrays of `count` values each, usually constant tables in flash.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct lb_directions {
    /// lb_direction.cos_theta_a of every direction.
    pub cos_theta_a: *const f32,
    /// lb_direction.tan2_alpha of every direction.
    pub tan2_alpha: *const f32,
    /// lb_direction.lobe_weight of every direction.
    pub lobe_weight: *const f32,
    /// Number of directions.
    pub count: u32,
}

/// Memory that the inversion of a band works in, the caller's: on the stack, static, or shared between tasks that take turns.
/// Its contents do not matter before, and mean nothing after.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct lb_workspace {
    /// Not for use.
    pub memory: [f32; LB_WORKSPACE_FLOATS],
}

impl lb_directions {
    /// # Safety
    /// Pointers that are not null point to `count` initialised values that nobody changes during the call.
    unsafe fn numbers(&self) -> Result<Directions<'_, Number>, lb_status> {
        // SAFETY: the caller's promise
        unsafe {
            Ok(Directions {
                cos_theta_a: numbers(self.cos_theta_a, self.count)?,
                tan2_alpha: numbers(self.tan2_alpha, self.count)?,
                weight: numbers(self.lobe_weight, self.count)?,
            })
        }
    }
}

/// Inverts the measurements of one wavelength for k_L, n and sigma: least squares inside bounds (Eq. 11).
///
/// - directions: prepared directions.
/// - brdf: measured BRDF, sr^-1, one value a direction.
/// - weight: one a value: 1, or relative weights; 0 for a missing value.
/// - bounds: null for those of the paper's Table 3.
/// - workspace: memory of the caller.
///
/// LB_ERR_TOO_FEW where fewer than 3 values count. A search that stops early is an answer: see `converged`.
///
/// # Safety
/// `brdf` and `weight` point to `directions->count` values, or are null; so do the arrays of `directions`. Nothing else uses
/// `workspace` during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lb_fit_band(
    directions: Option<&lb_directions>,
    brdf: *const f32,
    weight: *const f32,
    bounds: Option<&lb_bounds>,
    workspace: *mut lb_workspace,
    band: Option<&mut MaybeUninit<lb_band>>,
) -> lb_status {
    let (Some(directions), Some(out)) = (directions, band) else { return LB_ERR_NULL };
    let mut fit = || {
        // SAFETY: the caller's promise about pointers and lengths
        let (shared, brdf, weight, workspace) = unsafe {
            (
                directions.numbers()?,
                numbers(brdf, directions.count)?,
                numbers(weight, directions.count)?,
                border_workspace(workspace)?,
            )
        };
        let bounds = bounds.unwrap_or(const { &lb_bounds::TABLE_3 });
        let options = BandOptions {
            bounds: BandBounds {
                k_lambert: Interval::new(number(bounds.k_lambert_lower), number(bounds.k_lambert_upper)),
                n: Interval::new(number(bounds.n_lower), number(bounds.n_upper)),
                sigma: Interval::new(number(bounds.sigma_lower), number(bounds.sigma_upper)),
            },
            max_iterations: LB_BAND_MOST_STEPS / 4,
            ..BandOptions::table_3()
        };
        match device::fit_band(shared, Band { brdf, weight }, &options, workspace) {
            Ok(Some(fit)) => {
                out.write(lb_band::new(&fit));
                Ok(LB_OK)
            }
            Ok(None) => Err(LB_ERR_TOO_FEW),
            Err(FitError::Bounds { .. }) => Err(LB_ERR_BOUNDS),
            Err(_) => Err(LB_ERR_DATA),
        }
    };
    fit().unwrap_or_else(|status| status)
}

/// Inverts several wavelengths measured at the same directions, one after the other.
///
/// - brdf: band_count x count values, band after band.
/// - weight: count values, for all bands.
/// - bands: results, one a band, each with its own status.
///
/// Everything else as in lb_fit_band. Returns LB_OK where every band has a result, else the status of the last one that has not.
///
/// # Safety
/// As lb_fit_band, with `brdf` pointing to `band_count` x `count` values and `bands` to room for `band_count` results.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn lb_fit_bands(
    directions: Option<&lb_directions>,
    brdf: *const f32,
    weight: *const f32,
    band_count: u32,
    bounds: Option<&lb_bounds>,
    workspace: *mut lb_workspace,
    bands: *mut MaybeUninit<lb_band>,
) -> lb_status {
    let Some(directions) = directions else { return LB_ERR_NULL };
    let count = directions.count;
    let fit = || {
        let Some(values) = count.checked_mul(band_count).filter(|values| *values > 0) else { return Err(LB_ERR_COUNT) };
        // SAFETY: the caller's promise about pointers and lengths
        let (brdf, bands) = unsafe {
            directions.numbers()?;
            numbers(weight, count)?;
            border_workspace(workspace)?;
            (slice(brdf, values)?, slice_mut(bands, band_count)?)
        };
        let mut last = LB_OK;
        for (out, brdf) in bands.iter_mut().zip(brdf.chunks_exact(count.max(1) as usize)) {
            // SAFETY: the caller's promise; `brdf` are `count` values
            let status = unsafe { lb_fit_band(Some(directions), brdf.as_ptr(), weight, bounds, workspace, Some(out)) };
            if status != LB_OK {
                out.write(lb_band::without(status));
                last = status;
            }
        }
        Ok(last)
    };
    fit().unwrap_or_else(|status| status)
}
