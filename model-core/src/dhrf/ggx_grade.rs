//! The grades for GGX: constants of the rule in `ggx_walk.rs`.
//!
//! Found as those for Beckmann's facets (`grade.rs`), by a random search for the fewest nodes below a given error, on 530 points
//! (θ_s, σ) to 89°, each with F ≡ 1 and three indices, against a rule of some 7,000 nodes. They are what was found, not
//! proven minima. The errors that `Grade` states are from other points than these.

use super::ggx_walk::{GgxConstants, GgxRule};
use super::grade::{E4d, E6, E8, E10};
use super::table::{Legendre, Table, entries};

impl GgxRule for E4d {
    #[rustfmt::skip]
    const CONSTANTS: GgxConstants = GgxConstants {
        rows: 4.663, rows_tail: 1.087, around: 9.422, around_edge: 0.83,
        arcs: 10.856, arcs_grazing: 1.338, arcs_smooth: 1.103, along: 6.009, along_smooth: 0.377, crowd: 0.367, gamma: 1.13,
    };
    const ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::ORDERS) }>::TABLE;
}

impl GgxRule for E6 {
    #[rustfmt::skip]
    const CONSTANTS: GgxConstants = GgxConstants {
        rows: 6.015, rows_tail: 1.329, around: 10.663, around_edge: 0.702,
        arcs: 12.3, arcs_grazing: 2.135, arcs_smooth: 1.16, along: 7.484, along_smooth: 0.199, crowd: 0.322, gamma: 1.232,
    };
    const ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::ORDERS) }>::TABLE;
}

impl GgxRule for E8 {
    #[rustfmt::skip]
    const CONSTANTS: GgxConstants = GgxConstants {
        rows: 8.34, rows_tail: 2.331, around: 11.957, around_edge: 0.466,
        arcs: 21.539, arcs_grazing: 2.328, arcs_smooth: 1.685, along: 10.622, along_smooth: -0.074, crowd: 0.37, gamma: 1.509,
    };
    const ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::ORDERS) }>::TABLE;
}

impl GgxRule for E10 {
    #[rustfmt::skip]
    const CONSTANTS: GgxConstants = GgxConstants {
        rows: 14.696, rows_tail: 2.977, around: 17.089, around_edge: 0.538,
        arcs: 29.113, arcs_grazing: 2.577, arcs_smooth: 1.491, along: 16.602, along_smooth: 0.277, crowd: 0.432, gamma: 1.669,
    };
    const ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::ORDERS) }>::TABLE;
}
