//! From a valley to its minimum: steps in (ln e, ln σ), e = n² − 1, with k_L at its best for each.
//!
//! A step minimises the quadratic model inside a box, in which the bounds and the reach of the model are one: there is no damping beside it,
//! and a parameter at a bound is nothing special. Coordinates are local, x(1 + z/2)/(1 − z/2): dz = d ln x, and no logarithm.

use leafbrdf_core::Real;
use leafbrdf_core::facet::Falloff;

use super::lobe::{Data, Sums, look};
use crate::bounds::Interval;

/// The longest step of ln e and ln σ.
const REACH: f64 = 0.7;
/// A longer step is never the last: its quadratic model says little of where it ends.
const NEAR: f64 = 0.1;
/// The problem of one band.
pub(super) struct Problem<'a, T> {
    pub data: &'a Data<'a, T>,
    /// Σ ω
    pub total: T,
    /// bounds of k_L/π, n² − 1, σ
    pub a: Interval<T>,
    pub e: Interval<T>,
    pub sigma: Interval<T>,
    /// stop where the predicted decrease is below this share of χ²
    pub enough: T,
    /// mean of the data
    pub mean: T,
    /// the most looks at the data
    pub most: u32,
}

/// χ² with k_L at its best, and its quadratic model in (ln e, ln σ).
#[derive(Clone, Copy, Debug)]
pub(super) struct Point<T> {
    pub e: T,
    pub sigma: T,
    /// k_L/π
    pub a: T,
    pub cost: T,
    /// half the gradient by k_L/π, ln e, ln σ; the first is 0 (but for rounding) where k_L is free
    pub g: [T; 3],
    /// half the Hessian in (ln e, ln σ) without the residuals' own curvature
    pub h: [T; 3],
    /// mean of ∂s/∂ln e, ∂s/∂ln σ where k_L is free
    pub mean: [T; 2],
}

impl<T: Real> Point<T> {
    pub const ZERO: Self = Point {
        e: T::ZERO,
        sigma: T::ZERO,
        a: T::ZERO,
        cost: T::ZERO,
        g: [T::ZERO; 3],
        h: [T::ZERO; 3],
        mean: [T::ZERO; 2],
    };
}

impl<T: Real> Problem<'_, T> {
    /// χ² and its model at (e, σ); `near`: k_L/π nearby, so that what is left of the data is small.
    #[inline(always)]
    fn look(&self, e: T, sigma: T, near: T, sums: &mut Sums<T>, point: &mut Point<T>) {
        let inv_sigma2 = T::ONE / sigma.squared();
        let kappa = inv_sigma2 * T::lit(core::f64::consts::FRAC_1_PI / Falloff::<T>::GAIN);
        let rest = look(self.data, core::slice::from_mut(sums), 0, e, inv_sigma2, kappa, near);
        let inv_total = T::ONE / self.total;
        let best = near + rest.d * inv_total;
        let a = self.a.clip(best);
        let shift = a - near;
        let left = shift * self.total - rest.d;
        let free = if a == best { inv_total } else { T::ZERO };
        let mean = [sums.u * free, sums.v * free];
        *point = Point {
            e,
            sigma,
            a,
            cost: (rest.d_d + shift * (left - rest.d)).max(T::ZERO),
            g: [left, shift * sums.u - sums.d_u, shift * sums.v - sums.d_v],
            h: [sums.u_u - sums.u * mean[0], sums.u_v - sums.u * mean[1], sums.v_v - sums.v * mean[1]],
            mean,
        };
    }

    /// From (e, σ) to the minimum, left in `here`: looks at the data, and whether it arrived. `rounding`: what χ² is of data that are rounding.
    #[inline(always)]
    pub fn search<'p>(
        &self,
        mut to_e: T,
        mut to_sigma: T,
        rounding: T,
        sums: &mut Sums<T>,
        here: &mut &'p mut Point<T>,
        there: &mut &'p mut Point<T>,
    ) -> (u32, bool) {
        let mut near_a = self.mean;
        let mut reach = T::lit(REACH);
        let (mut predicted, mut largest) = (T::MAX, T::ONE);
        let mut looks = 0;
        while looks < self.most {
            self.look(to_e, to_sigma, near_a, sums, there);
            looks += 1;
            let decrease = here.cost - there.cost;
            let first = looks == 1;
            if first || decrease > T::ZERO {
                core::mem::swap(here, there);
            } else if predicted <= T::lit(64.0) * T::EPSILON * here.cost {
                return (looks, true);
            }
            // a step that gains little of what it promised has gone too far
            reach = if first || decrease > T::lit(0.25) * predicted { reach + reach } else { T::lit(0.4) * largest };
            reach = reach.min(T::lit(REACH));
            near_a = here.a;
            let [_, g_0, g_1] = here.g;
            let [h_0, h_01, h_1] = here.h;
            // without the box; then the least inside it, exact where at most one side of it holds
            let t = h_01 / h_1;
            let mut z_0 = (t * g_1 - g_0) / (h_0 - t * h_01);
            let mut z_1 = T::ZERO;
            for _ in 0..3 {
                (z_1, to_sigma) = step(here.sigma, -(g_1 + h_01 * z_0) / h_1, reach, &self.sigma);
                (z_0, to_e) = step(here.e, -(g_0 + h_01 * z_1) / h_0, reach, &self.e);
            }
            predicted = -(z_0 * (T::TWO * (g_0 + h_01 * z_1) + h_0 * z_0) + z_1 * (T::TWO * g_1 + h_1 * z_1));
            largest = z_0.abs().max(z_1.abs());
            if largest < T::lit(NEAR) && predicted <= self.enough * here.cost + rounding {
                // not worth a look at the data, and yet a step nearer
                here.e = to_e;
                here.sigma = to_sigma;
                here.cost = (here.cost - predicted).max(T::ZERO);
                here.a = self.a.clip(here.a - (here.mean[0] * z_0 + here.mean[1] * z_1));
                return (looks, true);
            }
        }
        (looks, false)
    }
}

/// A step z of ln x, as far as reach and bounds allow: what is left of it, and where it leads.
#[inline(never)]
fn step<T: Real>(x: T, z: T, reach: T, bounds: &Interval<T>) -> (T, T) {
    let z = z.max(-reach).min(reach);
    let to = snap(x * (T::TWO + z) / (T::TWO - z), bounds);
    (T::TWO * (to - x) / (to + x), to)
}

/// x, or the bound that it lies beyond or within rounding of; the lower one for NaN.
#[inline(never)]
pub(super) fn snap<T: Real>(x: T, bounds: &Interval<T>) -> T {
    let rounding = T::lit(8.0) * T::EPSILON;
    if !(x > bounds.lower + rounding * bounds.lower.abs()) {
        bounds.lower
    } else if x >= bounds.upper - rounding * bounds.upper.abs() {
        bounds.upper
    } else {
        x
    }
}
