//! What an inversion says: parameters, standard errors, correlations, χ², and what the spectra cannot tell.

use leafbrdf_core::Real;
use leafbrdf_prospect::{Lanes, LeafParams, Parameter};

use super::{Free, HemisphericalOptions};
use crate::band::{Identifiability, Weights};
use crate::bounds::AtBound;
use crate::linear::invert_spd;
use crate::solver::{Minimum, Termination};

/// The best leaf for the spectra.
#[derive(Clone, Copy, Debug)]
pub struct HemisphericalFit<T, const P: usize> {
    /// The leaf: free parameters as found, the others as held.
    pub leaf: LeafParams<T>,
    /// The free parameters, in the order asked for.
    pub parameters: [Parameter; P],
    /// Their values.
    pub values: [T; P],
    /// Their standard errors, in their units; `None` for a parameter at a bound (held there) or not identifiable.
    pub standard_errors: [Option<T>; P],
    /// Their correlations; `None` where either standard error is.
    pub correlations: [[Option<T>; P]; P],
    /// Which of them sit at a bound.
    pub at_bound: [AtBound; P],
    /// What the spectra can tell about each.
    pub identifiability: [Identifiability; P],
    /// χ² = Σ ω (measured − modelled)².
    pub chi2: T,
    /// Values that counted (weight > 0).
    pub n_obs: usize,
    /// As many independent values would carry the same information, residuals of neighbouring wavelengths being alike:
    /// Σ n (1 − ρ)/(1 + ρ) over the spectra, ρ ≥ 0 being the correlation of neighbouring residuals.
    ///
    /// The standard errors are those of a plain count times √(n_obs/n_effective): what is right for residuals that
    /// forget exponentially (AR(1)) and a model that changes slowly from band to band. White noise leaves them alone; a smooth
    /// misfit makes them many times larger. Equal to n_obs where the weights are absolute, or
    /// [`HemisphericalOptions::correlated_residuals`] is off.
    pub n_effective: T,
    /// Residuals of the reflectance.
    pub reflectance: Option<Residuals<T>>,
    /// Residuals of the transmittance.
    pub transmittance: Option<Residuals<T>>,
    /// Steps over all starts.
    pub iterations: u32,
    /// Starts searched from.
    pub starts: u32,
    /// Of these, how many arrived at this minimum (within a thousandth of each parameter's interval).
    pub agreeing: u32,
    /// Why the search that won ended.
    pub termination: Termination,
    /// The next best distinct place where a search ended.
    pub second: Option<OtherMinimum<T>>,
}

/// Another place where a search ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherMinimum<T> {
    /// The leaf there.
    pub leaf: LeafParams<T>,
    /// χ² there.
    pub chi2: T,
}

/// What is left over of one spectrum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residuals<T> {
    /// Values that counted.
    pub n_obs: usize,
    /// Σ (measured − modelled)², unweighted.
    pub squares: T,
    /// Σ ω.
    weight: T,
    /// Mean of the values and Σ (value − mean)².
    mean: T,
    spread: T,
    /// Σ r_i r_{i+1} and Σ (r_i² + r_{i+1}²)/2 of neighbours, r = √ω residual.
    lagged: T,
    paired: T,
    before: Option<T>,
}

impl<T: Real> Residuals<T> {
    pub(super) fn new() -> Self {
        let zero = T::ZERO;
        Residuals {
            n_obs: 0,
            squares: zero,
            weight: zero,
            mean: zero,
            spread: zero,
            lagged: zero,
            paired: zero,
            before: None,
        }
    }

    pub(super) fn push(&mut self, value: T, residual: T, weight: T) {
        if !(weight > T::ZERO) {
            self.before = None;
            return;
        }
        self.n_obs += 1;
        self.squares += residual.squared();
        self.weight += weight;
        // Welford: no cancellation
        let off = value - self.mean;
        self.mean += off / T::lit(self.n_obs as f64);
        self.spread += off * (value - self.mean);
        let scaled = residual * weight.sqrt();
        if let Some(before) = self.before {
            self.lagged += before * scaled;
            self.paired += T::HALF * (before.squared() + scaled.squared());
        }
        self.before = Some(scaled);
    }

