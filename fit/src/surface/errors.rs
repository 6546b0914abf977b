//! Standard errors that do not count one misfit 400 times.
//!
//! What a surface model leaves unexplained on a real leaf is its own imperfection: smooth over the wavelengths, so that 400 bands
//! see one and the same residual. The errors here take directions as the independent draws and let the bands be correlated in
//! any way (a sandwich, A⁻¹ M A⁻¹ with A = JᵀWJ):
//!
//! ```text
//! M_ij = Σ_v Σ_λλ' ω J_λvi Ω_λλ' J_λ'vj ω,     Ω_λλ' = Σ_v r_λv r_λ'v / (V − 1 − p)
//! ```
//!
//! Ω is never built: J is linear in k_L(λ), so that two sums a direction, Σ_λ r and Σ_λ k_L r, say all that M needs. White noise
//! comes out as white noise (the sums shrink), a misfit common to all bands as a single draw a direction. The larger of this
//! pooled estimate and of the plain sum over each direction's own scores (which sees that residuals are larger where the leaf is
//! brighter) is taken.

use std::vec;
use std::vec::Vec;

use super::model::{DirectionValue, PARAMETERS};
use super::search::Treatment;
use crate::bounds::AtBound;
use crate::linear::invert_spd;

/// What the data tell about a parameter of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Knowledge {
    /// It has a standard error smaller than the interval it was sought in.
    Identified,
    /// Held by the caller.
    Held,
    /// At a bound, and held there: the data ask for a value beyond.
    AtBound,
    /// The data do not determine it: the normal matrix is singular, the error exceeds the interval, or the directions cannot see it.
    NotIdentifiable,
    /// There are no more directions than parameters: nothing is left to estimate errors from.
    NoDegreesOfFreedom,
}

/// Errors of the surface's parameters [n, σ, a, b, t_x, t_y, e] (angles in radians).
#[derive(Clone, Debug)]
pub struct Errors {
    /// Standard errors; `None` where [`Knowledge`] says why.
    pub standard_errors: [Option<f64>; PARAMETERS],
    /// Covariances of those that have an error, 0 elsewhere.
    pub covariance: [[f64; PARAMETERS]; PARAMETERS],
    /// What the data tell.
    pub knowledge: [Knowledge; PARAMETERS],
    /// How much of what is known of a parameter (all others known) comes from its prior: 0 none of it, 1 all.
    pub prior_share: [f64; PARAMETERS],
    /// The condition number of the normal matrix scaled to unit diagonal, priors included: 1 for parameters that do not disturb
    /// each other; its square root tells by how much errors exceed those of one parameter alone.
    pub condition: f64,
    /// How many independent residuals a direction the bands amount to: 1 where all bands share one misfit, their number for white
    /// noise.
    pub effective_bands: f64,
    /// Degrees of freedom that the errors rest on: directions − 1 − parameters; for a 95 % interval take Student's t with so many.
    pub degrees_of_freedom: f64,
}

impl Errors {
    /// The correlation of two parameters; `None` where either has no error.
    pub fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        let product =
            self.standard_errors.get(i).copied().flatten()? * self.standard_errors.get(j).copied().flatten()?;
        Some(self.covariance[i][j] / product)
    }
}

/// A band's linearised fit: all that the errors need.
pub(super) struct Band<'a> {
    pub weight: &'a [f64],
    pub residual: &'a [f64],
    pub k_lambert: f64,
}

pub(super) struct Problem<'a> {
    pub values: &'a [DirectionValue<f64>],
    pub parameters: &'a [Treatment<f64>; PARAMETERS],
    pub at_bound: [AtBound; PARAMETERS],
    /// the caller has found that the directions cannot see it
    pub unseen: [bool; PARAMETERS],
    /// χ²/ν: what a prior is weighed against
    pub prior_variance: f64,
    /// every band has the same weights
    pub uniform: bool,
    pub known_sd: bool,
}

