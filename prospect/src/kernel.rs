//! The loop over bands: blocks of bands through absorption, transmission, plate and pile.

// Parallel arrays of one fixed length, one index: the clearest form here, and the one that vectorises.
#![allow(clippy::needless_range_loop)]

use core::ops::{Deref, DerefMut};

use leafbrdf_core::Real;

use crate::absorption::Layer;
use crate::expint::{
    THICK, Transmission, k_ln_k, log_slope, log_slope_thick, log_slope_thin, transmission_either, transmission_thick,
    transmission_thin,
};
use crate::lanes::{Lanes, Task};
use crate::plate::{Interface, Plate};
use crate::stack::{Decay, Optics, Pair, Pile, Reciprocals, SlopeSeries, Slopes, optics, pile_of, slopes};
use crate::table::View;

/// Bands worked on together: several of the widest registers, within the first-level cache. Without `std` there is no SIMD to
/// feed, and the stack of a device is what counts. Results do not depend on it.
pub(crate) const BLOCK: usize = if cfg!(feature = "std") { 64 } else { 8 };

/// One block of numbers, one a band.
///
/// Aligned with the widest register: a load across a cache line's border costs twice, and the stack alone aligns to 16 bytes.
#[derive(Clone, Copy)]
#[cfg_attr(feature = "std", repr(align(64)))]
pub(crate) struct Block<L>([L; BLOCK]);

impl<L: Copy> Block<L> {
    #[inline(always)]
    pub(crate) fn of(value: L) -> Self {
        Block([value; BLOCK])
    }
}

impl<L> Deref for Block<L> {
    type Target = [L; BLOCK];
    #[inline(always)]
    fn deref(&self) -> &[L; BLOCK] {
        &self.0
    }
}

