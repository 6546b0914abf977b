//! The minima that searches have found, each once.

use leafbrdf_core::Real;

use crate::bounds::AtBound;
use crate::solver::Termination;
use crate::surface::model::{N, PARAMETERS, SIGMA, TILT_IN_PLANE, TILT_LATERAL};

/// The most valleys that are searched, and kept.
pub const MOST_VALLEYS: usize = 12;

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
    pub(super) const fn none() -> Self {
        Valleys { found: [None; MOST_VALLEYS], starts: 0, iterations: 0 }
    }

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

    pub(super) fn add(&mut self, valley: Valley<T>) {
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
