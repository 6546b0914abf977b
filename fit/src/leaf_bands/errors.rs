//! Errors of a band that know how large each direction's noise is: from the same direction in other bands.
//!
//! One band looks at each direction once, and can only take all of them to be alike: (JᵀωJ)⁻¹ χ²/ν. The bands of a leaf look many
//! times. With c_i the row of A⁻¹ = (JᵀωJ)⁻¹ that belongs to a parameter and s_v² the variance of √ω r in direction v,
//!
//! ```text
//! variance_i = Σ_v ω_v (c_iᵀ J_v)² s_v²
//! ```
//!
//! s_v² is a mean over [`BLOCK`] neighbouring bands, so that it follows the light. A band's residuals r = (1 − H)e carry each
//! direction's noise over to the others: E ωr_v² = (1 − 2h_v) s_v² + Σ_u H_vu² s_u². Dividing by 1 − h_v is right where all are alike
//! (HC2); where one or two noisy views decide, it takes 20 to 30 % off the error. The equation is therefore solved, by
//!
//! ```text
//! s_v² ← s_v² · (mean of ωr_v²/E ωr_v²)^(1/√d),     d = (1 − h_v)² s_v²/E ωr_v²
//! ```
//!
//! which is positive by construction and HC2 where it starts; d is how much of a direction's residual is its own noise, and without
//! the exponent views that hardly have a residual of their own would take hundreds of steps.
//!
//! The larger variance of the two is taken. A misfit that all bands share is one draw a direction however many bands look, and there
//! the first is the better estimate.

use std::vec;
use std::vec::Vec;

use leafbrdf_core::{Dielectric, DirectionTerms, Portable, Real};
use rayon::prelude::*;

use super::{BandResult, LANES, Number, Prepared};
use crate::band::{Noise, covariance};
use crate::matrix::{dot, form, product};
use crate::{AtBound, BandFit, Identifiability};

/// Bands that s_v² is a mean over: enough to know it to 14 %. Means are taken every half block, and straight lines between them.
const BLOCK: usize = 100;

/// With fewer bands the sizes are too uncertain for the larger of two variances to be honest.
pub(super) const LEAST_BANDS: usize = 20;

/// Steps of s²: errors are within 2 % of where more would lead.
const STEPS: usize = 15;

/// A direction that alone decides a parameter leaves no residual to be judged by: no more than 20 times its own,
const LEAST_LEFT: f64 = 0.05;
/// and no more than 50 times that, whatever the other directions say. A misfit may leave any residual, and dividing by what is left of
/// a direction's own noise, (1 − h)² of it, would make errors of any size.
const MOST_CARRIED: f64 = 50.0;

/// A band's linearised fit.
struct Seen {
    /// √ω ∂BRDF/∂(k_L, n, σ) of those that are free, 0 elsewhere and where nothing was measured.
    slopes: Vec<[f64; 3]>,
    /// A⁻¹.
    inverse: [[f64; 3]; 3],
    /// h, and ωr²/(1 − h); NaN where nothing was measured.
    leverage: Vec<f64>,
    squares: Vec<f64>,
}

/// Lets the errors of all bands know how large the noise of each direction is, where there are enough bands to tell.
pub(super) fn by_direction(leaf: &Prepared, results: &mut [BandResult]) {
    let seen: Vec<Option<Seen>> = results
        .par_iter()
        .enumerate()
        .map(|(b, fit)| {
            let fit = fit.as_ref().filter(|fit| !fit.identifiability.contains(&Identifiability::NoDegreesOfFreedom))?;
            let mut values = vec![[0.0; 3]; leaf.width];
            pulp::Arch::new().dispatch(Values { leaf, band: b, fit, values: &mut values });
            Some(Seen::new(fit, values, leaf.band(b).weight))
        })
        .collect();
    if seen.iter().flatten().count() < LEAST_BANDS {
        return;
    }
    let blocks = blocks(&seen, leaf.real);
    results.par_iter_mut().zip(&seen).enumerate().for_each(|(b, (fit, seen))| {
        if let (Some(fit), Some(seen)) = (fit, seen) {
            seen.grow(fit, &sizes_at(&blocks, b));
        }
    });
}

