//! The grades: constants of the rule, and how large a table each one needs.
//!
//! The constants were found by random searches (a step at a time, kept if better) on 1,000 to 6,000 points (θ_s, σ) to 89.9°,
//! each with F ≡ 1, real and complex indices, against a rule of some thousand nodes. E4d: smallest error of value and
//! derivatives below a given cost, nodes and two more for each column, again and again on the worst and the dearest of the
//! points; E6 and E8: fewest nodes below a given error; E10: nodes added to an earlier search's result until the tail it cuts
//! off no longer showed. They are what was found, not proven minima. The errors that `Grade` states are from other points than
//! these.

use super::table::{Hermite, Legendre, Table, entries};
use crate::Real;

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
    /// Columns drawn to x = 0 on a segment longer than crowd_from: by crowd_x ((b − a)/σ − crowd_from).
    pub(super) crowd_x: f64,
    pub(super) crowd_from: f64,
    /// How the nodes on a plateau gather at its foot, where the Gaussian is.
    pub(super) foot: Foot,
    /// Beyond σ = 1, per unit of σ: columns and nodes more. Nothing changes for σ ≤ 1.
    pub(super) rough_x: f64,
    pub(super) rough_y: f64,
    /// Where no kink lies within smooth·σ, the tensor rule of smooth_x × smooth_y nodes serves.
    pub(super) smooth: f64,
    pub(super) smooth_x: usize,
    pub(super) smooth_y: usize,
}

/// The map of z, −1 to 1, to v = y/σ, −e to e, along a plateau.
#[derive(Clone, Copy)]
pub(super) enum Foot {
    /// v = e (z − k z (1 − z²)), k = crowd e²: a few operations.
    Cubic { crowd: f64 },
    /// v = p q/√(1 − q²), q ∝ z: for the last digits at grazing incidence. Beyond σ = 1, p/(1 + rough (σ − 1)).
    Compressed { p: f64, rough: f64 },
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

    /// exp(−x), x ≥ 0.
    #[inline(always)]
    fn gaussian<T: Real>(x: T) -> T {
        (-x).exp()
    }
}

/// See `Grade::E4d`; likewise below.
pub(super) struct E4d;
pub(super) struct E6;
pub(super) struct E8;
pub(super) struct E10;

impl Rule for E4d {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 3.824, ly: 3.713, kap: 0.997, ax: 5.05, bx: 2.074, ax0: -1.231, ax2: -1.423,
        a1: 1.392, b1: 1.935, a2: 2.573, b2: 1.051, cu: 0.258, crowd_x: 0.046, crowd_from: -0.848,
        foot: Foot::Cubic { crowd: 0.029 },
        rough_x: 1.2, rough_y: 0.4, smooth: 3.3, smooth_x: 4, smooth_y: 2,
    };
    // the longest segment would like 20; it does with less, for its columns are drawn to the Gaussian
    const LEGENDRE_ORDERS: usize = 16;
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(4) }>::TABLE;

    /// (P(x))³² with an error below 3e-7, P(0) = 1: no call, and every type computes it in the same few steps.
    #[inline(always)]
    fn gaussian<T: Real>(x: T) -> T {
        let mut power = T::lit(3.421_926_3e-8) * x - T::lit(5.046_505_6e-6);
        power = power * x + T::lit(4.881_813_07e-4);
        power = power * x - T::lit(3.124_993_334e-2);
        power = power * x + T::ONE;
        power.squared().squared().squared().squared().squared()
    }
}

impl Rule for E6 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 4.348, ly: 3.897, kap: 1.057, ax: 7.511, bx: 2.926, ax0: -1.647, ax2: -3.4,
        a1: 2.26, b1: 1.569, a2: 3.588, b2: 0.837, cu: 0.273, crowd_x: 0.0, crowd_from: 0.0,
        foot: Foot::Compressed { p: 1.964, rough: 0.3 },
        rough_x: 6.0, rough_y: 1.0, smooth: 3.6, smooth_x: 5, smooth_y: 3,
    };
    const LEGENDRE_ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(6) }>::TABLE;
}

impl Rule for E8 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 6.114, ly: 4.529, kap: 1.117, ax: 16.157, bx: 2.596, ax0: -4.726, ax2: -10.125,
        a1: 3.407, b1: 1.565, a2: 4.842, b2: 1.021, cu: 0.254, crowd_x: 0.0, crowd_from: 0.0,
        foot: Foot::Compressed { p: 2.302, rough: 0.6 },
        rough_x: 4.0, rough_y: 2.0, smooth: 4.2, smooth_x: 6, smooth_y: 3,
    };
    const LEGENDRE_ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(6) }>::TABLE;
}

impl Rule for E10 {
    #[rustfmt::skip]
    const CONSTANTS: Constants = Constants {
        lx: 6.869, ly: 5.15, kap: 1.0, ax: 27.5, bx: 2.235, ax0: -7.0, ax2: -19.0,
        a1: 4.7, b1: 1.75, a2: 6.2, b2: 1.16, cu: 0.252, crowd_x: 0.0, crowd_from: 0.0,
        foot: Foot::Compressed { p: 2.726, rough: 0.6 },
        rough_x: 1.0, rough_y: 4.0, smooth: 4.7, smooth_x: 7, smooth_y: 4,
    };
    const LEGENDRE_ORDERS: usize = Self::CONSTANTS.largest_order();
    const LEGENDRE: Table = Legendre::<{ entries(Self::LEGENDRE_ORDERS) }>::TABLE;
    const HERMITE: Table = Hermite::<{ entries(8) }>::TABLE;
}

#[cfg(test)]
mod tests {
    use super::{E4d, Rule};

    /// ∬ over the plane is ∫ over x: with the signs that the error has, they sum to less than 1e-7.
    #[test]
    fn the_short_gaussian_of_e4d_is_exact_to_3e_7() {
        let (mut largest, mut sum) = (0.0_f64, 0.0);
        for i in 0..36_000 {
            let x = 0.001 * f64::from(i);
            let error = E4d::gaussian(x) - (-x).exp();
            largest = largest.max(error.abs());
            sum += 0.001 * error;
        }
        assert!(largest < 3e-7, "{largest:e}");
        assert!(sum.abs() < 1e-7, "{sum:e}");
        assert_eq!(E4d::gaussian(0.0_f32), 1.0);
        assert_eq!(E4d::gaussian(0.0_f64), 1.0);
    }
}
