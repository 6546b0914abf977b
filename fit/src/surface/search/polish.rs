//! One search: Newton's method in (ln F₀, ln σ, a, b, t_x, t_y, e), over the free ones, priors included.

use leafbrdf_core::Real;

use super::SearchOptions;
use super::treatment::{Prior, Treatment};
use super::valleys::Valley;
use crate::band::profile::{f0_from_n, n_from_f0};
use crate::bounds::{AtBound, Interval};
use crate::solver::{Evaluation, Objective, SolverOptions, Termination, minimize};
use crate::surface::model::{DirectionalModel, N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use crate::surface::profile::{Derivatives, Profile};

/// One search from `start`, over the free parameters.
pub fn polish<T: Real, M: DirectionalModel<T>>(
    profile: &mut Profile<'_, T, M>,
    options: &SearchOptions<T>,
    start: &[T; PARAMETERS],
) -> Valley<T> {
    match options.parameters.iter().filter(|one| one.is_free()).count() {
        0 => polish_free::<T, M, 0>(profile, options, start),
        1 => polish_free::<T, M, 1>(profile, options, start),
        2 => polish_free::<T, M, 2>(profile, options, start),
        3 => polish_free::<T, M, 3>(profile, options, start),
        4 => polish_free::<T, M, 4>(profile, options, start),
        5 => polish_free::<T, M, 5>(profile, options, start),
        6 => polish_free::<T, M, 6>(profile, options, start),
        _ => polish_free::<T, M, PARAMETERS>(profile, options, start),
    }
}

fn polish_free<T: Real, M: DirectionalModel<T>, const P: usize>(
    profile: &mut Profile<'_, T, M>,
    options: &SearchOptions<T>,
    start: &[T; PARAMETERS],
) -> Valley<T> {
    let mut free = [0; P];
    let places = options.parameters.iter().enumerate().filter(|(_, one)| one.is_free());
    for (slot, (place, _)) in free.iter_mut().zip(places) {
        *slot = place;
    }
    let mut x = *start;
    for (x, one) in x.iter_mut().zip(&options.parameters) {
        *x = match one {
            Treatment::Held(value) => *value,
            Treatment::Free { bounds, .. } => bounds.clip(*x),
        };
    }
    if P == 0 {
        let chi2 = profile.chi2(&x).unwrap_or(T::MAX);
        let at_bound = [AtBound::Free; PARAMETERS];
        return Valley { x, cost: chi2, chi2, at_bound, iterations: 0, termination: Termination::Converged };
    }
    let bounds_of = |place: usize| match options.parameters[place] {
        Treatment::Free { bounds, .. } => bounds,
        Treatment::Held(value) => Interval::new(value, value),
    };
    let bounds = free.map(|place| {
        let Interval { lower, upper } = bounds_of(place);
        Interval::new(coordinate(place, lower), coordinate(place, upper))
    });
    let solver = SolverOptions {
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        max_step: free.map(|place| match place {
            N => T::ONE,
            SIGMA => T::lit(0.7),
            TILT_IN_PLANE | TILT_LATERAL => T::lit(0.06),
            _ => T::lit(0.25),
        }),
    };
    let start = free.map(|place| coordinate(place, x[place]));
    let mut objective = Cost { profile, options, free, fixed: x };
    let minimum = minimize(&mut objective, &bounds, &start, &solver);
    let mut x = objective.parameters(&minimum.x).0;
    let mut at_bound = [AtBound::Free; PARAMETERS];
    for (place, at) in free.into_iter().zip(minimum.at_bound) {
        at_bound[place] = at;
        // through logarithms and back leaves a rounding error: on a bound means on it
        let bounds = bounds_of(place);
        x[place] = match at {
            AtBound::Free => bounds.clip(x[place]),
            AtBound::Lower => bounds.lower,
            AtBound::Upper => bounds.upper,
        };
    }
    let cost = minimum.evaluation.cost;
    let chi2 = cost / penalty(options, &x);
    Valley { x, cost, chi2, at_bound, iterations: minimum.iterations, termination: minimum.termination }
}

/// Π = Σ ((x − mean)/sd)² over the priors.
fn prior_misfit<T: Real>(options: &SearchOptions<T>, x: &[T; PARAMETERS]) -> T {
    let of =
        |(one, x): (&Treatment<T>, &T)| one.prior().map_or(T::ZERO, |prior| ((*x - prior.mean) / prior.sd).squared());
    options.parameters.iter().zip(x).map(of).fold(T::ZERO, |sum, term| sum + term)
}

/// exp(Π/ν), no more than can be multiplied with.
pub(super) fn penalty<T: Real>(options: &SearchOptions<T>, x: &[T; PARAMETERS]) -> T {
    (prior_misfit(options, x) / options.draws).min(T::lit(60.0)).exp()
}

/// In which a valley is straight: ln F₀, ln σ; the others as they are.
fn coordinate<T: Real>(place: usize, x: T) -> T {
    match place {
        N => f0_from_n(x).ln(),
        SIGMA => x.ln(),
        _ => x,
    }
}

/// χ² exp(Π/ν) over the free parameters.
///
/// This is the posterior with the residual variance unknown (Jeffreys' prior on its scale, marginalised): minimising
/// ν ln χ² + Π weighs the priors against the variance that the fit itself leaves, χ²/ν, with nothing to be chosen but ν.
struct Cost<'a, 'b, T, M, const P: usize> {
    profile: &'a mut Profile<'b, T, M>,
    options: &'a SearchOptions<T>,
    free: [usize; P],
    fixed: [T; PARAMETERS],
}

impl<T: Real, M: DirectionalModel<T>, const P: usize> Cost<'_, '_, T, M, P> {
    /// [n, σ, a, b, t_x, t_y, e] and their slopes by the coordinates.
    fn parameters(&self, u: &[T; P]) -> ([T; PARAMETERS], [T; PARAMETERS]) {
        let (mut x, mut slope) = (self.fixed, [T::ONE; PARAMETERS]);
        for (place, u) in self.free.iter().zip(u) {
            match *place {
                N => {
                    let f0 = u.exp();
                    let [n, dn, _] = n_from_f0(f0);
                    x[N] = n;
                    slope[N] = dn * f0;
                }
                SIGMA => {
                    x[SIGMA] = u.exp();
                    slope[SIGMA] = x[SIGMA];
                }
                other => x[other] = *u,
            }
        }
        (x, slope)
    }
}

impl<T: Real, M: DirectionalModel<T>, const P: usize> Objective<T, P> for Cost<'_, '_, T, M, P> {
    fn evaluate(&mut self, u: &[T; P]) -> Evaluation<T, P> {
        let (x, slope) = self.parameters(u);
        let Ok(Derivatives { chi2, gradient: g, normal }) = self.profile.derivatives(&x) else {
            // outside the model's domain: a cost that no step is taken for
            return Evaluation {
                cost: T::MAX,
                gradient: [T::ZERO; P],
                hessian: [[T::ZERO; P]; P],
                gauss_newton: [[T::ZERO; P]; P],
            };
        };
        let factor = penalty(self.options, &x);
        let mut gradient = [T::ZERO; P];
        let mut gauss_newton = [[T::ZERO; P]; P];
        for i in 0..P {
            let place = self.free[i];
            gradient[i] = g[place];
            for j in 0..P {
                gauss_newton[i][j] = T::TWO * normal[place][self.free[j]] * factor * slope[place] * slope[self.free[j]];
            }
            if let Some(Prior { mean, sd }) = self.options.parameters[place].prior() {
                // χ² over ν is the variance that a prior is weighed against
                let weight = T::TWO * chi2 / (self.options.draws * sd.squared());
                gradient[i] += weight * (x[place] - mean);
                gauss_newton[i][i] += weight * factor * slope[place].squared();
            }
            gradient[i] = gradient[i] * factor * slope[place];
        }
        Evaluation { cost: chi2 * factor, gradient, hessian: gauss_newton, gauss_newton }
    }
}
