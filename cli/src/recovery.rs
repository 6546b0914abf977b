//! What comes back from noisy copies of a leaf whose truth is known: how far off, and are the standard errors honest?
//!
//! The measurement of a preset leaf is simulated again and again with other noise, and inverted by each model of the program.
//! Printed by `cargo run --release -p leafbrdf --example recovery`, and kept by `tests/recovery.rs` with fewer seeds.

use std::ops::Range;

use leafbrdf_fit::leaf::{DirectionalData, LeafOptions, Method, SurfaceFrom, Treatment, parameters};
use leafbrdf_fit::surface::{SurfaceData, SurfaceOptions};
use leafbrdf_fit::{LeafBandsOptions, LeafData};
use leafbrdf_prospect::Parameter;

use crate::fit::{FitFailure, Selected, Selection};
use crate::measurement::{Measurement, Metadata};
use crate::simulate::{CoupledLeaf, Instrument, LeafModel, Noise, PresetLeaf, paper_directions};

/// One way to invert a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Estimator {
    /// k_L, n, σ in each band (§4.2); n and σ as means over the bands (Table 4).
    Bands,
    /// One n and σ, k_L in each band.
    Surface,
    /// n and σ first, then N, C_ab, C_m from Eq. 17 (§4.6).
    TwoStep,
    /// All five parameters at once (Eq. 18).
    Joint,
}

impl Estimator {
    /// Every estimator.
    pub const ALL: [Estimator; 4] = [Estimator::Bands, Estimator::Surface, Estimator::TwoStep, Estimator::Joint];

    /// As in tables.
    pub fn name(self) -> &'static str {
        match self {
            Estimator::Bands => "bands",
            Estimator::Surface => "surface",
            Estimator::TwoStep => "two-step",
            Estimator::Joint => "joint",
        }
    }
}

/// How noise is made and weighed.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// Standard deviation as a share of the value.
    pub relative: f64,
    /// Standard deviation that does not depend on the value, sr⁻¹.
    pub absolute: f64,
    /// The file says the standard deviation of every value, and the fits weigh by it.
    pub with_sd: bool,
}

impl Conditions {
    /// The noise of the demo, every value weighing the same: Eq. 11.
    pub const PAPER: Conditions = Conditions { relative: Noise::RELATIVE, absolute: Noise::ABSOLUTE, with_sd: false };
}

/// A parameter over all seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Score {
    /// `n`, `sigma`, `n_struct`, `cab`, `cm`.
    pub parameter: &'static str,
    /// The true value.
    pub truth: f64,
    /// Mean of what was found.
    pub mean: f64,
    /// Root mean square of found − true.
    pub rms_error: f64,
    /// Root mean square of the standard errors.
    pub rms_se: f64,
    /// Shares of the seeds whose value lies within 1 and 2 standard errors of the truth.
    pub within: [f64; 2],
    /// Greatest distance from the truth.
    pub worst: f64,
    /// Seeds that gave a value with a standard error.
    pub seeds: usize,
}

impl Score {
    fn new(parameter: &'static str, truth: f64, found: &[(f64, f64)]) -> Self {
        let count = found.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| found.iter().map(of).sum::<f64>() / count;
        let share = |errors: f64| mean(&|(value, se)| f64::from(u8::from((value - truth).abs() <= errors * se)));
        Score {
            parameter,
            truth,
            mean: mean(&|(value, _)| *value),
            rms_error: mean(&|(value, _)| (value - truth).powi(2)).sqrt(),
            rms_se: mean(&|(_, se)| se * se).sqrt(),
            within: [share(1.0), share(2.0)],
            worst: found.iter().map(|(value, _)| (value - truth).abs()).fold(0.0, f64::max),
            seeds: found.len(),
        }
    }
}

/// k_L(λ) over all seeds and bands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpectrumScore {
    /// Root mean square of found − true.
    pub rms_error: f64,
    /// Greatest distance from the truth.
    pub worst: f64,
    /// Shares within 1 and 2 standard errors of the truth, where there are any.
    pub within: [f64; 2],
    /// Share of the bands whose k_L is off by no more than 0.003.
    pub within_3_thousandths: f64,
}

