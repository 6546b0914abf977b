//! One leaf, from measurements to a surface with errors.

use std::vec;
use std::vec::Vec;

use leafbrdf_core::DirectionVectors;

use super::errors::{self, Errors, leverage};
use super::model::{DirectionValue, DirectionalModel, LeafModel, PARAMETERS};
use super::options::SurfaceOptions;
use super::profile::{Place, Profile};
use super::robust::robust;
use super::search::{SearchOptions, Treatment, Valley, Valleys, search};
use super::settle::settle;
use super::spectra::{Spectra, band_weights};
use crate::bounds::{AtBound, Interval};
use crate::{FitError, Termination};

/// Measured BRDF of one leaf: directions × wavelengths.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceData<'a> {
    /// One pair of directions a column, in the instrument's frame.
    pub directions: &'a [DirectionVectors<f64>],
    /// BRDF in sr⁻¹, band after band, one value a direction; NaN where missing.
    pub brdf: &'a [f64],
    /// Standard deviation of each value in sr⁻¹, in the same order, > 0; without it every value counts the same.
    pub sd: Option<&'a [f64]>,
}

/// One band of a fitted leaf.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceBand {
    /// k_L, unbounded; `None` where the band has no value.
    pub k_lambert: Option<f64>,
    /// Its standard error, that of the surface included.
    pub k_lambert_se: Option<f64>,
    /// Σ (BRDF_measured − BRDF_modelled)², sr⁻², whatever the weights.
    pub squares: f64,
    /// Values.
    pub n_obs: usize,
}

/// The result for one leaf.
#[derive(Clone, Debug)]
pub struct SurfaceFit {
    /// n, σ, a, b, t_x, t_y (radians), e.
    pub x: [f64; PARAMETERS],
    /// What became of each parameter; a tilt that the directions cannot see has been held.
    pub parameters: [Treatment<f64>; PARAMETERS],
    /// Free parameters that the directions cannot see at all, held for that reason.
    pub unseen: [bool; PARAMETERS],
    /// Standard errors and what they rest on.
    pub errors: Errors,
    /// Which parameters sit at a bound.
    pub at_bound: [AtBound; PARAMETERS],
    /// k_L and the misfit, band by band.
    pub bands: Vec<SurfaceBand>,
    /// χ² = Σ ω (BRDF_measured − BRDF_modelled)² of the data as they are.
    pub chi2: f64,
    /// ν, by which priors were weighed.
    pub draws: f64,
    /// √(Σ residual²/values), sr⁻¹.
    pub rmse: f64,
    /// 1 − Σ residual²/Σ (value − mean)².
    pub r2: f64,
    /// Values used.
    pub n_obs: usize,
    /// All valleys of the cost that were found, the deepest (the result, but for a robust fit) first.
    pub valleys: Valleys<f64>,
    /// Why the search that won ended.
    pub termination: Termination,
}

impl SurfaceFit {
    /// How many k_L are negative: the lobe takes more than all the light there.
    pub fn negative_k_lambert(&self) -> usize {
        self.bands.iter().filter(|band| band.k_lambert.is_some_and(|k| k < 0.0)).count()
    }

    /// How many k_L lie outside `bounds` (Table 3 has [0.01, 0.99]), the negative ones included.
    pub fn k_lambert_outside(&self, bounds: Interval<f64>) -> usize {
        let outside = |k: f64| !(k >= bounds.lower && k <= bounds.upper);
        self.bands.iter().filter(|band| band.k_lambert.is_some_and(outside)).count()
    }
}

