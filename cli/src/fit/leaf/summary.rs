//! `summary.json` of a leaf: what was found, how well it is known, what was chosen and by what, and what to be warned of.

use std::io;
use std::path::Path;

use leafbrdf_fit::AtBound;
use leafbrdf_fit::leaf::parameters::{NAMES, interior, place};
use leafbrdf_fit::leaf::{Interior, Knowledge, Method, RecipeReport, Treatment};
use leafbrdf_fit::surface::model::{N, PARAMETERS, SIGMA, TILT_LATERAL};
use leafbrdf_prospect::Parameter;
use serde_json::{Map, Value, json};

use super::{LeafOutcome, unit};
use crate::fit::json::{self, constant, directions, finite, metadata, optional, program, values, wavelengths};
use crate::measurement::Measurement;

/// Another minimum whose cost is within this factor of the best is an ambiguity.
const AMBIGUOUS: f64 = 1.1;
/// From this condition number on (scaled to unit diagonal) errors of parameters lean on each other.
const ILL_CONDITIONED: f64 = 1e4;
/// From this one on the matrix is singular as far as doubles tell.
const SINGULAR: f64 = 1e15;

impl LeafOutcome {
    /// Writes `summary.json` into a folder, whole or not at all.
    ///
    /// # Errors
    /// The system's.
    pub fn write_summary(&self, folder: &Path, leaf: &Measurement, source: &str) -> io::Result<()> {
        json::write(folder, &self.json(leaf, source))
    }

    fn json(&self, leaf: &Measurement, source: &str) -> Value {
        let (selected, fit) = (&self.selected, &self.fit);
        let surface = &self.options.surface;
        let present: Vec<usize> = (0..NAMES.len()).filter(|&i| self.has(i)).collect();
        let parameters: Map<String, Value> =
            present.iter().map(|&i| (NAMES[i].to_string(), self.parameter(i))).collect();
        let mut correlations = Map::new();
        for (at, &i) in present.iter().enumerate() {
            for &k in present.iter().skip(at + 1) {
                if let Some(correlation) = fit.correlation(i, k).filter(|r| *r != 0.0) {
                    correlations.insert(format!("{},{}", NAMES[i], NAMES[k]), finite(correlation));
                }
            }
        }
        let mut used = values(selected, fit.n_obs);
        used["left_out"]["wavelengths_without_values_or_outside_prospect"] =
            json!(selected.wavelengths_nm.len() - fit.wavelengths_nm.len());
        json!({
            "program": program(),
            "leaf": leaf.name,
            "file": source,
            "metadata": metadata(&leaf.metadata),
            "model": "leaf",
            "method": fit.method.name(),
            "prospect": fit.version.name(),
            "coupling": self.coupling().name(),
            "interior": self.interior_json(),
            "facets": surface.facets.name(),
            "diffuse": surface.diffuse.name(),
            "normalization": surface.normalization.name(),
            "normalization_constant_k": constant(surface.normalization),
            "units": {
                "k_l": "1", "n": "1", "sigma": "1 (rms slope over both axes)", "p1_a": "1", "p1_b": "1",
                "tilt_in_plane_deg": "degree, towards the source", "tilt_lateral_deg": "degree, towards phi_v = 90",
                "n_struct": "1", "cab": "µg cm^-2", "car": "µg cm^-2", "cant": "µg cm^-2", "cbrown": "arbitrary", "cw": "cm",
                "cm": "g cm^-2", "prot": "g cm^-2", "cbc": "g cm^-2", "gain": "1", "offset": "1",
                "rmse": "sr^-1 of BRDF",
            },
            "recipe": fit.recipe.as_ref().map_or(Value::Null, |recipe| self.recipe(recipe)),
            "weights": if selected.sd.is_some() { "1/sd^2" } else { "equal" },
            "wavelengths_nm": wavelengths(&fit.wavelengths_nm),
            "theta_s_deg": selected.sources_deg(),
            "parameters": parameters,
            "car_per_cab": fit.car_per_cab,
            "correlations": correlations,
            "errors": {
                "method": match fit.method {
                    Method::Recommended => "interior: the recipe's residual covariance and priors, and what is held with its own \
                        uncertainty (see recipe.held); surface: residual variance, neighbouring wavelengths counting as fewer",
                    _ => "residual variance, neighbouring wavelengths counting as fewer: n (1 - rho)/(1 + rho), at least one a direction",
                },
                "effective_values": finite(fit.n_effective),
                "condition_number": finite(fit.condition),
                "prior_weight": finite(fit.prior_weight),
            },
            "k_l": {
                "definition": "see coupling; bands.csv has its values",
                "negative": fit.negative_k_lambert(),
            },
            "rmse": finite(fit.rmse),
            "r2": finite(fit.r2),
            "spectral_invariance": self.spectral_invariance(),
            "search": {
                "converged": fit.termination.converged(),
                "starts": fit.starts,
                "starts_within_0.1_percent_of_the_best_cost": fit.agreeing,
                "iterations": fit.iterations,
                "cost": finite(fit.cost),
                "second": fit.second.map_or(Value::Null, |other| {
                    let mut one: Map<String, Value> = present
                        .iter()
                        .filter(|&&i| fit.treatments[i].is_free())
                        .map(|&i| (NAMES[i].to_string(), finite(other.x[i] * unit(i))))
                        .collect();
                    one.insert("cost_ratio".to_string(), finite(other.cost / fit.cost));
                    Value::Object(one)
                }),
            },
            "directions": directions(selected),
            "values": used,
            "dhrf": json::DHRF_ANGLE,
            "warnings": self.warnings,
        })
    }

