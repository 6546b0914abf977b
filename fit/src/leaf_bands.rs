//! All bands of a leaf: the solver of `band` on the processor at hand, over threads, and a last look at the neighbours.

mod errors;

use std::vec;
use std::vec::Vec;

use leafbrdf_core::{DirectionTerms, Geometry, Normalization, Portable};
use rayon::prelude::*;

use crate::band::scan::{GridSize, Scan, ScanTable};
use crate::band::{Band, BandFit, BandOptions, BandSolver, Directions, Start, Weights};
use crate::{AtBound, FitError, Identifiability};

/// The number type of the host's solver: double precision with an exponential that vectorises.
type Number = Portable<f64>;

/// Lanes that the host's solver adds in.
const LANES: usize = 8;

/// Bands that one thread takes at a time.
const CHUNK: usize = 32;

/// Measured BRDF of one leaf: directions × wavelengths.
#[derive(Clone, Copy, Debug)]
pub struct LeafData<'a> {
    /// One geometry a direction.
    pub geometries: &'a [Geometry<f64>],
    /// BRDF in sr⁻¹, band after band, one value a direction; NaN where missing.
    pub brdf: &'a [f64],
    /// Standard deviation of each value in sr⁻¹, in the same order, > 0; without it every value counts the same.
    pub sd: Option<&'a [f64]>,
}

/// How the bands of a leaf are fitted.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafBandsOptions {
    /// The convention for K that n and σ belong to.
    pub normalization: Normalization,
    /// Bounds, tolerance, and so on of each band.
    pub band: BandOptions<f64>,
    /// The grid of the scan.
    pub grid: GridSize,
    /// Starts of the caller's own, tried on every band beside the scan's.
    pub starts: Vec<Start<f64>>,
    /// Huber's loss instead of squares: values farther than 1.345 scaled median absolute deviations count less.
    pub robust: bool,
}

impl Default for LeafBandsOptions {
    /// The paper's problem (§4.2, Table 3), under `Bousquet2005`.
    fn default() -> Self {
        LeafBandsOptions {
            normalization: Normalization::Bousquet2005,
            band: BandOptions::table_3(),
            grid: GridSize::DEFAULT,
            starts: Vec::new(),
            robust: false,
        }
    }
}

/// The result for one band of a leaf: `None` where fewer than 3 values are left.
pub type BandResult = Option<BandFit<f64>>;

/// Fits k_L, n, σ at every wavelength (§4.2), in parallel over the threads of the current rayon pool.
///
/// Where the sd are not known (`Weights::Relative`) and 20 bands or more have a result, standard errors know how large each direction's
/// noise is, from neighbouring bands ([`Noise::ByDirection`](crate::band::Noise::ByDirection)); not those of a robust fit.
///
/// The result does not depend on the number of threads. `progress` is told how many bands have been done since the last call.
///
/// # Errors
/// [`FitError`] for bounds out of order, slices whose lengths do not belong together, infinite values, or sd ≤ 0.
pub fn fit_bands(
    data: &LeafData,
    options: &LeafBandsOptions,
    progress: &(dyn Fn(usize) + Sync),
) -> Result<Vec<BandResult>, FitError> {
    let leaf = Prepared::new(data, options)?;
    let mut workspace = vec![Portable(0.0); options.grid.workspace(leaf.width)];
    let table = ScanTable::new(options.grid, leaf.options.bounds, leaf.directions(), leaf.real, &mut workspace)
        .ok_or(FitError::Bounds { parameter: "grid", expected: "at least 2 values of sigma and of n" })?;
    let starts: Vec<Start<Number>> =
        options.starts.iter().map(|s| Start { n: Portable(s.n), sigma: Portable(s.sigma) }).collect();

    let bands = leaf.bands();
    let mut results: Vec<BandResult> = vec![None; bands];
    results.par_chunks_mut(CHUNK).enumerate().try_for_each(|(chunk, results)| {
        let mut cost = vec![Portable(0.0); options.grid.points()];
        let scan = Scan::new(table, &mut cost);
        let solver = BandSolver::<Number, LANES>::new(leaf.directions(), leaf.options, scan)?;
        let count = results.len();
        pulp::Arch::new().dispatch(Job { leaf: &leaf, solver, starts: &starts, first: chunk * CHUNK, results })?;
        progress(count);
        Ok::<(), FitError>(())
    })?;
    neighbours(&leaf, &mut results)?;
    if options.robust {
        // residuals of values that count less say nothing of the noise
        robust(&leaf, &mut results)?;
    } else if options.band.weights == Weights::Relative {
        errors::by_direction(&leaf, &mut results);
    }
    Ok(results)
}