/// Fits one surface to a leaf.
///
/// # Errors
/// [`FitError`] for bounds out of order, slices whose lengths do not belong together, infinite values, sd that are not
/// positive, no value at all, or directions below the horizon of every leaf within the bounds of the tilt.
pub fn fit_surface(data: &SurfaceData<'_>, options: &SurfaceOptions) -> Result<SurfaceFit, FitError> {
    options.check()?;
    let directions = data.directions.len();
    let weight = omega(data)?;
    let spectra = Spectra::new(directions, data.brdf, weight.as_deref())?;
    if data.brdf.iter().all(|y| y.is_nan()) {
        return Err(FitError::Length { what: "values that are not missing", found: 0, expected: 1 });
    }
    let model = LeafModel {
        directions: data.directions,
        facets: options.facets,
        diffuse: options.diffuse,
        normalization: options.normalization,
    };
    let (parameters, unseen) = settle(&model, options)?;
    let used = used_directions(data);
    let draws = options.draws.unwrap_or(used as f64 - 1.0).max(1.0);
    let search_options = SearchOptions {
        parameters,
        draws,
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        scan: options.scan,
        valleys: options.valleys,
    };
    let mut places = vec![Place::empty(); directions];
    let mut grid = vec![0.0; options.scan.workspace(&parameters)];
    let valleys = spectra.moments(|moments| {
        let mut profile = Profile::new(&model, moments, &mut places)?;
        Some(search(&mut profile, &search_options, &options.starts, &mut grid))
    });
    let nothing = FitError::Bounds { parameter: "tilt", expected: "directions above the leaf's horizon" };
    let valleys = valleys.ok_or(nothing)?;
    let mut best = *valleys.best().ok_or(nothing)?;
    let mut final_weight = weight.clone();
    if options.robust {
        (best, final_weight) = robust(data, &model, &search_options, best, weight.as_deref(), &mut places)?;
    }
    report(data, &model, &search_options, unseen, valleys, best, [weight.as_deref(), final_weight.as_deref()])
}

/// 1/sd².
fn omega(data: &SurfaceData<'_>) -> Result<Option<Vec<f64>>, FitError> {
    let Some(sd) = data.sd else { return Ok(None) };
    if sd.len() != data.brdf.len() {
        return Err(FitError::Length { what: "sd", found: sd.len(), expected: data.brdf.len() });
    }
    if let Some(index) = sd.iter().zip(data.brdf).position(|(sd, y)| !y.is_nan() && !(*sd > 0.0 && sd.is_finite())) {
        return Err(FitError::NotFinite { what: "sd (or is not positive)", index });
    }
    Ok(Some(sd.iter().map(|sd| 1.0 / (sd * sd)).collect()))
}

fn used_directions(data: &SurfaceData<'_>) -> usize {
    let directions = data.directions.len();
    (0..directions).filter(|&v| data.brdf.iter().skip(v).step_by(directions).any(|y| !y.is_nan())).count()
}

/// Shape and lobe, direction by direction.
pub(super) fn values_at(
    model: &LeafModel<'_, f64>,
    x: &[f64; PARAMETERS],
) -> Result<Vec<DirectionValue<f64>>, FitError> {
    let mut values = Vec::with_capacity(model.directions.len());
    model.derivatives(x, |value| values.push(value))?;
    Ok(values)
}

/// k_L of a band, and its residuals (0 where the weight is).
pub(super) fn eliminate(
    values: &[DirectionValue<f64>],
    y: &[f64],
    weight: &[f64],
    residual: &mut [f64],
) -> Option<f64> {
    let (mut s2, mut s_y) = (0.0, 0.0);
    for ((value, y), w) in values.iter().zip(y).zip(weight).filter(|(_, w)| **w > 0.0) {
        s2 += w * value.diffuse * value.diffuse;
        s_y += w * value.diffuse * (y - value.specular);
    }
    let k = (s2 > 0.0).then(|| s_y / s2)?;
    for (((value, y), w), r) in values.iter().zip(y).zip(weight).zip(residual) {
        *r = if *w > 0.0 { y - value.specular - k * value.diffuse } else { 0.0 };
    }
    Some(k)
}

