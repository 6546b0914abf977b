//! The global minimum: a scan of the whole box, and a Newton search from every valley that it shows.
//!
//! The scan goes through σ × n, and through the tilts where these are free, a and b standing at their prior means. From the
//! plane of incidence alone, a tilt and b can stand in for the lobe: there the scan goes through b as well. Its cost is a few
//! microseconds a point, whatever the number of bands.

use leafbrdf_core::Real;

use super::model::{DIFFUSE_B, DirectionalModel, N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL};
use super::profile::{Derivatives, Profile};
use crate::band::profile::{f0_from_n, n_from_f0};
use crate::bounds::{AtBound, Interval};
use crate::solver::{Evaluation, Objective, SolverOptions, Termination, minimize};

/// What is known of a parameter before the measurement: a normal distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior<T> {
    /// Its mean.
    pub mean: T,
    /// Its standard deviation, > 0.
    pub sd: T,
}

/// What becomes of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Treatment<T> {
    /// Sought within bounds.
    Free {
        /// The bounds.
        bounds: Interval<T>,
        /// What is known beforehand.
        prior: Option<Prior<T>>,
    },
    /// Held at a value.
    Held(T),
}

impl<T: Real> Treatment<T> {
    /// Sought within bounds, nothing known beforehand.
    pub const fn within(lower: T, upper: T) -> Self {
        Treatment::Free { bounds: Interval::new(lower, upper), prior: None }
    }

    /// Is it sought?
    pub const fn is_free(&self) -> bool {
        matches!(self, Treatment::Free { .. })
    }

    /// The prior of a free parameter.
    pub const fn prior(&self) -> Option<Prior<T>> {
        match self {
            Treatment::Free { prior, .. } => *prior,
            Treatment::Held(_) => None,
        }
    }

    /// Where a scan of other parameters leaves it: the prior mean, else 0 or the bound nearest to it.
    fn resting(&self) -> T {
        match self {
            Treatment::Held(value) => *value,
            Treatment::Free { bounds, prior } => bounds.clip(prior.map_or(T::ZERO, |prior| prior.mean)),
        }
    }
}

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
    fn along(self, parameters: &[Treatment<impl Real>; PARAMETERS]) -> [usize; AXES] {
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
const AXES: usize = 5;
const PLACES: [usize; AXES] = [TILT_IN_PLANE, TILT_LATERAL, DIFFUSE_B, SIGMA, N];

/// The most valleys that are searched, and kept.
pub const MOST_VALLEYS: usize = 12;

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

/// A minimum that a search has found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Valley<T> {
    /// n, σ, a, b, t_x, t_y, e.
    pub x: [T; PARAMETERS],
    /// χ² · exp(Π/ν), what is minimised: χ² where there are no priors.
    pub cost: T,
    /// χ².
    pub chi2: T,
    /// Which parameters sit at a bound.
    pub at_bound: [AtBound; PARAMETERS],
    /// Newton steps.
    pub iterations: u32,
    /// Why the search ended.
    pub termination: Termination,
}

/// All valleys that were found, the deepest first, each once.
#[derive(Clone, Copy, Debug)]
pub struct Valleys<T> {
    found: [Option<Valley<T>>; MOST_VALLEYS],
    /// Searches made.
    pub starts: u32,
    /// Newton steps over all searches.
    pub iterations: u32,
}

impl<T: Real> Valleys<T> {
    /// The deepest; `None` only where the model could not be evaluated anywhere.
    pub fn best(&self) -> Option<&Valley<T>> {
        self.found.first()?.as_ref()
    }

    /// The deepest valley elsewhere, where there is one.
    pub fn second(&self) -> Option<&Valley<T>> {
        self.found.get(1)?.as_ref()
    }

    /// All of them, the deepest first.
    pub fn iter(&self) -> impl Iterator<Item = &Valley<T>> {
        self.found.iter().flatten()
    }

    fn add(&mut self, valley: Valley<T>) {
        self.starts += 1;
        self.iterations += valley.iterations;
        if !valley.cost.is_finite() {
            return;
        }
        let mut new = Some(valley);
        for place in &mut self.found {
            match (&*place, &new) {
                (Some(old), Some(this)) if old.cost <= this.cost => {
                    if same_place(old, this) {
                        return;
                    }
                }
                (_, Some(_)) => core::mem::swap(place, &mut new),
                (_, None) => break,
            }
        }
        // what the new one has pushed down may be its own shallower likeness
        let mut kept = [None; MOST_VALLEYS];
        let mut places = kept.iter_mut();
        for (i, this) in self.found.iter().enumerate() {
            let Some(this) = this else { continue };
            if self.found.iter().take(i).flatten().all(|other| !same_place(other, this))
                && let Some(place) = places.next()
            {
                *place = Some(*this);
            }
        }
        self.found = kept;
    }
}

