//! Everything at once (Eq. 18), and the paper's two steps (§4.6), which are the same problem with the surface held.

use std::boxed::Box;
use std::vec;
use std::vec::Vec;

use leafbrdf_prospect::{Coupling, Parameter};

use super::engine::{Cost, Measured, Model};
use super::error::LeafError;
use super::errors::{self, Variance};
use super::found::Found;
use super::parameters::{COUNT, GAIN, INTERIOR, OFFSET, Treatment, interior};
use super::problem::{
    LEAST_DIRECTIONS, Leaf, LeafOptions, Method, SurfaceFrom, UNSEEN_SURFACE, default_bounds, tabulate, view,
};
use super::recommended::search_surface;
use super::report::{Knowledge, LeafFit, absent};
use super::residuals::ResidualModel;
use crate::bounds::Interval;
use crate::hemispherical;
use crate::leaf_bands::{LeafBandsOptions, LeafData, fit_bands};
use crate::solver::Termination;
use crate::surface::model::{N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use crate::surface::{DiffuseKind, FacetKind, LeafModel, Treatment as SurfaceTreatment};

/// Bands of the grid on which the starts are tried; the best is then followed on all.
const THIN: usize = 210;
/// Surfaces that a joint search starts from.
const SURFACES: usize = 2;
/// The paper's bands (Table 4), nm: means of n and σ are taken here, or over all bands where there are none.
const TABLE_4_NM: [f64; 2] = [480.0, 880.0];

/// PROSPECT's refractive index, mean over 400–2500 nm.
const MEAN_INDEX: f64 = 1.375;

/// What the method makes of interior, gain and offset.
fn treatments(options: &LeafOptions) -> [Treatment; COUNT] {
    let coupling = options.coupling;
    let mut treatments = core::array::from_fn(|i| {
        let prior = options.content_priors.then(|| options.recipe.prior(i)).flatten();
        let free = Treatment::within(i, default_bounds(i, prior.is_some_and(|prior| prior.log)), prior);
        match (interior(i), options.decided(i)) {
            (_, Some(Treatment::Held(value))) => Treatment::Held(value),
            (_, Some(Treatment::Free { bounds, prior: own })) => Treatment::within(i, bounds, own.or(prior)),
            // N acts on the diffuse reflectance mostly as a factor: beside a free gain it is held
            (Some(Parameter::NStruct), None) if coupling == Coupling::GainOffset => {
                Treatment::Held(options.recipe.n_struct)
            }
            (Some(_), None) => free,
            (None, None) if i == GAIN && coupling == Coupling::GainOffset => free,
            (None, None) if i == OFFSET && matches!(coupling, Coupling::GainOffset | Coupling::Offset) => free,
            (None, None) => Treatment::Held(if i == GAIN { 1.0 } else { 0.0 }),
        }
    });
    absent(&mut treatments, |parameter| options.has(parameter));
    treatments
}

/// The surfaces to start from, what becomes of the surface, and what a prior weighs.
struct Surfaces {
    starts: Vec<[f64; PARAMETERS]>,
    parameters: [SurfaceTreatment<f64>; PARAMETERS],
    unseen: [bool; PARAMETERS],
    /// Against the misfit of the surface alone, k_L free in every band.
    prior_weight: f64,
    /// ν: as many independent residuals the measurement counts as where priors are weighed.
    draws: f64,
    /// Standard errors of n and σ where they are means over bands.
    errors: [Option<f64>; PARAMETERS],
}

fn surfaces(leaf: &Leaf<'_>, options: &LeafOptions, model: &LeafModel<'_, f64>) -> Result<Surfaces, LeafError> {
    let mut asked = options.surface.parameters;
    let mut unseen = [false; PARAMETERS];
    if leaf.seen < LEAST_DIRECTIONS {
        for (i, one) in asked.iter_mut().enumerate() {
            if let SurfaceTreatment::Free { prior, .. } = *one {
                let usual = UNSEEN_SURFACE.iter().find(|(place, _)| *place == i).map(|(_, value)| *value);
                *one = SurfaceTreatment::Held(usual.or(prior.map(|prior| prior.mean)).unwrap_or(0.0));
                unseen[i] = true;
            }
        }
    }
    let mut held = options.surface.clone();
    held.parameters = asked;
    let (parameters, tilt_unseen) = crate::surface::settle(model, &held)?;
    for (unseen, tilt) in unseen.iter_mut().zip(tilt_unseen) {
        *unseen |= tilt;
    }
    let draws = options.surface.draws.unwrap_or(leaf.seen as f64 - 1.0).max(1.0);
    let valleys = search_surface(leaf, options, model, parameters, draws, &[])?;
    let best = valleys.best().ok_or(LeafError::Model)?;
    let units = if leaf.data.sd.is_some() { 1.0 } else { core::f64::consts::PI.powi(2) };
    let mut starts: Vec<[f64; PARAMETERS]> = valleys.iter().take(SURFACES).map(|valley| valley.x).collect();
    let mut errors = [None; PARAMETERS];
    let paper = options.surface.facets == FacetKind::Beckmann && options.surface.diffuse == DiffuseKind::Lambert;
    let tilted = [TILT_IN_PLANE, TILT_LATERAL].iter().any(|&place| parameters[place].is_free());
    if options.method == Method::TwoStep {
        starts.truncate(1);
        if options.surface_from == SurfaceFrom::Bands && paper && !tilted && leaf.seen >= LEAST_DIRECTIONS {
            let (means, sds) = means_over_bands(leaf, options)?;
            for (place, i) in [N, SIGMA].into_iter().enumerate() {
                if parameters[i].is_free() {
                    starts[0][i] = means[place];
                    errors[i] = Some(sds[place]);
                }
            }
        }
    }
    Ok(Surfaces { starts, parameters, unseen, prior_weight: units * best.chi2 / draws, draws, errors })
}

/// Means of n and σ over separately fitted bands, and their standard deviations.
fn means_over_bands(leaf: &Leaf<'_>, options: &LeafOptions) -> Result<([f64; 2], [f64; 2]), LeafError> {
    let directions = leaf.data.directions.len();
    let inside = |nm: f64| (TABLE_4_NM[0]..=TABLE_4_NM[1]).contains(&nm);
    let any = leaf.wavelengths_nm.iter().any(|nm| inside(*nm));
    let wanted: Vec<usize> = (0..leaf.bands.len()).filter(|&i| !any || inside(leaf.wavelengths_nm[i])).collect();
    let take = |values: &[f64]| -> Vec<f64> {
        let rows = |&i: &usize| values.iter().skip(leaf.bands[i] * directions).take(directions).copied();
        wanted.iter().flat_map(rows).collect()
    };
    let level =
        leafbrdf_core::Tilt::new(leafbrdf_core::Angle::from_radians(0.0), leafbrdf_core::Angle::from_radians(0.0))
            .map_err(crate::FitError::from)?;
    let geometries = leaf
        .data
        .directions
        .iter()
        .map(|direction| Ok(*direction.about(&level).map_err(crate::FitError::from)?.geometry()))
        .collect::<Result<Vec<_>, LeafError>>()?;
    let (brdf, sd) = (take(leaf.data.brdf), leaf.data.sd.map(take));
    let mut bands = LeafBandsOptions { normalization: options.surface.normalization, ..LeafBandsOptions::default() };
    for (i, bounds) in [(N, &mut bands.band.bounds.n), (SIGMA, &mut bands.band.bounds.sigma)] {
        if let SurfaceTreatment::Free { bounds: asked, .. } = options.surface.parameters[i] {
            *bounds = asked;
        }
    }
    let data = LeafData { geometries: &geometries, brdf: &brdf, sd: sd.as_deref() };
    let fits: Vec<_> = fit_bands(&data, &bands, &|_| ())?.into_iter().flatten().collect();
    if fits.is_empty() {
        return Err(LeafError::Model);
    }
    let count = fits.len() as f64;
    let mean = |p: usize| fits.iter().map(|fit| fit.parameters[p]).sum::<f64>() / count;
    let means = [mean(1), mean(2)];
    let sd = |p: usize, mean: f64| {
        let sum: f64 = fits.iter().map(|fit| (fit.parameters[p] - mean).powi(2)).sum();
        (sum / (count - 1.0).max(1.0)).sqrt()
    };
    Ok((means, [sd(1, means[0]), sd(2, means[1])]))
}

pub(super) fn fit(leaf: &Leaf<'_>, options: &LeafOptions) -> Result<LeafFit, LeafError> {
    let surface = LeafModel {
        directions: leaf.data.directions,
        facets: options.surface.facets,
        diffuse: options.surface.diffuse,
        normalization: options.surface.normalization,
    };
    let Surfaces { starts: surfaces, parameters, unseen, prior_weight, draws, errors: of_means } =
        surfaces(leaf, options, &surface)?;
    let mut treatments = treatments(options);
    for i in 0..PARAMETERS {
        treatments[i] = match options.method {
            Method::TwoStep => Treatment::Held(surfaces[0][i]),
            _ => options.of_surface(&parameters[i]),
        };
    }
    let scaled_index = options.coupling == Coupling::Prospecular && treatments[N].is_free() && options.scaled_index();
    let mut surfaces = surfaces;
    if scaled_index {
        // PROSPECT's index is 1.27 to 1.52; below 0.79 the product would leave the Fresnel equations' domain
        let bounds = Interval::new(0.8, 2.0);
        treatments[N] = Treatment::Free { bounds, prior: None };
        surfaces.iter_mut().for_each(|x| x[N] = bounds.clip(x[N] / MEAN_INDEX));
    }
    let thin: Vec<usize> = {
        let step = leaf.bands.len().div_ceil(THIN);
        (0..leaf.bands.len()).step_by(step.max(1)).collect()
    };
    let starts = starts(options, &treatments, &surfaces);
    // what no wavelength sees at all is held where it starts
    let mut blind = [false; COUNT];
    let found = {
        let problem = Part::new(leaf, options, &thin)?;
        let model = problem.model(options, surface, scaled_index)?;
        let residuals = ResidualModel::white(1.0);
        let mut cost = Cost::new(model, problem.measured(), &residuals, &treatments, prior_weight);
        if let Some(start) = starts.first() {
            let u = cost.coordinates(start);
            let (x, slopes) = cost.parameters(&u);
            let normal = cost.normal(&x, false)?;
            let size = |i: usize| normal.matrix[i][i] * slopes[i] * slopes[i];
            let largest = (0..COUNT).map(size).fold(0.0, f64::max);
            for i in INTERIOR..COUNT {
                if treatments[i].is_free() && treatments[i].prior().is_none() && !(size(i) > 1e-14 * largest) {
                    blind[i] = true;
                    treatments[i] = Treatment::Held(x[i]);
                }
            }
        }
        let mut cost = Cost::new(model, problem.measured(), &residuals, &treatments, prior_weight);
        search_from(&mut cost, &starts, options)
    };
    let best = found.best.ok_or(LeafError::Model)?;
    let all: Vec<usize> = (0..leaf.bands.len()).collect();
    let problem = Part::new(leaf, options, &all)?;
    let model = problem.model(options, surface, scaled_index)?;
    let mut cost = Cost::new(model, problem.measured(), &ResidualModel::white(1.0), &treatments, prior_weight);
    let mut starts = vec![best.x];
    // the runner-up too: costs of some bands and of all are not to be compared
    starts.extend(found.second.filter(|second| second.cost < 2.0 * best.cost).map(|second| second.x));
    let mut whole = search_from(&mut cost, &starts, options);
    let mut iterations = found.iterations + whole.iterations;
    let mut at = whole.best.ok_or(LeafError::Model)?;
    if treatments.iter().any(|one| one.prior().is_some()) {
        // a prior is weighed against what this model leaves over: more than the surface did with k_L free
        for _ in 0..REWEIGHED {
            let own = cost.normal(&at.x, false)?.chi2 / draws;
            if (own - cost.prior_weight).abs() <= 1e-3 * own {
                break;
            }
            cost.prior_weight = own;
            let starts: Vec<_> = [Some(at), whole.second].into_iter().flatten().map(|at| at.x).collect();
            whole = search_from(&mut cost, &starts, options);
            iterations += whole.iterations;
            at = whole.best.ok_or(LeafError::Model)?;
        }
    }
    let spectrum = errors::spectrum(&mut cost, &at.x)?;
    let errors = errors::errors(&mut cost, &at.x, &at.at_bound, &treatments, Variance::Found(spectrum.scatter), None)?;
    let k_lambert_se = errors::diffuse_errors(&mut cost, &at.x, &errors)?;
    let mut standard_errors: [Option<f64>; COUNT] = core::array::from_fn(|i| errors.standard_error(i));
    let mut knowledge = errors.knowledge;
    for i in 0..PARAMETERS {
        if options.method == Method::TwoStep && parameters[i].is_free() {
            standard_errors[i] = of_means[i];
            knowledge[i] = Knowledge::Held;
        }
        if unseen[i] {
            knowledge[i] = Knowledge::NotIdentifiable;
        }
    }
    for (knowledge, blind) in knowledge.iter_mut().zip(blind) {
        if blind {
            *knowledge = Knowledge::NotIdentifiable;
        }
    }
    let mut covariance = errors.covariance;
    for (i, of_mean) in of_means.iter().enumerate() {
        if let Some(sd) = of_mean {
            covariance[i][i] = sd * sd;
        }
    }
    Ok(LeafFit {
        method: options.method,
        version: options.version,
        car_per_cab: options.car_per_cab,
        x: at.x,
        treatments,
        standard_errors,
        covariance: Box::new(covariance),
        knowledge,
        prior_share: errors.prior_share,
        at_bound: at.at_bound,
        has_surface: leaf.seen >= LEAST_DIRECTIONS,
        scaled_index,
        bands: leaf.bands.clone(),
        wavelengths_nm: leaf.wavelengths_nm.clone(),
        k_lambert: spectrum.k_lambert,
        k_lambert_se,
        squares: spectrum.squares,
        rmse: spectrum.rmse,
        r2: spectrum.r2,
        n_obs: spectrum.scatter.n_obs,
        n_effective: spectrum.scatter.n_effective,
        cost: at.cost,
        prior_weight: cost.prior_weight,
        condition: errors.condition,
        starts: found.starts(),
        agreeing: found.agreeing(),
        iterations,
        termination: whole.best.map_or(Termination::MaxIterations, |best| best.termination),
        second: whole.second.map(|other| super::OtherLeaf { x: other.x, cost: other.cost }),
        recipe: None,
    })
}

/// The most times that priors are weighed anew; two or three are enough.
const REWEIGHED: u32 = 6;

/// One search from each start.
fn search_from(cost: &mut Cost<'_>, starts: &[[f64; COUNT]], options: &LeafOptions) -> Found {
    let mut found = Found::default();
    for start in starts {
        found.add(cost.search(start, options.tolerance, options.max_iterations), cost);
    }
    found
}

/// Some of the leaf's bands.
struct Part<'a> {
    version: leafbrdf_prospect::Version,
    wavelengths_nm: Vec<f64>,
    columns: Vec<f64>,
    brf: Vec<f64>,
    sd: Option<Vec<f64>>,
    _leaf: core::marker::PhantomData<&'a ()>,
}