    /// √(Σ residual²/n), a fraction.
    pub fn rmse(&self) -> T {
        (self.squares / T::lit(self.n_obs as f64)).sqrt()
    }

    /// 1 − Σ residual²/Σ (value − mean)².
    pub fn r2(&self) -> T {
        T::ONE - self.squares / self.spread
    }

    /// Correlation of the residuals of neighbouring wavelengths, cut to [0, 1].
    pub fn neighbour_correlation(&self) -> T {
        if self.paired > T::ZERO { (self.lagged / self.paired).max(T::ZERO).min(T::ONE) } else { T::ZERO }
    }

    /// n (1 − ρ)/(1 + ρ), at least 2 (and at most n).
    fn n_effective(&self) -> T {
        let rho = self.neighbour_correlation();
        let n = T::lit(self.n_obs as f64);
        (n * (T::ONE - rho) / (T::ONE + rho)).max(T::TWO).min(n)
    }
}

/// What the searches have found.
pub(super) struct Found<T, const P: usize> {
    pub leaf: LeafParams<T>,
    pub minimum: Minimum<T, P>,
    /// dC/dx.
    pub slopes: [T; P],
    pub residuals: [Option<Residuals<T>>; 2],
    pub n_obs: usize,
    pub second: Option<(LeafParams<T>, T)>,
    pub iterations: u32,
    pub starts: u32,
    pub agreeing: u32,
}

impl<T: Lanes, const P: usize> HemisphericalFit<T, P> {
    pub(super) fn new(found: &Found<T, P>, free: &[Free<T>; P], options: &HemisphericalOptions<T>) -> Self {
        let minimum = &found.minimum;
        let is_free: [bool; P] = minimum.at_bound.map(|at| at == AtBound::Free);
        let count = is_free.iter().filter(|free| **free).count();
        let chi2 = minimum.evaluation.cost;
        let n_obs = T::lit(found.n_obs as f64);

        let mut n_effective = n_obs;
        if options.correlated_residuals && options.weights == Weights::Relative {
            n_effective = T::ZERO;
            for residuals in found.residuals.iter().flatten() {
                n_effective += residuals.n_effective();
            }
        }
        let absolute = options.weights == Weights::Absolute;
        let variance = if absolute {
            T::ONE
        } else {
            chi2 / T::lit(found.n_obs.saturating_sub(count).max(1) as f64) * (n_obs / n_effective)
        };
        // what an error of measurement that nobody could see would leave
        let mut weight = T::ZERO;
        for residuals in found.residuals.iter().flatten() {
            weight += residuals.weight;
        }
        let least = if absolute { T::ONE } else { options.least_error.squared() * weight / n_obs };
        let enough = if absolute { found.n_obs >= count } else { found.n_obs > count };

        // the Gauss–Newton matrix is twice the normal matrix
        let normal = minimum.evaluation.gauss_newton.map(|row| row.map(|value| T::HALF * value));
        let covariance = covariance(&normal, &is_free);
        let mut standard_errors = [None; P];
        let mut identifiability = [Identifiability::Identified; P];
        for i in 0..P {
            let unit = covariance[i][i].map(|c| c.sqrt() * found.slopes[i]);
            identifiability[i] = match unit {
                _ if !is_free[i] => Identifiability::Held,
                _ if !enough => Identifiability::NoDegreesOfFreedom,
                Some(unit) if unit * variance.max(least).sqrt() <= free[i].bounds.width() => {
                    standard_errors[i] = Some(unit * variance.sqrt());
                    Identifiability::Identified
                }
                _ => Identifiability::NotIdentifiable,
            };
        }
        // loops rather than `from_fn`, in whose closures checks of the bounds stay
        let mut correlations = [[None; P]; P];
        for i in 0..P {
            for j in 0..P {
                let variances = (covariance[i][j], covariance[i][i], covariance[j][j]);
                if let (Some(_), Some(_), (Some(both), Some(one), Some(other))) =
                    (standard_errors[i], standard_errors[j], variances)
                {
                    correlations[i][j] = Some(both / (one * other).sqrt());
                }
            }
        }
        let parameters = free.map(|free| free.parameter);
        let [reflectance, transmittance] = found.residuals;
        HemisphericalFit {
            leaf: found.leaf,
            parameters,
            values: parameters.map(|parameter| found.leaf.get(parameter)),
            standard_errors,
            correlations,
            at_bound: minimum.at_bound,
            identifiability,
            chi2,
            n_obs: found.n_obs,
            n_effective,
            reflectance,
            transmittance,
            iterations: found.iterations,
            starts: found.starts,
            agreeing: found.agreeing,
            termination: minimum.termination,
            second: found.second.map(|(leaf, chi2)| OtherMinimum { leaf, chi2 }),
        }
    }