impl SpectrumScore {
    /// `found`: (value − truth, standard error).
    fn new(found: &[(f64, Option<f64>)]) -> Self {
        let share = |count: usize, of: usize| count as f64 / of as f64;
        let with_se: Vec<(f64, f64)> = found.iter().filter_map(|(off, se)| Some((*off, (*se)?))).collect();
        let within =
            |errors: f64| share(with_se.iter().filter(|(off, se)| off.abs() <= errors * se).count(), with_se.len());
        SpectrumScore {
            rms_error: (found.iter().map(|(off, _)| off * off).sum::<f64>() / found.len() as f64).sqrt(),
            worst: found.iter().map(|(off, _)| off.abs()).fold(0.0, f64::max),
            within: [within(1.0), within(2.0)],
            within_3_thousandths: share(found.iter().filter(|(off, _)| off.abs() <= 0.003).count(), found.len()),
        }
    }
}

/// What one estimator makes of one leaf.
#[derive(Clone, Debug)]
pub struct Recovery {
    /// The estimator.
    pub estimator: Estimator,
    /// Its parameters, n and σ first.
    pub scores: Vec<Score>,
    /// k_L(λ).
    pub k_lambert: SpectrumScore,
    /// Mean RMSE of measured against modelled BRDF, sr⁻¹ (Table 5).
    pub rmse: f64,
}

impl Recovery {
    /// The score of a parameter.
    pub fn score(&self, parameter: &str) -> Option<&Score> {
        self.scores.iter().find(|score| score.parameter == parameter)
    }
}

/// One inversion: parameters with standard errors, k_L with its own, RMSE.
struct Found {
    parameters: Vec<(f64, Option<f64>)>,
    k_lambert: Vec<(f64, Option<f64>)>,
    rmse: f64,
}

/// The parameters that an estimator gives, and their true values.
fn truths(estimator: Estimator, leaf: &CoupledLeaf) -> Vec<(&'static str, f64)> {
    let surface = &leaf.model.surface;
    // two steps hold n and σ in the second, and give no error for them there
    let mut truths =
        if estimator == Estimator::TwoStep { vec![] } else { vec![("n", surface.n()), ("sigma", surface.sigma())] };
    if matches!(estimator, Estimator::TwoStep | Estimator::Joint) {
        let interior = &leaf.model.interior;
        truths.extend(INTERIOR.map(|parameter| (parameter.name(), interior.get(parameter))));
    }
    truths
}

/// The paper's interior parameters (§4.6).
const INTERIOR: [Parameter; 3] = [Parameter::NStruct, Parameter::Cab, Parameter::Cm];

/// Simulates a preset with the noise of every seed, 480–879 nm on the paper's goniometer, and inverts each measurement.
///
/// What the paper did not fit is held at its true value, which 480–880 nm hardly show: C_car at C_ab/4, C_w, no other pigment.
///
/// # Errors
/// What simulation or fit refuse, in words.
pub fn recover(
    preset: &PresetLeaf,
    estimator: Estimator,
    conditions: Conditions,
    seeds: Range<u64>,
) -> Result<Recovery, FitFailure> {
    let in_words = |error: crate::simulate::SimulationError| FitFailure(error.to_string());
    let wavelengths_nm: Vec<f64> = (480..=879).map(f64::from).collect();
    let leaf = LeafModel::of_preset(preset).and_then(|model| model.at(&wavelengths_nm)).map_err(in_words)?;
    let instrument = Instrument { with_sd: conditions.with_sd, ..Instrument::new(paper_directions()) };

    let truths = truths(estimator, &leaf);
    let mut found: Vec<Vec<(f64, f64)>> = vec![Vec::new(); truths.len()];
    let (mut k_lambert, mut rmse, mut count) = (Vec::new(), 0.0, 0.0);
    for seed in seeds {
        let mut noise = Noise::new(conditions.relative, conditions.absolute, seed);
        let measured = instrument.measure(&leaf, preset.name, Metadata::new(), &mut noise).map_err(in_words)?;
        let one = invert(&measured, estimator, &leaf)?;
        for (list, (value, se)) in found.iter_mut().zip(&one.parameters) {
            list.extend(se.map(|se| (*value, se)));
        }
        k_lambert.extend(one.k_lambert.iter().zip(&leaf.k_lambert).map(|((value, se), truth)| (value - truth, *se)));
        rmse += one.rmse;
        count += 1.0;
    }
    Ok(Recovery {
        estimator,
        scores: truths.iter().zip(&found).map(|((name, truth), found)| Score::new(name, *truth, found)).collect(),
        k_lambert: SpectrumScore::new(&k_lambert),
        rmse: rmse / count,
    })
}

