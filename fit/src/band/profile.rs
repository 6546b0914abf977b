//! χ² with k_L eliminated, as a function of (ln F₀, ln σ), with exact first and second derivatives.

use leafbrdf_core::{Dielectric, DirectionTerms, Real};

use super::{Band, Directions};
use crate::bounds::{BandBounds, Interval};
use crate::solver::{Evaluation, Objective};

/// F₀ = ((n − 1)/(n + 1))², the reflectance at normal incidence.
#[inline(always)]
pub(crate) fn f0_from_n<T: Real>(n: T) -> T {
    ((n - T::ONE) / (n + T::ONE)).squared()
}

/// n = (1 + √F₀)/(1 − √F₀), with dn/dF₀ and d²n/dF₀².
#[cfg_attr(feature = "std", inline(always))]
pub(crate) fn n_from_f0<T: Real>(f0: T) -> [T; 3] {
    let rho = f0.sqrt();
    let rest = T::ONE - rho;
    let inverse = T::ONE / (rho * rest.squared());
    let n = (T::ONE + rho) / rest;
    // dn/dρ = 2/(1 − ρ)², dρ/dF₀ = 1/(2ρ)
    let slope = inverse;
    let curvature = T::HALF * (T::TWO / rest - T::ONE / rho) * inverse / rho;
    [n, slope, curvature]
}

/// Sums over the directions at one (n, σ), of d = BRDF − BRDF_spec − a, a = k_L/π as known before.
///
/// The reference a keeps d of the size of the residuals, so that Σ ω d² − … loses no digits where k_L is large.
struct Sums<T> {
    d: T,
    d_d: T,
    /// Σ ω s_n, Σ ω s_σ
    s: [T; 2],
    /// Σ ω d s_n, Σ ω d s_σ
    d_s: [T; 2],
    /// Σ ω s_p s_q for (n,n), (n,σ), (σ,σ)
    s_s: [T; 3],
    /// Σ ω s_pq
    c: [T; 3],
    /// Σ ω d s_pq
    d_c: [T; 3],
}

const SUMS: usize = 15;

/// One pass over the directions, in `L` lanes; each lane adds its own share, and the lanes are added at the end in a fixed
/// order, so that every processor gives the same bits.
#[inline(always)]
fn accumulate<T: Real, const L: usize>(
    directions: Directions<T>,
    band: Band<T>,
    n: Dielectric<T>,
    sigma: T,
    a: T,
) -> Sums<T> {
    let mut lanes = [[T::ZERO; L]; SUMS];
    let chunks = directions
        .cos_theta_a
        .as_chunks::<L>()
        .0
        .iter()
        .zip(directions.tan2_alpha.as_chunks::<L>().0)
        .zip(directions.weight.as_chunks::<L>().0)
        .zip(band.brdf.as_chunks::<L>().0)
        .zip(band.weight.as_chunks::<L>().0);
    for ((((cos_theta_a, tan2_alpha), weight), brdf), omega) in chunks {
        for l in 0..L {
            let terms = DirectionTerms { cos_theta_a: cos_theta_a[l], tan2_alpha: tan2_alpha[l], weight: weight[l] };
            let spec = terms.brdf_to_second_order(n, sigma);
            let w = omega[l];
            let d = brdf[l] - spec.value - a;
            let w_d = w * d;
            let w_n = w * spec.d_n;
            let w_s = w * spec.d_sigma;
            lanes[0][l] += w_d;
            lanes[1][l] += w_d * d;
            lanes[2][l] += w_n;
            lanes[3][l] += w_s;
            lanes[4][l] += w_d * spec.d_n;
            lanes[5][l] += w_d * spec.d_sigma;
            lanes[6][l] += w_n * spec.d_n;
            lanes[7][l] += w_n * spec.d_sigma;
            lanes[8][l] += w_s * spec.d_sigma;
            lanes[9][l] += w * spec.d_n_n;
            lanes[10][l] += w * spec.d_n_sigma;
            lanes[11][l] += w * spec.d_sigma_sigma;
            lanes[12][l] += w_d * spec.d_n_n;
            lanes[13][l] += w_d * spec.d_n_sigma;
            lanes[14][l] += w_d * spec.d_sigma_sigma;
        }
    }
    let [d, d_d, s0, s1, ds0, ds1, ss0, ss1, ss2, c0, c1, c2, dc0, dc1, dc2] =
        lanes.map(|lane| lane.iter().fold(T::ZERO, |sum, x| sum + *x));
    Sums { d, d_d, s: [s0, s1], d_s: [ds0, ds1], s_s: [ss0, ss1, ss2], c: [c0, c1, c2], d_c: [dc0, dc1, dc2] }
}

/// The pass on one lane, for devices: one copy in flash, whoever calls. With more lanes it is part of a kernel that is built for one
/// processor, and must be compiled with it.
#[inline(never)]
fn accumulate_once<T: Real>(directions: Directions<T>, band: Band<T>, n: Dielectric<T>, sigma: T, a: T) -> Sums<T> {
    accumulate::<T, 1>(directions, band, n, sigma, a)
}