    /// √(Σ residual²/n) over all values, a fraction.
    pub fn rmse(&self) -> T {
        let mut squares = T::ZERO;
        for residuals in [&self.reflectance, &self.transmittance].into_iter().flatten() {
            squares += residuals.squares;
        }
        (squares / T::lit(self.n_obs as f64)).sqrt()
    }
}

/// The inverse of the normal matrix over the free parameters; `None` for a parameter that the spectra do not determine at all.
///
/// Scaled to unit diagonal first, so that units do not decide what counts as singular. Where the rest is singular all the
/// same, a ridge of a few roundings is added: the parameters that lean on each other then come out with enormous
/// variances, and those that do not are left as they are.
fn covariance<T: Real, const P: usize>(normal: &[[T; P]; P], free: &[bool; P]) -> [[Option<T>; P]; P] {
    let mut scale = [T::ZERO; P];
    for i in 0..P {
        let diagonal = normal[i][i];
        if free[i] && diagonal > T::ZERO && diagonal.is_finite() {
            scale[i] = T::ONE / diagonal.sqrt();
        }
    }
    let known = scale.map(|s| s > T::ZERO && s.is_finite());
    let mut ridge = T::ZERO;
    for _ in 0..40 {
        let mut matrix = [[T::ZERO; P]; P];
        for i in 0..P {
            for j in 0..P {
                if known[i] && known[j] {
                    matrix[i][j] = normal[i][j] * scale[i] * scale[j];
                }
            }
            matrix[i][i] = T::ONE + ridge;
        }
        if let Some(inverse) = invert_spd(&matrix) {
            return core::array::from_fn(|i| {
                core::array::from_fn(|j| (known[i] && known[j]).then(|| inverse[i][j] * scale[i] * scale[j]))
            });
        }
        ridge = (ridge + ridge).max(T::lit(4.0) * T::EPSILON);
    }
    [[None; P]; P]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parameter_without_influence_has_no_variance_and_leaves_the_others_alone() {
        let normal = [[4.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 2.0_f64]];
        let covariance = covariance(&normal, &[true; 3]);
        assert_eq!(covariance[1][1], None);
        // inverse of [[4, 1], [1, 2]] is [[2, −1], [−1, 4]]/7
        assert!((covariance[0][0].unwrap() - 2.0 / 7.0).abs() < 1e-15);
        assert!((covariance[0][2].unwrap() + 1.0 / 7.0).abs() < 1e-15);
    }

    #[test]
    fn two_parameters_that_do_the_same_have_enormous_variances_and_the_third_its_own() {
        let normal = [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 4.0_f64]];
        let covariance = covariance(&normal, &[true; 3]);
        assert!(covariance[0][0].unwrap() > 1e12 && covariance[1][1].unwrap() > 1e12);
        assert!((covariance[2][2].unwrap() - 0.25).abs() < 1e-14);
    }

    #[test]
    fn residuals_that_repeat_themselves_count_as_fewer() {
        let mut alternating = Residuals::<f64>::new();
        let mut blocks = Residuals::<f64>::new();
        for i in 0..400 {
            alternating.push(0.4, if i % 2 == 0 { 0.01 } else { -0.01 }, 1.0);
            blocks.push(0.4, if (i / 20) % 2 == 0 { 0.01 } else { -0.01 }, 1.0);
        }
        assert_eq!(alternating.n_effective(), 400.0);
        // 19 changes of sign among 399 pairs: ρ = 1 − 2·19/399
        let rho = 1.0 - 38.0 / 399.0;
        assert!((blocks.n_effective() - 400.0 * (1.0 - rho) / (1.0 + rho)).abs() < 1e-9);
        assert!((blocks.rmse() - 0.01).abs() < 1e-15);
    }
}