fn report(
    data: &SurfaceData<'_>,
    model: &LeafModel<'_, f64>,
    options: &SearchOptions<f64>,
    unseen: [bool; PARAMETERS],
    valleys: Valleys<f64>,
    best: Valley<f64>,
    [original, weight]: [Option<&[f64]>; 2],
) -> Result<SurfaceFit, FitError> {
    let directions = data.directions.len();
    let values = values_at(model, &best.x)?;
    let mut weights = Vec::with_capacity(data.brdf.len());
    let mut residuals = vec![0.0; data.brdf.len()];
    let mut k_lambert = Vec::new();
    let (mut chi2, mut squares, mut n_obs) = (0.0, 0.0, 0_usize);
    let mut bands = Vec::new();
    for (b, (y, r)) in data.brdf.chunks_exact(directions).zip(residuals.chunks_exact_mut(directions)).enumerate() {
        let w = band_weights(b, y, weight);
        let k = eliminate(&values, y, &w, r);
        // χ² of the data as they are, so that it compares with the plain fit's
        let plain = band_weights(b, y, original);
        chi2 += plain.iter().zip(&*r).map(|(w, r)| w * r * r).sum::<f64>();
        let of_band: f64 = r.iter().map(|r| r * r).sum();
        let count = w.iter().filter(|w| **w > 0.0).count();
        squares += of_band;
        n_obs += count;
        bands.push(SurfaceBand { k_lambert: k, k_lambert_se: None, squares: of_band, n_obs: count });
        k_lambert.push(k.unwrap_or(0.0));
        weights.extend(w);
    }
    let first = weights.get(..directions).unwrap_or(&[]);
    let uniform = weights.chunks_exact(directions).all(|w| w == first);
    let fitted_chi2: f64 = weights.iter().zip(&residuals).map(|(w, r)| w * r * r).sum();
    let problem = errors::Problem {
        values: &values,
        parameters: &options.parameters,
        at_bound: best.at_bound,
        unseen,
        prior_variance: fitted_chi2 / options.draws,
        uniform,
        known_sd: data.sd.is_some(),
    };
    let lines = weights.chunks_exact(directions).zip(residuals.chunks_exact(directions)).zip(&k_lambert);
    let lines = lines.map(|((weight, residual), k)| errors::Band { weight, residual, k_lambert: *k });
    let errors = errors::estimate(&problem, lines.clone());
    // k_L follows what is left of its own band, and every error of the surface
    let free = (0..PARAMETERS).filter(|&i| errors.standard_errors[i].is_some()).count() as f64;
    let unknown = (0..PARAMETERS).any(|i| {
        errors.standard_errors[i].is_none() && options.parameters[i].is_free() && best.at_bound[i] == AtBound::Free
    });
    let share = free / bands.len() as f64;
    for (band, line) in bands.iter_mut().zip(lines) {
        let (mut s2, mut left) = (0.0, 0.0);
        for ((value, w), r) in values.iter().zip(line.weight).zip(line.residual) {
            s2 += w * value.diffuse * value.diffuse;
            left += w * r * r;
        }
        let rest = band.n_obs as f64 - 1.0 - share;
        let taken = leverage(&values, &line);
        let mut from_surface = 0.0;
        for i in 0..PARAMETERS {
            for k in 0..PARAMETERS {
                from_surface += taken[i] * errors.covariance[i][k] * taken[k];
            }
        }
        let variance = if rest > 0.0 {
            Some(left / rest)
        } else if data.sd.is_some() {
            Some(1.0)
        } else {
            None
        };
        band.k_lambert_se = match variance {
            Some(variance) if s2 > 0.0 && !unknown => Some((variance / s2 + from_surface.max(0.0)).sqrt()),
            _ => None,
        };
    }
    let mean = data.brdf.iter().filter(|y| !y.is_nan()).sum::<f64>() / n_obs as f64;
    let spread: f64 = data.brdf.iter().filter(|y| !y.is_nan()).map(|y| (y - mean).powi(2)).sum();
    Ok(SurfaceFit {
        x: best.x,
        parameters: options.parameters,
        unseen,
        errors,
        at_bound: best.at_bound,
        bands,
        chi2,
        draws: options.draws,
        rmse: (squares / n_obs as f64).sqrt(),
        r2: 1.0 - squares / spread,
        n_obs,
        valleys,
        termination: best.termination,
    })
}
