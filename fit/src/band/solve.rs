//! From one band's measurements to its global minimum: scan, polish every valley, report.

use leafbrdf_core::Real;

use super::profile::{Profile, f0_from_n, n_from_f0};
use super::report::{BandFit, Candidate, Valley};
use super::scan::{GridMinimum, Scan};
use super::{Band, Directions};
use crate::FitError;
use crate::bounds::{AtBound, BandBounds, Interval};
use crate::linear::solve_spd;
use crate::solver::{Minimum, SolverOptions, Termination, minimize};

pub use super::report::Weights;

/// The most valleys of one band that are polished.
const MOST_VALLEYS: usize = 4;

/// How a band is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandOptions<T> {
    /// Bounds of k_L, n, σ.
    pub bounds: BandBounds<T>,
    /// Stop where the predicted decrease is below this share of χ².
    pub tolerance: T,
    /// The most Newton steps a start.
    pub max_iterations: u32,
    /// The most valleys of the scan that are polished, 1 to 4.
    pub starts: usize,
    /// What the weights mean for the standard errors.
    pub weights: Weights,
}

impl<T: Real> BandOptions<T> {
    /// Table 3's bounds; 10⁻¹¹ of χ² in double precision, 10⁻⁴ in single (tighter only burns steps there); 200 steps (ordinary bands take 4, narrow valleys dozens); all valleys.
    pub fn table_3() -> Self {
        BandOptions {
            bounds: BandBounds::table_3(),
            tolerance: if T::EPSILON < T::lit(1e-10) { T::lit(1e-11) } else { T::lit(1e-4) },
            max_iterations: 200,
            starts: MOST_VALLEYS,
            weights: Weights::Relative,
        }
    }
}

/// A point (n, σ) to search from; k_L follows from the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<T> {
    /// Refractive index.
    pub n: T,
    /// Roughness.
    pub sigma: T,
}

/// The solver of one leaf's bands: the directions, and in caller-owned memory the scan that all bands share.
///
/// `L` is the number of lanes that a processor adds in: 8 where there are vector registers, 1 on a microcontroller.
#[derive(Debug)]
pub struct BandSolver<'a, T, const L: usize> {
    directions: Directions<'a, T>,
    options: BandOptions<T>,
    scan: Option<Scan<'a, T>>,
}

impl<'a, T: Real, const L: usize> BandSolver<'a, T, L> {
    /// A solver for these directions. Without a scan every band is searched from the caller's starts alone.
    ///
    /// # Errors
    /// [`FitError`] for bounds out of order, slices of different lengths, or direction terms that are not finite.
    pub fn new(
        directions: Directions<'a, T>,
        options: BandOptions<T>,
        scan: Option<Scan<'a, T>>,
    ) -> Result<Self, FitError> {
        options.bounds.check()?;
        directions.check(L)?;
        Ok(BandSolver { directions, options, scan })
    }

    /// Fits one band: the valleys of the scan and the given starts are polished, and the best minimum is reported.
    ///
    /// `None` where the band has fewer than 3 values that count, or where there is neither scan nor start.
    ///
    /// # Errors
    /// [`FitError`] for values or weights that are not finite, negative weights, or slices of the wrong length.
    #[cfg_attr(feature = "std", inline(always))]
    pub fn fit(&mut self, band: Band<T>, starts: &[Start<T>]) -> Result<Option<BandFit<T>>, FitError> {
        band.check(self.directions.len())?;
        let (total_weight, n_obs) = count(&band);
        if n_obs < 3 {
            return Ok(None);
        }
        let nothing = GridMinimum { cost: T::MAX, n: T::ONE, sigma: T::ONE };
        let mut valleys = [nothing; MOST_VALLEYS];
        let found = match &mut self.scan {
            Some(scan) => scan.valleys(band, total_weight, &mut valleys),
            None => 0,
        };
        let from_scan = valleys.iter().take(found.min(self.options.starts.max(1)));
        let all = from_scan.map(|valley| Start { n: valley.n, sigma: valley.sigma }).chain(starts.iter().copied());
        Ok(self.polish_all(band, total_weight, n_obs, all))
    }

    /// Searches from each start and reports the best minimum.
    #[cfg_attr(feature = "std", inline(always))]
    fn polish_all(
        &self,
        band: Band<T>,
        total_weight: T,
        n_obs: usize,
        starts: impl Iterator<Item = Start<T>>,
    ) -> Option<BandFit<T>> {
        let found = self.best_of(band, total_weight, starts)?;
        let mut fit = BandFit::new(&found.best, total_weight, n_obs, &self.options.bounds, self.options.weights);
        fit.iterations = found.iterations;
        fit.starts = found.starts;
        fit.second = found.second;
        Some(fit)
    }

