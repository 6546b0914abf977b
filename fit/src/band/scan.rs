//! The coarse scan: χ² with k_L eliminated on a grid over the whole box of (σ, n), and the valleys it shows.
//!
//! With one source angle χ² often has a second valley at large σ, where a start from Table 3 ends on many real leaves. The grid is the
//! same for all bands, so the lobe is computed once; a band then costs one matrix–vector product.

use leafbrdf_core::facet::beckmann;
use leafbrdf_core::{Dielectric, Index, Real};

use super::profile::{f0_from_n, n_from_f0};
use super::{Band, Directions};
use crate::bounds::BandBounds;

/// Grid points are worked on in blocks of this many: the sums of a block stay in registers.
const BLOCK: usize = 32;

/// Size of the grid: `sigma` × `n` values, both ends of each interval included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridSize {
    /// Values of σ, in equal steps of ln σ; at least 2.
    pub sigma: usize,
    /// Values of n, in equal ratios of F₀; at least 2.
    pub n: usize,
}

impl GridSize {
    /// 24 × 16, as fine as real leaves need (an exhaustive search finds nothing better: see the crate's README).
    pub const DEFAULT: GridSize = GridSize { sigma: 24, n: 16 };

    /// Grid points, rounded up to whole blocks.
    pub const fn points(self) -> usize {
        (self.sigma * self.n).next_multiple_of(BLOCK)
    }

    /// Numbers of workspace that a [`ScanTable`] takes for so many directions.
    pub const fn workspace(self, directions: usize) -> usize {
        self.points() * (directions + 2)
    }
}

/// BRDF_spec at every grid point and direction, in caller-owned memory; shared by all bands and threads.
#[derive(Clone, Copy, Debug)]
pub struct ScanTable<'a, T> {
    size: GridSize,
    bounds: BandBounds<T>,
    /// BRDF_spec, one row of grid points a direction
    lobe: &'a [T],
    /// Σ s and Σ s² of each grid point over all directions, for bands where every value counts once
    sum: &'a [T],
    sum2: &'a [T],
    /// directions that are not padding
    real_directions: usize,
}

/// The shared table and one solver's own memory for χ² on the grid.
#[derive(Debug)]
pub struct Scan<'a, T> {
    table: ScanTable<'a, T>,
    cost: &'a mut [T],
}

/// A valley of χ² on the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GridMinimum<T> {
    pub cost: T,
    pub n: T,
    pub sigma: T,
}

impl<'a, T: Real> ScanTable<'a, T> {
    /// Computes the lobe on the grid for `real_directions` directions (the others are padding).
    ///
    /// `None` if `workspace` holds fewer than [`GridSize::workspace`] numbers, or the grid has fewer than two values of a
    /// parameter.
    pub fn new(
        size: GridSize,
        bounds: BandBounds<T>,
        directions: Directions<T>,
        real_directions: usize,
        workspace: &'a mut [T],
    ) -> Option<Self> {
        let points = size.points();
        if size.sigma < 2 || size.n < 2 {
            return None;
        }
        let (lobe, rest) = workspace.split_at_mut_checked(points * directions.len())?;
        let (sum, rest) = rest.split_at_mut_checked(points)?;
        let (sum2, _) = rest.split_at_mut_checked(points)?;
        sum.fill(T::ZERO);
        sum2.fill(T::ZERO);
        lobe.fill(T::ZERO);
        let terms = directions.cos_theta_a.iter().zip(directions.tan2_alpha).zip(directions.weight);
        // `max(1)` changes nothing; it tells the compiler that there is no chunk of length 0, and so no panic
        for (row, ((cos_theta_a, tan2_alpha), weight)) in lobe.chunks_exact_mut(points.max(1)).zip(terms) {
            // F of every n in the place of the first σ, then F · D of every σ, the first one last
            let (first, others) = row.split_at_mut_checked(size.n)?;
            for (k, value) in first.iter_mut().enumerate() {
                if let Ok(index) = Dielectric::new(grid_n(size, &bounds, k)) {
                    *value = index.fresnel(*cos_theta_a);
                }
            }
            let lobe_at = |j: usize| beckmann(*tan2_alpha, grid_sigma(size, &bounds, j)) * *weight;
            for (j, row) in others.chunks_exact_mut(size.n).take(size.sigma - 1).enumerate() {
                let d = lobe_at(j + 1);
                for (value, f) in row.iter_mut().zip(&*first) {
                    *value = *f * d;
                }
            }
            let d = lobe_at(0);
            for value in first {
                *value *= d;
            }
            for ((value, sum), sum2) in row.iter().zip(&mut *sum).zip(&mut *sum2) {
                *sum += *value;
                *sum2 += value.squared();
            }
        }
        Some(ScanTable { size, bounds, lobe, sum, sum2, real_directions })
    }
}

impl<'a, T: Real> Scan<'a, T> {
    /// A scan by this table; `cost` is the solver's own memory of [`GridSize::points`] numbers. `None` if it is shorter.
    pub fn new(table: ScanTable<'a, T>, cost: &'a mut [T]) -> Option<Self> {
        let cost = cost.get_mut(..table.size.points())?;
        Some(Scan { table, cost })
    }

