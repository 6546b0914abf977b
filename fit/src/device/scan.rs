//! The coarse scan of a device: χ² with k_L eliminated over the box of (σ, n), from sums over the directions.
//!
//! Two things make it small. σ² falls by a constant power of two from rung to rung, so that the exponential of the next rung is the square
//! of this one's: one `exp` a direction. And F(n, cosθ_a) is written in two fixed indices, F ≈ α(n) F(n₁) + β(n) F(n₂), exact at
//! normal and at 65° incidence, so that seven sums a rung serve every n.

use leafbrdf_core::{Dielectric, Index, Real};

use crate::band::profile::{f0_from_n, n_from_f0};
use crate::band::{Band, Directions, Start};
use crate::bounds::BandBounds;

/// Rungs of the ladder of σ.
const RUNGS: usize = 16;
/// Values of n that every rung is tried with.
const INDICES: usize = 12;
/// The most starts handed on.
const STARTS: usize = 2;

/// The sums of one rung, over the directions: u = D F(n₁), v = D F(n₂), y less its mean.
#[derive(Clone, Copy, Debug)]
struct Sums<T> {
    u: T,
    v: T,
    u_u: T,
    u_v: T,
    v_v: T,
    y_u: T,
    y_v: T,
}

/// What the scan works in: the caller's memory, so that a firmware decides where it lies.
#[derive(Clone, Debug)]
pub struct Workspace<T> {
    rungs: [Sums<T>; RUNGS],
    /// α and β of every n
    mixture: [(T, T); INDICES],
    starts: [Start<T>; STARTS],
}

/// The two indices that F is written in, and the cosine (beside 1) at which the mixture is exact.
const BASIS: [f64; 2] = [1.25, 2.2];
const MATCHED_COSINE: f64 = 0.42;

/// A rung adds nothing to the sums once its exponential is below this.
const NEGLIGIBLE: f64 = 1e-6;

impl<T: Real> Default for Workspace<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Real> Workspace<T> {
    /// Its size; 0.6 KB in single precision.
    pub const BYTES: usize = size_of::<Self>();

    /// A workspace; what it holds does not matter.
    pub const fn new() -> Self {
        let start = Start { n: T::ONE, sigma: T::ONE };
        Workspace { rungs: [Sums::ZERO; RUNGS], mixture: [(T::ZERO, T::ZERO); INDICES], starts: [start; STARTS] }
    }

    /// The best valleys of χ², the deepest first: none where no value counts.
    ///
    /// The caller has checked that the slices are of one length and hold finite numbers, and the bounds.
    pub(super) fn starts(
        &mut self,
        directions: Directions<'_, T>,
        band: Band<'_, T>,
        bounds: &BandBounds<T>,
    ) -> &[Start<T>] {
        let (mut total, mut sum) = (T::ZERO, T::ZERO);
        for (y, w) in band.brdf.iter().zip(band.weight) {
            total += *w;
            sum += *w * *y;
        }
        if !(total > T::ZERO) {
            return &[];
        }
        let inv_total = T::ONE / total;
        let mean = sum * inv_total;
        let ladder = Ladder::new(bounds);
        let y_y = self.accumulate(directions, band, mean, &ladder);
        self.mix(bounds);
        let inv_pi = T::lit(core::f64::consts::FRAC_1_PI);
        let costs = Costs {
            workspace: self,
            total,
            inv_total,
            mean,
            y_y,
            a: (bounds.k_lambert.lower * inv_pi, bounds.k_lambert.upper * inv_pi),
        };
        let (starts, found) = costs.valleys(&ladder, bounds);
        self.starts = starts;
        self.starts.get(..found).unwrap_or(&[])
    }

