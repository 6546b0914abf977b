//! `summary.json` of a surface: what was found, how well it is known, what it rests on, and what to be warned of.

use std::io;
use std::path::Path;

use leafbrdf_core::{Angle, Tilt};
use leafbrdf_fit::AtBound;
use leafbrdf_fit::surface::model::{N, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use leafbrdf_fit::surface::{FacetKind, Knowledge, Treatment, Valley};
use serde_json::{Map, Value, json};

use super::{PARAMETERS, SurfaceOutcome};
use crate::fit::json::{self, constant, directions, finite, metadata, optional, program, values, wavelengths};
use crate::measurement::Measurement;

/// Valleys whose cost is within this factor of the best are an ambiguity.
const AMBIGUOUS: f64 = 1.1;

impl SurfaceOutcome {
    /// Writes `summary.json` into a folder, whole or not at all.
    ///
    /// # Errors
    /// The system's.
    pub fn write_summary(&self, folder: &Path, leaf: &Measurement, source: &str) -> io::Result<()> {
        json::write(folder, &self.json(leaf, source))
    }

    fn json(&self, leaf: &Measurement, source: &str) -> Value {
        let (selected, fit, errors) = (&self.selected, &self.fit, &self.fit.errors);
        let present: Vec<usize> = (0..PARAMETERS.len()).filter(|&i| self.has(i)).collect();
        let parameters: Map<String, Value> =
            present.iter().map(|&i| (PARAMETERS[i].0.to_string(), self.parameter(i))).collect();
        let mut correlations = Map::new();
        for (place, &i) in present.iter().enumerate() {
            for &k in present.iter().skip(place + 1) {
                if let Some(correlation) = errors.correlation(i, k) {
                    correlations.insert(format!("{},{}", PARAMETERS[i].0, PARAMETERS[k].0), finite(correlation));
                }
            }
        }
        let best = fit.valleys.best().map_or(f64::NAN, |best| best.cost);
        let valleys: Vec<Value> = fit
            .valleys
            .iter()
            .map(|valley| {
                let mut one: Map<String, Value> = present
                    .iter()
                    .map(|&i| (PARAMETERS[i].0.to_string(), finite(valley.x[i] * PARAMETERS[i].1)))
                    .collect();
                one.insert("cost_ratio".to_string(), finite(valley.cost / best));
                Value::Object(one)
            })
            .collect();
        let outside = fit.k_lambert_outside(self.k_l_bounds);
        let empty = selected.wavelengths_nm.len() - self.fitted();
        json!({
            "program": program(),
            "leaf": leaf.name,
            "file": source,
            "metadata": metadata(&leaf.metadata),
            "model": "surface",
            "facets": self.options.facets.name(),
            "diffuse": self.options.diffuse.name(),
            "normalization": self.options.normalization.name(),
            "normalization_constant_k": constant(self.options.normalization),
            "units": {
                "k_l": "1", "n": "1", "sigma": "1 (rms slope over both axes)", "p1_a": "1", "p1_b": "1",
                "tilt_in_plane_deg": "degree, towards the source", "tilt_lateral_deg": "degree, towards phi_v = 90",
                "rmse": "sr^-1 of BRDF",
            },
            "weights": match (selected.sd.is_some(), self.options.robust) {
                (true, false) => "1/sd^2", (false, false) => "equal",
                (true, true) => "1/sd^2 and Huber's", (false, true) => "equal and Huber's",
            },
            "wavelengths_nm": wavelengths(&selected.wavelengths_nm),
            "theta_s_deg": selected.sources_deg(),
            "parameters": parameters,
            "correlations": correlations,
            "errors": {
                "method": "sandwich over directions, each with noise of its own size, residuals correlated in any way over the bands",
                "degrees_of_freedom": finite(errors.degrees_of_freedom),
                "effective_bands": finite(errors.effective_bands),
                "condition_number": finite(errors.condition),
                "independent_residuals_for_priors": finite(fit.draws),
            },
            "k_l": {
                "definition": "eliminated in each band without bounds; see bands.csv",
                "negative": fit.negative_k_lambert(),
                "outside_bounds": outside,
                "bounds": [self.k_l_bounds.lower, self.k_l_bounds.upper],
            },
            "rmse": finite(fit.rmse),
            "r2": finite(fit.r2),
            "chi2": finite(fit.chi2),
            "search": {
                "converged": fit.termination.converged(),
                "searches": fit.valleys.starts,
                "iterations": fit.valleys.iterations,
                "valleys": valleys,
            },
            "spectral_invariance": {"definition": "n and sigma are the same at all wavelengths, by the model", "n": 0, "sigma": 0},
            "bands": {"fitted": self.fitted(), "without_values": empty},
            "directions": directions(selected),
            "values": values(selected, selected.used),
            "dhrf": json::DHRF_ANGLE,
            "warnings": self.warnings,
        })
    }

    fn parameter(&self, i: usize) -> Value {
        let (fit, errors) = (&self.fit, &self.fit.errors);
        let scale = PARAMETERS[i].1;
        let knowledge = match errors.knowledge[i] {
            Knowledge::Identified => "identified",
            Knowledge::Held => "held",
            Knowledge::AtBound => "at a bound",
            Knowledge::NotIdentifiable => "not identifiable",
            Knowledge::NoDegreesOfFreedom => "no more values than parameters",
        };
        let mut one = json!({
            "value": optional(self.value(i)),
            "standard_error": optional(self.standard_error(i)),
            "knowledge": knowledge,
        });
        if let (Treatment::Free { bounds, prior }, Some(map)) = (&fit.parameters[i], one.as_object_mut()) {
            map.insert("bounds".to_string(), json!([bounds.lower * scale, bounds.upper * scale]));
            map.insert("at_bound".to_string(), json::at_bound(fit.at_bound[i]));
            if let Some(prior) = prior {
                let prior = json!({
                    "mean": prior.mean * scale, "sd": prior.sd * scale, "share_of_information": finite(errors.prior_share[i]),
                });
                map.insert("prior".to_string(), prior);
            }
        }
        one
    }

    /// tan α of the facet that the view nearest to the lobe's middle needs, about the leaf as it lies.
    fn nearest_facet(&self) -> Option<f64> {
        let angle = |i: usize| Angle::from_radians(self.fit.x[i]);
        let tilt = Tilt::new(angle(TILT_IN_PLANE), angle(TILT_LATERAL)).ok()?;
        let tan2 =
            self.selected.vectors.iter().filter_map(|pair| Some(pair.about(&tilt).ok()?.geometry().tan2_alpha()));
        tan2.min_by(f64::total_cmp).map(f64::sqrt)
    }

    /// Sentences on what the numbers cannot be trusted for.
    pub(super) fn warn(&self, leaf: &Measurement) -> Vec<String> {
        let mut warnings: Vec<String> = leaf.warnings();
        let (fit, errors) = (&self.fit, &self.fit.errors);
        let bands = fit.bands.len();
        let names = |of: &dyn Fn(usize) -> bool| {
            let those = (0..PARAMETERS.len()).filter(|&i| self.has(i) && of(i));
            those.map(|i| PARAMETERS[i].0).collect::<Vec<_>>().join(", ")
        };
        if !fit.termination.converged() {
            warnings.push("the search did not converge: the parameters are where it stopped".to_string());
        }
        if fit.unseen[TILT_LATERAL] {
            warnings.push(
                "tilt_lateral_deg is held at 0: all directions lie in the plane of incidence, which cannot see it. One azimuth \
                 30° off the plane is enough"
                    .to_string(),
            );
        }
        let unknown = names(&|i| errors.knowledge[i] == Knowledge::NotIdentifiable && !fit.unseen[i]);
        if !unknown.is_empty() {
            warnings.push(format!("not identifiable from these directions, and without standard error: {unknown}"));
        }
        for i in (0..PARAMETERS.len()).filter(|&i| fit.at_bound[i] != AtBound::Free) {
            let (name, value) = (PARAMETERS[i].0, fit.x[i] * PARAMETERS[i].1);
            warnings.push(format!("{name} sits at its bound {value}: the data ask for a value beyond it"));
        }
        let from_prior = names(&|i| errors.prior_share[i] > 0.5);
        if !from_prior.is_empty() {
            warnings.push(format!("more from the prior than from the data: {from_prior}"));
        }
        if let Some(second) = fit.valleys.second()
            && let Some(best) = fit.valleys.best()
            && second.cost < AMBIGUOUS * best.cost
        {
            let Valley { x, cost, .. } = second;
            warnings.push(format!(
                "a second minimum is nearly as good (cost {:.3} times the best, n {:.3}, sigma {:.3}): the surface is ambiguous",
                cost / best.cost,
                x[N],
                x[SIGMA]
            ));
        }
        if let Some(tan_alpha) = self.nearest_facet().filter(|tan_alpha| *tan_alpha > fit.x[SIGMA]) {
            let lobe = match self.options.facets {
                FacetKind::Beckmann => "n is extrapolated",
                FacetKind::Ggx => {
                    "n is extrapolated, which GGX does badly on some glossy leaves: compare with --facets beckmann"
                }
            };
            warnings.push(format!(
                "no view lies within the lobe (the nearest needs facets tilted by {:.1}°, sigma is {:.1}°): {lobe}",
                tan_alpha.atan().to_degrees(),
                fit.x[SIGMA].atan().to_degrees()
            ));
        }
        let negative = fit.negative_k_lambert();
        if negative > 0 {
            warnings.push(format!(
                "k_l is negative in {negative} of {bands} bands: the lobe alone exceeds the reflectance there"
            ));
        }
        let outside = fit.k_lambert_outside(self.k_l_bounds) - negative.min(fit.k_lambert_outside(self.k_l_bounds));
        if outside > 0 {
            let (lower, upper) = (self.k_l_bounds.lower, self.k_l_bounds.upper);
            warnings.push(format!(
                "k_l lies outside {lower} to {upper} in {outside} more of {bands} bands (it is not held there)"
            ));
        }
        let empty = bands - self.fitted();
        if empty > 0 {
            warnings.push(format!("{empty} of {bands} bands have no value"));
        }
        warnings
    }
}
