//! One leaf, from measurements to a surface with errors.

use std::vec;
use std::vec::Vec;

use leafbrdf_core::{Angle, DirectionVectors, Normalization, Tilt};

use super::errors::{self, Errors, leverage};
use super::model::{
    DIFFUSE_A, DIFFUSE_B, DIFFUSE_E, DiffuseKind, DirectionValue, DirectionalModel, FacetKind, LeafModel, N,
    PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL,
};
use super::profile::{Place, Profile};
use super::search::{Prior, ScanSize, SearchOptions, Treatment, Valleys, polish, search};
use super::spectra::{Spectra, band_weights};
use crate::bounds::{AtBound, BandBounds, Interval};
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

/// What is fitted, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceOptions {
    /// Distribution of facets, and masking.
    pub facets: FacetKind,
    /// Shape of the diffuse term.
    pub diffuse: DiffuseKind,
    /// The convention for K that n and σ belong to.
    pub normalization: Normalization,
    /// What becomes of n, σ, a, b, t_x, t_y (angles in radians). Where all directions lie in the plane of incidence, a free t_y
    /// is held at 0: they cannot see it.
    pub parameters: [Treatment<f64>; PARAMETERS],
    /// ν, how many independent residuals the measurement counts as where priors are weighed against it; without a number:
    /// directions − 1. All bands of a direction count as one, k_L takes one away.
    pub draws: Option<f64>,
    /// Huber's loss instead of squares: values farther than 1.345 scaled median absolute deviations count less.
    pub robust: bool,
    /// Stop where the predicted decrease is below this share of the cost.
    pub tolerance: f64,
    /// The most steps a search.
    pub max_iterations: u32,
    /// The grid of the scan.
    pub scan: ScanSize,
    /// The most valleys of the scan that are searched.
    pub valleys: usize,
    /// Starts of the caller's own, tried beside the scan's.
    pub starts: Vec<[f64; PARAMETERS]>,
}

impl Default for SurfaceOptions {
    /// [`paper`](Self::paper).
    fn default() -> Self {
        SurfaceOptions::paper()
    }
}

/// The tilt of a leaf before it is measured: 0° ± 3°, and no more than 10° (cross-validated on 33 leaves of a published
/// campaign).
const TILT_SD_DEG: f64 = 3.0;
const TILT_MOST_DEG: f64 = 10.0;

impl SurfaceOptions {
    /// The paper's surface: Beckmann, V-cavities, Lambert, K = 2π², n and σ within Table 3, the leaf level.
    pub fn paper() -> Self {
        let BandBounds { n, sigma, .. } = BandBounds::table_3();
        let mut parameters = [Treatment::Held(0.0); PARAMETERS];
        parameters[N] = Treatment::Free { bounds: n, prior: None };
        parameters[SIGMA] = Treatment::Free { bounds: sigma, prior: None };
        SurfaceOptions {
            facets: FacetKind::Beckmann,
            diffuse: DiffuseKind::Lambert,
            normalization: Normalization::Bousquet2005,
            parameters,
            draws: None,
            robust: false,
            tolerance: 1e-12,
            max_iterations: 100,
            scan: ScanSize::DEFAULT,
            valleys: 8,
            starts: Vec::new(),
        }
    }

    /// GGX facets with Smith's masking, normalised as derived ([`Normalization::CookTorrance`]).
    #[must_use]
    pub fn with_ggx(mut self) -> Self {
        self.facets = FacetKind::Ggx;
        self.normalization = Normalization::CookTorrance;
        self
    }

    /// Beckmann facets and V-cavities; the convention for K as printed.
    #[must_use]
    pub fn with_beckmann(mut self) -> Self {
        self.facets = FacetKind::Beckmann;
        self.normalization = Normalization::Bousquet2005;
        self
    }

    /// Lambert's diffuse term: no a, no b.
    #[must_use]
    pub fn with_lambert(mut self) -> Self {
        self.diffuse = DiffuseKind::Lambert;
        self.parameters[DIFFUSE_A] = Treatment::Held(0.0);
        self.parameters[DIFFUSE_B] = Treatment::Held(0.0);
        self.parameters[DIFFUSE_E] = Treatment::Held(0.0);
        self
    }

    /// The diffuse term P1, with priors a ~ N(0.15, 0.1) and b ~ N(0, 0.1): what 33 leaves of a published campaign have.
    #[must_use]
    pub fn with_p1(mut self) -> Self {
        let free = |mean| Treatment::Free { bounds: Interval::new(-0.9, 0.9), prior: Some(Prior { mean, sd: 0.1 }) };
        self.diffuse = DiffuseKind::P1;
        self.parameters[DIFFUSE_A] = free(0.15);
        self.parameters[DIFFUSE_B] = free(0.0);
        self.parameters[DIFFUSE_E] = Treatment::Held(0.0);
        self
    }

