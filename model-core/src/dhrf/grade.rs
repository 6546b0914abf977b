//! The grades: constants of the rule, and how large a table each one needs.
//!
//! The constants were found by a random search (one step at a time, kept if better) on about 1,000 points (θ_s, σ) to 89.9°,
//! each with F ≡ 1, four real and three complex indices, against a rule of some 20,000 nodes. E4d: smallest error of value
//! and derivatives below a given number of nodes; E6 and E8: fewest nodes below a given error; E10: nodes added to an
//! earlier search's result until the tail it cuts off no longer showed. They are what was found, not proven minima. The
//! errors that `Grade` states are from other points than these.

use super::table::{Hermite, Legendre, Table, entries};

/// The constants of one grade. Lengths in units of σ; u = x/σ.
#[derive(Clone, Copy)]
pub(super) struct Constants {
    /// Columns |u| ≤ lx.
    pub(super) lx: f64,
    /// Along a column, v² ≤ max(1, ly² − kap u²).
    pub(super) ly: f64,
    pub(super) kap: f64,
    /// Columns on a segment of length b − a: ax + bx (b − a)/σ, plus ax0 on the first and ax2 on the last segment.
    pub(super) ax: f64,
    pub(super) bx: f64,
    pub(super) ax0: f64,
    pub(super) ax2: f64,
    /// Nodes on the plateau of half-length y: a1 − cu u² + b1 y/σ.
    pub(super) a1: f64,
    pub(super) b1: f64,
    /// Nodes beyond it, on a length y: a2 − cu u² + b2 y/σ.
    pub(super) a2: f64,
    pub(super) b2: f64,
    pub(super) cu: f64,
    /// Compression of the plateau's variable.
    pub(super) py: f64,
    /// Order of the Hermite rule for the columns where one segment holds them all; 0: none.
    pub(super) ghx: usize,
    /// Beyond σ = 1, per unit of σ: columns and nodes more, and less compression. Nothing changes for σ ≤ 1.
    pub(super) rough_x: f64,
    pub(super) rough_y: f64,
    pub(super) rough_p: f64,
    /// Where no kink lies within smooth·σ, the tensor rule of smooth_x × smooth_y nodes serves.
    pub(super) smooth: f64,
    pub(super) smooth_x: usize,
    pub(super) smooth_y: usize,
}

impl Constants {
    /// The largest order met for σ ≤ 2; beyond, orders stay there.
    const fn largest_order(&self) -> usize {
        let offset = if self.ax0 > self.ax2 { self.ax0 } else { self.ax2 };
        let offset = if offset > 0.0 { offset } else { 0.0 };
        let columns = self.ax + offset + self.bx * 2.0 * self.lx + self.rough_x;
        let on_plateau = self.a1 + self.b1 * self.ly + self.rough_y;
        let beyond = self.a2 + self.b2 * self.ly + self.rough_y;
        let plateau = 2 * rounded_up(on_plateau);
        let other = rounded_up(if columns > beyond { columns } else { beyond });
        if plateau > other { plateau } else { other }
    }
}

const fn rounded_up(x: f64) -> usize {
    (x + 0.9999) as usize
}

/// A grade as a type, so that a program links the tables of only the grades it names.
pub(super) trait Rule {
    const CONSTANTS: Constants;
    const LEGENDRE_ORDERS: usize;
    const LEGENDRE: Table;
    const HERMITE: Table;
}

/// See `Grade::E4d`; likewise below.
pub(super) struct E4d;
pub(super) struct E6;
pub(super) struct E8;
pub(super) struct E10;

impl Rule for E4d {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 4.08, ly: 3.741, kap: 1.151, ax: 5.65, bx: 2.547, ax0: -1.692, ax2: -2.7,
        a1: 1.691, b1: 1.419, a2: 2.617, b2: 0.954, cu: 0.202, py: 3.737, ghx: 11,
        rough_x: 0.0, rough_y: 0.0, rough_p: 1.0, smooth: 3.3, smooth_x: 4, smooth_y: 2,
    };
    const LEGENDRE_ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(11) }>::TABLE;
}

impl Rule for E6 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 4.348, ly: 3.897, kap: 1.057, ax: 7.511, bx: 2.926, ax0: -1.647, ax2: -3.8,
        a1: 2.26, b1: 1.569, a2: 3.588, b2: 0.837, cu: 0.273, py: 1.964, ghx: 4,
        rough_x: 6.0, rough_y: 1.0, rough_p: 0.3, smooth: 3.6, smooth_x: 5, smooth_y: 3,
    };
    const LEGENDRE_ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(6) }>::TABLE;
}

impl Rule for E8 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 6.114, ly: 4.529, kap: 1.117, ax: 16.157, bx: 2.596, ax0: -4.726, ax2: -10.125,
        a1: 3.407, b1: 1.565, a2: 4.842, b2: 1.021, cu: 0.254, py: 2.302, ghx: 0,
        rough_x: 4.0, rough_y: 2.0, rough_p: 0.6, smooth: 4.2, smooth_x: 6, smooth_y: 3,
    };
    const LEGENDRE_ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(6) }>::TABLE;
}

impl Rule for E10 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 6.869, ly: 5.15, kap: 1.0, ax: 27.5, bx: 2.235, ax0: -7.0, ax2: -19.0,
        a1: 4.7, b1: 1.75, a2: 6.2, b2: 1.16, cu: 0.252, py: 2.726, ghx: 0,
        rough_x: 1.0, rough_y: 4.0, rough_p: 0.6, smooth: 4.7, smooth_x: 7, smooth_y: 4,
    };
    const LEGENDRE_ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(8) }>::TABLE;
}
