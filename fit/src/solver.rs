//! Bounded minimisation by damped Newton steps that stay inside the box.
//!
//! Each step solves M s = −g with M = H + diag(λ/v_i), v_i being the distance to the bound that −g_i points at, so that damping
//! holds back first what is near its bound (the scaling of Coleman and Li 1996). A parameter whose step would leave the box
//! goes 99.5 % of the way to its bound, and the others are solved for again, knowing that: it approaches the bound by a factor
//! of 200 a step, never touches it, and never leaves the others behind, as happens where parameters are clamped or where the
//! whole step is cut. H is the exact Hessian where that is positive definite, else Gauss and Newton's.
//! Where no such step promises anything more, a parameter whose own slope points back inside is let go, if that lowers the cost.

use leafbrdf_core::Real;

use crate::bounds::{AtBound, Interval};

/// The objective at one point: cost, gradient, exact Hessian, and its Gauss–Newton part (positive semidefinite).
#[derive(Clone, Copy, Debug)]
pub struct Evaluation<T, const P: usize> {
    /// The cost, ≥ 0.
    pub cost: T,
    /// ∂cost/∂x.
    pub gradient: [T; P],
    /// ∂²cost/∂x².
    pub hessian: [[T; P]; P],
    /// The part of the Hessian without the residuals' own curvature.
    pub gauss_newton: [[T; P]; P],
}

/// A cost with derivatives, to be minimised over P parameters.
pub trait Objective<T, const P: usize> {
    /// Cost and derivatives at `x`, which lies inside the bounds.
    fn evaluate(&mut self, x: &[T; P]) -> Evaluation<T, P>;
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The next step would lower the cost by less than the tolerance.
    Converged,
    /// No step, however short, lowers the cost any more: rounding is all that is left.
    AtRounding,
    /// The limit on iterations was reached first.
    MaxIterations,
}

impl Termination {
    /// A minimum was found, to the tolerance or to rounding.
    pub fn converged(self) -> bool {
        self != Termination::MaxIterations
    }
}

/// When to stop, and how far to go at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverOptions<T, const P: usize> {
    /// Stop where the predicted decrease is below this share of the cost.
    pub tolerance: T,
    /// The most steps, accepted or not.
    pub max_iterations: u32,
    /// The longest step in each parameter.
    pub max_step: [T; P],
}

/// Where a search ended.
#[derive(Clone, Copy, Debug)]
pub struct Minimum<T, const P: usize> {
    /// The parameters.
    pub x: [T; P],
    /// Cost and derivatives there.
    pub evaluation: Evaluation<T, P>,
    /// Which parameters sit at a bound.
    pub at_bound: [AtBound; P],
    /// Steps taken, accepted or not.
    pub iterations: u32,
    /// Why the search ended.
    pub termination: Termination,
}

/// How near to a bound, in widths of the interval, a parameter that is pushed outwards counts as sitting there.
const BOUND_MARGIN: f64 = 1e-5;

/// Minimises `objective` over the box from `start` (from a point just inside, where it touches a bound or lies beyond).
///
/// The model is never evaluated outside the bounds, and the cost returned is never above that of the start.
#[cfg_attr(feature = "std", inline(always))]
pub fn minimize<T: Real, const P: usize, O: Objective<T, P>>(
    objective: &mut O,
    bounds: &[Interval<T>; P],
    start: &[T; P],
    options: &SolverOptions<T, P>,
) -> Minimum<T, P> {
    let (mut asked, mut x) = (*start, *start);
    for ((asked, x), bound) in asked.iter_mut().zip(&mut x).zip(bounds) {
        *asked = bound.clip(*asked);
        *x = bound.inside(*x, T::lit(1e-3));
    }
    // a start at a bound is looked at as it is, and left only for something better
    let moved = x.iter().zip(&asked).any(|(x, asked)| x != asked);
    let at_start = if moved { Some(objective.evaluate(&asked)) } else { None };
    let mut here = objective.evaluate(&x);
    let mut lambda = T::ZERO;
    let mut iterations = 0;
    let mut termination = Termination::MaxIterations;

    while iterations < options.max_iterations {
        iterations += 1;
        let distance = distances(&x, &here.gradient, bounds);
        let Some(step) = propose(&here, &x, bounds, &distance, &mut lambda) else {
            termination = Termination::AtRounding;
            break;
        };
        let (trial, step) = shorten(&x, &step, bounds, &options.max_step);
        let predicted = predicted_decrease(&here, &step);
        if predicted.abs() <= options.tolerance * here.cost {
            if let Some(trial) = back_inside(&here, &x, bounds, options.tolerance) {
                let there = objective.evaluate(&trial);
                if there.cost < here.cost {
                    (x, here) = (trial, there);
                    continue;
                }
            }
            termination = Termination::Converged;
            break;
        }
        if predicted < T::ZERO {
            // parameters sent to their bounds spoil the step of the others: hold back
            lambda = (T::lit(8.0) * lambda).max(T::lit(0.25) * largest_abs(&here.gradient));
            continue;
        }
        let there = objective.evaluate(&trial);
        let actual = here.cost - there.cost;
        let largest = largest_abs(&here.gradient);
        // NaN in the cost fails this test and shortens the step
        if actual > T::ZERO {
            let ratio = actual / predicted;
            if ratio > T::lit(0.5) {
                lambda *= T::lit(0.1);
                if lambda < T::lit(1e-4) * largest {
                    lambda = T::ZERO;
                }
            } else if ratio < T::lit(0.1) {
                lambda = (T::lit(4.0) * lambda).max(T::lit(0.1) * largest);
            }
            x = trial;
            here = there;
        } else {
            lambda = (T::lit(8.0) * lambda).max(T::lit(0.25) * largest);
            if predicted <= T::lit(64.0) * T::EPSILON * here.cost || !(lambda < T::lit(1e12) * largest) {
                termination = Termination::AtRounding;
                break;
            }
        }
    }

    let (x, here, at_bound) = match at_start {
        Some(there) if there.cost < here.cost => settle(objective, bounds, asked, there),
        _ => settle(objective, bounds, x, here),
    };
    Minimum { x, evaluation: here, at_bound, iterations, termination }
}

