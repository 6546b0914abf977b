//! What the inversion of a device says.

use leafbrdf_core::Real;

use super::search::{Point, Problem, snap};
use crate::band::{BandOptions, Weights};
use crate::bounds::{AtBound, Interval};

/// The result for one band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit<T> {
    /// k_L, n, σ.
    pub parameters: [T; 3],
    /// Standard errors of k_L, n, σ; `None` for a parameter at a bound (held there) or not identifiable.
    pub standard_errors: [Option<T>; 3],
    /// √(χ²/n_obs), in sr⁻¹ where every value counts once.
    pub rmse: T,
    /// Values that counted (weight > 0).
    pub n_obs: usize,
    /// Which of k_L, n, σ sit at a bound.
    pub at_bound: [AtBound; 3],
    /// Steps over all starts: passes over the directions.
    pub iterations: u32,
    /// The search arrived at a minimum; `false`: it ran out of steps.
    pub converged: bool,
}

impl<T: Real> Fit<T> {
    /// The same numbers in double precision.
    pub fn to_f64(&self) -> Fit<f64> {
        Fit {
            parameters: self.parameters.map(T::to_f64),
            standard_errors: self.standard_errors.map(|x| x.map(T::to_f64)),
            rmse: self.rmse.to_f64(),
            n_obs: self.n_obs,
            at_bound: self.at_bound,
            iterations: self.iterations,
            converged: self.converged,
        }
    }

    #[inline(always)]
    pub(super) fn new(best: &Point<T>, problem: &Problem<'_, T>, n_obs: usize, options: &BandOptions<T>) -> Self {
        let bounds = &options.bounds;
        let at_bound = [
            held(best.a, best.g[0], &problem.a),
            held(best.e, best.g[1], &problem.e),
            held(best.sigma, best.g[2], &problem.sigma),
        ];
        let [k_at, n_at, sigma_at] = at_bound;
        let (k_free, n_free, sigma_free) = (k_at == AtBound::Free, n_at == AtBound::Free, sigma_at == AtBound::Free);
        let k_lambert = snap(best.a * T::PI, &bounds.k_lambert);
        let n = snap((best.e + T::ONE).sqrt(), &bounds.n);

        // h⁻¹ in numbers that neither over- nor underflow. A parameter that is held, or that the data say nothing about, has no row:
        // n where it changes the data as k_L does, σ where it changes them as the two do
        let [mut h_0, mut h_01, h_1] = best.h;
        let [mut m_0, mut m_1] = best.mean;
        let rounding = T::lit(4.0) * T::EPSILON;
        let n_known = n_free && h_0 > rounding * (h_0 + problem.total * m_0.squared());
        if !n_known {
            (h_0, h_01, m_0) = (T::ONE, T::ZERO, T::ZERO);
        }
        let i_0 = T::ONE / h_0;
        let t = h_01 * i_0;
        let left = h_1 - t * h_01;
        let sigma_known = sigma_free && (n_known || !n_free) && left > rounding * (h_1 + problem.total * m_1.squared());
        let i_1 = if sigma_known { T::ONE / left } else { T::ZERO };
        m_1 -= t * m_0;

        let free = usize::from(k_free) + usize::from(n_free) + usize::from(sigma_free);
        let (spare, variance) = match options.weights {
            Weights::Absolute => (n_obs >= free, T::ONE),
            Weights::Relative => (n_obs > free, best.cost / T::lit((n_obs - free).max(1) as f64)),
        };
        let per_known = if spare { variance } else { -T::ONE };
        let error = |known: bool, inverse: T, scale: T, bounds: &Interval<T>| {
            if known { error(per_known * inverse, scale, bounds) } else { None }
        };
        Fit {
            parameters: [k_lambert, n, best.sigma],
            standard_errors: [
                error(
                    k_free,
                    T::ONE / problem.total + (m_0.squared() * i_0 + m_1.squared() * i_1),
                    T::PI,
                    &bounds.k_lambert,
                ),
                error(n_known, i_0 + t.squared() * i_1, T::HALF * best.e / n, &bounds.n),
                error(sigma_known, i_1, best.sigma, &bounds.sigma),
            ],
            rmse: (best.cost / T::lit(n_obs as f64)).sqrt(),
            n_obs,
            at_bound,
            iterations: 0,
            converged: false,
        }
    }
}

/// Is a parameter at a bound, and do the data ask for more?
#[inline(never)]
fn held<T: Real>(x: T, g: T, bounds: &Interval<T>) -> AtBound {
    if x <= bounds.lower && g > T::ZERO {
        AtBound::Lower
    } else if x >= bounds.upper && g < T::ZERO {
        AtBound::Upper
    } else {
        AtBound::Free
    }
}

/// A standard error, unless it is longer than the interval (or NaN): then the data say nothing about the parameter.
#[inline(never)]
fn error<T: Real>(variance: T, scale: T, bounds: &Interval<T>) -> Option<T> {
    let error = variance.sqrt() * scale;
    (error <= bounds.width()).then_some(error)
}
