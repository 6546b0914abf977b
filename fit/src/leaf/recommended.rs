//! The recommended method: the interior from the darkest directions, then the surface from all of them.

use std::boxed::Box;
use std::vec;
use std::vec::Vec;

use leafbrdf_prospect::Coupling;

use super::engine::{Cost, Measured, Model};
use super::error::LeafError;
use super::errors::{self, Errors, Variance};
use super::found::Found;
use super::parameters::{COUNT, GAIN, OFFSET, Treatment, interior, place};
use super::problem::{LEAST_DIRECTIONS, Leaf, LeafOptions, default_bounds, tabulate, view};
use super::recipe::{Interior, Recipe};
use super::report::{Knowledge, LeafFit, RecipeReport, absent};
use super::residuals::ResidualModel;
use crate::bounds::AtBound;
use crate::solver::Termination;
use crate::surface::model::PARAMETERS;
use crate::surface::{
    LeafModel, Place, Profile, SearchOptions, Spectra, Treatment as SurfaceTreatment, Valleys, search,
};

/// The darkest directions of a leaf and their mean reflectance on the recipe's grid.
struct Dark {
    kept: Vec<usize>,
    wavelengths_nm: Vec<f64>,
    reflectance: Vec<f64>,
}

/// The place of the band nearest to a wavelength, no farther than `reach`.
fn nearest(wavelengths_nm: &[f64], nm: f64, reach: f64) -> Option<usize> {
    let after = wavelengths_nm.partition_point(|other| *other < nm);
    let candidates = [after.checked_sub(1), Some(after)];
    candidates
        .into_iter()
        .flatten()
        .filter_map(|place| Some((place, (wavelengths_nm.get(place)? - nm).abs())))
        .filter(|(_, distance)| *distance <= reach)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(place, _)| place)
}

impl Dark {
    fn new(leaf: &Leaf<'_>, recipe: &Recipe) -> Result<Self, LeafError> {
        let [first, last, step] = recipe.grid_nm;
        let reach = 0.5 * step;
        let nm = &leaf.wavelengths_nm;
        let mut dark: Vec<usize> = recipe.dark_nm.iter().filter_map(|target| nearest(nm, *target, reach)).collect();
        dark.dedup();
        if dark.is_empty() {
            dark = (0..nm.len()).collect();
        }
        let count = ((last - first) / step).round() as usize + 1;
        let mut grid: Vec<usize> =
            (0..count).filter_map(|i| nearest(nm, first + step * i as f64, 0.499 * step)).collect();
        grid.dedup();
        grid.retain(|&place| {
            recipe.without_nm.is_none_or(|[from, to]| !(nm[place] >= from && nm[place] <= to)) && nm[place] <= last
        });
        if grid.is_empty() {
            return Err(LeafError::NoRecipeWavelength);
        }
        let mean = |values: &mut dyn Iterator<Item = f64>| {
            let (mut sum, mut count) = (0.0, 0.0);
            for y in values.filter(|y| !y.is_nan()) {
                sum += y;
                count += 1.0;
            }
            sum / count
        };
        let at_dark = leaf.brf(&dark);
        let brightness: Vec<f64> =
            at_dark.chunks_exact(dark.len()).map(|values| mean(&mut values.iter().copied())).collect();
        let mut kept: Vec<usize> = (0..brightness.len()).filter(|&v| !brightness[v].is_nan()).collect();
        if kept.is_empty() {
            return Err(LeafError::NoRecipeWavelength);
        }
        let keep = ((kept.len() as f64 * recipe.kept_share).floor() as usize).max(1);
        kept.sort_by(|a, b| brightness[*a].total_cmp(&brightness[*b]));
        kept.truncate(keep);
        kept.sort_unstable();
        let values = leaf.brf(&grid);
        let reflectance = (0..grid.len()).map(|i| mean(&mut kept.iter().map(|v| values[v * grid.len() + i]))).collect();
        Ok(Dark { kept, wavelengths_nm: grid.iter().map(|&place| nm[place]).collect(), reflectance })
    }
}

