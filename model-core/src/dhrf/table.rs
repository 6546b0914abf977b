//! The one-dimensional rules as the walk over the nodes wants them: positive halves, of only the orders a grade reaches.

use super::nodes;
use crate::Real;

/// Nodes and weights of the orders 1, 2, … of one family, in two words of 24 bits each (relative error below 2⁻⁴⁸).
///
/// A single-precision type reads the first words only. Nothing refers to the second ones then, so that a device which
/// computes in `f32` carries half the table and converts no double.
#[derive(Clone, Copy)]
pub(super) struct Table {
    first: &'static [[f32; 2]],
    second: &'static [[f32; 2]],
}

/// Gauss–Legendre rules; the number of entries is [`entries`] of the largest order.
pub(super) struct Legendre<const ENTRIES: usize>;

impl<const ENTRIES: usize> Legendre<ENTRIES> {
    pub(super) const TABLE: Table =
        Table { first: &first_words::<ENTRIES>(&nodes::LEGENDRE), second: &second_words::<ENTRIES>(&nodes::LEGENDRE) };
}

/// Gauss–Hermite rules, likewise; weights times exp(x²).
pub(super) struct Hermite<const ENTRIES: usize>;

impl<const ENTRIES: usize> Hermite<ENTRIES> {
    pub(super) const TABLE: Table =
        Table { first: &first_words::<ENTRIES>(&nodes::HERMITE), second: &second_words::<ENTRIES>(&nodes::HERMITE) };
}

/// Entries of the orders 1 to `orders`: Σ ⌈n/2⌉.
pub(super) const fn entries(orders: usize) -> usize {
    (orders + 1) * (orders + 1) / 4
}

const fn first_words<const ENTRIES: usize>(rules: &[[f64; 2]]) -> [[f32; 2]; ENTRIES] {
    let mut out = [[0.0; 2]; ENTRIES];
    let mut i = 0;
    while i < ENTRIES {
        out[i] = [rules[i][0] as f32, rules[i][1] as f32];
        i += 1;
    }
    out
}

const fn second_words<const ENTRIES: usize>(rules: &[[f64; 2]]) -> [[f32; 2]; ENTRIES] {
    let mut out = first_words::<ENTRIES>(rules);
    let mut i = 0;
    while i < ENTRIES {
        out[i] = [(rules[i][0] - out[i][0] as f64) as f32, (rules[i][1] - out[i][1] as f64) as f32];
        i += 1;
    }
    out
}

impl Table {
    /// Nodes ≥ 0 of the rule of this order, the smallest first, with their weights; nothing if the table ends before.
    #[inline(always)]
    pub(super) fn half<T: Real>(self, order: usize) -> impl Iterator<Item = (T, T)> {
        let start = order * order / 4;
        let first = self.first.get(start..).unwrap_or(&[]);
        first.iter().take(order.div_ceil(2)).enumerate().map(move |(i, &[node, weight])| {
            let rest = if needs_second_word::<T>() { self.second.get(start + i) } else { None };
            let [node_rest, weight_rest] = rest.copied().unwrap_or([0.0; 2]);
            (number(node, node_rest), number(weight, weight_rest))
        })
    }

    /// All nodes of the rule of this order with their weights: x and −x in turn.
    #[inline(always)]
    pub(super) fn whole<T: Real>(self, order: usize, mut visit: impl FnMut(T, T)) {
        for (mut node, weight) in self.half::<T>(order) {
            // one call, so that what is visited is compiled once
            loop {
                visit(node, weight);
                node = -node;
                if node >= T::ZERO {
                    break;
                }
            }
        }
    }
}

#[inline(always)]
fn needs_second_word<T: Real>() -> bool {
    // of numbers that the compiler knows, also where a comparison of `T` is a call
    T::EPSILON.to_f64() < 1e-10
}

#[inline(always)]
fn number<T: Real>(first: f32, second: f32) -> T {
    if needs_second_word::<T>() { T::lit(f64::from(first) + f64::from(second)) } else { T::lit(f64::from(first)) }
}