    /// One pass over the directions. Returns Σ ω (y − mean)².
    #[inline(never)]
    fn accumulate(&mut self, directions: Directions<'_, T>, band: Band<'_, T>, mean: T, ladder: &Ladder<T>) -> T {
        self.rungs.fill(Sums::ZERO);
        let (Ok(first), Ok(second)) = (Dielectric::new(T::lit(BASIS[0])), Dielectric::new(T::lit(BASIS[1]))) else {
            return T::ZERO;
        };
        let inv_sigma2 = T::ONE / ladder.sigma2;
        let mut y_y = T::ZERO;
        let terms = directions.cos_theta_a.iter().zip(directions.tan2_alpha).zip(directions.weight);
        for ((((cos_theta_a, tan2_alpha), weight), y), w) in terms.zip(band.brdf).zip(band.weight) {
            if *w == T::ZERO {
                continue;
            }
            let y = *y - mean;
            y_y += *w * y.squared();
            let base = *weight * (T::ONE + *tan2_alpha).squared();
            let (f_u, f_v) = (base * first.fresnel(*cos_theta_a), base * second.fresnel(*cos_theta_a));
            let mut lobe = (-*tan2_alpha * inv_sigma2).exp();
            for rung in self.rungs.iter_mut().take(ladder.rungs) {
                if lobe < T::lit(NEGLIGIBLE) {
                    break;
                }
                let (u, v) = (lobe * f_u, lobe * f_v);
                let (w_u, w_v) = (*w * u, *w * v);
                rung.u += w_u;
                rung.v += w_v;
                rung.u_u += w_u * u;
                rung.u_v += w_u * v;
                rung.v_v += w_v * v;
                rung.y_u += w_u * y;
                rung.y_v += w_v * y;
                for _ in 0..ladder.squarings {
                    lobe = lobe.squared();
                }
            }
        }
        y_y
    }

    /// α and β of every n: F(n) = α F(n₁) + β F(n₂) at normal incidence and at one more angle.
    fn mix(&mut self, bounds: &BandBounds<T>) {
        let at = |n: T| match Dielectric::new(n) {
            Ok(index) => [index.fresnel(T::ONE), index.fresnel(T::lit(MATCHED_COSINE))],
            Err(_) => [T::ZERO; 2],
        };
        let ([u0, u1], [v0, v1]) = (at(T::lit(BASIS[0])), at(T::lit(BASIS[1])));
        let inverse = T::ONE / (u0 * v1 - v0 * u1);
        for (k, mixture) in self.mixture.iter_mut().enumerate() {
            let [f0, f1] = at(index_at(bounds, T::lit(k as f64)));
            *mixture = ((f0 * v1 - v0 * f1) * inverse, (u0 * f1 - f0 * u1) * inverse);
        }
    }
}

impl<T: Real> Sums<T> {
    const ZERO: Self =
        Sums { u: T::ZERO, v: T::ZERO, u_u: T::ZERO, u_v: T::ZERO, v_v: T::ZERO, y_u: T::ZERO, y_v: T::ZERO };
}

/// σ² of rung j: `sigma2`/2^(j · squarings).
struct Ladder<T> {
    sigma2: T,
    rungs: usize,
    squarings: u32,
}

impl<T: Real> Ladder<T> {
    /// From the upper bound down to the lower one, in steps of √2 if the rungs suffice, else of 2, 2√2, …
    fn new(bounds: &BandBounds<T>) -> Self {
        let sigma2 = bounds.sigma.upper.squared();
        let least = bounds.sigma.lower.squared();
        let mut squarings = 1;
        loop {
            let ladder = Ladder { sigma2, rungs: RUNGS, squarings };
            let mut rungs = 1;
            while rungs < RUNGS && ladder.sigma2_at(rungs) >= least {
                rungs += 1;
            }
            // the bounds' ratio is at most 10⁵, 34 halvings of σ²
            if rungs < RUNGS || squarings == 4 {
                return Ladder { rungs, ..ladder };
            }
            squarings += 1;
        }
    }

    fn sigma2_at(&self, rung: usize) -> T {
        let mut sigma2 = self.sigma2;
        for _ in 0..rung as u32 * self.squarings {
            sigma2 *= T::HALF;
        }
        sigma2
    }
}

/// The n at place k of the list (also between two places): in equal ratios of F₀.
fn index_at<T: Real>(bounds: &BandBounds<T>, k: T) -> T {
    let (low, high) = (f0_from_n(bounds.n.lower).ln(), f0_from_n(bounds.n.upper).ln());
    let share = k * T::lit(1.0 / (INDICES - 1) as f64);
    bounds.n.clip(n_from_f0((low + share * (high - low)).exp())[0])
}

