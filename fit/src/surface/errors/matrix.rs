//! Small symmetric matrices over the surface's parameters.

use super::super::model::PARAMETERS;
pub(super) use crate::matrix::{dot, eigen, form, product, transposed};

/// A matrix over all parameters; rows and columns of those that are not asked for are left alone.
pub(super) type Matrix = [[f64; PARAMETERS]; PARAMETERS];
/// One number a parameter.
pub(super) type Vector = [f64; PARAMETERS];

pub(super) const ZERO: Matrix = [[0.0; PARAMETERS]; PARAMETERS];

pub(super) fn rescaled(m: &Matrix, scale: &Vector) -> Matrix {
    core::array::from_fn(|i| core::array::from_fn(|k| m[i][k] * scale[i] * scale[k]))
}

/// λ_max/λ_min of a positive definite matrix of unit diagonal, by power iteration on it and on its inverse.
pub(super) fn condition(m: &Matrix, inverse: &Matrix) -> f64 {
    let largest = |m: &Matrix| {
        let mut x: Vector = core::array::from_fn(|i| 1.0 + 0.1 * i as f64);
        let mut length = 1.0;
        for _ in 0..100 {
            let y: Vector = core::array::from_fn(|i| dot(&m[i], &x));
            length = dot(&y, &y).sqrt();
            x = y.map(|y| y / length);
        }
        length
    };
    largest(m) * largest(inverse)
}

/// Coordinates in which what the data tell is the same in every direction: A⁺ = down·downᵀ, A = up·upᵀ, downᵀ·up the projector.
///
/// Combinations of parameters of which the data tell nothing have no coordinate.
pub(super) struct Root {
    pub down: Matrix,
    pub up: Matrix,
    pub rank: usize,
}

impl Root {
    /// Of the normal matrix's `kept` rows and columns.
    pub fn new(normal: &Matrix, kept: &[bool; PARAMETERS]) -> Self {
        // scaled to unit diagonal, less than this is a combination whose error is 30,000 times that of its parameters alone
        const NOTHING: f64 = 1e-9;
        let kept: [bool; PARAMETERS] = core::array::from_fn(|i| kept[i] && normal[i][i] > 0.0);
        let scale: Vector = core::array::from_fn(|i| if kept[i] { 1.0 / normal[i][i].sqrt() } else { 0.0 });
        let (values, vectors) = eigen(&rescaled(normal, &scale));
        let told: [bool; PARAMETERS] = core::array::from_fn(|a| values[a] > NOTHING);
        let of = |entry: &dyn Fn(usize, usize) -> f64| -> Matrix {
            core::array::from_fn(|i| {
                core::array::from_fn(|a| if kept[i] && told[a] { vectors[i][a] * entry(i, a) } else { 0.0 })
            })
        };
        Root {
            down: of(&|i, a| scale[i] / values[a].sqrt()),
            up: of(&|i, a| values[a].sqrt() / scale[i]),
            rank: told.iter().filter(|told| **told).count(),
        }
    }

    /// A⁺ g.
    pub fn solve(&self, g: &Vector) -> Vector {
        let inner: Vector = core::array::from_fn(|a| (0..PARAMETERS).map(|i| self.down[i][a] * g[i]).sum());
        core::array::from_fn(|i| dot(&self.down[i], &inner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Matrix {
        let x: [[f64; PARAMETERS]; 9] =
            core::array::from_fn(|v| core::array::from_fn(|i| ((v * v + 3 * i * v + i) as f64).sin() + 0.2 * i as f64));
        core::array::from_fn(|i| core::array::from_fn(|k| x.iter().map(|row| row[i] * row[k]).sum()))
    }

    #[test]
    fn the_root_inverts_what_the_data_tell_and_drops_the_rest() {
        // the last parameter is the sum of the first two: one combination is not told
        let mut m = example();
        let last = PARAMETERS - 1;
        for k in 0..last {
            m[last][k] = m[0][k] + m[1][k];
        }
        for k in 0..last {
            m[k][last] = m[last][k];
        }
        m[last][last] = m[last][0] + m[last][1];
        let kept = core::array::from_fn(|i| i != 3);
        let root = Root::new(&m, &kept);
        assert_eq!(root.rank, PARAMETERS - 2);
        let rebuilt = product(&root.up, &transposed(&root.up));
        for i in (0..PARAMETERS).filter(|i| kept[*i]) {
            for k in (0..PARAMETERS).filter(|k| kept[*k]) {
                assert!((rebuilt[i][k] - m[i][k]).abs() < 1e-12 * m[i][i].max(m[k][k]));
            }
        }
        // A A⁺ A x = A x
        let x: Vector = core::array::from_fn(|i| if kept[i] { 1.0 + i as f64 } else { 0.0 });
        let of = |x: &Vector| -> Vector { core::array::from_fn(|i| if kept[i] { dot(&m[i], x) } else { 0.0 }) };
        let ax = of(&x);
        for (a, b) in of(&root.solve(&ax)).iter().zip(ax) {
            assert!((a - b).abs() < 1e-10 * ax.iter().fold(0.0, |most: f64, x| most.max(x.abs())), "{a} {b}");
        }
    }
}
