//! `summary.json`: the leaf as a whole. Mean n and σ (Table 4), their spectral invariance (§4.3), how good the fit is, what
//! was left out and why, and what the user should be warned of.

use std::io;
use std::path::Path;

use leafbrdf_core::Normalization;
use leafbrdf_fit::{AtBound, BandFit, Identifiability};
use serde_json::{Value, json};

use super::bands::{BandsOutcome, PARAMETERS, status};
use super::json::{self, constant, directions, finite, metadata, program, wavelengths};
use crate::measurement::Measurement;

/// VIS ends and NIR begins here, nm.
const VIS_END_NM: f64 = 700.0;
/// NIR ends here, nm.
const NIR_END_NM: f64 = 1300.0;

/// What the bands of a leaf say together.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Mean n over the bands that were fitted (Table 4).
    pub n: f64,
    /// Mean σ over the bands that were fitted (Table 4).
    pub sigma: f64,
    /// Median over the bands of their standard errors of n and σ: that of the means where all bands err alike.
    pub surface_se: [Option<f64>; 2],
    /// √(Σ residual²/values) over all bands, sr⁻¹.
    pub rmse: f64,
    /// 1 − Σ residual²/Σ (value − mean)² over all values.
    pub r2: f64,
    /// Bands fitted.
    pub fitted: usize,
    /// What the user should know before using the numbers.
    pub warnings: Vec<String>,
    /// The convention for K.
    pub normalization: Normalization,
    json: Value,
}

impl Summary {
    /// Sums up the bands of a leaf.
    pub fn of_bands(leaf: &Measurement, source: &str, outcome: &BandsOutcome) -> Self {
        let fits: Vec<(f64, &BandFit<f64>)> = outcome
            .selected
            .wavelengths_nm
            .iter()
            .zip(&outcome.bands)
            .filter_map(|(wavelength, band)| Some((*wavelength, band.as_ref()?)))
            .collect();
        let squares: f64 = (0..outcome.bands.len()).map(|band| outcome.squares(band)).filter(|s| s.is_finite()).sum();
        let values: usize = fits.iter().map(|(_, fit)| fit.n_obs).sum();
        let rmse = (squares / values as f64).sqrt();
        let r2 = 1.0 - squares / spread(outcome);
        let warnings = warnings(leaf, outcome, &fits);

        let parameters: serde_json::Map<String, Value> =
            PARAMETERS.iter().enumerate().map(|(p, name)| ((*name).to_string(), parameter(&fits, p))).collect();
        let count = |name: &str| outcome.bands.iter().filter(|band| status(band) == name).count();
        let at_bound: serde_json::Map<String, Value> = PARAMETERS
            .iter()
            .enumerate()
            .map(|(p, name)| {
                let at = |place| fits.iter().filter(|(_, fit)| fit.at_bound[p] == place).count();
                ((*name).to_string(), json!({"lower": at(AtBound::Lower), "upper": at(AtBound::Upper)}))
            })
            .collect();
        let selected = &outcome.selected;
        let json = json!({
            "program": program(),
            "leaf": leaf.name,
            "file": source,
            "metadata": metadata(&leaf.metadata),
            "model": "bands",
            "normalization": outcome.normalization.name(),
            "normalization_constant_k": constant(outcome.normalization),
            "units": {"k_l": "1", "n": "1", "sigma": "1 (rms slope over both axes)", "rmse": "sr^-1 of BRDF"},
            "weights": if selected.sd.is_some() { "1/sd^2" } else { "equal" },
            "wavelengths_nm": wavelengths(&selected.wavelengths_nm),
            "theta_s_deg": selected.sources_deg(),
            "parameters": parameters,
            "noise_of_standard_errors": fits.first().map(|(_, fit)| fit.noise.words()),
            "rmse": finite(rmse),
            "r2": finite(r2),
            "errors": {
                "method": "standard_error is the median of the bands' own: that of the mean where all bands err alike, too large where their \
                           errors are independent",
            },
            "correlations": correlations(&fits),
            "spectral_invariance": {
                "definition": "(max - min)/mean over the bands of the range (section 4.3)",
                "vis": invariance(&fits, f64::MIN, VIS_END_NM),
                "nir": invariance(&fits, VIS_END_NM, NIR_END_NM),
                "all": invariance(&fits, f64::MIN, f64::MAX),
            },
            "bands": {
                "converged": count("converged"), "max_iterations": count("max_iterations"),
                "too_few_values": count("too_few_values"), "at_bound": at_bound,
                "with_a_second_valley": fits.iter().filter(|(_, fit)| fit.second.is_some()).count(),
            },
            "directions": directions(selected),
            "values": json::values(selected, selected.used),
            "warnings": warnings,
        });
        let mean = |p: usize| fits.iter().map(|(_, fit)| fit.parameters[p]).sum::<f64>() / fits.len() as f64;
        let typical = |p: usize| median(fits.iter().filter_map(|(_, fit)| fit.standard_errors[p]).collect());
        Summary {
            n: mean(1),
            sigma: mean(2),
            surface_se: [1, 2].map(|p| Some(typical(p)).filter(|error| error.is_finite())),
            rmse,
            r2,
            fitted: fits.len(),
            warnings,
            normalization: outcome.normalization,
            json,
        }
    }

    /// One line for people.
    pub fn line(&self) -> String {
        format!(
            "{} bands, mean n {:.4}, mean sigma {:.4}, rmse {:.3e} sr^-1, R2 {:.4}",
            self.fitted, self.n, self.sigma, self.rmse, self.r2
        )
    }

