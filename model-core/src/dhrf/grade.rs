//! The grades: constants of the rule, and how large a table each one needs.

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
    /// Where no kink lies within smooth·σ, the tensor rule of smooth_x × smooth_y nodes serves.
    pub(super) smooth: f64,
    pub(super) smooth_x: usize,
    pub(super) smooth_y: usize,
}

/// A grade as a type, so that a program links the tables of only the grades it names.
pub(super) trait Rule {
    const CONSTANTS: Constants;
    const LEGENDRE_ORDERS: usize;
    const LEGENDRE: Table;
    const HERMITE: Table;
}

pub(super) struct E4d;
pub(super) struct E6;
pub(super) struct E8;
pub(super) struct E10;

impl Rule for E4d {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 3.831, ly: 3.546, kap: 0.888, ax: 6.086, bx: 2.343, ax0: -2.723, ax2: -2.902,
        a1: 2.023, b1: 1.387, a2: 2.873, b2: 0.735, cu: 0.29, py: 5.464, ghx: 4,
        smooth: 3.0, smooth_x: 3, smooth_y: 2,
    };
    const LEGENDRE_ORDERS: usize = 24;
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(4) }>::TABLE;
}

impl Rule for E6 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 4.327, ly: 3.864, kap: 1.0, ax: 7.204, bx: 2.539, ax0: -1.48, ax2: -3.564,
        a1: 2.492, b1: 1.409, a2: 3.738, b2: 0.819, cu: 0.283, py: 2.479, ghx: 3,
        smooth: 3.8, smooth_x: 5, smooth_y: 3,
    };
    const LEGENDRE_ORDERS: usize = 30;
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(6) }>::TABLE;
}

impl Rule for E8 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 5.308, ly: 4.265, kap: 0.887, ax: 13.242, bx: 2.6, ax0: -2.791, ax2: -7.713,
        a1: 3.48, b1: 1.527, a2: 4.565, b2: 1.187, cu: 0.279, py: 1.835, ghx: 0,
        smooth: 4.5, smooth_x: 8, smooth_y: 4,
    };
    const LEGENDRE_ORDERS: usize = 41;
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(8) }>::TABLE;
}

impl Rule for E10 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 6.869, ly: 4.941, kap: 1.0, ax: 26.861, bx: 2.235, ax0: -7.262, ax2: -19.833,
        a1: 4.539, b1: 1.72, a2: 6.084, b2: 1.135, cu: 0.252, py: 2.726, ghx: 0,
        smooth: 5.1, smooth_x: 10, smooth_y: 5,
    };
    const LEGENDRE_ORDERS: usize = 58;
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(10) }>::TABLE;
}
