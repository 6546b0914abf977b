//! `--model prospect`: a leaf's structure and contents from hemispherical spectra, `spectrum.csv` and `summary.json`.

use std::io::{self, Write};
use std::path::Path;

use leafbrdf_fit::band::Weights;
use leafbrdf_fit::hemispherical::{
    Free, HemisphericalProblem, LeafFit, LeafFitOptions, Measured, PriorN, Residuals, Spectra, fit_leaf, n_prior,
};
use leafbrdf_fit::{AtBound, Identifiability, Termination};
use leafbrdf_prospect::table::{FIRST_NM, LAST_NM};
use leafbrdf_prospect::{LeafParams, Parameter, Prospect, Version};
use serde_json::{Map, Value, json};

use super::{FitFailure, LeafValues, WavelengthRange};
use crate::output::{AtomicFile, Cell, Format, TableWriter};
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

    /// One line for people.
    pub fn line(&self) -> String {
        let leaf = self.leaf();
        let numbers = self.fit.estimates.iter().map(|estimate| {
            let name = estimate.parameter.name();
            let error = estimate.standard_error.map_or(String::new(), |error| format!(" ± {error:.1e}"));
            format!("{name} {:.4}{error}", leaf.get(estimate.parameter))
        });
        let numbers: Vec<String> = numbers.collect();
        format!("PROSPECT-{}: {}, rmse {:.2e}, R2 {:.5}", self.version.name(), numbers.join(", "), self.rmse, self.r2)
    }

    fn warn(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if !self.fit.termination.converged() {
            warnings.push("the search did not converge: the parameters are where it stopped".to_string());
        }
        let named = |of: &dyn Fn(Identifiability) -> bool| {
            let those = self.fit.estimates.iter().filter(|estimate| of(estimate.identifiability));
            those.map(|estimate| estimate.parameter.name()).collect::<Vec<_>>().join(", ")
        };
        let held = self.fit.estimates.iter().filter(|estimate| estimate.at_bound == AtBound::Upper);
        for estimate in held {
            let (name, value) = (estimate.parameter.name(), estimate.value);
            warnings.push(format!("{name} sits at its upper bound {value}: the data ask for more"));
        }
        let unknown = named(&|identifiability| identifiability == Identifiability::NotIdentifiable);
        if !unknown.is_empty() {
            warnings.push(format!("not identifiable from these spectra, and without standard error: {unknown}"));
        }
        let no_freedom = named(&|identifiability| identifiability == Identifiability::NoDegreesOfFreedom);
        if !no_freedom.is_empty() {
            warnings.push(format!("no more values than parameters: no standard errors for {no_freedom}"));
        }
        for (i, estimate) in self.fit.estimates.iter().enumerate() {
            for (other, correlation) in self.fit.estimates.iter().zip(&estimate.correlations).take(i) {
                if let Some(correlation) = correlation.filter(|correlation| correlation.abs() > 0.95) {
                    warnings.push(format!(
                        "{} and {} lean on each other (correlation {correlation:.3}): their sum of effects is known, not each",
                        other.parameter.name(),
                        estimate.parameter.name()
                    ));
                }
            }
        }
        if let Some(second) = self.fit.second.filter(|second| second.chi2 < 1.1 * self.fit.chi2) {
            let leaf = second.leaf;
            warnings.push(format!(
                "a second minimum has χ² within 10 % of the best (n_struct {:.3}, cab {:.2}, cm {:.5}): the leaf is ambiguous",
                leaf.n_struct,
                leaf.cab,
                leaf.cm + leaf.prot + leaf.cbc
            ));
        }
        if let [Some(reflectance), Some(transmittance)] = &self.measured {
            let above = reflectance.iter().zip(transmittance).filter(|(r, t)| **r + **t > 1.0).count();
            if above > 0 {
                warnings.push(format!(
                    "reflectance + transmittance exceeds 1 at {above} wavelengths: no leaf does that, check the calibration"
                ));
            }
        }
        let unusual: Vec<String> = self.fit.leaf.unusual(self.version).map(|p| p.name().to_string()).collect();
        if !unusual.is_empty() {
            warnings.push(format!("outside the range of ordinary leaves: {}", unusual.join(", ")));
        }
        warnings
    }

    /// Writes `spectrum.csv` and `summary.json` into a folder, each whole or not at all.
    ///
    /// # Errors
    /// The system's.
    pub fn write(&self, folder: &Path, leaf: &LeafSpectra, source: &str) -> io::Result<()> {
        let columns =
            ["wavelength_nm", "reflectance", "transmittance", "reflectance_modelled", "transmittance_modelled"];
        let mut table = TableWriter::create(Some(&folder.join("spectrum.csv")), Some(Format::Csv), &columns)?;
        for (place, nm) in self.wavelengths_nm.iter().enumerate() {
            let at = |values: Option<&Vec<f64>>| {
                Cell::Number(values.and_then(|values| values.get(place)).copied().unwrap_or(f64::NAN))
            };
            let [r, t] = &self.measured;
            let [r_modelled, t_modelled] = &self.modelled;
            table.row(&[
                Cell::Number(*nm),
                at(r.as_ref()),
                at(t.as_ref()),
                at(Some(r_modelled)),
                at(Some(t_modelled)),
            ])?;
        }
        table.finish()?;
        let mut file = AtomicFile::create(&folder.join("summary.json"))?;
        serde_json::to_writer_pretty(&mut file, &self.json(leaf, source))?;
        file.write_all(b"\n")?;
        file.commit()
    }

    fn json(&self, leaf: &LeafSpectra, source: &str) -> Value {
        let [used, missing, other_wavelengths, negative] = self.counts;
        let metadata: Map<String, Value> =
            leaf.metadata.iter().map(|(key, value)| (key.to_string(), json!(value))).collect();
        let residuals = |residuals: &Option<Residuals<f64>>| match residuals {
            None => Value::Null,
            Some(residuals) => json!({
                "values": residuals.n_obs, "rmse": residuals.rmse(), "r2": finite(residuals.r2()),
                "correlation_of_neighbouring_residuals": residuals.neighbour_correlation(),
            }),
        };
        json!({
            "program": {"name": "leafbrdf", "version": env!("CARGO_PKG_VERSION")},
            "leaf": leaf.name,
            "file": source,
            "metadata": metadata,
            "model": "prospect",
            "prospect": self.version.name(),
            "units": {
                "n_struct": "1", "cab": "ug cm^-2", "car": "ug cm^-2", "cant": "ug cm^-2", "cbrown": "1", "cw": "cm",
                "cm": "g cm^-2", "prot": "g cm^-2", "cbc": "g cm^-2", "rmse": "1 (reflectance, transmittance)",
            },
            "weights": if self.weighted { "1/sd^2" } else { "equal" },
            "wavelengths_nm": {
                "first": self.wavelengths_nm.first(), "last": self.wavelengths_nm.last(),
                "count": self.wavelengths_nm.len(),
            },
            "parameters": self.parameters(),
            "car_per_cab": self.car_per_cab,
            "n_prior": self.prior.map(|prior| json!({
                "n_struct": prior.n_struct, "standard_deviation": prior.standard_deviation,
                "wavelength_nm": prior.wavelength_nm,
            })),
            "chi2": self.fit.chi2,
            "rmse": finite(self.rmse),
            "r2": finite(self.r2),
            "reflectance": residuals(&self.fit.reflectance),
            "transmittance": residuals(&self.fit.transmittance),
            "search": {
                "termination": match self.fit.termination {
                    Termination::Converged => "converged",
                    Termination::AtRounding => "at_rounding",
                    Termination::MaxIterations => "max_iterations",
                },
                "starts": self.fit.starts, "starts_that_agree": self.fit.agreeing, "iterations": self.fit.iterations,
            },
            "values": {
                "used": used, "negative_among_them": negative, "effective": finite(self.fit.n_effective),
                "left_out": {"missing": missing, "other_wavelengths": other_wavelengths},
            },
            "warnings": self.warnings,
        })
    }

    /// Every parameter of the version: value, and standard error, correlations and the rest where it was free.
    fn parameters(&self) -> Map<String, Value> {
        let leaf = self.leaf();
        let mut parameters = Map::new();
        for parameter in core::iter::once(Parameter::NStruct).chain(self.version.constituents().iter().copied()) {
            let mut entry = Map::new();
            entry.insert("value".into(), json!(leaf.get(parameter)));
            entry.insert("standard_error".into(), json!(self.standard_error(parameter)));
            match self.fit.estimate(parameter) {
                None => {
                    let tied = parameter == Parameter::Car && self.car_per_cab.is_some();
                    let sum = parameter == Parameter::Cm && leaf.cm != self.fit.leaf.cm;
                    let how = match () {
                        () if tied => "tied to cab",
                        () if sum => "prot + cbc",
                        () if parameter == Parameter::NStruct && self.prior.is_some() => "from the plateau, held",
                        () => "held",
                    };
                    entry.insert("free".into(), json!(false));
                    entry.insert("how".into(), json!(how));
                }
                Some(estimate) => {
                    entry.insert("free".into(), json!(true));
                    entry.insert(
                        "at_bound".into(),
                        match estimate.at_bound {
                            AtBound::Free => Value::Null,
                            AtBound::Lower => json!("lower"),
                            AtBound::Upper => json!("upper"),
                        },
                    );
                    entry.insert("why_no_standard_error".into(), json!(estimate.why_no_error()));
                    let others = self.fit.estimates.iter().zip(&estimate.correlations);
                    let others = others.filter(|(other, _)| other.parameter != parameter);
                    let correlations: Map<String, Value> =
                        others.map(|(other, c)| (other.parameter.name().to_string(), json!(c))).collect();
                    entry.insert("correlation_with".into(), Value::Object(correlations));
                }
            }
            parameters.insert(parameter.name().to_string(), Value::Object(entry));
        }
        parameters
    }
}

/// A number, or `null` where there is none.
fn finite(number: f64) -> Value {
    if number.is_finite() { json!(number) } else { Value::Null }
}