/// α + k β: what a band's k_L takes over of a change of parameters, Σ ω s (∂p + k ∂s)/Σ ω s².
pub(super) fn leverage(values: &[DirectionValue<f64>], band: &Band<'_>) -> [f64; PARAMETERS] {
    let mut sums = [0.0; PARAMETERS];
    let mut s2 = 0.0;
    for (value, w) in values.iter().zip(band.weight) {
        let w_s = w * value.diffuse;
        s2 += w_s * value.diffuse;
        for i in 0..PARAMETERS {
            sums[i] += w_s * (value.d_specular[i] + band.k_lambert * value.d_diffuse[i]);
        }
    }
    sums.map(|sum| if s2 > 0.0 { sum / s2 } else { 0.0 })
}

pub(super) fn estimate<'a>(problem: &Problem<'_>, bands: impl Iterator<Item = Band<'a>> + Clone) -> Errors {
    let values = problem.values;
    let free: [bool; PARAMETERS] = core::array::from_fn(|i| {
        problem.parameters[i].is_free() && problem.at_bound[i] == AtBound::Free && !problem.unseen[i]
    });
    let directions = values.len();
    let mut normal = [[0.0; PARAMETERS]; PARAMETERS];
    let mut scores = vec![[0.0; PARAMETERS]; directions];
    // Σ_λ √ω r J'_u for every pair of directions; with equal weights two sums a direction are enough
    let mut seen = vec![false; directions];
    let mut sums = vec![[0.0; 2]; directions];
    let mut cross = if problem.uniform { Vec::new() } else { vec![[0.0; PARAMETERS]; directions * directions] };
    let (mut plain, mut values_used) = (0.0, 0.0);
    for band in bands.clone() {
        let taken = leverage(values, &band);
        let slope = |value: &DirectionValue<f64>| -> [f64; PARAMETERS] {
            core::array::from_fn(|i| {
                value.d_specular[i] + band.k_lambert * value.d_diffuse[i] - taken[i] * value.diffuse
            })
        };
        for (v, value) in values.iter().enumerate() {
            let (w, r) = (band.weight[v], band.residual[v]);
            if !(w > 0.0) {
                continue;
            }
            seen[v] = true;
            plain += w * r * r;
            values_used += 1.0;
            let j = slope(value);
            for i in 0..PARAMETERS {
                scores[v][i] += w * r * j[i];
                for k in 0..=i {
                    normal[i][k] += w * j[i] * j[k];
                }
            }
            if problem.uniform {
                sums[v][0] += r;
                sums[v][1] += band.k_lambert * r;
            } else {
                let root = w.sqrt();
                for (u, other) in cross.iter_mut().skip(v * directions).zip(0..directions) {
                    let scaled = band.weight[other].sqrt() * band.residual[other] * root;
                    for i in 0..PARAMETERS {
                        u[i] += scaled * j[i];
                    }
                }
            }
        }
    }
    for i in 0..PARAMETERS {
        for k in 0..i {
            normal[k][i] = normal[i][k];
        }
    }

    let prior: [f64; PARAMETERS] =
        problem.parameters.map(|one| one.prior().map_or(0.0, |prior| problem.prior_variance / (prior.sd * prior.sd)));
    let prior_share: [f64; PARAMETERS] = core::array::from_fn(|i| match normal[i][i] + prior[i] {
        total if free[i] && total > 0.0 => prior[i] / total,
        _ => 0.0,
    });
    let parameters: f64 = (0..PARAMETERS).filter(|&i| free[i]).map(|i| 1.0 - prior_share[i]).sum();
    let seen_directions = seen.iter().filter(|seen| **seen).count() as f64;
    let degrees_of_freedom = seen_directions - 1.0 - parameters;

    // pooled over the directions
    let mut pooled = [[0.0; PARAMETERS]; PARAMETERS];
    if problem.uniform {
        let first = bands.clone().next();
        let projected: Vec<[[f64; PARAMETERS]; 2]> = match &first {
            None => Vec::new(),
            Some(band) => {
                let at = |k: f64| leverage(values, &Band { k_lambert: k, ..*band });
                let (alpha, with_one) = (at(0.0), at(1.0));
                let on = |value: &DirectionValue<f64>| {
                    [
                        core::array::from_fn(|i| value.d_specular[i] - alpha[i] * value.diffuse),
                        core::array::from_fn(|i| value.d_diffuse[i] - (with_one[i] - alpha[i]) * value.diffuse),
                    ]
                };
                values.iter().map(on).collect()
            }
        };
        let mut second = [[0.0; 2]; 2];
        for sum in &sums {
            for a in 0..2 {
                for b in 0..2 {
                    second[a][b] += sum[a] * sum[b];
                }
            }
        }
        for (v, [d, e]) in projected.iter().enumerate() {
            let w = first.as_ref().map_or(0.0, |band| band.weight[v]);
            let w2 = w * w;
            for i in 0..PARAMETERS {
                for k in 0..PARAMETERS {
                    pooled[i][k] += w2
                        * (d[i] * second[0][0] * d[k]
                            + second[0][1] * (d[i] * e[k] + e[i] * d[k])
                            + e[i] * second[1][1] * e[k]);
                }
            }
        }
    } else {
        for u in &cross {
            for i in 0..PARAMETERS {
                for k in 0..PARAMETERS {
                    pooled[i][k] += u[i] * u[k];
                }
            }
        }
    }
    let rest = degrees_of_freedom.max(1.0);
    for row in &mut pooled {
        for x in row {
            *x /= rest;
        }
    }
    let mut own = [[0.0; PARAMETERS]; PARAMETERS];
    for score in &scores {
        for i in 0..PARAMETERS {
            for k in 0..PARAMETERS {
                own[i][k] += score[i] * score[k];
            }
        }
    }
    let enough = degrees_of_freedom > 0.0;
    if !enough && problem.known_sd {
        pooled = normal;
        own = [[0.0; PARAMETERS]; PARAMETERS];
    }

    // A with the priors, parameters that have no error taken out
    let mut singular = [false; PARAMETERS];
    let (inverse, condition) = loop {
        let mut matrix = normal;
        for i in 0..PARAMETERS {
            matrix[i][i] += prior[i];
            if !free[i] || singular[i] {
                for k in 0..PARAMETERS {
                    matrix[i][k] = 0.0;
                    matrix[k][i] = 0.0;
                }
                matrix[i][i] = 1.0;
            }
        }
        let mut scale = [1.0; PARAMETERS];
        let mut flat = None;
        for i in 0..PARAMETERS {
            if !(matrix[i][i] > 0.0 && matrix[i][i].is_finite()) {
                flat = Some(i);
            } else {
                scale[i] = 1.0 / matrix[i][i].sqrt();
            }
        }
        let scaled = rescaled(&matrix, &scale);
        match (flat, invert_spd(&scaled)) {
            (None, Some(inverse)) => break (rescaled(&inverse, &scale), condition(&scaled, &inverse)),
            (flat, _) => {
                // the lobe's parameters go first, roughness before index: the order of what a leaf without gloss hides
                let next = flat.or_else(|| [1, 0, 3, 2, 5, 4].into_iter().find(|&i| free[i] && !singular[i]));
                match next {
                    Some(i) if !singular[i] => singular[i] = true,
                    _ => break ([[0.0; PARAMETERS]; PARAMETERS], f64::INFINITY),
                }
            }
        }
    };
    let sandwich = |meat: &[[f64; PARAMETERS]; PARAMETERS]| -> [[f64; PARAMETERS]; PARAMETERS] {
        let mut with_prior = *meat;
        for i in 0..PARAMETERS {
            // a prior is one more measurement, of variance sd²
            with_prior[i][i] += prior[i] * problem.prior_variance;
        }
        product(&product(&inverse, &with_prior), &inverse)
    };
    let (of_pool, of_own) = (sandwich(&pooled), sandwich(&own));
    let mut covariance = of_pool;
    // the larger error of the two, the pooled correlations
    let growth: [f64; PARAMETERS] =
        core::array::from_fn(
            |i| {
                if of_pool[i][i] > 0.0 { (of_own[i][i] / of_pool[i][i]).max(1.0).sqrt() } else { 1.0 }
            },
        );
    let mut standard_errors = [None; PARAMETERS];
    let mut knowledge = [Knowledge::Identified; PARAMETERS];
    for i in 0..PARAMETERS {
        for k in 0..PARAMETERS {
            covariance[i][k] *= growth[i] * growth[k];
        }
    }
    for i in 0..PARAMETERS {
        let error = covariance[i][i].max(0.0).sqrt();
        knowledge[i] = match &problem.parameters[i] {
            _ if problem.unseen[i] => Knowledge::NotIdentifiable,
            Treatment::Held(_) => Knowledge::Held,
            Treatment::Free { .. } if problem.at_bound[i] != AtBound::Free => Knowledge::AtBound,
            Treatment::Free { .. } if !enough && !problem.known_sd => Knowledge::NoDegreesOfFreedom,
            Treatment::Free { bounds, .. } if singular[i] || !(error <= bounds.width()) => Knowledge::NotIdentifiable,
            Treatment::Free { .. } => {
                standard_errors[i] = Some(error);
                Knowledge::Identified
            }
        };
    }
    for i in 0..PARAMETERS {
        for k in 0..PARAMETERS {
            if standard_errors[i].is_none() || standard_errors[k].is_none() {
                covariance[i][k] = 0.0;
            }
        }
    }
    let white = plain / (values_used - bands.count() as f64 - parameters).max(1.0);
    let trace = |m: &[[f64; PARAMETERS]; PARAMETERS]| -> f64 {
        // in units of each parameter's own information, so that no unit decides
        (0..PARAMETERS).filter(|&i| free[i] && normal[i][i] > 0.0).map(|i| m[i][i] / normal[i][i]).sum()
    };
    let inflation = trace(&pooled) / (white * trace(&normal));
    let per_direction = values_used / seen_directions.max(1.0);
    let effective_bands = if inflation.is_finite() && inflation > 0.0 {
        (per_direction / inflation).clamp(1.0, per_direction)
    } else {
        f64::NAN
    };
    Errors { standard_errors, covariance, knowledge, prior_share, condition, effective_bands, degrees_of_freedom }
}

