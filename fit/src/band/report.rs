//! What a least-squares fit must say: parameters, standard errors, correlations, χ², and what the data cannot tell.

use leafbrdf_core::Real;

use crate::bounds::{AtBound, BandBounds};
use crate::linear::invert_spd;
use crate::solver::Termination;

/// The result for one band.
#[derive(Clone, Copy, Debug)]
pub struct BandFit<T> {
    /// k_L, n, σ.
    pub parameters: [T; 3],
    /// Standard errors of k_L, n, σ; `None` for a parameter at a bound (held there) or not identifiable.
    ///
    /// They take every value's noise to be independent, and as large as [`noise`](Self::noise) says. A band by itself has no second
    /// look at a direction: where a peak is noisier than the rest and two or three directions see it, errors of n and σ from its own
    /// residuals are too small (49 and 80 % within 1 and 1.96 for a narrow peak, 1 % of the value beside 0.003 sr⁻¹). The other bands
    /// of a leaf have ([`fit_bands`](crate::fit_bands)), and weights 1/sd² mend it too.
    pub standard_errors: [Option<T>; 3],
    /// Where the size of the noise is known from.
    pub noise: Noise,
    /// Correlations (k_L, n), (k_L, σ), (n, σ); `None` where either standard error is.
    pub correlations: [Option<T>; 3],
    /// χ² = Σ ω (BRDF_measured − BRDF_modelled)².
    pub chi2: T,
    /// Values that counted (weight > 0).
    pub n_obs: usize,
    /// Which of k_L, n, σ sit at a bound.
    pub at_bound: [AtBound; 3],
    /// What the data can tell about k_L, n, σ.
    pub identifiability: [Identifiability; 3],
    /// Newton steps over all starts.
    pub iterations: u32,
    /// Starts polished.
    pub starts: u32,
    /// Why the search that won ended.
    pub termination: Termination,
    /// The next best distinct minimum, where one was found.
    pub second: Option<Valley<T>>,
}

/// Another minimum of χ².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valley<T> {
    /// k_L, n, σ there.
    pub parameters: [T; 3],
    /// χ² there.
    pub chi2: T,
}

/// What the data can tell about a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Identifiability {
    /// It has a standard error smaller than the interval it was sought in.
    Identified,
    /// It sits at a bound and is held there: the data ask for a value beyond.
    Held,
    /// The data do not determine it: the normal matrix is singular, or the standard error exceeds the whole interval.
    NotIdentifiable,
    /// There are no more values than free parameters: nothing is left to estimate errors from.
    NoDegreesOfFreedom,
}

/// Are residuals in units of their standard deviations (then χ² has its own scale) or is their variance to be estimated?
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Weights {
    /// ω is 0 or 1, or relative: the residual variance is χ²/(n_obs − free parameters).
    #[default]
    Relative,
    /// ω = 1/sd² with known sd.
    Absolute,
}

/// Where the standard errors of a band have the size of the noise from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// χ²/(values − free parameters) of this band, the same in all directions but for the weights.
    Alike,
    /// Each direction has a size of its own, known from the leaf's other bands; where it is larger, the error by
    /// [`Alike`](Noise::Alike).
    ByDirection,
    /// The sd that came with the data ([`Weights::Absolute`]).
    Known,
}

impl Noise {
    /// In words, for files.
    pub const fn words(self) -> &'static str {
        match self {
            Noise::Alike => "one for all directions, from the band's own residuals",
            Noise::ByDirection => {
                "each direction's own, from neighbouring bands, or one for all directions where that gives the larger error"
            }
            Noise::Known => "the standard deviations of the data",
        }
    }
}

impl<T: Real> BandFit<T> {
    /// √(χ²/n_obs), in sr⁻¹ where every value counts once.
    pub fn rmse(&self) -> T {
        (self.chi2 / T::lit(self.n_obs as f64)).sqrt()
    }

    /// The same numbers in double precision.
    pub fn to_f64(&self) -> BandFit<f64> {
        let numbers = |x: [T; 3]| x.map(T::to_f64);
        BandFit {
            parameters: numbers(self.parameters),
            standard_errors: self.standard_errors.map(|x| x.map(T::to_f64)),
            noise: self.noise,
            correlations: self.correlations.map(|x| x.map(T::to_f64)),
            chi2: self.chi2.to_f64(),
            n_obs: self.n_obs,
            at_bound: self.at_bound,
            identifiability: self.identifiability,
            iterations: self.iterations,
            starts: self.starts,
            termination: self.termination,
            second: self.second.map(|v| Valley { parameters: numbers(v.parameters), chi2: v.chi2.to_f64() }),
        }
    }

