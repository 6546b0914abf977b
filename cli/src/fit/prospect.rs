//! `--model prospect`: a leaf's structure and contents from hemispherical spectra, `spectrum.csv` and `summary.json`.

mod summary;

use leafbrdf_fit::band::Weights;
use leafbrdf_fit::hemispherical::{
    Free, HemisphericalProblem, LeafFit, LeafFitOptions, Measured, PriorN, Spectra, fit_leaf, n_prior,
};
use leafbrdf_fit::{AtBound, Identifiability};
use leafbrdf_prospect::table::{FIRST_NM, LAST_NM};
use leafbrdf_prospect::{LeafParams, Parameter, Prospect, Version};

use super::{FitFailure, LeafValues, WavelengthRange};
use crate::spectra::{Grid, LeafSpectra};

/// What is sought, and in which part of the spectra.
#[derive(Clone, Debug, PartialEq)]
pub struct ProspectOptions {
    /// Version of PROSPECT.
    pub version: Version,
    /// The free parameters and their bounds.
    pub free: Vec<Free<f64>>,
    /// Values of the others.
    pub held: LeafParams<f64>,
    /// C_car = ratio · C_ab, where it is tied.
    pub car_per_cab: Option<f64>,
    /// Where a leaf has no transmittance, N is taken from the plateau of the reflectance and held.
    pub n_prior: bool,
    /// Wavelengths that take part; all without it.
    pub wavelengths: Option<WavelengthRange>,
    /// Standard deviations of the file are used as weights; without, every value counts the same.
    pub use_sd: bool,
}

/// One leaf, inverted.
#[derive(Clone, Debug)]
pub struct ProspectOutcome {
    /// The best leaf, with errors.
    pub fit: LeafFit,
    /// N where it was taken from the reflectance.
    pub prior: Option<PriorN<f64>>,
    /// √(Σ residual²/values) over reflectance and transmittance, a fraction.
    pub rmse: f64,
    /// 1 − Σ residual²/Σ (value − mean)² over all values.
    pub r2: f64,
    /// What the user should know before using the numbers.
    pub warnings: Vec<String>,
    version: Version,
    car_per_cab: Option<f64>,
    wavelengths_nm: Vec<f64>,
    /// Reflectance and transmittance as measured, NaN where missing.
    measured: [Option<Vec<f64>>; 2],
    modelled: [Vec<f64>; 2],
    weighted: bool,
    /// Values used, missing, left out because of their wavelength, and negative ones among those used.
    counts: [usize; 4],
}

/// Inverts the spectra of one leaf.
///
/// # Errors
/// What the solver refuses, in words.
pub fn fit_prospect(leaf: &LeafSpectra, options: &ProspectOptions) -> Result<ProspectOutcome, FitFailure> {
    let words = |error: &dyn std::fmt::Display| FitFailure(error.to_string());
    let taken = |nm: f64| {
        nm >= f64::from(FIRST_NM)
            && nm <= f64::from(LAST_NM)
            && options.wavelengths.is_none_or(|range| range.contains(nm))
    };
    let kept: Vec<usize> =
        leaf.wavelengths_nm.iter().enumerate().filter(|(_, nm)| taken(**nm)).map(|(place, _)| place).collect();
    if kept.is_empty() {
        let (first, last) = (leaf.wavelengths_nm.first(), leaf.wavelengths_nm.last());
        return Err(FitFailure(format!(
            "no wavelength is left: the file has {} to {} nm, and PROSPECT {FIRST_NM} to {LAST_NM} nm",
            first.unwrap_or(&f64::NAN),
            last.unwrap_or(&f64::NAN)
        )));
    }
    let take =
        |values: &Vec<f64>| -> Vec<f64> { kept.iter().filter_map(|&place| values.get(place).copied()).collect() };
    let wavelengths_nm = take(&leaf.wavelengths_nm);
    let measured = [leaf.reflectance.as_ref().map(take), leaf.transmittance.as_ref().map(take)];
    let sd = [leaf.reflectance_sd.as_ref().map(take), leaf.transmittance_sd.as_ref().map(take)];
    let weighted = options.use_sd && sd.iter().any(Option::is_some);
    let mut weights = [const { Vec::new() }; 2];
    let mut values = [const { Vec::new() }; 2];
    for (index, name) in ["reflectance", "transmittance"].into_iter().enumerate() {
        let Some(measured) = &measured[index] else { continue };
        weights[index] = if weighted {
            let Some(sd) = &sd[index] else {
                return Err(FitFailure(format!(
                    "{name} has no standard deviations, the other spectrum has: add {name}_sd, or leave them out with --ignore-sd"
                )));
            };
            of_sd(name, &wavelengths_nm, measured, sd)?
        } else {
            measured.iter().map(|value| f64::from(u8::from(!value.is_nan()))).collect()
        };
        values[index] = measured.iter().map(|value| if value.is_nan() { 0.0 } else { *value }).collect();
    }

    let grid = Grid::new(wavelengths_nm);
    let mut room = grid.room(options.version);
    let view = grid.view(options.version, &mut room).map_err(|error| words(&error))?;
    let mut model = Prospect::new(view);
    if let Some(ratio) = options.car_per_cab {
        model = model.with_car_per_cab(ratio).map_err(|error| words(&error))?;
    }
    let mut solver = LeafFitOptions { free: options.free.clone(), ..LeafFitOptions::new(&[]) };
    if weighted {
        solver.solver.weights = Weights::Absolute;
    }
    let mut held = options.held;
    let prior = match (&measured, options.n_prior) {
        ([Some(reflectance), None], true) => {
            let bounds = Free::<f64>::new(Parameter::NStruct).bounds;
            let bounds = options
                .free
                .iter()
                .find(|free| free.parameter == Parameter::NStruct)
                .map_or(bounds, |free| free.bounds);
            let prior = n_prior(&model, reflectance, bounds).map_err(|error| words(&error))?;
            solver.free.retain(|free| free.parameter != Parameter::NStruct);
            held.n_struct = prior.n_struct;
            Some(prior)
        }
        _ => None,
    };
    let spectrum = |index: usize| {
        measured[index].as_ref().map(|_| Measured { values: &values[index], weights: Some(&weights[index]) })
    };
    let spectra = Spectra { reflectance: spectrum(0), transmittance: spectrum(1) };
    let fit = fit_leaf(&HemisphericalProblem { model, spectra, held }, &solver).map_err(|error| words(&error))?;

    if fit.estimates.iter().any(|one| one.identifiability == Identifiability::NoDegreesOfFreedom) {
        let sought = fit.estimates.iter().filter(|one| one.at_bound == AtBound::Free);
        let sought: Vec<&str> = sought.map(|one| one.parameter.name()).collect();
        let values = weights.iter().flatten().filter(|weight| **weight > 0.0).count();
        let remedy = "Measure more wavelengths, or hold parameters with --fix";
        return Err(FitFailure::exact(&format!("{values} values"), sought.len() as f64, &sought, remedy));
    }

    let mut modelled = [vec![0.0; kept.len()], vec![0.0; kept.len()]];
    let [reflectance, transmittance] = &mut modelled;
    model.spectrum(&fit.leaf, reflectance, transmittance).map_err(|error| words(&error))?;
    let used: Vec<f64> = measured.iter().flatten().flatten().copied().filter(|value| !value.is_nan()).collect();
    let (all, missing) = (leaf.counts()[0], measured.iter().flatten().flatten().filter(|value| value.is_nan()).count());
    let negative = used.iter().filter(|value| **value < 0.0).count();
    let mean = used.iter().sum::<f64>() / used.len() as f64;
    let spread: f64 = used.iter().map(|value| (value - mean).powi(2)).sum();
    let squares: f64 = [&fit.reflectance, &fit.transmittance].into_iter().flatten().map(|r| r.squares).sum();
    let mut outcome = ProspectOutcome {
        prior,
        rmse: fit.rmse,
        r2: 1.0 - squares / spread,
        warnings: Vec::new(),
        version: options.version,
        car_per_cab: options.car_per_cab,
        wavelengths_nm: grid.wavelengths_nm().to_vec(),
        measured,
        modelled,
        weighted,
        counts: [used.len(), missing, all - used.len(), negative],
        fit,
    };
    outcome.warnings = outcome.warn();
    Ok(outcome)
}