/// What the recipe makes of each parameter, and what the caller does.
fn treatments(options: &LeafOptions) -> [Treatment; COUNT] {
    let recipe = options.recipe;
    let mut treatments = core::array::from_fn(|i| {
        let prior = recipe.prior(i);
        let free = Treatment::within(i, default_bounds(i, prior.is_some_and(|prior| prior.log)), prior);
        match (interior(i), options.decided(i)) {
            (_, Some(Treatment::Held(value))) => Treatment::Held(value),
            // freed by the caller within bounds: the recipe's prior stays
            (_, Some(Treatment::Free { bounds, prior: own })) => Treatment::within(i, bounds, own.or(prior)),
            (Some(leafbrdf_prospect::Parameter::NStruct), None) => Treatment::Held(recipe.n_struct),
            (Some(_), None) => free,
            (None, None) if i == GAIN || i == OFFSET => free,
            (None, None) => Treatment::Held(0.0),
        }
    });
    absent(&mut treatments, |parameter| options.has(parameter));
    treatments
}

/// The centre of what is known beforehand.
fn centre(treatments: &[Treatment; COUNT]) -> [f64; COUNT] {
    treatments.map(|one| match one {
        Treatment::Held(value) => value,
        Treatment::Free { bounds, prior } => {
            bounds.clip(prior.map_or(0.5 * (bounds.lower + bounds.upper), |prior| prior.centre))
        }
    })
}

/// The centre of the priors first, and three leaves far from it on either side: all meet, which says that they do.
fn starts(treatments: &[Treatment; COUNT], options: &LeafOptions) -> Vec<[f64; COUNT]> {
    let centre = centre(treatments);
    let shifted = |sign: [f64; 2]| {
        core::array::from_fn(|i| match (treatments[i].prior(), interior(i)) {
            (Some(prior), Some(parameter)) if prior.log && treatments[i].is_free() => {
                let pigment = matches!(
                    parameter,
                    leafbrdf_prospect::Parameter::Cab
                        | leafbrdf_prospect::Parameter::Car
                        | leafbrdf_prospect::Parameter::Cant
                        | leafbrdf_prospect::Parameter::Cbrown
                );
                centre[i] * (sign[usize::from(!pigment)] * prior.sd).exp()
            }
            _ => centre[i],
        })
    };
    let mut starts = options.starts.clone();
    if !options.only_starts {
        starts.extend([centre, shifted([-1.0, 1.0]), shifted([0.5, -1.0])]);
    }
    starts
}

pub(super) fn fit(leaf: &Leaf<'_>, options: &LeafOptions) -> Result<LeafFit, LeafError> {
    let recipe = options.recipe;
    let dark = Dark::new(leaf, recipe)?;
    let columns = tabulate(options.version, &dark.wavelengths_nm)?;
    let treatments = treatments(options);
    let model = Model {
        prospect: options.prospect(view(options.version, &dark.wavelengths_nm, &columns)?)?,
        interior: recipe.interior,
        coupling: Coupling::GainOffset,
        scaled_index: false,
        surface: None,
    };
    let measured = Measured { wavelengths_nm: &dark.wavelengths_nm, brf: &dark.reflectance, sd: None };
    let mut cost = Cost::new(model, measured, &recipe.residuals, &treatments, 1.0);
    if cost.used() == 0 {
        return Err(LeafError::NoRecipeWavelength);
    }
    let starts = starts(&treatments, options);
    let mut found = Found::default();
    for start in &starts {
        found.add(cost.search(start, options.tolerance, options.max_iterations), &cost);
    }
    let mut best = found.best.ok_or(LeafError::Model)?;
    if let (Some(rule), Interior::TwoLayer { upper_share }) = (recipe.share_rule, recipe.interior) {
        let errors = errors::errors(&mut cost, &best.x, &best.at_bound, &treatments, Variance::Stated, None)?;
        let (cm, log_sd) = dry_matter(&best.x, &errors);
        let upper_share = rule.share(upper_share, cm, log_sd);
        // C_m hardly depends on the share: once more is enough
        cost = Cost::new(
            Model { interior: Interior::TwoLayer { upper_share }, ..model },
            measured,
            &recipe.residuals,
            &treatments,
            1.0,
        );
        let mut again = Found::default();
        again.add(cost.search(&best.x, options.tolerance, options.max_iterations), &cost);
        found.iterations += again.iterations;
        best = again.best.ok_or(LeafError::Model)?;
    }
    let interior = cost.model.interior;
    let HeldOff { sds } = HeldOff::new(recipe, &treatments);
    let interior_errors = errors::errors(&mut cost, &best.x, &best.at_bound, &treatments, Variance::Stated, Some(sds))?;
    let modelled = cost.modelled(&best.x)?;
    let report = RecipeReport {
        recipe,
        interior,
        kept: dark.kept.clone(),
        wavelengths_nm: dark.wavelengths_nm.clone(),
        reflectance: dark.reflectance.clone(),
        modelled,
        cost: best.cost,
        diffuse_gain: best.x[GAIN],
        diffuse_offset: best.x[OFFSET],
    };
    let step = Step { x: best.x, treatments, errors: interior_errors, at_bound: best.at_bound };
    with_surface(leaf, options, step, &found, report)
}