/// Distance of each parameter to the bound that the descent direction points at.
#[inline(always)]
fn distances<T: Real, const P: usize>(x: &[T; P], gradient: &[T; P], bounds: &[Interval<T>; P]) -> [T; P] {
    core::array::from_fn(|i| if gradient[i] < T::ZERO { bounds[i].upper - x[i] } else { x[i] - bounds[i].lower })
}

/// The damped step, with blocked parameters on the way to their bounds; `None` where even a strongly damped M is not positive
/// definite (nothing finite is left).
#[cfg_attr(feature = "std", inline(always))]
fn propose<T: Real, const P: usize>(
    here: &Evaluation<T, P>,
    x: &[T; P],
    bounds: &[Interval<T>; P],
    distance: &[T; P],
    lambda: &mut T,
) -> Option<[T; P]> {
    let largest = largest_abs(&here.gradient);
    for attempt in 0..24_u32 {
        let mut m = if attempt == 0 { here.hessian } else { here.gauss_newton };
        for i in 0..P {
            m[i][i] += *lambda / distance[i];
        }
        if let Some(step) = solve_inside(&m, &here.gradient, x, bounds) {
            return Some(step);
        }
        if attempt > 0 {
            *lambda = (T::lit(8.0) * *lambda).max(T::lit(1e-3) * largest);
        }
    }
    None
}

/// The way of one parameter alone that promises most, where a step of all promises nothing more: one that the others have sent to
/// its bound and whose own slope points back inside. In a minimum no way of one promises more than the step of all.
#[cfg_attr(feature = "std", inline(always))]
fn back_inside<T: Real, const P: usize>(
    here: &Evaluation<T, P>,
    x: &[T; P],
    bounds: &[Interval<T>; P],
    tolerance: T,
) -> Option<[T; P]> {
    let mut best: Option<(T, [T; P])> = None;
    for i in 0..P {
        let (slope, curvature) = (here.gradient[i], here.gauss_newton[i][i]);
        if !(curvature > T::ZERO) {
            continue;
        }
        let mut trial = *x;
        trial[i] = bounds[i].inside(x[i] - slope / curvature, T::lit(1e-3));
        let s = trial[i] - x[i];
        let decrease = -s * (slope + T::HALF * curvature * s);
        let least = best.map_or(T::lit(8.0) * tolerance * here.cost, |(decrease, _)| decrease);
        if decrease > least {
            best = Some((decrease, trial));
        }
    }
    best.map(|(_, trial)| trial)
}

