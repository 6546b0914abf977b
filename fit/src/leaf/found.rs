//! Where searches ended: the best, the next best that is distinct, and how many agree.

use std::vec::Vec;

use super::engine::Cost;
use super::parameters::COUNT;
use crate::bounds::AtBound;
use crate::solver::Termination;

/// The searches so far.
#[derive(Default)]
pub(super) struct Found {
    pub best: Option<At>,
    pub second: Option<At>,
    costs: Vec<f64>,
    pub iterations: u32,
}

/// Where a search ended.
#[derive(Clone, Copy)]
pub(super) struct At {
    pub x: [f64; COUNT],
    pub cost: f64,
    pub at_bound: [AtBound; COUNT],
    pub termination: Termination,
}

impl Found {
    pub fn add(&mut self, minimum: crate::solver::Minimum<f64, COUNT>, cost: &Cost<'_>) {
        let at = At {
            x: cost.parameters(&minimum.x).0,
            cost: minimum.evaluation.cost,
            at_bound: minimum.at_bound,
            termination: minimum.termination,
        };
        self.iterations += minimum.iterations;
        self.costs.push(at.cost);
        if !(at.cost < f64::MAX) {
            return;
        }
        let Some(leader) = self.best else {
            self.best = Some(at);
            return;
        };
        let (winner, loser) = if at.cost < leader.cost { (at, leader) } else { (leader, at) };
        self.best = Some(winner);
        if distinct(&winner, &loser, cost) && self.second.is_none_or(|other| loser.cost < other.cost) {
            self.second = Some(loser);
        }
    }

    pub fn starts(&self) -> u32 {
        self.costs.len() as u32
    }

    /// Starts that arrived within 0.1 % of the best cost.
    pub fn agreeing(&self) -> u32 {
        let best = self.best.map_or(f64::NAN, |best| best.cost);
        // squares of rounding errors, where a fit is perfect, are all alike
        self.costs.iter().filter(|cost| **cost <= 1.001 * best + 1e-12).count() as u32
    }
}

/// Do two minima differ in a parameter by more than a hundredth of its way?
fn distinct(a: &At, b: &At, cost: &Cost<'_>) -> bool {
    let (u, w) = (cost.coordinates(&a.x), cost.coordinates(&b.x));
    (0..COUNT).any(|i| {
        let width = cost.axes[i].bounds().width();
        (u[i] - w[i]).abs() > 0.01 * width
    })
}