/// χ² of every rung and n.
struct Costs<'a, T> {
    workspace: &'a Workspace<T>,
    total: T,
    inv_total: T,
    mean: T,
    y_y: T,
    /// bounds of k_L/π
    a: (T, T),
}

/// The best n of a rung: its place in the list, with χ² there and at its neighbours.
#[derive(Clone, Copy)]
struct Best<T> {
    cost: T,
    k: usize,
    sides: (T, T),
}

impl<T: Real> Costs<'_, T> {
    /// The valleys along σ of min over n.
    #[inline(never)]
    fn valleys(&self, ladder: &Ladder<T>, bounds: &BandBounds<T>) -> ([Start<T>; STARTS], usize) {
        let none = Best { cost: T::MAX, k: 0, sides: (T::MAX, T::MAX) };
        let mut starts = [Start { n: T::ONE, sigma: T::ONE }; STARTS];
        let mut costs = [T::MAX; STARTS];
        let mut found = 0;
        let (mut before, mut here) = (none, self.best(ladder, 0));
        for j in 0..ladder.rungs {
            let after = if j + 1 < ladder.rungs { self.best(ladder, j + 1) } else { none };
            if here.cost <= before.cost && here.cost < after.cost {
                let k = T::lit(here.k as f64) + vertex(here.sides.0, here.cost, here.sides.1);
                // between two rungs: σ falls by 2^(−squarings/2)
                let offset = vertex(before.cost, here.cost, after.cost) * T::lit(-0.5 * core::f64::consts::LN_2);
                let sigma = ladder.sigma2_at(j).sqrt() * (offset * T::lit(f64::from(ladder.squarings))).exp();
                let start = Start { n: index_at(bounds, k), sigma: bounds.sigma.clip(sigma) };
                found = insert(&mut starts, &mut costs, found, start, here.cost);
            }
            before = here;
            here = after;
        }
        (starts, found)
    }

    /// The best n of rung j.
    fn best(&self, ladder: &Ladder<T>, j: usize) -> Best<T> {
        let Some(sums) = self.workspace.rungs.get(j) else {
            return Best { cost: T::MAX, k: 0, sides: (T::MAX, T::MAX) };
        };
        let kappa = T::lit(core::f64::consts::FRAC_1_PI) / ladder.sigma2_at(j);
        let mut best = Best { cost: T::MAX, k: 0, sides: (T::MAX, T::MAX) };
        let mut before = T::MAX;
        for (k, (alpha, beta)) in self.workspace.mixture.iter().enumerate() {
            let (alpha, beta) = (kappa * *alpha, kappa * *beta);
            let s = alpha * sums.u + beta * sums.v;
            let s_s = alpha.squared() * sums.u_u + T::TWO * (alpha * beta) * sums.u_v + beta.squared() * sums.v_v;
            let y_s = alpha * sums.y_u + beta * sums.y_v;
            let mean_s = s * self.inv_total;
            let free = self.mean - mean_s;
            let excess = free - free.max(self.a.0).min(self.a.1);
            let cost = self.y_y - T::TWO * y_s + (s_s - s * mean_s) + self.total * excess.squared();
            if cost < best.cost {
                best = Best { cost, k, sides: (before, T::MAX) };
            } else if k == best.k + 1 {
                best.sides.1 = cost;
            }
            before = cost;
        }
        best
    }
}

/// Where the parabola through three values at −1, 0, 1 has its least, for a least one in the middle; 0 at an end of the list.
fn vertex<T: Real>(before: T, here: T, after: T) -> T {
    let curvature = (before - here) + (after - here);
    if before < T::MAX && after < T::MAX && curvature > T::ZERO {
        T::HALF * (before - after) / curvature
    } else {
        T::ZERO
    }
}

/// Inserts by ascending cost; the worst falls out where there is no room.
fn insert<T: Real>(
    starts: &mut [Start<T>; STARTS],
    costs: &mut [T; STARTS],
    found: usize,
    start: Start<T>,
    cost: T,
) -> usize {
    let (mut start, mut cost) = (start, cost);
    for (place, at) in starts.iter_mut().zip(costs.iter_mut()) {
        if cost < *at {
            core::mem::swap(place, &mut start);
            core::mem::swap(at, &mut cost);
        }
    }
    (found + 1).min(STARTS)
}