/// r, ∂BRDF/∂n and ∂BRDF/∂σ of every direction, padding included, compiled for each instruction set.
struct Values<'a> {
    leaf: &'a Prepared,
    band: usize,
    fit: &'a BandFit<f64>,
    values: &'a mut [[f64; 3]],
}

impl pulp::NullaryFnOnce for Values<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [k_lambert, n, sigma] = self.fit.parameters;
        // a fit's n is in the domain
        let Ok(index) = Dielectric::new(Portable(n)) else { return };
        let (sigma, diffuse): (Number, f64) = (Portable(sigma), k_lambert * core::f64::consts::FRAC_1_PI);
        let directions = self.leaf.directions();
        let chunks = directions
            .cos_theta_a
            .as_chunks::<LANES>()
            .0
            .iter()
            .zip(directions.tan2_alpha.as_chunks::<LANES>().0)
            .zip(directions.weight.as_chunks::<LANES>().0)
            .zip(self.leaf.band(self.band).brdf.as_chunks::<LANES>().0)
            .zip(self.values.as_chunks_mut::<LANES>().0);
        for ((((cos_theta_a, tan2_alpha), weight), y), values) in chunks {
            for l in 0..LANES {
                let terms =
                    DirectionTerms { cos_theta_a: cos_theta_a[l], tan2_alpha: tan2_alpha[l], weight: weight[l] };
                let lobe = terms.brdf_to_second_order(index, sigma);
                values[l] = [y[l].0 - lobe.value.0 - diffuse, lobe.d_n.0, lobe.d_sigma.0];
            }
        }
    }
}

impl Seen {
    /// `values`: r, ∂BRDF/∂n, ∂BRDF/∂σ.
    fn new(fit: &BandFit<f64>, values: Vec<[f64; 3]>, weight: &[Number]) -> Self {
        let free = fit.at_bound.map(|at| at == AtBound::Free);
        let slopes: Vec<[f64; 3]> = values
            .iter()
            .zip(weight)
            .map(|([_, d_n, d_sigma], w)| {
                let root = w.0.sqrt();
                let j = [core::f64::consts::FRAC_1_PI, *d_n, *d_sigma];
                core::array::from_fn(|p| if free[p] { root * j[p] } else { 0.0 })
            })
            .collect();
        let mut normal = sum_of_squares(slopes.iter().map(|j| (j, 1.0)));
        for p in (0..3).filter(|p| !free[*p]) {
            normal[p][p] = 1.0;
        }
        let (mut inverse, singular) = covariance(&normal, &free);
        for p in (0..3).filter(|&p| !free[p] || singular[p]) {
            inverse[p] = [0.0; 3];
        }
        let leverage: Vec<f64> = slopes.iter().map(|j| form(&inverse, j)).collect();
        let square = |([r, ..], w): (&[f64; 3], &Number)| if w.0 > 0.0 { w.0 * r * r } else { f64::NAN };
        let squares = values.iter().zip(weight).map(square);
        let squares = squares.zip(&leverage).map(|(square, h)| square / (1.0 - h).max(LEAST_LEFT)).collect();
        Seen { slopes, inverse, leverage, squares }
    }