/// Within 2 % in n and σ, and half a degree in the tilts?
fn same_place<T: Real>(a: &Valley<T>, b: &Valley<T>) -> bool {
    let near = |i: usize| (a.x[i] - b.x[i]).abs() <= T::lit(0.02) * b.x[i].abs();
    let level = |i: usize| (a.x[i] - b.x[i]).abs() <= T::lit(0.0087);
    near(N) && near(SIGMA) && level(TILT_IN_PLANE) && level(TILT_LATERAL)
}

/// Searches the whole box, and from the caller's own `starts` besides. `grid` is workspace, [`ScanSize::workspace`] numbers;
/// with fewer there is no scan.
pub fn search<T: Real, M: DirectionalModel<T>>(
    profile: &mut Profile<'_, T, M>,
    options: &SearchOptions<T>,
    starts: &[[T; PARAMETERS]],
    grid: &mut [T],
) -> Valleys<T> {
    let mut valleys = Valleys { found: [None; MOST_VALLEYS], starts: 0, iterations: 0 };
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
fn point<T: Real>(parameters: &[Treatment<T>; PARAMETERS], along: [usize; AXES], index: usize) -> [T; PARAMETERS] {
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

fn scan<T: Real, M: DirectionalModel<T>>(
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
fn is_valley<T: Real>(grid: &[T], along: [usize; AXES], index: usize) -> bool {
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

/// Π = Σ ((x − mean)/sd)² over the priors.
fn prior_misfit<T: Real>(options: &SearchOptions<T>, x: &[T; PARAMETERS]) -> T {
    let of =
        |(one, x): (&Treatment<T>, &T)| one.prior().map_or(T::ZERO, |prior| ((*x - prior.mean) / prior.sd).squared());
    options.parameters.iter().zip(x).map(of).fold(T::ZERO, |sum, term| sum + term)
}

/// exp(Π/ν), no more than can be multiplied with.
fn penalty<T: Real>(options: &SearchOptions<T>, x: &[T; PARAMETERS]) -> T {
    (prior_misfit(options, x) / options.draws).min(T::lit(60.0)).exp()
}

/// One search from `start`, over the free parameters.
pub fn polish<T: Real, M: DirectionalModel<T>>(
    profile: &mut Profile<'_, T, M>,
    options: &SearchOptions<T>,
    start: &[T; PARAMETERS],
) -> Valley<T> {
    match options.parameters.iter().filter(|one| one.is_free()).count() {
        0 => polish_free::<T, M, 0>(profile, options, start),
        1 => polish_free::<T, M, 1>(profile, options, start),
        2 => polish_free::<T, M, 2>(profile, options, start),
        3 => polish_free::<T, M, 3>(profile, options, start),
        4 => polish_free::<T, M, 4>(profile, options, start),
        5 => polish_free::<T, M, 5>(profile, options, start),
        6 => polish_free::<T, M, 6>(profile, options, start),
        _ => polish_free::<T, M, PARAMETERS>(profile, options, start),
    }
}

fn polish_free<T: Real, M: DirectionalModel<T>, const P: usize>(
    profile: &mut Profile<'_, T, M>,
    options: &SearchOptions<T>,
    start: &[T; PARAMETERS],
) -> Valley<T> {
    let mut free = [0; P];
    let places = options.parameters.iter().enumerate().filter(|(_, one)| one.is_free());
    for (slot, (place, _)) in free.iter_mut().zip(places) {
        *slot = place;
    }
    let mut x = *start;
    for (x, one) in x.iter_mut().zip(&options.parameters) {
        *x = match one {
            Treatment::Held(value) => *value,
            Treatment::Free { bounds, .. } => bounds.clip(*x),
        };
    }
    if P == 0 {
        let chi2 = profile.chi2(&x).unwrap_or(T::MAX);
        let at_bound = [AtBound::Free; PARAMETERS];
        return Valley { x, cost: chi2, chi2, at_bound, iterations: 0, termination: Termination::Converged };
    }
    let bounds_of = |place: usize| match options.parameters[place] {
        Treatment::Free { bounds, .. } => bounds,
        Treatment::Held(value) => Interval::new(value, value),
    };
    let bounds = free.map(|place| {
        let Interval { lower, upper } = bounds_of(place);
        Interval::new(coordinate(place, lower), coordinate(place, upper))
    });
    let solver = SolverOptions {
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        max_step: free.map(|place| match place {
            N => T::ONE,
            SIGMA => T::lit(0.7),
            TILT_IN_PLANE | TILT_LATERAL => T::lit(0.06),
            _ => T::lit(0.25),
        }),
    };
    let start = free.map(|place| coordinate(place, x[place]));
    let mut objective = Cost { profile, options, free, fixed: x };
    let minimum = minimize(&mut objective, &bounds, &start, &solver);
    let mut x = objective.parameters(&minimum.x).0;
    let mut at_bound = [AtBound::Free; PARAMETERS];
    for (place, at) in free.into_iter().zip(minimum.at_bound) {
        at_bound[place] = at;
        // through logarithms and back leaves a rounding error: on a bound means on it
        let bounds = bounds_of(place);
        x[place] = match at {
            AtBound::Free => bounds.clip(x[place]),
            AtBound::Lower => bounds.lower,
            AtBound::Upper => bounds.upper,
        };
    }
    let cost = minimum.evaluation.cost;
    let chi2 = cost / penalty(options, &x);
    Valley { x, cost, chi2, at_bound, iterations: minimum.iterations, termination: minimum.termination }
}

/// In which a valley is straight: ln F₀, ln σ; the others as they are.
fn coordinate<T: Real>(place: usize, x: T) -> T {
    match place {
        N => f0_from_n(x).ln(),
        SIGMA => x.ln(),
        _ => x,
    }
}

/// χ² exp(Π/ν) over the free parameters.
///
/// This is the posterior with the residual variance unknown (Jeffreys' prior on its scale, marginalised): minimising
/// ν ln χ² + Π weighs the priors against the variance that the fit itself leaves, χ²/ν, with nothing to be chosen but ν.
struct Cost<'a, 'b, T, M, const P: usize> {
    profile: &'a mut Profile<'b, T, M>,
    options: &'a SearchOptions<T>,
    free: [usize; P],
    fixed: [T; PARAMETERS],
}

impl<T: Real, M: DirectionalModel<T>, const P: usize> Cost<'_, '_, T, M, P> {
    /// [n, σ, a, b, t_x, t_y, e] and their slopes by the coordinates.
    fn parameters(&self, u: &[T; P]) -> ([T; PARAMETERS], [T; PARAMETERS]) {
        let (mut x, mut slope) = (self.fixed, [T::ONE; PARAMETERS]);
        for (place, u) in self.free.iter().zip(u) {
            match *place {
                N => {
                    let f0 = u.exp();
                    let [n, dn, _] = n_from_f0(f0);
                    x[N] = n;
                    slope[N] = dn * f0;
                }
                SIGMA => {
                    x[SIGMA] = u.exp();
                    slope[SIGMA] = x[SIGMA];
                }
                other => x[other] = *u,
            }
        }
        (x, slope)
    }
}

impl<T: Real, M: DirectionalModel<T>, const P: usize> Objective<T, P> for Cost<'_, '_, T, M, P> {
    fn evaluate(&mut self, u: &[T; P]) -> Evaluation<T, P> {
        let (x, slope) = self.parameters(u);
        let Ok(Derivatives { chi2, gradient: g, normal }) = self.profile.derivatives(&x) else {
            // outside the model's domain: a cost that no step is taken for
            return Evaluation {
                cost: T::MAX,
                gradient: [T::ZERO; P],
                hessian: [[T::ZERO; P]; P],
                gauss_newton: [[T::ZERO; P]; P],
            };
        };
        let factor = penalty(self.options, &x);
        let mut gradient = [T::ZERO; P];
        let mut gauss_newton = [[T::ZERO; P]; P];
        for i in 0..P {
            let place = self.free[i];
            gradient[i] = g[place];
            for j in 0..P {
                gauss_newton[i][j] = T::TWO * normal[place][self.free[j]] * factor * slope[place] * slope[self.free[j]];
            }
            if let Some(Prior { mean, sd }) = self.options.parameters[place].prior() {
                // χ² over ν is the variance that a prior is weighed against
                let weight = T::TWO * chi2 / (self.options.draws * sd.squared());
                gradient[i] += weight * (x[place] - mean);
                gauss_newton[i][i] += weight * factor * slope[place].squared();
            }
            gradient[i] = gradient[i] * factor * slope[place];
        }
        Evaluation { cost: chi2 * factor, gradient, hessian: gauss_newton, gauss_newton }
    }
}