/// Everything at one (n, σ): χ² with k_L at its best, and the derivatives with respect to n and σ.
#[derive(Clone, Copy)]
pub(super) struct Point<T> {
    pub k_lambert: T,
    /// k_L is at neither of its bounds
    pub k_free: bool,
    pub cost: T,
    gradient: [T; 2],
    hessian: [T; 3],
    gauss_newton: [T; 3],
    /// Σ ω s_p and Σ ω s_p s_q: the normal matrix of (k_L, n, σ)
    pub s: [T; 2],
    pub s_s: [T; 3],
}

/// χ²(ln F₀, ln σ) of one band.
pub(super) struct Profile<'a, T, const L: usize> {
    pub directions: Directions<'a, T>,
    pub band: Band<'a, T>,
    /// Σ ω
    pub total_weight: T,
    pub bounds: BandBounds<T>,
    /// k_L/π at the last evaluation
    pub a: T,
}

impl<T: Real, const L: usize> Profile<'_, T, L> {
    /// The box in (ln F₀, ln σ).
    #[cfg_attr(feature = "std", inline(always))]
    pub fn box_of(bounds: &BandBounds<T>) -> [Interval<T>; 2] {
        [
            Interval::new(f0_from_n(bounds.n.lower).ln(), f0_from_n(bounds.n.upper).ln()),
            Interval::new(bounds.sigma.lower.ln(), bounds.sigma.upper.ln()),
        ]
    }

    /// χ² at (n, σ) with the best k_L inside its bounds.
    #[inline(always)]
    pub fn at(&mut self, n: T, sigma: T) -> Point<T> {
        // the solver's bounds keep n in the domain
        let index = match Dielectric::new(n) {
            Ok(index) => index,
            Err(_) => return Point::nowhere(),
        };
        let sums = if L == 1 {
            accumulate_once(self.directions, self.band, index, sigma, self.a)
        } else {
            accumulate::<T, L>(self.directions, self.band, index, sigma, self.a)
        };
        let inv_weight = T::ONE / self.total_weight;
        let k_bounds = self.bounds.k_lambert;
        let inv_pi = T::lit(core::f64::consts::FRAC_1_PI);
        let best = self.a + sums.d * inv_weight;
        let a = best.max(k_bounds.lower * inv_pi).min(k_bounds.upper * inv_pi);
        let k_free = a == best;
        // r = d − shift
        let shift = a - self.a;
        self.a = a;

        let cost = sums.d_d - shift * (T::TWO * sums.d - shift * self.total_weight);
        let r_s = |p: usize| sums.d_s[p] - shift * sums.s[p];
        let r_c = |p: usize| sums.d_c[p] - shift * sums.c[p];
        // eliminating a free k_L takes the mean of each derivative away
        let mean = |p: usize, q: usize| if k_free { sums.s[p] * sums.s[q] * inv_weight } else { T::ZERO };
        let gauss_newton =
            [sums.s_s[0] - mean(0, 0), sums.s_s[1] - mean(0, 1), sums.s_s[2] - mean(1, 1)].map(|x| T::TWO * x);
        Point {
            k_lambert: a * T::PI,
            k_free,
            cost: cost.max(T::ZERO),
            gradient: [-T::TWO * r_s(0), -T::TWO * r_s(1)],
            // spelled out: behind a closure the compiler may keep a bounds check, and with it a panic on a device
            hessian: [
                gauss_newton[0] - T::TWO * r_c(0),
                gauss_newton[1] - T::TWO * r_c(1),
                gauss_newton[2] - T::TWO * r_c(2),
            ],
            gauss_newton,
            s: sums.s,
            s_s: sums.s_s,
        }
    }
}

impl<T: Real> Point<T> {
    /// A point outside the domain: infinite cost, so that no search ends there.
    fn nowhere() -> Self {
        Point {
            k_lambert: T::ZERO,
            k_free: false,
            cost: T::MAX,
            gradient: [T::ZERO; 2],
            hessian: [T::ZERO; 3],
            gauss_newton: [T::ZERO; 3],
            s: [T::ZERO; 2],
            s_s: [T::ZERO; 3],
        }
    }
}

impl<T: Real, const L: usize> Objective<T, 2> for Profile<'_, T, L> {
    #[cfg_attr(feature = "std", inline(always))]
    fn evaluate(&mut self, x: &[T; 2]) -> Evaluation<T, 2> {
        let f0 = x[0].exp();
        let [n, slope, curvature] = n_from_f0(f0);
        // n(ln F₀)
        let (n1, n2) = (slope * f0, (curvature * f0 + slope) * f0);
        let sigma = x[1].exp();
        let point = self.at(self.bounds.n.clip(n), self.bounds.sigma.clip(sigma));
        // chain rule: n(ln F₀), σ(ln σ) with σ' = σ'' = σ
        let change =
            |m: &[T; 3]| [[m[0] * n1.squared(), m[1] * n1 * sigma], [m[1] * n1 * sigma, m[2] * sigma.squared()]];
        let mut hessian = change(&point.hessian);
        hessian[0][0] += point.gradient[0] * n2;
        hessian[1][1] += point.gradient[1] * sigma;
        Evaluation {
            cost: point.cost,
            gradient: [point.gradient[0] * n1, point.gradient[1] * sigma],
            hessian,
            gauss_newton: change(&point.gauss_newton),
        }
    }
}
