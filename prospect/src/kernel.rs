//! The loop over bands: blocks of bands through absorption, transmission, plate and pile.

// Parallel arrays of one fixed length, one index: the clearest form here, and the one that vectorises.
#![allow(clippy::needless_range_loop)]

use leafbrdf_core::Real;

use crate::absorption::Layer;
use crate::expint::{
    THICK, Transmission, log_slope_thick, log_slope_thin, transmission, transmission_log_slope, transmission_thick,
    transmission_thin,
};
use crate::lanes::{Lanes, Task};
use crate::plate::{Interface, Plate};
use crate::stack::{Optics, SlopeSeries, Slopes, leaf, leaf_with_slopes};
use crate::table::View;

/// Bands worked on together: a multiple of every register width, small enough for the first-level cache.
pub(crate) const BLOCK: usize = 32;

/// One block of numbers, one a band.
pub(crate) type Block<L> = [L; BLOCK];

/// Receives results block by block.
pub(crate) trait Sink<T: Lanes> {
    /// Whether slopes are wanted.
    const SLOPES: bool;
    /// `first`: first band of the block; results beyond the table's end are padding.
    fn take(&mut self, first: usize, results: &Results<T::Lane>);
}

/// Results of one block.
pub(crate) struct Results<L> {
    /// Absorption coefficient K of one layer.
    pub k: Block<L>,
    pub reflectance: Block<L>,
    pub transmittance: Block<L>,
    pub absorptance: Block<L>,
    pub dr_dk: Block<L>,
    pub dt_dk: Block<L>,
    pub dr_dn: Block<L>,
    pub dt_dn: Block<L>,
}

/// All bands of a view, for one leaf.
pub(crate) struct Spectrum<'a, T, S> {
    pub view: View<'a, T>,
    pub layer: Layer<T>,
    pub sink: S,
}

impl<T: Lanes, S: Sink<T>> Task for Spectrum<'_, T, S> {
    #[inline(always)]
    fn run(mut self) {
        let m = self.layer.m.into_lane();
        let series = SlopeSeries::new(m);
        let mut first = 0;
        while first < self.view.len() {
            let k = absorption(&self.view, &self.layer, first);
            let faces =
                [load(self.view.t_alpha(), first), load(self.view.t_90(), first), load(self.view.t_21(), first)];
            let results = block::<T::Lane, S, T>(k, &faces, m, &series);
            self.sink.take(first, &results);
            first += BLOCK;
        }
    }
}

/// K of one block, Σ C_i k_i/N. Absent constituents are passed over: adding 0 changes nothing.
#[inline(always)]
fn absorption<T: Lanes>(view: &View<'_, T>, layer: &Layer<T>, first: usize) -> Block<T::Lane> {
    let mut k = [T::Lane::ZERO; BLOCK];
    for (column, &content) in view.coefficients().zip(&layer.contents) {
        if content > T::ZERO {
            let content = content.into_lane();
            let column = load(column, first);
            for i in 0..BLOCK {
                k[i] += content * column[i];
            }
        }
    }
    k
}

/// One block of a column, padded with 1 beyond the end.
#[inline(always)]
fn load<T: Lanes>(column: &[T], first: usize) -> Block<T::Lane> {
    let mut block = [T::Lane::ONE; BLOCK];
    let rest = column.get(first..).unwrap_or_default();
    if let Some(whole) = rest.first_chunk::<BLOCK>() {
        for i in 0..BLOCK {
            block[i] = whole[i].into_lane();
        }
    } else {
        for (to, from) in block.iter_mut().zip(rest) {
            *to = from.into_lane();
        }
    }
    block
}

// The loops below run over whole fixed-size arrays: the compiler sees that no index can be out of range, and vectorises.