    /// The diffuse term P2: P1 with its priors, and e ~ N(0.1, 0.03).
    ///
    /// The prior of e is what the same 33 leaves have, in sample and where other views are predicted; it is narrow because
    /// e falls with θ_s and is in part the instrument's. The bounds keep every triple positive.
    #[must_use]
    pub fn with_p2(mut self) -> Self {
        let free = |mean, sd, most: f64| Treatment::Free {
            bounds: Interval::new(-most, most),
            prior: Some(Prior { mean, sd }),
        };
        self.diffuse = DiffuseKind::P2;
        self.parameters[DIFFUSE_A] = free(0.15, 0.1, 0.59);
        self.parameters[DIFFUSE_B] = free(0.0, 0.1, 0.59);
        self.parameters[DIFFUSE_E] = free(0.1, 0.03, 0.4);
        self
    }

    /// Both tilts of the leaf free, each N(0°, 3°) and within ±10°.
    #[must_use]
    pub fn with_tilt(mut self) -> Self {
        let most = TILT_MOST_DEG.to_radians();
        let prior = Some(Prior { mean: 0.0, sd: TILT_SD_DEG.to_radians() });
        for place in [TILT_IN_PLANE, TILT_LATERAL] {
            self.parameters[place] = Treatment::Free { bounds: Interval::new(-most, most), prior };
        }
        self
    }