/// −M⁻¹g inside the box: while a parameter's step would leave it, the one that leaves it first (as a share of its step) is
/// sent 99.5 % of the way to its bound, and the rest is solved for again.
#[cfg_attr(feature = "std", inline(always))]
fn solve_inside<T: Real, const P: usize>(
    m: &[[T; P]; P],
    gradient: &[T; P],
    x: &[T; P],
    bounds: &[Interval<T>; P],
) -> Option<[T; P]> {
    let mut held: [Option<T>; P] = [None; P];
    let mut step = crate::linear::solve_spd(m, gradient)?.map(|s| -s);
    for _ in 0..P {
        let mut first: Option<(usize, T, T)> = None;
        for i in 0..P {
            let s = step[i];
            let room = if s < T::ZERO { bounds[i].lower - x[i] } else { bounds[i].upper - x[i] };
            if held[i].is_none() && s.abs() >= room.abs() {
                let share = room / s;
                if first.is_none_or(|(_, least, _)| share < least) {
                    first = Some((i, share, T::lit(0.995) * room));
                }
            }
        }
        let Some((i, _, s)) = first else { break };
        held[i] = Some(s);
        let mut reduced = *m;
        let mut right = gradient.map(|g| -g);
        for i in 0..P {
            if let Some(s) = held[i] {
                for j in 0..P {
                    if held[j].is_none() {
                        right[j] -= m[j][i] * s;
                    }
                    reduced[i][j] = T::ZERO;
                    reduced[j][i] = T::ZERO;
                }
            }
        }
        for i in 0..P {
            if let Some(s) = held[i] {
                reduced[i][i] = T::ONE;
                right[i] = s;
            }
        }
        step = crate::linear::solve_spd(&reduced, &right)?;
    }
    Some(step)
}

/// The step cut to the longest allowed one, and the point it leads to.
#[cfg_attr(feature = "std", inline(always))]
fn shorten<T: Real, const P: usize>(
    x: &[T; P],
    step: &[T; P],
    bounds: &[Interval<T>; P],
    max_step: &[T; P],
) -> ([T; P], [T; P]) {
    let mut scale = T::ONE;
    for i in 0..P {
        let s = step[i].abs();
        if s * scale > max_step[i] {
            scale = max_step[i] / s;
        }
    }
    let step = step.map(|s| s * scale);
    (core::array::from_fn(|i| bounds[i].clip(x[i] + step[i])), step)
}

/// −(gᵀs + ½ sᵀHs), with the Hessian that made the step where it is convex along it.
#[cfg_attr(feature = "std", inline(always))]
fn predicted_decrease<T: Real, const P: usize>(here: &Evaluation<T, P>, step: &[T; P]) -> T {
    let mut slope = T::ZERO;
    let mut exact = T::ZERO;
    let mut approximate = T::ZERO;
    for i in 0..P {
        slope += here.gradient[i] * step[i];
        for j in 0..P {
            exact += here.hessian[i][j] * step[i] * step[j];
            approximate += here.gauss_newton[i][j] * step[i] * step[j];
        }
    }
    let curvature = if exact > T::ZERO { exact } else { approximate };
    -(slope + T::HALF * curvature)
}

#[inline(always)]
fn largest_abs<T: Real, const P: usize>(values: &[T; P]) -> T {
    values.iter().fold(T::ZERO, |most, x| most.max(x.abs()))
}

/// Parameters that the search has driven to within a hair of a bound are set on it, if the cost agrees.
#[cfg_attr(feature = "std", inline(always))]
fn settle<T: Real, const P: usize, O: Objective<T, P>>(
    objective: &mut O,
    bounds: &[Interval<T>; P],
    x: [T; P],
    here: Evaluation<T, P>,
) -> ([T; P], Evaluation<T, P>, [AtBound; P]) {
    let mut at_bound = [AtBound::Free; P];
    let mut settled = x;
    for i in 0..P {
        let margin = T::lit(BOUND_MARGIN) * bounds[i].width();
        if here.gradient[i] < T::ZERO && bounds[i].upper - x[i] <= margin {
            at_bound[i] = AtBound::Upper;
            settled[i] = bounds[i].upper;
        } else if here.gradient[i] > T::ZERO && x[i] - bounds[i].lower <= margin {
            at_bound[i] = AtBound::Lower;
            settled[i] = bounds[i].lower;
        }
    }
    if at_bound.iter().all(|at| *at == AtBound::Free) {
        return (x, here, at_bound);
    }
    if settled == x {
        // on the bound already: a second look would differ by rounding only
        return (x, here, at_bound);
    }
    let there = objective.evaluate(&settled);
    // within a hair of the bound the costs differ by rounding, which is larger where the cost was first looked at from afar: then
    // it is looked at once more
    let mut here = here;
    for again in [true, false] {
        if there.cost <= here.cost + T::lit(64.0) * T::EPSILON * here.cost {
            return (settled, there, at_bound);
        }
        if again {
            here = objective.evaluate(&x);
        }
    }
    (x, here, [AtBound::Free; P])
}