/// The leaf's numbers as the solver takes them: padded to whole lanes, missing values with weight 0.
struct Prepared {
    terms: [Vec<Number>; 3],
    brdf: Vec<Number>,
    weight: Vec<Number>,
    options: BandOptions<Number>,
    /// directions, with and without padding
    width: usize,
    real: usize,
}

impl Prepared {
    fn new(data: &LeafData, options: &LeafBandsOptions) -> Result<Self, FitError> {
        let real = data.geometries.len();
        let width = real.next_multiple_of(LANES);
        if real == 0 || !data.brdf.len().is_multiple_of(real) {
            let expected = data.brdf.len().next_multiple_of(real.max(1));
            return Err(FitError::Length { what: "brdf", found: data.brdf.len(), expected });
        }
        if let Some(sd) = data.sd {
            if sd.len() != data.brdf.len() {
                return Err(FitError::Length { what: "sd", found: sd.len(), expected: data.brdf.len() });
            }
            // a missing value may have any sd, a value that counts must have a positive one
            if let Some(index) =
                sd.iter().zip(data.brdf).position(|(sd, y)| !y.is_nan() && !(*sd > 0.0 && sd.is_finite()))
            {
                return Err(FitError::NotFinite { what: "sd (or is not positive)", index });
            }
        }
        let band = &options.band;
        band.bounds.check()?;

        let mut terms = [const { Vec::new() }; 3];
        for geometry in data.geometries {
            let DirectionTerms { cos_theta_a, tan2_alpha, weight } =
                DirectionTerms::new(geometry, options.normalization);
            for (list, value) in terms.iter_mut().zip([cos_theta_a, tan2_alpha, weight]) {
                list.push(Portable(value));
            }
        }
        let padding = Directions::<Number>::padding();
        for (list, value) in terms.iter_mut().zip([padding.cos_theta_a, padding.tan2_alpha, padding.weight]) {
            list.resize(width, value);
        }

        let bands = data.brdf.len() / real;
        let mut brdf = vec![Portable(0.0); bands * width];
        let mut weight = vec![Portable(0.0); bands * width];
        for (b, values) in data.brdf.chunks_exact(real).enumerate() {
            for (i, y) in values.iter().enumerate().filter(|(_, y)| !y.is_nan()) {
                brdf[b * width + i] = Portable(*y);
                weight[b * width + i] = Portable(data.sd.map_or(1.0, |sd| 1.0 / (sd[b * real + i] * sd[b * real + i])));
            }
        }
        let interval = |x: crate::Interval<f64>| crate::Interval::new(Portable(x.lower), Portable(x.upper));
        let options = BandOptions {
            bounds: crate::BandBounds {
                k_lambert: interval(band.bounds.k_lambert),
                n: interval(band.bounds.n),
                sigma: interval(band.bounds.sigma),
            },
            tolerance: Portable(band.tolerance),
            max_iterations: band.max_iterations,
            starts: band.starts,
            weights: band.weights,
        };
        Ok(Prepared { terms, brdf, weight, options, width, real })
    }

    fn bands(&self) -> usize {
        self.brdf.len() / self.width
    }