fn rescaled(m: &[[f64; PARAMETERS]; PARAMETERS], scale: &[f64; PARAMETERS]) -> [[f64; PARAMETERS]; PARAMETERS] {
    core::array::from_fn(|i| core::array::from_fn(|k| m[i][k] * scale[i] * scale[k]))
}

fn product(
    a: &[[f64; PARAMETERS]; PARAMETERS],
    b: &[[f64; PARAMETERS]; PARAMETERS],
) -> [[f64; PARAMETERS]; PARAMETERS] {
    core::array::from_fn(|i| core::array::from_fn(|k| (0..PARAMETERS).map(|m| a[i][m] * b[m][k]).sum()))
}

/// λ_max/λ_min of a positive definite matrix of unit diagonal, by power iteration on it and on its inverse.
fn condition(m: &[[f64; PARAMETERS]; PARAMETERS], inverse: &[[f64; PARAMETERS]; PARAMETERS]) -> f64 {
    let largest = |m: &[[f64; PARAMETERS]; PARAMETERS]| {
        let mut x: [f64; PARAMETERS] = core::array::from_fn(|i| 1.0 + 0.1 * i as f64);
        let mut length = 1.0;
        for _ in 0..100 {
            let y: [f64; PARAMETERS] = core::array::from_fn(|i| (0..PARAMETERS).map(|k| m[i][k] * x[k]).sum());
            length = y.iter().map(|y| y * y).sum::<f64>().sqrt();
            x = y.map(|y| y / length);
        }
        length
    };
    largest(m) * largest(inverse)
}