/// C_m, or C_prot + C_cbc in its place, and the standard error of its logarithm.
fn dry_matter(x: &[f64; COUNT], errors: &Errors) -> (f64, f64) {
    use leafbrdf_prospect::Parameter::{Cbc, Cm, Prot};
    let parts = [Cm, Prot, Cbc].map(place);
    let total: f64 = parts.iter().map(|&i| x[i]).sum();
    let variance: f64 = parts.iter().flat_map(|&i| parts.map(|j| errors.covariance[i][j])).sum();
    (total, variance.max(0.0).sqrt() / total)
}

/// What is held in the interior step, as far as nobody has freed it.
struct HeldOff {
    sds: [f64; 3],
}

impl HeldOff {
    fn new(recipe: &Recipe, treatments: &[Treatment; COUNT]) -> Self {
        let n_held = !treatments[place(leafbrdf_prospect::Parameter::NStruct)].is_free();
        let shared = matches!(recipe.interior, Interior::TwoLayer { .. });
        HeldOff {
            sds: [
                if n_held { recipe.held_sd.log_n_struct } else { 0.0 },
                if shared { recipe.held_sd.upper_share } else { 0.0 },
                recipe.held_sd.wavelength_nm,
            ],
        }
    }
}

/// One finished step.
pub(super) struct Step {
    pub x: [f64; COUNT],
    pub treatments: [Treatment; COUNT],
    pub errors: Errors,
    pub at_bound: [AtBound; COUNT],
}

