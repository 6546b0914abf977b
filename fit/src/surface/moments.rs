//! The measurements as the fit sees them: rows of one value a direction, k_L free in each.
//!
//! BRDF_spec and the diffuse shape do not depend on the wavelength. Bands that share their weights may therefore be rotated
//! among themselves: the model of a rotated row is κ · shape + gain · lobe, and the sum of squares is the same. One rotation puts
//! the lobe into a single row (the bands' mean, gain √B), another one leaves at most as many rows as there are directions:
//! 400 or 2101 bands become 42 rows, at no loss.

use leafbrdf_core::Real;

/// Rows that share one weight a direction.
#[derive(Clone, Copy, Debug)]
pub struct Group<'a, T> {
    /// ω of each direction, ≥ 0; 0 where nothing was measured.
    pub weight: &'a [T],
    /// Values in sr⁻¹, row after row, one a direction; any finite number where the weight is 0.
    pub rows: &'a [T],
    /// How often the lobe stands in each row: 1 for a band as measured.
    pub gain: &'a [T],
}

/// All that is known of a leaf.
#[derive(Clone, Copy, Debug)]
pub struct Moments<'a, T> {
    /// The rows.
    pub groups: &'a [Group<'a, T>],
    /// Σ ω y² of rows in which neither lobe nor diffuse term stands.
    pub constant: T,
}

/// Rotates `bands` rows of `directions` values, in place, into rows of which only the first has a lobe; returns how many rows
/// are left: at most `directions` + 1. Only the first rows are meaningful then, the first one with gain √bands, all others 0.
///
/// Householder's reflections: the sums of squares keep all their digits, which the matrix of second moments would not.
pub fn compress<T: Real>(rows: &mut [T], directions: usize) -> usize {
    let bands = rows.len() / directions.max(1);
    if directions == 0 || bands < 2 {
        return bands;
    }
    // mean and deviations: Σ (y − m)(y − m)ᵀ over B bands has rank ≤ B − 1, so the last band can be rotated away. A reflection
    // that takes (1, …, 1)/√B to the first axis does both at once: y_i − u_i (Σ u y) · 2/|u|², u = (1, …, 1)/√B − e₁.
    let count = T::lit(bands as f64);
    let root = count.sqrt();
    let (u_first, u_other) = (T::ONE / root - T::ONE, T::ONE / root);
    // |u|²/2 = 1 − 1/√B
    reflect(rows, directions, 0, 0, u_first, T::ONE - T::ONE / root, |_| u_other);
    for column in 0..directions {
        let first = column + 1;
        if first + 1 >= bands {
            break;
        }
        let (mut norm2, mut largest) = (T::ZERO, T::ZERO);
        for row in rows.chunks_exact(directions).skip(first) {
            if let Some(x) = row.get(column) {
                norm2 += x.squared();
                largest = largest.max(x.abs());
            }
        }
        let norm = norm2.sqrt();
        let top = rows.get(first * directions + column).copied().unwrap_or(T::ZERO);
        if !(norm > T::ZERO) || largest == T::ZERO {
            continue;
        }
        // the sign that adds: no cancellation
        let signed = if top < T::ZERO { -norm } else { norm };
        let u_first = top + signed;
        // |u|²/2 = norm² + |top| norm
        let half_norm2 = norm2 + top.abs() * norm;
        reflect(rows, directions, first, column, u_first, half_norm2, |x| x);
    }
    bands.min(directions + 1)
}

/// x ← x − u (uᵀx)/(½|u|²) on the rows from `first` on and the columns from `column` on; u is `u_first` in the first row, and
/// `u_other(entry in that column)` in the others.
fn reflect<T: Real>(
    rows: &mut [T],
    directions: usize,
    first: usize,
    column: usize,
    u_first: T,
    half_norm2: T,
    u_other: impl Fn(T) -> T,
) {
    const CHUNK: usize = 64;
    // a chunk of columns at a time, so that the sums fit a fixed array; the reflecting column comes last to be changed
    let mut end = directions;
    while end > column {
        let start = column.max(end.saturating_sub(CHUNK));
        let mut sums = [T::ZERO; CHUNK];
        for (i, row) in rows.chunks_exact(directions).enumerate().skip(first) {
            let own = row.get(column).copied().unwrap_or(T::ZERO);
            let u = if i == first { u_first } else { u_other(own) };
            for (sum, x) in sums.iter_mut().zip(row.get(start..end).unwrap_or(&[])) {
                *sum += u * *x;
            }
        }
        let scale = T::ONE / half_norm2;
        for (i, row) in rows.chunks_exact_mut(directions).enumerate().skip(first) {
            let own = row.get(column).copied().unwrap_or(T::ZERO);
            let u = if i == first { u_first } else { u_other(own) } * scale;
            for (sum, x) in sums.iter().zip(row.get_mut(start..end).unwrap_or(&mut [])) {
                *x -= u * *sum;
            }
        }
        end = start;
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    /// Σ over rows of (Σ c_v y_v)², for some c: what a rotation of the rows must not change.
    fn invariants(rows: &[f64], directions: usize) -> Vec<f64> {
        (0..directions)
            .map(|v| {
                let row_form =
                    |row: &[f64]| row.iter().enumerate().map(|(i, y)| y * ((i * v + 1) as f64).sin()).sum::<f64>();
                rows.chunks_exact(directions).map(|row| row_form(row).powi(2)).sum()
            })
            .collect()
    }

    #[test]
    fn a_rotation_of_the_rows_keeps_every_sum_of_squares() {
        for (bands, directions) in [(1, 3), (2, 5), (7, 3), (40, 12), (5, 80), (150, 70)] {
            let mut rows: Vec<f64> = (0..bands * directions).map(|i| ((i * i + 3 * i) as f64).sin() + 0.3).collect();
            let (before, mean): (Vec<f64>, Vec<f64>) = (
                invariants(&rows, directions),
                (0..directions).map(|v| rows.iter().skip(v).step_by(directions).sum::<f64>()).collect(),
            );
            let left = compress(&mut rows, directions);
            assert!(left <= directions + 1 && left <= bands);
            rows.truncate(left * directions);
            for (a, b) in before.iter().zip(invariants(&rows, directions)) {
                assert!((a - b).abs() < 1e-12 * a.abs(), "{bands} × {directions}: {a} {b}");
            }
            // the first row is the mean times √B
            for (first, sum) in rows.iter().zip(&mean) {
                assert!((first - sum / (bands as f64).sqrt()).abs() < 1e-12);
            }
        }
    }
}