    #[cfg_attr(feature = "std", inline(always))]
    #[cfg_attr(not(feature = "std"), inline(never))]
    pub(super) fn new(
        best: &Candidate<T>,
        total_weight: T,
        n_obs: usize,
        bounds: &BandBounds<T>,
        weights: Weights,
    ) -> Self {
        let point = best;
        let free: [bool; 3] = best.at_bound.map(|at| at == AtBound::Free);
        let free_count = free.iter().filter(|free| **free).count();

        // normal matrix of (k_L, n, σ); a held parameter is taken out by a unit row
        let inv_pi = T::lit(core::f64::consts::FRAC_1_PI);
        let mut normal = [
            [total_weight * inv_pi.squared(), point.s[0] * inv_pi, point.s[1] * inv_pi],
            [point.s[0] * inv_pi, point.s_s[0], point.s_s[1]],
            [point.s[1] * inv_pi, point.s_s[1], point.s_s[2]],
        ];
        for i in 0..3 {
            for j in 0..3 {
                if !(free[i] && free[j]) {
                    normal[i][j] = if i == j { T::ONE } else { T::ZERO };
                }
            }
        }
        let variance = match weights {
            Weights::Absolute => T::ONE,
            Weights::Relative => point.cost / T::lit(n_obs.saturating_sub(free_count).max(1) as f64),
        };
        let enough = match weights {
            Weights::Absolute => n_obs >= free_count,
            Weights::Relative => n_obs > free_count,
        };

        let widths = [bounds.k_lambert.width(), bounds.n.width(), bounds.sigma.width()];
        let (covariance, singular) = covariance(&normal, &free);
        let mut standard_errors = [None; 3];
        let mut identifiability = [Identifiability::Identified; 3];
        for i in 0..3 {
            let error = (variance * covariance[i][i]).sqrt();
            identifiability[i] = if !free[i] {
                Identifiability::Held
            } else if !enough {
                Identifiability::NoDegreesOfFreedom
            } else if singular[i] || !(error <= widths[i]) {
                Identifiability::NotIdentifiable
            } else {
                standard_errors[i] = Some(error);
                Identifiability::Identified
            };
        }
        let correlation = |i: usize, j: usize| match (standard_errors[i], standard_errors[j]) {
            (Some(_), Some(_)) => Some(covariance[i][j] / (covariance[i][i] * covariance[j][j]).sqrt()),
            _ => None,
        };
        BandFit {
            parameters: [point.k_lambert, best.n, best.sigma],
            standard_errors,
            noise: match weights {
                Weights::Absolute => Noise::Known,
                Weights::Relative => Noise::Alike,
            },
            correlations: [correlation(0, 1), correlation(0, 2), correlation(1, 2)],
            chi2: point.cost,
            n_obs,
            at_bound: best.at_bound,
            identifiability,
            iterations: best.iterations,
            starts: 0,
            termination: best.termination,
            second: None,
        }
    }
}

/// The inverse of the normal matrix. Where it is singular, n and σ (the lobe) are taken out one after the other, σ first: they
/// are marked, and the rest keeps its errors.
#[cfg_attr(feature = "std", inline(always))]
pub(crate) fn covariance<T: Real>(normal: &[[T; 3]; 3], free: &[bool; 3]) -> ([[T; 3]; 3], [bool; 3]) {
    let mut matrix = *normal;
    let mut singular = [false; 3];
    for out in [3, 2, 1, 0] {
        if out < 3 {
            singular[out] = free[out];
            for i in 0..3 {
                matrix[out][i] = T::ZERO;
                matrix[i][out] = T::ZERO;
            }
            matrix[out][out] = T::ONE;
        }
        if let Some(inverse) = scaled_inverse(&matrix) {
            return (inverse, singular);
        }
    }
    ([[T::ZERO; 3]; 3], *free)
}

/// A⁻¹ by way of the matrix of unit diagonal, so that the units of k_L, n and σ do not decide what counts as singular.
#[cfg_attr(feature = "std", inline(always))]
#[cfg_attr(not(feature = "std"), inline(never))]
fn scaled_inverse<T: Real>(a: &[[T; 3]; 3]) -> Option<[[T; 3]; 3]> {
    let mut scale = [T::ONE; 3];
    for i in 0..3 {
        if !(a[i][i] > T::ZERO && a[i][i].is_finite()) {
            return None;
        }
        scale[i] = T::ONE / a[i][i].sqrt();
    }
    // loops of known length: behind a closure the compiler may keep a bounds check, and with it a panic on a device
    let rescale = |m: &[[T; 3]; 3]| -> [[T; 3]; 3] {
        let mut scaled = *m;
        for i in 0..3 {
            for j in 0..3 {
                scaled[i][j] = m[i][j] * scale[i] * scale[j];
            }
        }
        scaled
    };
    invert_spd(&rescale(a)).map(|inverse| rescale(&inverse))
}

/// A minimum that a search has found.
#[derive(Clone, Copy)]
pub(super) struct Candidate<T> {
    pub n: T,
    pub sigma: T,
    pub k_lambert: T,
    /// χ²
    pub cost: T,
    /// Σ ω s_p and Σ ω s_p s_q: the normal matrix of (k_L, n, σ)
    pub s: [T; 2],
    pub s_s: [T; 3],
    pub at_bound: [AtBound; 3],
    pub iterations: u32,
    pub termination: Termination,
}

impl<T: Real> Candidate<T> {
    pub fn valley(&self) -> Valley<T> {
        Valley { parameters: [self.k_lambert, self.n, self.sigma], chi2: self.cost }
    }
}
