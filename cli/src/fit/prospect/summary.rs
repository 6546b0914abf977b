//! What is told of an inverted leaf: a line, warnings, `spectrum.csv`, `summary.json`.

use std::io;
use std::path::Path;

use leafbrdf_fit::hemispherical::Residuals;
use leafbrdf_fit::{AtBound, Identifiability, Termination};
use leafbrdf_prospect::Parameter;
use serde_json::{Map, Value, json};

use super::ProspectOutcome;
use crate::fit::json::{self, finite, metadata, program, wavelengths};
use crate::output::{Cell, Format, TableWriter};
use crate::spectra::LeafSpectra;

impl ProspectOutcome {
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

    pub(super) fn warn(&self) -> Vec<String> {
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
        let vague =
            self.fit.estimates.iter().filter(|one| one.standard_error.is_some_and(|error| error > 0.5 * one.value));
        let vague: Vec<&str> = vague.map(|estimate| estimate.parameter.name()).collect();
        if !vague.is_empty() {
            warnings.push(format!("known to half of its value at best: {}", vague.join(", ")));
        }
        let mut pairs = Vec::new();
        for (i, estimate) in self.fit.estimates.iter().enumerate() {
            for (other, correlation) in self.fit.estimates.iter().zip(&estimate.correlations).take(i) {
                if let Some(correlation) = correlation.filter(|correlation| correlation.abs() > 0.95) {
                    let (one, two) = (other.parameter.name(), estimate.parameter.name());
                    pairs.push(format!("{one} and {two} ({correlation:.3})"));
                }
            }
        }
        if !pairs.is_empty() {
            let alone = self.measured[1].is_none() && self.fit.estimate(Parameter::NStruct).is_some();
            let remedy = if alone { "; measure transmittance, or hold n_struct with --n-prior or --fix" } else { "" };
            let pairs = pairs.join(", ");
            warnings.push(format!("known together rather than each (correlation above 0.95): {pairs}{remedy}"));
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
        json::write(folder, &self.json(leaf, source))
    }

    fn json(&self, leaf: &LeafSpectra, source: &str) -> Value {
        let [used, missing, other_wavelengths, negative] = self.counts;
        let residuals = |residuals: &Option<Residuals<f64>>| match residuals {
            None => Value::Null,
            Some(residuals) => json!({
                "values": residuals.n_obs, "rmse": residuals.rmse(), "r2": finite(residuals.r2()),
                "correlation_of_neighbouring_residuals": residuals.neighbour_correlation(),
            }),
        };
        json!({
            "program": program(),
            "leaf": leaf.name,
            "file": source,
            "metadata": metadata(&leaf.metadata),
            "model": "prospect",
            "prospect": self.version.name(),
            "units": {
                "n_struct": "1", "cab": "ug cm^-2", "car": "ug cm^-2", "cant": "ug cm^-2", "cbrown": "1", "cw": "cm",
                "cm": "g cm^-2", "prot": "g cm^-2", "cbc": "g cm^-2", "rmse": "1 (reflectance, transmittance)",
            },
            "weights": if self.weighted { "1/sd^2" } else { "equal" },
            "wavelengths_nm": wavelengths(&self.wavelengths_nm),
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
                    entry.insert("at_bound".into(), json::at_bound(estimate.at_bound));
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