/// 1/sd² for every value, 0 for missing ones.
fn of_sd(name: &str, wavelengths_nm: &[f64], measured: &[f64], sd: &[f64]) -> Result<Vec<f64>, FitFailure> {
    let weight = |((value, sd), nm): ((&f64, &f64), &f64)| match () {
        () if value.is_nan() => Ok(0.0),
        () if *sd > 0.0 => Ok(1.0 / (sd * sd)),
        () => Err(FitFailure(format!(
            "the {name} at {nm} nm has no positive standard deviation: complete the column {name}_sd, or leave it out with --ignore-sd"
        ))),
    };
    measured.iter().zip(sd).zip(wavelengths_nm).map(weight).collect()
}

impl ProspectOutcome {
    /// The leaf with carotenoids where they are tied, and dry matter as prot + cbc where these are what was fitted.
    pub fn leaf(&self) -> LeafParams<f64> {
        let mut leaf = self.fit.leaf;
        if let Some(ratio) = self.car_per_cab {
            leaf.car = ratio * leaf.cab;
        }
        if self.version == Version::Pro && leaf.cm == 0.0 {
            leaf.cm = leaf.prot + leaf.cbc;
        }
        leaf
    }

    /// The standard error of a parameter of [`ProspectOutcome::leaf`].
    fn standard_error(&self, parameter: Parameter) -> Option<f64> {
        let of = |parameter| self.fit.estimate(parameter);
        match parameter {
            Parameter::Car if self.car_per_cab.is_some() => {
                Some(self.car_per_cab? * of(Parameter::Cab)?.standard_error?)
            }
            Parameter::Cm if self.version == Version::Pro && of(Parameter::Cm).is_none() => {
                let (prot, cbc) = (of(Parameter::Prot)?, of(Parameter::Cbc)?);
                let place = self.fit.estimates.iter().position(|other| other.parameter == Parameter::Cbc)?;
                let (a, b) = (prot.standard_error?, cbc.standard_error?);
                let correlation = prot.correlations.get(place).copied().flatten()?;
                Some((a * a + b * b + 2.0 * correlation * a * b).max(0.0).sqrt())
            }
            other => of(other)?.standard_error,
        }
    }

    /// The leaf's row of `leaves.csv`.
    pub fn values(&self) -> LeafValues {
        let leaf = self.leaf();
        let known =
            |parameter: &Parameter| *parameter == Parameter::NStruct || self.version.constituents().contains(parameter);
        LeafValues {
            prospect: Parameter::ALL.map(|parameter| known(&parameter).then(|| leaf.get(parameter))),
            prospect_se: Parameter::ALL.map(|parameter| self.standard_error(parameter)),
            rmse: self.rmse,
            r2: self.r2,
            bands: self.wavelengths_nm.len(),
            warnings: self.warnings.clone(),
            ..LeafValues::default()
        }
    }
}