    /// Fills `valleys` with the local minima over σ of min over n, best first, and returns how many there are.
    #[inline(always)]
    pub(super) fn valleys<const M: usize>(
        &mut self,
        band: Band<T>,
        total_weight: T,
        valleys: &mut [GridMinimum<T>; M],
    ) -> usize {
        self.costs(band, total_weight);
        let size = self.table.size;
        let bounds = self.table.bounds;
        let mut found = 0;
        // best n for the σ before, at, and after
        let best_of = |j: usize, costs: &[T]| {
            let mut best = (T::MAX, 0);
            let rows = costs.get(j * size.n..(j + 1) * size.n).unwrap_or(&[]);
            for (k, cost) in rows.iter().enumerate() {
                if *cost < best.0 {
                    best = (*cost, k);
                }
            }
            best
        };
        let mut before = T::MAX;
        let mut here = best_of(0, self.cost);
        for j in 0..size.sigma {
            let after = if j + 1 < size.sigma { best_of(j + 1, self.cost) } else { (T::MAX, 0) };
            if here.0 <= before && here.0 < after.0 {
                let (n, sigma) = (grid_n(size, &bounds, here.1), grid_sigma(size, &bounds, j));
                found = insert(valleys, found, GridMinimum { cost: here.0, n, sigma });
            }
            before = here.0;
            here = after;
        }
        found
    }

    /// χ² at every grid point: Σω(y−s)² with k_L at its best.
    #[inline(always)]
    fn costs(&mut self, band: Band<T>, total_weight: T) {
        let table = self.table;
        let points = table.size.points();
        let inv_weight = T::ONE / total_weight;
        let every_value_once = total_weight == T::lit(table.real_directions as f64)
            && band.weight.iter().all(|w| *w == T::ZERO || *w == T::ONE);
        let mut sum_y = T::ZERO;
        for (y, w) in band.brdf.iter().zip(band.weight) {
            sum_y += *w * *y;
        }
        let mean = sum_y * inv_weight;
        // centred: what k_L takes away anyway
        let mut centred2 = T::ZERO;
        for (y, w) in band.brdf.iter().zip(band.weight) {
            centred2 += *w * (*y - mean).squared();
        }
        let k = table.bounds.k_lambert;
        let inv_pi = T::lit(core::f64::consts::FRAC_1_PI);
        let (lower, upper) = (k.lower * inv_pi, k.upper * inv_pi);

        let blocks = self.cost.as_chunks_mut::<BLOCK>().0.iter_mut();
        let sums = table.sum.as_chunks::<BLOCK>().0.iter().zip(table.sum2.as_chunks::<BLOCK>().0);
        for (b, (cost, (sum, sum2))) in blocks.zip(sums).enumerate() {
            let mut y_s = [T::ZERO; BLOCK];
            let mut s = *sum;
            let mut s_s = *sum2;
            let rows = || table.lobe.chunks_exact(points.max(1)).filter_map(|row| row.as_chunks::<BLOCK>().0.get(b));
            if every_value_once {
                for ((row, y), w) in rows().zip(band.brdf).zip(band.weight) {
                    let w_y = *w * (*y - mean);
                    for l in 0..BLOCK {
                        y_s[l] += w_y * row[l];
                    }
                }
            } else {
                s = [T::ZERO; BLOCK];
                s_s = [T::ZERO; BLOCK];
                for ((row, y), w) in rows().zip(band.brdf).zip(band.weight) {
                    let w_y = *w * (*y - mean);
                    for l in 0..BLOCK {
                        y_s[l] += w_y * row[l];
                        s[l] += *w * row[l];
                        s_s[l] += *w * row[l].squared();
                    }
                }
            }
            for l in 0..BLOCK {
                let mean_s = s[l] * inv_weight;
                let free = centred2 - T::TWO * y_s[l] + (s_s[l] - s[l] * mean_s);
                let best = mean - mean_s;
                let excess = best - best.max(lower).min(upper);
                cost[l] = free + total_weight * excess.squared();
            }
        }
    }
}

/// The k-th n of the grid.
fn grid_n<T: Real>(size: GridSize, bounds: &BandBounds<T>, k: usize) -> T {
    let f0 = geometric(f0_from_n(bounds.n.lower), f0_from_n(bounds.n.upper), k, size.n);
    bounds.n.clip(n_from_f0(f0)[0])
}

/// The j-th σ of the grid.
fn grid_sigma<T: Real>(size: GridSize, bounds: &BandBounds<T>, j: usize) -> T {
    bounds.sigma.clip(geometric(bounds.sigma.lower, bounds.sigma.upper, j, size.sigma))
}

/// The i-th of `count` values from `lower` to `upper` in equal ratios.
fn geometric<T: Real>(lower: T, upper: T, i: usize, count: usize) -> T {
    let share = T::lit(i as f64) / T::lit((count - 1) as f64);
    (lower.ln() + share * (upper.ln() - lower.ln())).exp()
}

/// Inserts by ascending cost; the worst falls out where there is no room.
#[inline(always)]
fn insert<T: Real, const M: usize>(list: &mut [GridMinimum<T>; M], len: usize, item: GridMinimum<T>) -> usize {
    let mut carried = item;
    for slot in list.iter_mut().take(len) {
        if carried.cost < slot.cost {
            core::mem::swap(slot, &mut carried);
        }
    }
    match list.get_mut(len) {
        Some(slot) => {
            *slot = carried;
            len + 1
        }
        None => len,
    }
}