    fn interior_json(&self) -> Value {
        match self.interior() {
            Interior::Plain => json!({"kind": "plain"}),
            Interior::TwoLayer { upper_share } => json!({
                "kind": "two-layer", "upper_share": upper_share,
                "assumption": "this share of all pigments lies in the optically upper half of the leaf",
            }),
        }
    }

    /// Every constant of the recommended method, and where it comes from.
    fn recipe(&self, report: &RecipeReport) -> Value {
        let recipe = report.recipe;
        let directions: Vec<Value> = report
            .kept
            .iter()
            .filter_map(|&kept| self.selected.directions.get(kept))
            .map(|d| json!([d.theta_s_deg, d.theta_v_deg, d.phi_v_deg]))
            .collect();
        let priors: Map<String, Value> = (0..NAMES.len())
            .filter_map(|i| {
                let prior = self.fit.treatments[i].prior().filter(|_| i >= PARAMETERS)?;
                let sd = if prior.log { "sd_of_ln" } else { "sd" };
                Some((NAMES[i].to_string(), json!({"centre": prior.centre, sd: prior.sd})))
            })
            .collect();
        json!({
            "name": recipe.name,
            "chosen_by_chemistry": recipe.chosen,
            "upper_share_rule": recipe.share_rule.map_or(Value::Null, |rule| json!({
                "upper_share": "at_reference - slope ln(cm / reference_cm), within bounds; at_reference where ln cm is too uncertain",
                "at_reference": match recipe.interior {
                    Interior::TwoLayer { upper_share } => json!(upper_share),
                    Interior::Plain => Value::Null,
                },
                "slope": rule.slope, "reference_cm_g_cm2": rule.reference_cm, "within": rule.within,
                "most_uncertain_ln_cm": rule.most_uncertain,
            })),
            "n_struct_held": recipe.n_struct,
            "directions_kept": {
                "rule": "the darkest half at 440, 450, 460, 680, 1930, 1940, 1950 nm, at least one",
                "theta_s_theta_v_phi_v_deg": directions,
            },
            "wavelengths_nm": {
                "first": report.wavelengths_nm.first(), "last": report.wavelengths_nm.last(),
                "count": report.wavelengths_nm.len(), "step": recipe.grid_nm[2], "without": recipe.without_nm,
            },
            "residuals": {
                "slow_sd": recipe.residuals.slow_sd, "length_nm": recipe.residuals.length_nm,
                "white_sd": recipe.residuals.white_sd, "first_surface_sd": recipe.residuals.surface_sd, "unit": "reflectance",
            },
            "priors": priors,
            "held": {
                "meaning": "one standard deviation of what is held, part of the standard errors",
                "ln_n_struct": recipe.held_sd.log_n_struct, "upper_share": recipe.held_sd.upper_share,
                "wavelength_nm": recipe.held_sd.wavelength_nm,
            },
            "cost": finite(report.cost),
            "diffuse_gain": finite(report.diffuse_gain),
            "diffuse_offset": finite(report.diffuse_offset),
        })
    }

