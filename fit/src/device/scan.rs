//! The coarse scan of a device: χ² with k_L eliminated over the box of (σ, n), from one pass over the directions.
//!
//! Two things make it small. σ² falls by a constant power of two from rung to rung, so that the exponential of the next rung is the square
//! of this one's: one `exp` a direction. And F at any n is written in F and ∂F/∂ln e at one n, with weights that make it exact at
//! normal and at 65° incidence, so that seven sums a rung serve every n.

use leafbrdf_core::Real;
use leafbrdf_core::facet::Falloff;
use leafbrdf_core::fresnel::squares::fresnel_with_log_slope as fresnel;

use super::Workspace;
use super::lobe::look;
use super::search::Problem;
use crate::bounds::Interval;

/// Rungs of the ladder of σ.
pub(super) const RUNGS: usize = 16;
/// Halvings of the interval of ln e: 2⁴ + 1 values of n are tried with every rung.
const ROOTS: u32 = 5;

/// e = n² − 1 that F is developed about: n = 1.5.
const E_0: f64 = 1.25;
/// The cosine (beside 1) at which the development is exact, whatever n: 65°.
const MATCHED_COSINE: f64 = 0.42;
/// F(e) ≈ α F(e₀) + β F′(e₀): α and β from F(e) at normal incidence and at the matched cosine.
const ALPHA: [f64; 2] = [-21.002_650_568_001_76, 15.104_327_203_106_044];
const BETA: [f64; 2] = [34.501_987_926_001_31, -11.328_245_402_329_532];

/// σ² of rung j: `sigma2` · 2^(−j · squarings).
pub(super) struct Ladder<T> {
    pub sigma2: T,
    pub shrink: T,
    pub rungs: usize,
    pub squarings: u32,
}

impl<T: Real> Ladder<T> {
    /// From the upper bound down to the lower one, in steps of √2 if the rungs suffice, else of 2, 2√2, …
    pub fn new(sigma: &Interval<T>) -> Self {
        let (sigma2, least) = (sigma.upper.squared(), sigma.lower.squared());
        let mut ladder = Ladder { sigma2, shrink: T::HALF, rungs: 0, squarings: 1 };
        loop {
            let mut here = sigma2;
            ladder.rungs = 0;
            while ladder.rungs < RUNGS && here >= least {
                here *= ladder.shrink;
                ladder.rungs += 1;
            }
            // the bounds' ratio is at most 10⁵, 34 halvings of σ²
            if here < least || ladder.squarings >= 4 {
                return ladder;
            }
            ladder.shrink *= T::HALF;
            ladder.squarings += 1;
        }
    }
}

impl<T: Real> Workspace<T> {
    /// χ² of every rung at its best n: the least of them, and Σ ω (y − mean)².
    #[inline(always)]
    pub(super) fn scan(&mut self, problem: &Problem<'_, T>, ladder: &Ladder<T>) -> (T, T) {
        let Problem { data, total, a, e, mean, .. } = problem;
        let (total, mean) = (*total, *mean);
        let inv_sigma2 = T::ONE / ladder.sigma2;
        let rungs = self.sums.get_mut(..ladder.rungs).unwrap_or(&mut []);
        let mut least = T::MAX;
        let kappa = T::lit(1.0 / Falloff::<T>::GAIN);
        let y_y = look(data, rungs, ladder.squarings, T::lit(E_0), inv_sigma2, kappa, mean).d_d;
        for cost in &mut self.cost {
            *cost = (T::MAX, T::ONE);
        }
        let inv_total = T::ONE / total;
        // e in equal ratios
        let mut ratio = e.upper / e.lower;
        for _ in 0..ROOTS {
            ratio = ratio.sqrt();
        }
        let grow = T::ONE / ladder.shrink;
        let mut at_e = e.lower;
        for _ in 0..(1 << ROOTS) + 1 {
            let (f_0, f_1) = (fresnel(at_e, T::ONE).0, fresnel(at_e, T::lit(MATCHED_COSINE * MATCHED_COSINE)).0);
            let inv_pi_sigma2 = inv_sigma2 * T::lit(core::f64::consts::FRAC_1_PI);
            let mut alpha = (T::lit(ALPHA[0]) * f_0 + T::lit(ALPHA[1]) * f_1) * inv_pi_sigma2;
            let mut beta = (T::lit(BETA[0]) * f_0 + T::lit(BETA[1]) * f_1) * inv_pi_sigma2;
            for (sums, best) in rungs.iter().zip(&mut self.cost) {
                let s = alpha * sums.u + beta * sums.v;
                let s_s = alpha * (alpha * sums.u_u + T::TWO * (beta * sums.u_v)) + beta.squared() * sums.v_v;
                let y_s = alpha * sums.d_u + beta * sums.d_v;
                let mean_s = s * inv_total;
                let free = mean - mean_s;
                let excess = free - a.clip(free);
                let cost = y_y - T::TWO * y_s + (s_s - s * mean_s) + total * excess.squared();
                // rounding may leave less than nothing
                let cost = T::ZERO.max(cost); // NaN stays
                if cost < best.0 {
                    *best = (cost, at_e);
                    least = least.min(cost);
                }
                alpha *= grow;
                beta *= grow;
            }
            at_e *= ratio;
        }
        (least, y_y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between the two angles of the match it is within 7 % (n from 1.2 to 2.2), enough for a start.
    #[test]
    fn f_is_developed_exactly_where_it_is_matched() {
        for n in [1.1, 1.2, 1.5, 1.8, 2.2, 3.0, 5.0_f64] {
            let e = n * n - 1.0;
            let (f_0, f_1) = (fresnel(e, 1.0).0, fresnel(e, MATCHED_COSINE * MATCHED_COSINE).0);
            let developed = |c| {
                let (f, slope) = fresnel(E_0, c * c);
                (ALPHA[0] * f_0 + ALPHA[1] * f_1) * f + (BETA[0] * f_0 + BETA[1] * f_1) * slope
            };
            assert!((developed(1.0) / f_0 - 1.0).abs() < 1e-11, "{n}");
            assert!((developed(MATCHED_COSINE) / f_1 - 1.0).abs() < 1e-11, "{n}");
            if (1.2..=2.2).contains(&n) {
                for i in 0..=58 {
                    let c = 0.42 + 0.01 * f64::from(i);
                    assert!((developed(c) / fresnel(e, c * c).0 - 1.0).abs() < 0.07, "{n} {c}");
                }
            }
        }
    }

    #[test]
    fn the_ladder_reaches_from_bound_to_bound_in_sixteen_rungs() {
        for (lower, upper, squarings) in [(0.01_f64, 1.0, 1), (0.1, 0.11, 1), (1e-3, 1.0, 2), (1e-4, 10.0, 3_u32)] {
            let ladder = Ladder::new(&Interval::new(lower, upper));
            assert_eq!(ladder.squarings, squarings, "{lower} {upper}");
            assert!(ladder.rungs >= 1 && ladder.rungs <= RUNGS);
            let last = ladder.sigma2 * 0.5_f64.powi(squarings as i32 * (ladder.rungs as i32 - 1));
            assert!(last >= lower * lower && last * ladder.shrink < lower * lower, "{lower} {upper}");
        }
    }
}