    /// The best minimum, and the next best that is distinct from it.
    #[inline(always)]
    fn best_of(&self, band: Band<T>, total_weight: T, starts: impl Iterator<Item = Start<T>>) -> Option<Found<T>> {
        let mut found: Option<Found<T>> = None;
        for start in starts {
            let candidate = self.polish(band, total_weight, start);
            let Some(found) = &mut found else {
                found = Some(Found { best: candidate, second: None, iterations: candidate.iterations, starts: 1 });
                continue;
            };
            found.iterations += candidate.iterations;
            found.starts += 1;
            let mut loser = candidate.valley();
            if candidate.cost < found.best.cost {
                loser = found.best.valley();
                found.best = candidate;
            }
            if distinct(&found.best, &loser) && found.second.is_none_or(|other| loser.chi2 < other.chi2) {
                found.second = Some(loser);
            }
        }
        let mut found = found?;
        found.second = found.second.filter(|other| distinct(&found.best, other));
        Some(found)
    }

    /// One Newton search.
    #[cfg_attr(feature = "std", inline(always))]
    fn polish(&self, band: Band<T>, total_weight: T, start: Start<T>) -> Candidate<T> {
        let bounds = self.options.bounds;
        let boxed = Profile::<T, L>::box_of(&bounds);
        let mut profile = Profile::<T, L> { directions: self.directions, band, total_weight, bounds, a: T::ZERO };
        let options = SolverOptions {
            tolerance: self.options.tolerance,
            max_iterations: self.options.max_iterations,
            // F₀ changes by a factor of e at most, σ by a factor of 2
            max_step: [T::ONE, T::lit(0.7)],
        };
        let x = [f0_from_n(bounds.n.clip(start.n)).ln(), bounds.sigma.clip(start.sigma).ln()];
        let minimum = minimize(&mut profile, &boxed, &x, &options);

        let last = last_step(&minimum, &boxed, self.options.tolerance);
        let value = |at: AtBound, interval: Interval<T>, x: T| match at {
            AtBound::Lower => interval.lower,
            AtBound::Upper => interval.upper,
            AtBound::Free => interval.clip(x),
        };
        let n = value(minimum.at_bound[0], bounds.n, n_from_f0(last[0].exp())[0]);
        let sigma = value(minimum.at_bound[1], bounds.sigma, last[1].exp());
        // once more with k_L/π as reference: χ² to the last digit, and the normal matrix
        let mut point = profile.at(n, sigma);
        let k_at = if point.k_free {
            AtBound::Free
        } else if point.k_lambert > T::HALF * (bounds.k_lambert.lower + bounds.k_lambert.upper) {
            AtBound::Upper
        } else {
            AtBound::Lower
        };
        point.k_lambert = value(k_at, bounds.k_lambert, point.k_lambert);
        Candidate {
            n,
            sigma,
            k_lambert: point.k_lambert,
            cost: point.cost,
            s: point.s,
            s_s: point.s_s,
            at_bound: [k_at, minimum.at_bound[0], minimum.at_bound[1]],
            iterations: minimum.iterations,
            termination: minimum.termination,
        }
    }
}

/// Where the step that the search saw no need to take would have led: in single precision, where searches stop early, it brings
/// the parameters from a tenth of their errors to a hundredth at no cost, for the last point is looked at once more anyway.
///
/// Inside the box and of a parameter that is free only; in double precision the step is below what anyone reads.
#[cfg_attr(feature = "std", inline(always))]
fn last_step<T: Real>(minimum: &Minimum<T, 2>, boxed: &[Interval<T>; 2], tolerance: T) -> [T; 2] {
    let x = minimum.x;
    let free = minimum.at_bound.iter().all(|at| *at == AtBound::Free);
    if !(free && minimum.termination == Termination::Converged && tolerance > T::lit(1e-8)) {
        return x;
    }
    let Some(step) = solve_spd(&minimum.evaluation.hessian, &minimum.evaluation.gradient) else { return x };
    let moved = [x[0] - step[0], x[1] - step[1]];
    let inside = moved.iter().zip(boxed).all(|(x, bound)| *x > bound.lower && *x < bound.upper);
    if inside { moved } else { x }
}

/// Σ ω and the number of values with ω > 0.
#[cfg_attr(feature = "std", inline(always))]
fn count<T: Real>(band: &Band<T>) -> (T, usize) {
    let mut total = T::ZERO;
    let mut n_obs = 0;
    for w in band.weight {
        total += *w;
        n_obs += usize::from(*w > T::ZERO);
    }
    (total, n_obs)
}

/// What the searches of one band have found.
struct Found<T> {
    best: Candidate<T>,
    second: Option<Valley<T>>,
    iterations: u32,
    starts: u32,
}

/// Two minima are distinct where σ or n differ by more than a tenth of a per cent.
#[inline(always)]
fn distinct<T: Real>(a: &Candidate<T>, b: &Valley<T>) -> bool {
    let apart = |x: T, y: T| (x - y).abs() > T::lit(1e-3) * x.abs();
    let [_, n, sigma] = b.parameters;
    apart(a.sigma, sigma) || apart(a.n, n)
}