    fn parameter(&self, i: usize) -> Value {
        let fit = &self.fit;
        let knowledge = if self.split_dry_matter(i) {
            "prot + cbc"
        } else if i == place(Parameter::Car) && fit.car_per_cab.is_some() {
            "tied to cab"
        } else {
            match fit.knowledge[i] {
                Knowledge::Identified => "identified",
                Knowledge::Held => "held",
                Knowledge::AtBound => "at a bound",
                Knowledge::NotIdentifiable => "not identifiable",
                Knowledge::PriorOnly => "from its prior alone",
                Knowledge::NoDegreesOfFreedom => "no more values than parameters",
            }
        };
        let mut one = json!({
            "value": optional(self.value(i)),
            "standard_error": optional(self.standard_error(i)),
            "knowledge": knowledge,
        });
        let Some(map) = one.as_object_mut() else { return one };
        if i == N && fit.scaled_index {
            map.insert("index_coefficient".to_string(), finite(fit.x[N]));
            map.insert("meaning".to_string(), json!("coefficient times PROSPECT's index, mean over the wavelengths"));
        }
        if let Treatment::Free { bounds, prior } = &fit.treatments[i] {
            map.insert("bounds".to_string(), json!([bounds.lower * unit(i), bounds.upper * unit(i)]));
            map.insert("at_bound".to_string(), json::at_bound(fit.at_bound[i]));
            if let Some(prior) = prior {
                let (sd, scale) = if prior.log { ("sd_of_ln", 1.0) } else { ("sd", unit(i)) };
                let mut prior = json!({
                    "centre": prior.centre * unit(i), sd: prior.sd * scale,
                    "share_of_its_variance_left": finite(fit.prior_share[i]),
                });
                if i >= PARAMETERS {
                    prior["from"] = json!(if self.is_given_a_prior(i) { "--prior" } else { "the method" });
                }
                map.insert("prior".to_string(), prior);
            }
        }
        one
    }