impl<'a> Part<'a> {
    fn new(leaf: &'a Leaf<'_>, options: &LeafOptions, places: &[usize]) -> Result<Self, LeafError> {
        let wavelengths_nm: Vec<f64> = places.iter().map(|&place| leaf.wavelengths_nm[place]).collect();
        let columns = tabulate(options.version, &wavelengths_nm)?;
        Ok(Part {
            version: options.version,
            wavelengths_nm,
            columns,
            brf: leaf.brf(places),
            sd: leaf.sd(places),
            _leaf: core::marker::PhantomData,
        })
    }

    fn model<'b>(
        &'b self,
        options: &LeafOptions,
        surface: LeafModel<'b, f64>,
        scaled_index: bool,
    ) -> Result<Model<'b>, LeafError> {
        Ok(Model {
            prospect: options.prospect(view(self.version, &self.wavelengths_nm, &self.columns)?)?,
            interior: options.interior,
            coupling: options.coupling,
            scaled_index,
            surface: Some(surface),
        })
    }

    fn measured(&self) -> Measured<'_> {
        Measured { wavelengths_nm: &self.wavelengths_nm, brf: &self.brf, sd: self.sd.as_deref() }
    }
}

/// Every interior of `hemispherical::starts` under every surface.
fn starts(options: &LeafOptions, treatments: &[Treatment; COUNT], surfaces: &[[f64; PARAMETERS]]) -> Vec<[f64; COUNT]> {
    let mut starts = options.starts.clone();
    if options.only_starts {
        return starts;
    }
    for surface in surfaces {
        for leaf in hemispherical::starts::<f64>() {
            starts.push(core::array::from_fn(|i| match (treatments[i], interior(i)) {
                (Treatment::Held(value), _) => value,
                (_, Some(parameter)) => leaf.get(parameter),
                (_, None) if i < PARAMETERS => surface[i],
                (_, None) if i == GAIN => 1.0,
                _ => 0.0,
            }));
        }
    }
    starts
}

impl LeafOptions {
    /// Is n a coefficient on the tabulated index? As in PROSPECULAR, with its coupling.
    fn scaled_index(&self) -> bool {
        self.coupling == Coupling::Prospecular
    }
}