impl<L> DerefMut for Block<L> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [L; BLOCK] {
        &mut self.0
    }
}

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
    let mut k = Block::of(T::Lane::ZERO);
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
pub(crate) fn load<T: Lanes>(column: &[T], first: usize) -> Block<T::Lane> {
    let mut block = Block::of(T::Lane::ONE);
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

/// What a leaf and a pile have in common: the plates of one block and how light fades in them.
struct Front<L> {
    side: Side,
    k_ln_k: Block<L>,
    plates: Plate<Block<L>>,
    pairs: Pair<Block<L>>,
    decays: Decay<Block<L>>,
}

#[inline(always)]
fn front<L: Real>(k: &Block<L>, faces: &[Block<L>; 3], m: L) -> Front<L> {
    let zero = Block::of(L::ZERO);
    let side = Side::of(k);
    let k_ln_k = logarithms(k, side);
    let layers = transmissions(k, &k_ln_k, side);
    let mut plates = Plate::padding(zero);
    let mut pairs = Pair { d: zero, z: zero, half_t: zero, growth: zero };
    for i in 0..BLOCK {
        let plate = plate(faces, &layers, i);
        let Pair { d, z, half_t, growth } = Pair::new(&plate);
        (pairs.d[i], pairs.z[i], pairs.half_t[i], pairs.growth[i]) = (d, z, half_t, growth);
        plates.put(i, plate);
    }
    let mut decays = Decay { l: zero, y: zero, y_less_one: zero };
    for i in 0..BLOCK {
        decays.l[i] = Decay::rate(pairs.growth[i]);
    }
    for i in 0..BLOCK {
        let Decay { y, y_less_one, .. } = Decay::new(decays.l[i], m);
        (decays.y[i], decays.y_less_one[i]) = (y, y_less_one);
    }
    Front { side, k_ln_k, plates, pairs, decays }
}

impl<L: Real> Front<L> {
    /// (dτ/dK)/τ of the block that this was made of.
    #[inline(always)]
    fn log_slopes(&self, k: &Block<L>, faces: &[Block<L>; 3]) -> Block<L> {
        let mut tau_inverse = Block::of(L::ZERO);
        for i in 0..BLOCK {
            // t = t₉₀ t₂₁ τ/(1 − ρ²τ²), and 1/2t is there
            let t_inverse = self.pairs.half_t[i] + self.pairs.half_t[i];
            tau_inverse[i] = (faces[1][i] * faces[2][i]) * self.plates.inverse[i] * t_inverse;
        }
        log_slopes(k, &self.k_ln_k, &tau_inverse, self.side)
    }
}

/// Piles of `m` equal plates (see [`Pile`]), one block: `faces` of isotropic light on either side.
#[inline(always)]
pub(crate) fn piles<L: Real>(k: &Block<L>, faces: &[Block<L>; 3], m: L, series: &SlopeSeries<L>) -> Piles<L> {
    let zero = Block::of(L::ZERO);
    let front = front(k, faces, m);
    let log_slope = front.log_slopes(k, faces);
    let Front { plates, pairs, decays, .. } = front;
    let mut piles = Piles { r: zero, t: zero, dr_dk: zero, dt_dk: zero, dr_dn: zero, dt_dn: zero };
    for i in 0..BLOCK {
        let plate = plates.at(i);
        let slope = plate.slope(log_slope[i]);
        let Pile { r, t, slopes } = pile_of(&plate, slope, &pairs.at(i), &decays.at(i), m, series);
        (piles.r[i], piles.t[i]) = (r, t);
        (piles.dr_dk[i], piles.dt_dk[i]) = (slopes.dr_dk, slopes.dt_dk);
        (piles.dr_dn[i], piles.dt_dn[i]) = (slopes.dr_dn, slopes.dt_dn);
    }
    piles
}

/// Reflectance, transmittance and slopes of one block of piles.
pub(crate) struct Piles<L> {
    pub r: Block<L>,
    pub t: Block<L>,
    pub dr_dk: Block<L>,
    pub dt_dk: Block<L>,
    pub dr_dn: Block<L>,
    pub dt_dn: Block<L>,
}

impl<L: Copy> Piles<L> {
    #[inline(always)]
    pub(crate) fn at(&self, i: usize) -> Pile<L> {
        let slopes = Slopes { dr_dk: self.dr_dk[i], dt_dk: self.dt_dk[i], dr_dn: self.dr_dn[i], dt_dn: self.dt_dn[i] };
        Pile { r: self.r[i], t: self.t[i], slopes }
    }
}

#[inline(always)]
fn block<L: Real, S: Sink<T>, T: Lanes<Lane = L>>(
    k: Block<L>,
    faces: &[Block<L>; 3],
    m: L,
    series: &SlopeSeries<L>,
) -> Results<L> {
    let zero = Block::of(L::ZERO);
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
    let front = front(&k, faces, m);
    let Front { plates, pairs, decays, .. } = &front;
    let mut reciprocals = Reciprocals { h: zero, d: zero };
    for i in 0..BLOCK {
        let (plate, pair, decay) = (plates.at(i), pairs.at(i), decays.at(i));
        let reciprocal = Reciprocals::new(&pair, &decay);
        (reciprocals.h[i], reciprocals.d[i]) = (reciprocal.h, reciprocal.d);
        let Optics { reflectance, transmittance, absorptance } = optics(&plate, &pair, &decay, &reciprocal);
        results.reflectance[i] = reflectance;
        results.transmittance[i] = transmittance;
        results.absorptance[i] = absorptance;
    }
    if S::SLOPES {
        let log_slope = front.log_slopes(&k, faces);
        for i in 0..BLOCK {
            let plate = plates.at(i);
            let slope = plate.slope(log_slope[i]);
            let Slopes { dr_dk, dt_dk, dr_dn, dt_dn } =
                slopes(&plate, slope, &pairs.at(i), &decays.at(i), &reciprocals.at(i), m, series);
            results.dr_dk[i] = dr_dk;
            results.dt_dk[i] = dt_dk;
            results.dr_dn[i] = dr_dn;
            results.dt_dn[i] = dt_dn;
        }
    }
    results
}

#[inline(always)]
fn plate<L: Real>(faces: &[Block<L>; 3], layers: &Transmission<Block<L>>, i: usize) -> Plate<L> {
    let [t_alpha, t_90, t_21] = faces;
    let faces = Interface { t_alpha: t_alpha[i], t_90: t_90[i], t_21: t_21[i] };
    Plate::new(faces, Transmission { tau: layers.tau[i], absorbed: layers.absorbed[i] })
}

// Between two loops the parts of all bands of a block are kept column by column.

impl<L: Copy> Plate<Block<L>> {
    #[inline(always)]
    fn padding(value: Block<L>) -> Self {
        Plate { r: value, t: value, a: value, r_top: value, t_top: value, a_top: value, rho_tau: value, inverse: value }
    }

    #[inline(always)]
    fn put(&mut self, i: usize, plate: Plate<L>) {
        self.r[i] = plate.r;
        self.t[i] = plate.t;
        self.a[i] = plate.a;
        self.r_top[i] = plate.r_top;
        self.t_top[i] = plate.t_top;
        self.a_top[i] = plate.a_top;
        self.rho_tau[i] = plate.rho_tau;
        self.inverse[i] = plate.inverse;
    }

    #[inline(always)]
    fn at(&self, i: usize) -> Plate<L> {
        Plate {
            r: self.r[i],
            t: self.t[i],
            a: self.a[i],
            r_top: self.r_top[i],
            t_top: self.t_top[i],
            a_top: self.a_top[i],
            rho_tau: self.rho_tau[i],
            inverse: self.inverse[i],
        }
    }
}

impl<L: Copy> Pair<Block<L>> {
    #[inline(always)]
    fn at(&self, i: usize) -> Pair<L> {
        Pair { d: self.d[i], z: self.z[i], half_t: self.half_t[i], growth: self.growth[i] }
    }
}

impl<L: Copy> Reciprocals<Block<L>> {
    #[inline(always)]
    fn at(&self, i: usize) -> Reciprocals<L> {
        Reciprocals { h: self.h[i], d: self.d[i] }
    }
}

impl<L: Copy> Decay<Block<L>> {
    #[inline(always)]
    fn at(&self, i: usize) -> Decay<L> {
        Decay { l: self.l[i], y: self.y[i], y_less_one: self.y_less_one[i] }
    }
}

/// K ln K where a block needs it.
#[inline(always)]
fn logarithms<L: Real>(k: &Block<L>, side: Side) -> Block<L> {
    let mut products = Block::of(L::ZERO);
    if side != Side::Thick {
        for i in 0..BLOCK {
            products[i] = k_ln_k(k[i]);
        }
    }
    products
}

/// τ and 1 − τ.
#[inline(always)]
fn transmissions<L: Real>(k: &Block<L>, k_ln_k: &Block<L>, side: Side) -> Transmission<Block<L>> {
    let (mut tau, mut absorbed) = (Block::of(L::ZERO), Block::of(L::ZERO));
    match side {
        Side::Thin => {
            for i in 0..BLOCK {
                Transmission { tau: tau[i], absorbed: absorbed[i] } = transmission_thin(k[i], k_ln_k[i]);
            }
        }
        Side::Thick => {
            for i in 0..BLOCK {
                Transmission { tau: tau[i], absorbed: absorbed[i] } = transmission_thick(k[i]);
            }
        }
        Side::Both => {
            for i in 0..BLOCK {
                Transmission { tau: tau[i], absorbed: absorbed[i] } = transmission_either(k[i], k_ln_k[i]);
            }
        }
    }
    Transmission { tau, absorbed }
}

/// (dτ/dK)/τ.
#[inline(always)]
fn log_slopes<L: Real>(k: &Block<L>, k_ln_k: &Block<L>, tau_inverse: &Block<L>, side: Side) -> Block<L> {
    let mut slopes = Block::of(L::ZERO);
    match side {
        Side::Thin => {
            for i in 0..BLOCK {
                slopes[i] = log_slope_thin(k[i], k_ln_k[i], tau_inverse[i]);
            }
        }
        Side::Thick => {
            for i in 0..BLOCK {
                slopes[i] = log_slope_thick(k[i]);
            }
        }
        Side::Both => {
            for i in 0..BLOCK {
                slopes[i] = log_slope(k[i], k_ln_k[i], tau_inverse[i]);
            }
        }
    }
    slopes
}

/// On which side of K = 2 a block lies. Most lie wholly on one, and need one of the two expansions only: same numbers, less
/// work.
#[derive(Clone, Copy, PartialEq)]
enum Side {
    Thin,
    Thick,
    Both,
}

impl Side {
    #[inline(always)]
    fn of<L: Real>(k: &Block<L>) -> Side {
        let border = L::lit(THICK);
        let mut below = 0;
        for value in k.iter() {
            below += usize::from(*value < border);
        }
        match below {
            BLOCK => Side::Thin,
            0 => Side::Thick,
            _ => Side::Both,
        }
    }
}