    #[inline(always)]
    fn directions(&self) -> Directions<'_, Number> {
        let [cos_theta_a, tan2_alpha, weight] = &self.terms;
        Directions { cos_theta_a, tan2_alpha, weight }
    }

    #[inline(always)]
    fn band(&self, b: usize) -> Band<'_, Number> {
        let place = b * self.width..(b + 1) * self.width;
        Band { brdf: &self.brdf[place.clone()], weight: &self.weight[place] }
    }
}

/// One thread's share of the bands, compiled for each instruction set by `pulp`.
struct Job<'a, 'b> {
    leaf: &'a Prepared,
    solver: BandSolver<'b, Number, LANES>,
    starts: &'a [Start<Number>],
    first: usize,
    results: &'a mut [BandResult],
}

impl pulp::NullaryFnOnce for Job<'_, '_> {
    type Output = Result<(), FitError>;

    #[inline(always)]
    fn call(mut self) -> Self::Output {
        for (i, result) in self.results.iter_mut().enumerate() {
            *result = self.solver.fit(self.leaf.band(self.first + i), self.starts)?.map(|fit| fit.to_f64());
        }
        Ok(())
    }
}

/// One search from a given start, without a scan.
struct Polish<'a> {
    leaf: &'a Prepared,
    weight: Option<&'a [Number]>,
    band: usize,
    start: Start<Number>,
}

impl pulp::NullaryFnOnce for Polish<'_> {
    type Output = Result<BandResult, FitError>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let mut band = self.leaf.band(self.band);
        if let Some(weight) = self.weight {
            band.weight = weight;
        }
        let mut solver = BandSolver::<Number, LANES>::new(self.leaf.directions(), self.leaf.options, None)?;
        Ok(solver.fit(band, &[self.start])?.map(|fit| fit.to_f64()))
    }
}

/// Starts each band from its neighbours' solutions where these lie elsewhere, for as long as that improves any.
///
/// Neighbouring wavelengths have nearly the same valleys: where two valleys are equally deep, the scan may miss the deeper one
/// in one band and find it in the next. Each round looks at the solutions of the round before, so the order does not matter.
fn neighbours(leaf: &Prepared, results: &mut [BandResult]) -> Result<(), FitError> {
    const ROUNDS: usize = 50;
    let mut changed: Vec<bool> = vec![true; results.len()];
    for _ in 0..ROUNDS {
        let before = results.to_vec();
        let improved: Vec<BandResult> = (0..results.len())
            .into_par_iter()
            .map(|b| {
                let here = before.get(b).copied().flatten();
                let mut better = None;
                for other in [b.checked_sub(1), Some(b + 1)].into_iter().flatten() {
                    let (Some(here), Some(Some(there))) = (better.or(here), before.get(other)) else { continue };
                    if !changed.get(other).copied().unwrap_or(false) || !elsewhere(&here, there) {
                        continue;
                    }
                    let start = Start { n: Portable(there.parameters[1]), sigma: Portable(there.parameters[2]) };
                    let found = pulp::Arch::new().dispatch(Polish { leaf, weight: None, band: b, start })?;
                    if let Some(found) = found.filter(|found| found.chi2 < here.chi2 * (1.0 - 1e-9)) {
                        better = Some(merge(here, found));
                    }
                }
                Ok::<_, FitError>(better)
            })
            .collect::<Result<_, _>>()?;
        let mut any = false;
        for ((result, change), better) in results.iter_mut().zip(&mut changed).zip(improved) {
            *change = better.is_some();
            any |= *change;
            if better.is_some() {
                *result = better;
            }
        }
        if !any {
            break;
        }
    }
    Ok(())
}

/// The better solution, keeping count of the work and the former solution as the second valley.
fn merge(former: BandFit<f64>, found: BandFit<f64>) -> BandFit<f64> {
    BandFit {
        iterations: former.iterations + found.iterations,
        starts: former.starts + found.starts,
        second: Some(crate::Valley { parameters: former.parameters, chi2: former.chi2 }),
        ..found
    }
}