    /// One step of s² towards what the measured means of ωr²/(1 − h) say.
    fn improve(&self, sizes: &mut [f64], means: &[f64]) {
        let measured = self.slopes.iter().zip(&*sizes).filter(|(_, size)| !size.is_nan());
        let spread = sum_of_squares(measured.map(|(j, size)| (j, *size)));
        let spread = product(&product(&self.inverse, &spread), &self.inverse);
        for (((size, mean), j), h) in sizes.iter_mut().zip(means).zip(&self.slopes).zip(&self.leverage) {
            let expected = (1.0 - 2.0 * h) * *size + form(&spread, j);
            // a direction without any residual has no size, whatever the others say
            if !(*mean > 0.0 && expected > 0.0) {
                continue;
            }
            let ratio = mean * (1.0 - h).max(LEAST_LEFT) / expected;
            let own = (1.0 - h) * (1.0 - h) * *size / expected;
            // the same bits on every machine; a step of ten times is far enough
            let step = (Portable(ratio.clamp(0.1, 10.0)).ln() * Portable(1.0 / own.max(0.01).sqrt())).exp();
            *size = (*size * step.0.clamp(0.1, 10.0)).min(MOST_CARRIED * mean);
        }
    }

    /// The larger error of the two for each parameter; correlations stay.
    fn grow(&self, fit: &mut BandFit<f64>, sizes: &[f64]) {
        let free = fit.at_bound.iter().filter(|at| **at == AtBound::Free).count();
        let alike = fit.chi2 / fit.n_obs.saturating_sub(free).max(1) as f64;
        for p in 0..3 {
            let measured = self.slopes.iter().zip(sizes).filter(|(_, size)| !size.is_nan());
            let own: f64 = measured.map(|(j, size)| dot(&self.inverse[p], j).powi(2) * size).sum();
            if let (Some(error), true) = (&mut fit.standard_errors[p], own > alike * self.inverse[p][p]) {
                *error *= (own / (alike * self.inverse[p][p])).sqrt();
            }
        }
        fit.noise = Noise::ByDirection;
    }
}

/// Places of the blocks' middles, and s² of every direction there (NaN where nothing was measured).
fn blocks(seen: &[Option<Seen>], directions: usize) -> Vec<(f64, Vec<f64>)> {
    let last = seen.len().saturating_sub(BLOCK);
    let mut starts: Vec<usize> = (0..last).step_by(BLOCK / 2).collect();
    starts.push(last);
    starts
        .into_par_iter()
        .map(|start| {
            let block = seen.get(start..(start + BLOCK).min(seen.len())).unwrap_or(&[]);
            let mut sums = vec![(0.0, 0.0); directions];
            for band in block.iter().flatten() {
                for ((sum, count), square) in sums.iter_mut().zip(&band.squares).filter(|(_, square)| !square.is_nan())
                {
                    *sum += square;
                    *count += 1.0;
                }
            }
            let means: Vec<f64> = sums.iter().map(|(sum, count)| sum / count).collect();
            let mut sizes = means.clone();
            // n and σ, and with them the lobe, are nearly the same in all bands of a block: one stands for all
            if let Some(middle) = block.iter().skip(block.len() / 2).chain(block).flatten().next() {
                (0..STEPS).for_each(|_| middle.improve(&mut sizes, &means));
            }
            (start as f64 + 0.5 * (block.len() as f64 - 1.0), sizes)
        })
        .collect()
}

/// s² at a band: on the straight line between the blocks' middles before and after it.
fn sizes_at(blocks: &[(f64, Vec<f64>)], band: usize) -> Vec<f64> {
    let place = band as f64;
    let after = blocks.partition_point(|(middle, _)| *middle < place).min(blocks.len().saturating_sub(1));
    let (Some((from, before)), Some((to, there))) = (blocks.get(after.saturating_sub(1)), blocks.get(after)) else {
        return Vec::new();
    };
    let share = if to > from { ((place - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
    let line = before.iter().zip(there).map(|(before, there)| match (before.is_nan(), there.is_nan()) {
        (true, _) => *there,
        (_, true) => *before,
        _ => before + share * (there - before),
    });
    line.collect()
}

/// Σ j jᵀ · weight.
fn sum_of_squares<'a>(of: impl Iterator<Item = (&'a [f64; 3], f64)>) -> [[f64; 3]; 3] {
    let mut sum = [[0.0; 3]; 3];
    for (j, weight) in of {
        for p in 0..3 {
            for q in 0..3 {
                sum[p][q] += weight * j[p] * j[q];
            }
        }
    }
    sum
}