#[inline(always)]
fn block<L: Real, S: Sink<T>, T: Lanes<Lane = L>>(
    k: Block<L>,
    faces: &[Block<L>; 3],
    m: L,
    series: &SlopeSeries<L>,
) -> Results<L> {
    let zero = [L::ZERO; BLOCK];
    let mut results = Results {
        k,
        reflectance: zero,
        transmittance: zero,
        absorptance: zero,
        dr_dk: zero,
        dt_dk: zero,
        dr_dn: zero,
        dt_dn: zero,
    };
    let (tau, absorbed) = transmissions(&k);
    if S::SLOPES {
        let log_slope = log_slopes(&k, &tau);
        for i in 0..BLOCK {
            let plate = plate(faces, &tau, &absorbed, i);
            let slope = plate.slope(log_slope[i]);
            let (value, slopes) = leaf_with_slopes(&plate, slope, m, series);
            let Optics { reflectance, transmittance, absorptance } = value;
            let Slopes { dr_dk, dt_dk, dr_dn, dt_dn } = slopes;
            results.reflectance[i] = reflectance;
            results.transmittance[i] = transmittance;
            results.absorptance[i] = absorptance;
            results.dr_dk[i] = dr_dk;
            results.dt_dk[i] = dt_dk;
            results.dr_dn[i] = dr_dn;
            results.dt_dn[i] = dt_dn;
        }
    } else {
        for i in 0..BLOCK {
            let plate = plate(faces, &tau, &absorbed, i);
            let Optics { reflectance, transmittance, absorptance } = leaf(&plate, m);
            results.reflectance[i] = reflectance;
            results.transmittance[i] = transmittance;
            results.absorptance[i] = absorptance;
        }
    }
    results
}

#[inline(always)]
fn plate<L: Real>(faces: &[Block<L>; 3], tau: &Block<L>, absorbed: &Block<L>, i: usize) -> Plate<L> {
    let [t_alpha, t_90, t_21] = faces;
    let faces = Interface { t_alpha: t_alpha[i], t_90: t_90[i], t_21: t_21[i] };
    Plate::new(faces, Transmission { tau: tau[i], absorbed: absorbed[i] })
}

/// τ and 1 − τ. Most blocks lie wholly on one side of K = 2, and need one of the two expansions only: same numbers, less work.
#[inline(always)]
fn transmissions<L: Real>(k: &Block<L>) -> (Block<L>, Block<L>) {
    let (mut tau, mut absorbed) = ([L::ZERO; BLOCK], [L::ZERO; BLOCK]);
    let (thin, thick) = sides(k);
    if thin {
        for i in 0..BLOCK {
            Transmission { tau: tau[i], absorbed: absorbed[i] } = transmission_thin(k[i]);
        }
    } else if thick {
        for i in 0..BLOCK {
            Transmission { tau: tau[i], absorbed: absorbed[i] } = transmission_thick(k[i]);
        }
    } else {
        for i in 0..BLOCK {
            Transmission { tau: tau[i], absorbed: absorbed[i] } = transmission(k[i]);
        }
    }
    (tau, absorbed)
}

#[inline(always)]
fn log_slopes<L: Real>(k: &Block<L>, tau: &Block<L>) -> Block<L> {
    let mut slopes = [L::ZERO; BLOCK];
    let (thin, thick) = sides(k);
    if thin {
        for i in 0..BLOCK {
            slopes[i] = log_slope_thin(k[i], tau[i]);
        }
    } else if thick {
        for i in 0..BLOCK {
            slopes[i] = log_slope_thick(k[i]);
        }
    } else {
        for i in 0..BLOCK {
            slopes[i] = transmission_log_slope(k[i], tau[i]);
        }
    }
    slopes
}

/// Whether all K of a block are below 2, and whether all are at or above.
#[inline(always)]
fn sides<L: Real>(k: &Block<L>) -> (bool, bool) {
    let border = L::lit(THICK);
    let mut below = 0;
    for value in k {
        below += usize::from(*value < border);
    }
    (below == BLOCK, below == 0)
}
