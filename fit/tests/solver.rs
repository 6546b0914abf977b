//! The bounded minimiser by itself, on functions whose minima are known.

use leafbrdf_fit::solver::{Evaluation, Objective, SolverOptions, Termination, minimize};
use leafbrdf_fit::{AtBound, Interval};

/// Rosenbrock's valley, written as two squares; remembers where it was asked.
struct Rosenbrock {
    bounds: [Interval<f64>; 2],
    highest_cost_accepted: Vec<f64>,
}

impl Objective<f64, 2> for Rosenbrock {
    fn evaluate(&mut self, x: &[f64; 2]) -> Evaluation<f64, 2> {
        for (x, bound) in x.iter().zip(self.bounds) {
            assert!(*x >= bound.lower && *x <= bound.upper, "asked outside the bounds: {x} {bound:?}");
        }
        let [a, b] = *x;
        let (r, s) = (1.0 - a, 10.0 * (b - a * a));
        let cost = r * r + s * s;
        self.highest_cost_accepted.push(cost);
        Evaluation {
            cost,
            gradient: [-2.0 * r - 40.0 * a * s, 20.0 * s],
            hessian: [[2.0 + 800.0 * a * a - 40.0 * s, -400.0 * a], [-400.0 * a, 200.0]],
            gauss_newton: [[2.0 + 800.0 * a * a, -400.0 * a], [-400.0 * a, 200.0]],
        }
    }
}

const OPTIONS: SolverOptions<f64, 2> =
    SolverOptions { tolerance: 1e-14, max_iterations: 200, max_step: [f64::INFINITY; 2] };

fn run(bounds: [Interval<f64>; 2], start: [f64; 2]) -> ([f64; 2], [AtBound; 2], f64, Termination, f64) {
    let mut objective = Rosenbrock { bounds, highest_cost_accepted: Vec::new() };
    let minimum = minimize(&mut objective, &bounds, &start, &OPTIONS);
    let first = objective.highest_cost_accepted[0];
    (minimum.x, minimum.at_bound, minimum.evaluation.cost, minimum.termination, first)
}

#[test]
fn the_valley_is_followed_to_its_end() {
    let wide = [Interval::new(-3.0, 3.0), Interval::new(-3.0, 3.0)];
    for start in [[-1.2, 1.0], [2.9, -2.9], [-3.0, 3.0], [0.0, 0.0]] {
        let (x, at_bound, cost, termination, first) = run(wide, start);
        assert!((x[0] - 1.0).abs() < 1e-6 && (x[1] - 1.0).abs() < 1e-6, "{start:?}: {x:?}");
        assert_eq!(at_bound, [AtBound::Free; 2]);
        assert!(termination.converged() && cost <= first);
    }
}

#[test]
fn a_bound_in_the_way_is_met_exactly_and_the_rest_is_at_its_best() {
    // b ≤ 0.5: then a solves 2(a − 1) + 400 a (a² − 0.5) = 0 near √½
    let (x, at_bound, _, termination, _) = run([Interval::new(-3.0, 3.0), Interval::new(-3.0, 0.5)], [-1.2, -1.0]);
    assert_eq!(at_bound, [AtBound::Free, AtBound::Upper]);
    assert_eq!(x[1], 0.5);
    let slope = 2.0 * (x[0] - 1.0) + 400.0 * x[0] * (x[0] * x[0] - 0.5);
    // the second derivative is about 800: a slope of 1e-3 is 1e-6 in a
    assert!(slope.abs() < 1e-3, "{x:?} {slope}");
    assert!(termination.converged());

    // a ≤ −0.5, b ≥ 1: the valley b = a² crosses the box, and (1 − a)² is least where a is largest: a = −0.5 is cut off
    // from the valley by b ≥ 1, so the minimum lies on b = 1 near a = −1
    let (x, at_bound, ..) = run([Interval::new(-3.0, -0.5), Interval::new(1.0, 3.0)], [-2.0, 2.0]);
    assert_eq!((at_bound, x[1]), ([AtBound::Free, AtBound::Lower], 1.0));
    let slope = 2.0 * (x[0] - 1.0) + 400.0 * x[0] * (x[0] * x[0] - 1.0);
    assert!(slope.abs() < 1e-3, "{x:?} {slope}");
}

#[test]
fn a_limit_on_iterations_is_kept_and_reported() {
    let wide = [Interval::new(-3.0, 3.0), Interval::new(-3.0, 3.0)];
    let mut objective = Rosenbrock { bounds: wide, highest_cost_accepted: Vec::new() };
    let options = SolverOptions { max_iterations: 3, ..OPTIONS };
    let minimum = minimize(&mut objective, &wide, &[-1.2, 1.0], &options);
    assert_eq!((minimum.iterations, minimum.termination), (3, Termination::MaxIterations));
    assert!(!minimum.termination.converged());
}