    /// (max − min)/mean of n and σ over the wavelengths (§4.3): by the model, σ is one, and n too unless it follows PROSPECT's index.
    fn spectral_invariance(&self) -> Value {
        if !self.fit.has_surface {
            return Value::Null;
        }
        let n: Vec<f64> = self.fit.wavelengths_nm.iter().filter_map(|nm| self.surface_at(*nm)[0]).collect();
        let ends = n.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], n| [least.min(*n), most.max(*n)]);
        let range =
            if self.fit.scaled_index { (ends[1] - ends[0]) * n.len() as f64 / n.iter().sum::<f64>() } else { 0.0 };
        let definition = if self.fit.scaled_index {
            "(max - min)/mean: n follows PROSPECT's index, sigma is the same at all wavelengths, both by the model"
        } else {
            "n and sigma are the same at all wavelengths, by the model"
        };
        json!({"definition": definition, "n": finite(range), "sigma": 0})
    }

    /// Sentences on what the numbers cannot be trusted for.
    pub(super) fn warn(&self, leaf: &Measurement) -> Vec<String> {
        let mut warnings: Vec<String> = leaf.warnings();
        let fit = &self.fit;
        let names = |of: &dyn Fn(usize) -> bool| {
            let those = (0..NAMES.len()).filter(|&i| of(i));
            those.map(|i| NAMES[i]).collect::<Vec<_>>().join(", ")
        };
        if !fit.termination.converged() {
            warnings.push("the search did not converge: the parameters are where it stopped".to_string());
        }
        if fit.agreeing < fit.starts {
            warnings.push(format!(
                "{} of {} starts ended elsewhere, with a cost more than 0.1 % above the best",
                fit.starts - fit.agreeing,
                fit.starts
            ));
        }
        if !fit.has_surface {
            warnings.push(match fit.method {
                Method::Recommended => {
                    "fewer than 3 directions: no surface is fitted, and the offset holds what it reflects".to_string()
                }
                _ => format!(
                    "fewer than 3 directions: n and sigma cannot be known and are held at {} and {}; --hold n=…,sigma=… for others",
                    fit.x[N], fit.x[SIGMA]
                ),
            });
        }
        // the recommended method frees both tilts wherever it may: nobody asked for this one
        let lateral = fit.knowledge[TILT_LATERAL] == Knowledge::NotIdentifiable
            && fit.has_surface
            && fit.method != Method::Recommended;
        if lateral && self.options.surface.parameters[TILT_LATERAL].is_free() {
            warnings.push(
                "tilt_lateral_deg is held at 0: all directions lie in the plane of incidence, which cannot see it"
                    .to_string(),
            );
        }
        let unknown = names(&|i| {
            self.has(i) && i != TILT_LATERAL && fit.knowledge[i] == Knowledge::NotIdentifiable && !self.is_tied(i)
        });
        if !unknown.is_empty() {
            warnings.push(format!("not identifiable from these data, and left empty: {unknown}"));
        }
        let alone = |i: usize| self.has(i) && fit.knowledge[i] == Knowledge::PriorOnly;
        let given = names(&|i| alone(i) && self.is_given_a_prior(i));
        if !given.is_empty() {
            warnings.push(format!("the data say nothing beyond the prior that was given: {given}"));
        }
        let prior = names(&|i| alone(i) && !self.is_given_a_prior(i));
        if !prior.is_empty() {
            warnings.push(format!("the data say nothing beyond the prior, and these are left empty: {prior}"));
        }
        for i in (0..NAMES.len()).filter(|&i| fit.at_bound[i] != AtBound::Free) {
            let value = fit.x[i] * unit(i);
            warnings.push(format!("{} sits at its bound {value}: the data ask for a value beyond it", NAMES[i]));
        }
        if fit.condition > SINGULAR {
            warnings.push(
                "some parameters are not known apart, or not at all: the condition number is beyond 1e15".to_string(),
            );
        } else if fit.condition > ILL_CONDITIONED {
            warnings.push(format!(
                "condition number {:.0e}: some parameters are only known together, see the correlations",
                fit.condition
            ));
        }
        if let Some(second) = fit.second
            && second.cost < AMBIGUOUS * fit.cost
        {
            let values: Vec<String> = (0..NAMES.len())
                .filter(|&i| fit.treatments[i].is_free() && (i < 2 || interior(i).is_some()))
                .map(|i| format!("{} {}", NAMES[i], super::brief(second.x[i] * unit(i))))
                .collect();
            warnings.push(format!(
                "a second minimum is nearly as good (cost {:.3} times the best): {}",
                second.cost / fit.cost,
                values.join(", ")
            ));
        }
        let negative = fit.negative_k_lambert();
        if negative > 0 {
            warnings.push(format!(
                "k_l is negative in {negative} of {} bands: the surface alone exceeds the reflectance there",
                fit.wavelengths_nm.len()
            ));
        }
        let outside = self.selected.wavelengths_nm.iter().filter(|nm| !(**nm >= 400.0 && **nm <= 2500.0)).count();
        if outside > 0 {
            warnings
                .push(format!("{outside} wavelengths outside 400 to 2500 nm, where PROSPECT is known, are left out"));
        }
        warnings
    }

    /// Carotenoids tied to chlorophyll, or dry matter that is prot + cbc: not parameters of their own.
    fn is_tied(&self, i: usize) -> bool {
        (i == place(Parameter::Car) && self.fit.car_per_cab.is_some()) || self.split_dry_matter(i)
    }
}