/// n, σ, shape and tilt from all directions, the interior frozen: k_L = gain · d + offset.
fn with_surface(
    leaf: &Leaf<'_>,
    options: &LeafOptions,
    step: Step,
    found: &Found,
    mut recipe_report: RecipeReport,
) -> Result<LeafFit, LeafError> {
    let all: Vec<usize> = (0..leaf.bands.len()).collect();
    let (brf, sd) = (leaf.brf(&all), leaf.sd(&all));
    let directions = leaf.data.directions;
    let surface = LeafModel {
        directions,
        facets: options.surface.facets,
        diffuse: options.surface.diffuse,
        normalization: options.surface.normalization,
    };
    let has_surface = leaf.seen >= LEAST_DIRECTIONS;
    let mut treatments: [Treatment; COUNT] = core::array::from_fn(|i| match i {
        GAIN | OFFSET => Treatment::Free { bounds: default_bounds(i, false), prior: None },
        _ => Treatment::Held(step.x[i]),
    });
    let mut start = step.x;
    let mut unseen = [false; PARAMETERS];
    let mut prior_weight = 1.0;
    let prospect = options.prospect(leaf.view()?)?;
    let model = Model {
        prospect,
        interior: recipe_report.interior,
        coupling: Coupling::GainOffset,
        scaled_index: false,
        surface: has_surface.then_some(surface),
    };
    if has_surface {
        let (parameters, not_seen) = crate::surface::settle(&surface, &options.surface)?;
        unseen = not_seen;
        let draws = options.surface.draws.unwrap_or(leaf.seen as f64 - 1.0).max(1.0);
        let valleys = {
            let measured = Measured { wavelengths_nm: &leaf.wavelengths_nm, brf: &brf, sd: None };
            let plain =
                Cost::new(model, measured, &ResidualModel::white(1.0), &treatments, 1.0).diffuse(&step.x, false)?;
            search_surface(leaf, options, &surface, parameters, draws, &plain.k)?
        };
        let best = valleys.best().ok_or(LeafError::Model)?;
        for i in 0..PARAMETERS {
            treatments[i] = options.of_surface(&parameters[i]);
            start[i] = best.x[i];
        }
        start[OFFSET] = 0.0;
        // reflectances here, sr⁻¹ there
        prior_weight = best.chi2 / draws * if sd.is_some() { 1.0 } else { core::f64::consts::PI.powi(2) };
    }
    let residuals = ResidualModel::white(1.0);
    let measured = Measured { wavelengths_nm: &leaf.wavelengths_nm, brf: &brf, sd: sd.as_deref() };
    let mut cost = Cost::new(model, measured, &residuals, &treatments, prior_weight);
    let mut at = Found::default();
    if has_surface {
        at.add(cost.search(&start, options.tolerance, options.max_iterations), &cost);
    }
    // without a surface the interior step's own gain and offset stand
    let (x, at_bound) = at.best.map_or((step.x, [AtBound::Free; COUNT]), |best| (best.x, best.at_bound));
    let spectrum = errors::spectrum(&mut cost, &x)?;
    let errors = errors::errors(&mut cost, &x, &at_bound, &treatments, Variance::Found(spectrum.scatter), None)?;
    let k_lambert_se = errors::diffuse_errors(&mut cost, &x, &errors)?;
    recipe_report.diffuse_gain = x[GAIN];
    recipe_report.diffuse_offset = x[OFFSET];

    // the surface from this step, everything else from the one before
    let of_surface = |i: usize| i < PARAMETERS;
    let mut fit = LeafFit {
        method: options.method,
        version: options.version,
        car_per_cab: options.car_per_cab,
        x: core::array::from_fn(|i| if of_surface(i) { x[i] } else { step.x[i] }),
        treatments: core::array::from_fn(|i| if of_surface(i) { treatments[i] } else { step.treatments[i] }),
        standard_errors: core::array::from_fn(|i| {
            if of_surface(i) { errors.standard_error(i) } else { step.errors.standard_error(i) }
        }),
        covariance: Box::new(core::array::from_fn(|i| {
            core::array::from_fn(|j| match (of_surface(i), of_surface(j)) {
                (true, true) => errors.covariance[i][j],
                (false, false) => step.errors.covariance[i][j],
                _ => 0.0,
            })
        })),
        knowledge: core::array::from_fn(|i| if of_surface(i) { errors.knowledge[i] } else { step.errors.knowledge[i] }),
        prior_share: core::array::from_fn(|i| {
            if of_surface(i) { errors.prior_share[i] } else { step.errors.prior_share[i] }
        }),
        at_bound: core::array::from_fn(|i| if of_surface(i) { at_bound[i] } else { step.at_bound[i] }),
        has_surface,
        scaled_index: false,
        bands: leaf.bands.clone(),
        wavelengths_nm: leaf.wavelengths_nm.clone(),
        k_lambert: spectrum.k_lambert,
        k_lambert_se,
        squares: spectrum.squares,
        rmse: spectrum.rmse,
        r2: spectrum.r2,
        n_obs: spectrum.scatter.n_obs,
        n_effective: spectrum.scatter.n_effective,
        cost: recipe_report.cost,
        prior_weight,
        condition: step.errors.condition.max(errors.condition),
        starts: found.starts(),
        agreeing: found.agreeing(),
        iterations: found.iterations,
        termination: found.best.map_or(Termination::MaxIterations, |best| best.termination),
        second: found.second.map(|other| super::OtherLeaf { x: other.x, cost: other.cost }),
        recipe: Some(recipe_report),
    };
    for (i, unseen) in unseen.into_iter().enumerate() {
        if unseen {
            fit.knowledge[i] = Knowledge::NotIdentifiable;
        }
    }
    Ok(fit)
}

/// The global search of the surface, with k_L = c₁ d + c₂ eliminated; where values are missing or have standard deviations, with
/// k_L free in every band.
pub(super) fn search_surface(
    leaf: &Leaf<'_>,
    options: &LeafOptions,
    surface: &LeafModel<'_, f64>,
    parameters: [SurfaceTreatment<f64>; PARAMETERS],
    draws: f64,
    diffuse: &[f64],
) -> Result<Valleys<f64>, LeafError> {
    let brdf = leaf.brdf();
    let directions = surface.directions.len();
    let weight: Option<Vec<f64>> = leaf.data.sd.map(|sd| leaf.rows(sd).iter().map(|sd| 1.0 / (sd * sd)).collect());
    let one = vec![1.0; diffuse.len()];
    let spectra = if weight.is_none() && brdf.iter().all(|y| !y.is_nan()) && !diffuse.is_empty() {
        Spectra::with_basis(directions, &brdf, &[&one, diffuse])?
    } else {
        Spectra::new(directions, &brdf, weight.as_deref())?
    };
    let search_options = SearchOptions {
        parameters,
        draws,
        tolerance: options.surface.tolerance,
        max_iterations: options.surface.max_iterations,
        scan: options.surface.scan,
        valleys: options.surface.valleys,
    };
    let mut places = vec![Place::empty(); directions];
    let mut grid = vec![0.0; options.surface.scan.workspace(&parameters)];
    spectra
        .moments(|moments| {
            let mut profile = Profile::new(surface, moments, &mut places)?;
            Some(search(&mut profile, &search_options, &options.surface.starts, &mut grid))
        })
        .ok_or(LeafError::Model)
}