    /// Writes `summary.json` into a folder, whole or not at all.
    ///
    /// # Errors
    /// The system's.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        json::write(folder, &self.json)
    }
}

/// Σ (value − mean)² over all values of fitted bands.
fn spread(outcome: &BandsOutcome) -> f64 {
    let width = outcome.selected.geometries.len();
    let of_fitted = outcome.selected.brdf.chunks(width.max(1)).zip(&outcome.bands).filter(|(_, band)| band.is_some());
    let values: Vec<f64> = of_fitted.flat_map(|(values, _)| values).copied().filter(|y| !y.is_nan()).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    values.iter().map(|y| (y - mean).powi(2)).sum()
}

/// Mean, spread and typical errors of one parameter over the bands.
fn parameter(fits: &[(f64, &BandFit<f64>)], p: usize) -> Value {
    let values: Vec<f64> = fits.iter().map(|(_, fit)| fit.parameters[p]).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0).max(1.0);
    let errors = fits.iter().filter_map(|(_, fit)| fit.standard_errors[p]).collect();
    // correlations of this parameter's pairs: (k_L, n), (k_L, σ), (n, σ)
    let pairs: [(usize, &str); 2] =
        [[(0, "n"), (1, "sigma")], [(0, "k_l"), (2, "sigma")], [(1, "k_l"), (2, "n")]][p.min(2)];
    let correlation = |pair: usize| median(fits.iter().filter_map(|(_, fit)| fit.correlations[pair]).collect());
    let correlations: serde_json::Map<String, Value> =
        pairs.iter().map(|(pair, with)| ((*with).to_string(), finite(correlation(*pair)))).collect();
    let typical = finite(median(errors));
    json!({
        "value": finite(mean),
        "standard_error": typical,
        "mean_over_bands": finite(mean),
        "standard_deviation_over_bands": finite(variance.sqrt()),
        "min": finite(values.iter().copied().fold(f64::INFINITY, f64::min)),
        "max": finite(values.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
        "median_standard_error_of_a_band": typical,
        "median_correlation_with": correlations,
    })
}

/// The bands' correlations of the pairs, each the median over the bands, named as in the other models.
fn correlations(fits: &[(f64, &BandFit<f64>)]) -> Value {
    let pairs = [(0, 1), (0, 2), (1, 2)].iter().enumerate().map(|(at, (one, other))| {
        let correlation = median(fits.iter().filter_map(|(_, fit)| fit.correlations[at]).collect());
        (format!("{},{}", PARAMETERS[*one], PARAMETERS[*other]), finite(correlation))
    });
    Value::Object(pairs.collect())
}

/// (max − min)/mean of n and of σ over the bands of a range of wavelengths (§4.3); `null` without bands there.
fn invariance(fits: &[(f64, &BandFit<f64>)], above_nm: f64, to_nm: f64) -> Value {
    let inside: Vec<&(f64, &BandFit<f64>)> = fits.iter().filter(|(nm, _)| *nm > above_nm && *nm <= to_nm).collect();
    let (Some(first), Some(last)) = (inside.first(), inside.last()) else { return Value::Null };
    let range = |p: usize| {
        let values = || inside.iter().map(|(_, fit)| fit.parameters[p]);
        let mean = values().sum::<f64>() / inside.len() as f64;
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        finite((most - least) / mean)
    };
    json!({"from_nm": first.0, "to_nm": last.0, "n": range(1), "sigma": range(2)})
}

/// The middle value; NaN without values.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Sentences on what the numbers cannot be trusted for.
fn warnings(leaf: &Measurement, outcome: &BandsOutcome, fits: &[(f64, &BandFit<f64>)]) -> Vec<String> {
    let mut warnings = leaf.warnings();
    let of = |count: usize| format!("{count} of {} bands", outcome.bands.len());
    let skipped = outcome.bands.len() - fits.len();
    if skipped > 0 {
        warnings.push(format!("{} have fewer than 3 values and are not fitted", of(skipped)));
    }
    let unfinished = fits.iter().filter(|(_, fit)| !fit.termination.converged()).count();
    if unfinished > 0 {
        warnings.push(format!("{} did not converge: see the column status of bands.csv", of(unfinished)));
    }
    for (p, name) in PARAMETERS.iter().enumerate() {
        let held = fits.iter().filter(|(_, fit)| fit.at_bound[p] != AtBound::Free).count();
        if held > 0 {
            warnings.push(format!("{name} sits at a bound in {}: the data ask for a value beyond it", of(held)));
        }
        let unknown = fits.iter().filter(|(_, fit)| fit.identifiability[p] == Identifiability::NotIdentifiable).count();
        if unknown > 0 {
            warnings.push(format!("{name} is not identifiable in {}: no standard error is given there", of(unknown)));
        }
    }
    let exact =
        fits.iter().filter(|(_, fit)| fit.identifiability.contains(&Identifiability::NoDegreesOfFreedom)).count();
    if exact > 0 {
        warnings.push(format!("{} have no more values than parameters: no standard errors there", of(exact)));
    }
    let ambiguous = fits.iter().filter(|(_, fit)| fit.second.is_some_and(|other| other.chi2 < 1.1 * fit.chi2)).count();
    if ambiguous > 0 {
        warnings.push(format!(
            "{} have a second minimum of chi2 within 10 % of the best (columns second_…): n and sigma are ambiguous there",
            of(ambiguous)
        ));
    }
    warnings
}
