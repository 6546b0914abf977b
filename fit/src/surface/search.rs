//! The global minimum: a scan of the whole box, and a Newton search from every valley that it shows.
//!
//! The scan goes through σ × n, and through the tilts where these are free, a and b standing at their prior means. From the
//! plane of incidence alone, a tilt and b can stand in for the lobe: there the scan goes through b as well. Its cost is a few
//! microseconds a point, whatever the number of bands.

mod polish;
mod scan;
mod treatment;
mod valleys;

use leafbrdf_core::Real;

use self::scan::{is_valley, point, scan};
use super::model::{DirectionalModel, PARAMETERS};
use super::profile::Profile;

pub use polish::polish;
pub use scan::ScanSize;
pub use treatment::{Prior, Treatment};
pub use valleys::{MOST_VALLEYS, Valley, Valleys};

/// How the minimum is sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchOptions<T> {
    /// What becomes of n, σ, a, b, t_x, t_y, e.
    pub parameters: [Treatment<T>; PARAMETERS],
    /// ν: how many independent residuals the measurement counts as where priors are weighed against it.
    pub draws: T,
    /// Stop where the predicted decrease is below this share of the cost.
    pub tolerance: T,
    /// The most steps a search.
    pub max_iterations: u32,
    /// The grid of the scan.
    pub scan: ScanSize,
    /// The most valleys of the scan that are searched, at most [`MOST_VALLEYS`].
    pub valleys: usize,
}

/// Searches the whole box, and from the caller's own `starts` besides. `grid` is workspace, [`ScanSize::workspace`] numbers;
/// with fewer there is no scan.
pub fn search<T: Real, M: DirectionalModel<T>>(
    profile: &mut Profile<'_, T, M>,
    options: &SearchOptions<T>,
    starts: &[[T; PARAMETERS]],
    grid: &mut [T],
) -> Valleys<T> {
    let mut valleys = Valleys::none();
    for start in starts {
        valleys.add(polish(profile, options, start));
    }
    let along = options.scan.along(&options.parameters);
    if let Some(grid) = grid.get_mut(..along.iter().product()) {
        scan(profile, options, along, grid);
        let mut chosen: [Option<(T, usize)>; MOST_VALLEYS] = [None; MOST_VALLEYS];
        let most = options.valleys.clamp(1, MOST_VALLEYS);
        for (index, cost) in grid.iter().enumerate() {
            if is_valley(grid, along, index) {
                let mut new = Some((*cost, index));
                for place in chosen.iter_mut().take(most) {
                    if place.is_none_or(|old| new.is_some_and(|new| new.0 < old.0)) {
                        core::mem::swap(place, &mut new);
                    }
                }
            }
        }
        for (_, index) in chosen.iter().flatten() {
            valleys.add(polish(profile, options, &point(&options.parameters, along, *index)));
        }
        // and the best of each tilt: with a at its mean the scan may not see a valley there
        let of_tilt = (along[3] * along[4]).max(1);
        if grid.len() > of_tilt {
            for (tilt, costs) in grid.chunks_exact(of_tilt).enumerate() {
                let lower = |best: (usize, T), (i, cost): (usize, &T)| if *cost < best.1 { (i, *cost) } else { best };
                let (i, cost) = costs.iter().enumerate().fold((0, T::MAX), lower);
                let index = tilt * of_tilt + i;
                if cost < T::MAX && !chosen.iter().flatten().any(|(_, other)| *other == index) {
                    valleys.add(polish(profile, options, &point(&options.parameters, along, index)));
                }
            }
        }
    }
    valleys
}
