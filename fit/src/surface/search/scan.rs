//! The grid over the whole box: σ × n, and tilts and b where these are free.

use leafbrdf_core::Real;

use super::SearchOptions;
use super::polish::penalty;
use super::treatment::Treatment;
use crate::band::profile::{f0_from_n, n_from_f0};
use crate::surface::model::{DIFFUSE_B, DirectionalModel, N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use crate::surface::profile::Profile;

/// Points of the scan along each parameter that is free; one point along held ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanSize {
    /// Values of σ, in equal steps of ln σ, both bounds included.
    pub sigma: usize,
    /// Values of n, in equal ratios of F₀, both bounds included.
    pub n: usize,
    /// Values of each tilt, ends (80 % of the bounds) included; odd, so that 0 is among them. Where only one tilt is free, one less
    /// than twice as many.
    pub tilt: usize,
}

impl ScanSize {
    /// 20 × 12 × 5 × 5: see `docs/inversion.md` for what it takes to miss a valley.
    pub const DEFAULT: ScanSize = ScanSize { sigma: 20, n: 12, tilt: 5 };

    /// Points along t_x, t_y, b, σ, n.
    pub(super) fn along(self, parameters: &[Treatment<impl Real>; PARAMETERS]) -> [usize; AXES] {
        let free = |place: usize| parameters[place].is_free();
        let of = |place: usize, points: usize| if free(place) { points.max(2) } else { 1 };
        let both = free(TILT_IN_PLANE) && free(TILT_LATERAL);
        let tilt = if both { self.tilt } else { 2 * self.tilt.max(2) - 1 };
        let b = if free(TILT_IN_PLANE) && !both { of(DIFFUSE_B, 3) } else { 1 };
        [of(TILT_IN_PLANE, tilt), of(TILT_LATERAL, tilt), b, of(SIGMA, self.sigma), of(N, self.n)]
    }

    /// Numbers of workspace that the scan takes.
    pub fn workspace(self, parameters: &[Treatment<impl Real>; PARAMETERS]) -> usize {
        self.along(parameters).iter().product()
    }
}

/// Axes of the scan: t_x, t_y, b, σ, n; n runs fastest.
pub(super) const AXES: usize = 5;
const PLACES: [usize; AXES] = [TILT_IN_PLANE, TILT_LATERAL, DIFFUSE_B, SIGMA, N];

/// The index along each axis of a point of the grid.
fn indices(along: [usize; AXES], index: usize) -> [usize; AXES] {
    let mut rest = index;
    let mut place = [0; AXES];
    for (i, points) in place.iter_mut().zip(along).rev() {
        *i = rest % points.max(1);
        rest /= points.max(1);
    }
    place
}

/// The parameters at a point of the grid.
pub(super) fn point<T: Real>(
    parameters: &[Treatment<T>; PARAMETERS],
    along: [usize; AXES],
    index: usize,
) -> [T; PARAMETERS] {
    let mut x = parameters.map(|one| one.resting());
    for ((place, i), points) in PLACES.into_iter().zip(indices(along, index)).zip(along) {
        let Treatment::Free { bounds, prior } = parameters[place] else { continue };
        if points < 2 {
            continue;
        }
        let share = T::lit(i as f64) / T::lit((points - 1) as f64);
        let between = |lower: T, upper: T| lower + share * (upper - lower);
        x[place] = bounds.clip(match place {
            SIGMA => between(bounds.lower.ln(), bounds.upper.ln()).exp(),
            N => n_from_f0(between(f0_from_n(bounds.lower).ln(), f0_from_n(bounds.upper).ln()).exp())[0],
            DIFFUSE_B => {
                let reach = prior.map_or(T::lit(0.15), |prior| T::lit(1.5) * prior.sd);
                x[place] + between(-reach, reach)
            }
            _ => between(T::lit(0.8) * bounds.lower, T::lit(0.8) * bounds.upper),
        });
    }
    x
}

/// χ² · exp(Π/ν) at every point of `grid`; the largest number where the model cannot be evaluated.
pub(super) fn scan<T: Real, M: DirectionalModel<T>>(
    profile: &mut Profile<'_, T, M>,
    options: &SearchOptions<T>,
    along: [usize; AXES],
    grid: &mut [T],
) {
    let [.., sigma, n] = along;
    for (tilt, costs) in grid.chunks_exact_mut((sigma * n).max(1)).enumerate() {
        let first = point(&options.parameters, along, tilt * sigma * n);
        // below the horizon, or outside a domain: no valley there
        let constant = match profile.chi2(&first) {
            Ok(_) => profile.chi2_without_lobe(),
            Err(_) => T::MAX,
        };
        for (i, cost) in costs.iter_mut().enumerate() {
            let x = point(&options.parameters, along, tilt * sigma * n + i);
            *cost = match profile.chi2_of_lobe(&x) {
                Ok(chi2) if constant < T::MAX => (constant + chi2) * penalty(options, &x),
                _ => T::MAX,
            };
        }
    }
}

/// Is no neighbour along any axis lower? Of equals, the first counts.
pub(super) fn is_valley<T: Real>(grid: &[T], along: [usize; AXES], index: usize) -> bool {
    let Some(here) = grid.get(index) else { return false };
    if !(*here < T::MAX) {
        return false;
    }
    let place = indices(along, index);
    let mut strides = [1; AXES];
    let mut stride = 1;
    for (one, points) in strides.iter_mut().zip(along).rev() {
        *one = stride;
        stride *= points;
    }
    place.iter().zip(along).zip(strides).all(|((i, points), stride)| {
        let below = *i == 0 || index.checked_sub(stride).and_then(|j| grid.get(j)).is_none_or(|other| *here < *other);
        let above = *i + 1 >= points || grid.get(index + stride).is_none_or(|other| *here <= *other);
        below && above
    })
}