fn invert(measured: &Measurement, estimator: Estimator, leaf: &CoupledLeaf) -> Result<Found, FitFailure> {
    let selected = Selected::new(measured, &Selection::default())?;
    let Selected { wavelengths_nm, geometries, vectors, brdf, sd, .. } = &selected;
    let sd = sd.as_deref();
    match estimator {
        Estimator::Bands => {
            let data = LeafData { geometries, brdf, sd };
            let fits = leafbrdf_fit::fit_bands(&data, &LeafBandsOptions::default(), &|_| ())?;
            let fits: Vec<_> = fits.into_iter().flatten().collect();
            let bands = fits.len() as f64;
            // the bands' noise is independent: the error of the mean is √(Σ se²)/bands
            let mean = |p: usize| {
                let errors: Option<Vec<f64>> = fits.iter().map(|fit| fit.standard_errors[p]).collect();
                let se = errors.map(|errors| errors.iter().map(|se| se * se).sum::<f64>().sqrt() / bands);
                (fits.iter().map(|fit| fit.parameters[p]).sum::<f64>() / bands, se)
            };
            let squares: f64 = fits.iter().map(|fit| fit.chi2).sum();
            let values: usize = fits.iter().map(|fit| fit.n_obs).sum();
            Ok(Found {
                parameters: vec![mean(1), mean(2)],
                k_lambert: fits.iter().map(|fit| (fit.parameters[0], fit.standard_errors[0])).collect(),
                // χ² is that of weighted residuals where there are sd
                rmse: if sd.is_some() { f64::NAN } else { (squares / values as f64).sqrt() },
            })
        }
        Estimator::Surface => {
            let data = SurfaceData { directions: vectors, brdf, sd };
            let fit = leafbrdf_fit::surface::fit_surface(&data, &SurfaceOptions::paper())?;
            let parameter = |p: usize| (fit.x[p], fit.errors.standard_errors[p]);
            Ok(Found {
                parameters: vec![parameter(0), parameter(1)],
                k_lambert: fit.bands.iter().map(|b| (b.k_lambert.unwrap_or(f64::NAN), b.k_lambert_se)).collect(),
                rmse: fit.rmse,
            })
        }
        Estimator::TwoStep | Estimator::Joint => {
            let data = DirectionalData { wavelengths_nm, directions: vectors, brdf, sd };
            let options = five_parameters(estimator, leaf);
            let fit = leafbrdf_fit::leaf::fit(&data, &options).map_err(|error| FitFailure(error.to_string()))?;
            let surface = [0, 1].into_iter().filter(|_| estimator == Estimator::Joint);
            let places = surface.chain(INTERIOR.map(parameters::place));
            Ok(Found {
                parameters: places.map(|place| (fit.x[place], fit.standard_errors[place])).collect(),
                k_lambert: fit.k_lambert.iter().copied().zip(fit.k_lambert_se.iter().copied()).collect(),
                rmse: fit.rmse,
            })
        }
    }
}

/// n, σ, N, C_ab, C_m; the rest held at the truth, C_car tied.
pub fn five_parameters(estimator: Estimator, leaf: &CoupledLeaf) -> LeafOptions {
    let method = if estimator == Estimator::Joint { Method::Joint } else { Method::TwoStep };
    let interior = &leaf.model.interior;
    let held = [Parameter::Cant, Parameter::Cbrown, Parameter::Cw]
        .map(|parameter| (parameters::place(parameter), Treatment::Held(interior.get(parameter))));
    LeafOptions {
        car_per_cab: Some(interior.car / interior.cab),
        treatments: held.to_vec(),
        surface_from: SurfaceFrom::Surface,
        ..LeafOptions::new(method)
    }
}
