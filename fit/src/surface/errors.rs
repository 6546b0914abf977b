//! Standard errors that do not count one misfit 400 times, and do not take a noisy peak for a quiet one.
//!
//! What a surface model leaves unexplained on a real leaf is its own imperfection: smooth over the wavelengths, so that 400 bands
//! see one and the same residual. Noise, on the other hand, is larger where more light comes from. The errors here take directions
//! as the independent draws, let the bands be correlated in any way, and let every direction have a size of its own: a sandwich,
//! A⁻¹ M A⁻¹ with A = JᵀWJ (priors added), whose M is the larger, parameter by parameter, of two estimates.
//!
//! **All directions alike.** Residuals of all directions together estimate the covariance between bands:
//!
//! ```text
//! M_ij = Σ_v Σ_λλ' ω J_λvi Ω_λλ' J_λ'vj ω,     Ω_λλ' = Σ_v r_λv r_λ'v / ν,     ν = V − 1 − p
//! ```
//!
//! Ω is never built: J is linear in k_L(λ), so that two sums a direction, Σ_λ r and Σ_λ k_L r, say all that M needs.
//!
//! **Each direction its own size.** With c_i the row of A⁻¹ that belongs to a parameter,
//!
//! ```text
//! variance_i = f_i Σ_v c_iᵀ R_v W_v R_vᵀ c_i,     W_v = Σ_λ ω² J_λv J_λvᵀ r_λv²/(1 − h_λv)
//! f_i = 1/ν Σ_v (c_iᵀ Σ_λ ω J_λv r_λv)²/(c_iᵀ W_v c_i),     1 ≤ f_i ≤ B
//! ```
//!
//! W_v is what a direction would contribute if its bands were independent; it knows the size of its noise from all B bands, however
//! few directions see the peak. f_i is how many times more the bands' sum scatters than that, 1 for white noise and B for one misfit
//! common to all; every direction has the same say in it. h is what k_L takes of a residual, and R_v = (1 − φ_i H_v)^(−½) gives back
//! what the parameters take of it (H_v: the direction's share in its own prediction, CR2 of Bell and McCaffrey 2002): of the part
//! that is common to the bands, φ_i = (f_i − 1)/(B − 1), and not of their scatter, which a few parameters cannot follow.
//!
//! Priors pull the fit off the data, and what they leave would pass for misfit; residuals are therefore taken after one more
//! linear step without priors, in which all p parameters follow the data.

mod clusters;
mod matrix;

use clusters::{Clusters, Seen};
use matrix::{Matrix, Root, Vector, ZERO, condition, form, product, rescaled};

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
    /// Standard errors, in the parameters' units (angles in radians); `None` where [`Knowledge`] says why. They assume neither
    /// one noise for all directions nor independent bands; what directions share with their neighbours they do not see.
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
    /// Where priors alone make up for missing directions, a parameter counts by the share that its prior does not know.
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
    let free: [bool; PARAMETERS] = core::array::from_fn(|i| {
        problem.parameters[i].is_free() && problem.at_bound[i] == AtBound::Free && !problem.unseen[i]
    });
    let seen = Seen::new(problem.values, &free, bands.clone());
    let normal = seen.normal;

    let prior: Vector =
        problem.parameters.map(|one| one.prior().map_or(0.0, |prior| problem.prior_variance / (prior.sd * prior.sd)));
    let prior_share: Vector = core::array::from_fn(|i| match normal[i][i] + prior[i] {
        total if free[i] && total > 0.0 => prior[i] / total,
        _ => 0.0,
    });
    let (inverse, condition, singular) = invert(&normal, &prior, &free);

    // what no parameter can follow, prior or not; where there are too few directions for that, what the fit leaves
    let parameters: f64 = (0..PARAMETERS).filter(|&i| free[i]).map(|i| 1.0 - prior_share[i]).sum();
    let rest = seen.directions() - 1.0 - parameters;
    let root = Root::new(&normal, &core::array::from_fn(|i| free[i] && !singular[i]));
    let without_priors = seen.directions() - 1.0 - root.rank as f64;
    let (step, degrees_of_freedom) = if prior_share.iter().any(|share| *share > 0.0) && without_priors >= 1.0 {
        (root.solve(&seen.gradient), without_priors)
    } else {
        ([0.0; PARAMETERS], rest)
    };
    let enough = rest > 0.0;
    let clusters = Clusters::new(problem, &free, &step, bands.clone());
    let nu = degrees_of_freedom.max(1.0);
    let pooled = clusters.pooled(problem, bands.clone().next().as_ref(), nu);
    let own = clusters.own(&inverse, &root, &free, nu);
    let known = !enough && problem.known_sd;

    let mut with_prior = if known { normal } else { pooled };
    for i in 0..PARAMETERS {
        // a prior is one more measurement, of variance sd²
        with_prior[i][i] += prior[i] * problem.prior_variance;
    }
    let mut covariance = product(&product(&inverse, &with_prior), &inverse);
    // the larger error of the two, the pooled correlations
    let growth: Vector = core::array::from_fn(|i| {
        let alike = form(&pooled, &inverse[i]);
        let grown = covariance[i][i] + own[i] - alike;
        if !known && own[i] > alike && covariance[i][i] > 0.0 { (grown / covariance[i][i]).sqrt() } else { 1.0 }
    });
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
    let white = clusters.squares / (seen.values - bands.count() as f64 - parameters).max(1.0);
    let trace = |m: &Matrix| -> f64 {
        // in units of each parameter's own information, so that no unit decides
        (0..PARAMETERS).filter(|&i| free[i] && normal[i][i] > 0.0).map(|i| m[i][i] / normal[i][i]).sum()
    };
    let inflation = trace(if known { &normal } else { &pooled }) / (white * trace(&normal));
    let per_direction = seen.values / seen.directions().max(1.0);
    let effective_bands = if inflation.is_finite() && inflation > 0.0 {
        (per_direction / inflation).clamp(1.0, per_direction)
    } else {
        f64::NAN
    };
    Errors { standard_errors, covariance, knowledge, prior_share, condition, effective_bands, degrees_of_freedom }
}

/// (A + priors)⁻¹ of the free parameters and its condition number; parameters that have no error are taken out, and told.
fn invert(normal: &Matrix, prior: &Vector, free: &[bool; PARAMETERS]) -> (Matrix, f64, [bool; PARAMETERS]) {
    let mut singular = [false; PARAMETERS];
    loop {
        let mut matrix = *normal;
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
            (None, Some(inverse)) => return (rescaled(&inverse, &scale), condition(&scaled, &inverse), singular),
            (flat, _) => {
                // the lobe's parameters go first, roughness before index: the order of what a leaf without gloss hides
                let next = flat.or_else(|| [1, 0, 3, 2, 5, 4].into_iter().find(|&i| free[i] && !singular[i]));
                match next {
                    Some(i) if !singular[i] => singular[i] = true,
                    _ => return (ZERO, f64::INFINITY, singular),
                }
            }
        }
    }
}