    /// Are the bounds a box inside the model's domain? [`fit_surface`] asks before it starts.
    ///
    /// # Errors
    /// [`FitError::Bounds`].
    pub fn check(&self) -> Result<(), FitError> {
        let limits: [(f64, f64, &str, &str); PARAMETERS] = [
            (1.0001, 100.0, "n", "1.0001 ≤ lower < upper ≤ 100"),
            (1e-4, 10.0, "sigma", "1e-4 ≤ lower < upper ≤ 10"),
            (-0.99, 0.99, "p1_a", "-0.99 ≤ lower < upper ≤ 0.99"),
            (-0.99, 0.99, "p1_b", "-0.99 ≤ lower < upper ≤ 0.99"),
            (-0.8, 0.8, "tilt_in_plane", "within ±0.8 rad"),
            (-0.8, 0.8, "tilt_lateral", "within ±0.8 rad"),
            (-0.99, 0.99, "p2_e", "-0.99 ≤ lower < upper ≤ 0.99"),
        ];
        for (one, (least, most, parameter, expected)) in self.parameters.iter().zip(limits) {
            let fine = match *one {
                Treatment::Held(value) => value >= least.min(1.0) && value <= most,
                Treatment::Free { bounds, prior } => {
                    bounds.lower >= least
                        && bounds.upper <= most
                        && bounds.lower < bounds.upper
                        && prior.is_none_or(|prior| prior.sd > 0.0 && prior.mean.is_finite())
                }
            };
            if !fine {
                return Err(FitError::Bounds { parameter, expected });
            }
        }
        Ok(())
    }
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

/// Tilts within what keeps every direction above the horizon; what the directions cannot see, held at 0.
pub(crate) fn settle(
    model: &LeafModel<'_, f64>,
    options: &SurfaceOptions,
) -> Result<([Treatment<f64>; PARAMETERS], [bool; PARAMETERS]), FitError> {
    let mut parameters = options.parameters;
    let mut unseen = [false; PARAMETERS];
    let tilts = [TILT_IN_PLANE, TILT_LATERAL];
    if !tilts.iter().any(|&place| parameters[place].is_free()) {
        return Ok((parameters, unseen));
    }
    let level = Tilt::new(Angle::from_radians(0.0), Angle::from_radians(0.0))?;
    let mut lowest = 1.0_f64;
    for direction in model.directions {
        let seen = direction.about(&level)?;
        lowest = lowest.min(seen.geometry().cos_theta_s()).min(seen.geometry().cos_theta_v());
    }
    // both tilts at once turn the normal by √2 times as much; one degree is left above the horizon
    let room = (lowest.asin() - 1.0_f64.to_radians()) * core::f64::consts::FRAC_1_SQRT_2;
    if !(room > 1.0_f64.to_radians()) {
        return Err(FitError::Bounds { parameter: "tilt", expected: "no direction within 3° of the horizon" });
    }
    for place in tilts {
        if let Treatment::Free { bounds, .. } = &mut parameters[place] {
            *bounds = Interval::new(bounds.lower.max(-room), bounds.upper.min(room));
            if !(bounds.lower < bounds.upper) {
                return Err(FitError::Bounds {
                    parameter: "tilt",
                    expected: "bounds that keep the views above the horizon",
                });
            }
        }
    }
    if parameters[TILT_LATERAL].is_free() {
        let mut x = parameters.map(|one| match one {
            Treatment::Held(value) => value,
            Treatment::Free { bounds, prior } => prior.map_or(0.5 * (bounds.lower + bounds.upper), |prior| prior.mean),
        });
        x[N] = x[N].clamp(1.3, 2.0);
        x[SIGMA] = x[SIGMA].clamp(0.1, 0.5);
        let (mut in_plane, mut lateral) = (0.0_f64, 0.0_f64);
        model.derivatives(&x, |value| {
            let size = |place: usize| value.d_specular[place].abs() + value.d_diffuse[place].abs();
            in_plane = in_plane.max(size(TILT_IN_PLANE));
            lateral = lateral.max(size(TILT_LATERAL));
        })?;
        if !(lateral > 1e-9 * in_plane) {
            parameters[TILT_LATERAL] = Treatment::Held(0.0);
            unseen[TILT_LATERAL] = true;
        }
    }
    Ok((parameters, unseen))
}

/// Shape and lobe, direction by direction.
fn values_at(model: &LeafModel<'_, f64>, x: &[f64; PARAMETERS]) -> Result<Vec<DirectionValue<f64>>, FitError> {
    let mut values = Vec::with_capacity(model.directions.len());
    model.derivatives(x, |value| values.push(value))?;
    Ok(values)
}

/// k_L of a band, and its residuals (0 where the weight is).
fn eliminate(values: &[DirectionValue<f64>], y: &[f64], weight: &[f64], residual: &mut [f64]) -> Option<f64> {
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

/// Huber's loss by reweighting: the scale is 1.4826 × the median absolute residual of the leaf, the knee 1.345 scales.
#[allow(clippy::type_complexity)]
fn robust(
    data: &SurfaceData<'_>,
    model: &LeafModel<'_, f64>,
    options: &SearchOptions<f64>,
    start: super::Valley<f64>,
    weight: Option<&[f64]>,
    places: &mut [Place<f64>],
) -> Result<(super::Valley<f64>, Option<Vec<f64>>), FitError> {
    const ROUNDS: usize = 50;
    let directions = data.directions.len();
    let mut best = start;
    let original: Vec<f64> =
        data.brdf.chunks_exact(directions).enumerate().flat_map(|(b, y)| band_weights(b, y, weight)).collect();
    let mut current = original.clone();
    let mut residual = vec![0.0; directions];
    for _ in 0..ROUNDS {
        let values = values_at(model, &best.x)?;
        let mut all = vec![0.0; data.brdf.len()];
        for ((y, w), r) in data
            .brdf
            .chunks_exact(directions)
            .zip(current.chunks_exact(directions))
            .zip(all.chunks_exact_mut(directions))
        {
            residual.fill(0.0);
            eliminate(&values, y, w, &mut residual);
            r.copy_from_slice(&residual);
        }
        let scaled = |(r, w): (&f64, &f64)| r.abs() * w.sqrt();
        let mut sizes: Vec<f64> = all.iter().zip(&original).filter(|(_, w)| **w > 0.0).map(scaled).collect();
        sizes.sort_by(f64::total_cmp);
        let scale = 1.4826 * sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
        if !(scale > 0.0) {
            break;
        }
        for ((w, w0), r) in current.iter_mut().zip(&original).zip(&all) {
            *w = w0 * (1.345 * scale / scaled((r, w0))).min(1.0);
        }
        let spectra = Spectra::new(directions, data.brdf, Some(&current))?;
        let next = spectra.moments(|moments| {
            Profile::new(model, moments, places).map(|mut profile| polish(&mut profile, options, &best.x))
        });
        let Some(next) = next else { break };
        let still = next.x.iter().zip(&best.x).all(|(a, b)| (a - b).abs() <= 1e-7 * b.abs().max(1e-3));
        best = super::Valley { iterations: best.iterations + next.iterations, ..next };
        if still {
            break;
        }
    }
    Ok((best, Some(current)))
}

fn report(
    data: &SurfaceData<'_>,
    model: &LeafModel<'_, f64>,
    options: &SearchOptions<f64>,
    unseen: [bool; PARAMETERS],
    valleys: Valleys<f64>,
    best: super::Valley<f64>,
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