/// Are two solutions different enough in n or σ to be in different valleys?
fn elsewhere(a: &BandFit<f64>, b: &BandFit<f64>) -> bool {
    let apart = |i: usize| (a.parameters[i] - b.parameters[i]).abs() > 0.02 * a.parameters[i].abs();
    apart(1) || apart(2)
}

/// Huber's loss by reweighting: the scale is 1.4826 × the median absolute residual of the band, the knee 1.345 scales.
fn robust(leaf: &Prepared, results: &mut [BandResult]) -> Result<(), FitError> {
    const ROUNDS: usize = 30;
    results.par_iter_mut().enumerate().try_for_each(|(b, result)| {
        let Some(mut fit) = *result else { return Ok(()) };
        let band = leaf.band(b);
        let mut weight = band.weight.to_vec();
        for _ in 0..ROUNDS {
            let residuals = residuals(leaf, b, &fit.parameters)?;
            let mut sizes: Vec<f64> = residuals
                .iter()
                .zip(band.weight)
                .filter(|(_, w)| w.0 > 0.0)
                .map(|(r, w)| r.abs() * w.0.sqrt())
                .collect();
            sizes.sort_by(f64::total_cmp);
            let scale = 1.4826 * sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
            if !(scale > 0.0) {
                break;
            }
            for ((w, w0), r) in weight.iter_mut().zip(band.weight).zip(&residuals) {
                let size = r.abs() * w0.0.sqrt();
                *w = Portable(w0.0 * (1.345 * scale / size).min(1.0));
            }
            let [_, n, sigma] = fit.parameters;
            let start = Start { n: Portable(n), sigma: Portable(sigma) };
            let Some(next) = pulp::Arch::new().dispatch(Polish { leaf, weight: Some(&weight), band: b, start })? else {
                break;
            };
            let still = (0..3).all(|i| (next.parameters[i] - fit.parameters[i]).abs() < 1e-7 * fit.parameters[i].abs());
            fit = BandFit {
                iterations: fit.iterations + next.iterations,
                starts: fit.starts,
                second: fit.second,
                ..next
            };
            if still {
                break;
            }
        }
        // χ² of the data as they are, so that rmse compares with the plain fit's
        fit.chi2 = residuals(leaf, b, &fit.parameters)?.iter().zip(band.weight).map(|(r, w)| w.0 * r * r).sum();
        *result = Some(fit);
        Ok(())
    })
}

/// Measured − modelled BRDF of one band, padding included.
fn residuals(leaf: &Prepared, b: usize, parameters: &[f64; 3]) -> Result<Vec<f64>, FitError> {
    let [k_lambert, n, sigma] = *parameters;
    let index = leafbrdf_core::Dielectric::new(Portable(n))?;
    let directions = leaf.directions();
    let terms = directions.cos_theta_a.iter().zip(directions.tan2_alpha).zip(directions.weight);
    Ok(terms
        .zip(leaf.band(b).brdf)
        .map(|(((cos_theta_a, tan2_alpha), weight), y)| {
            let terms = DirectionTerms { cos_theta_a: *cos_theta_a, tan2_alpha: *tan2_alpha, weight: *weight };
            y.0 - terms.brdf(index, Portable(sigma)).0 - k_lambert * core::f64::consts::FRAC_1_PI
        })
        .collect())
}

/// Why a parameter of a band has no standard error, in a few words; `None` where it has one.
pub fn why_no_error(fit: &BandFit<f64>, parameter: usize) -> Option<&'static str> {
    match fit.identifiability.get(parameter)? {
        Identifiability::Identified => None,
        Identifiability::Held => Some(match fit.at_bound.get(parameter)? {
            AtBound::Lower => "held at its lower bound",
            _ => "held at its upper bound",
        }),
        Identifiability::NotIdentifiable => Some("not identifiable from these directions"),
        Identifiability::NoDegreesOfFreedom => Some("no more values than parameters"),
    }
}
