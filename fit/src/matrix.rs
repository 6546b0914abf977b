//! Small matrices of fixed size, row by row.

pub(crate) fn product<const P: usize>(a: &[[f64; P]; P], b: &[[f64; P]; P]) -> [[f64; P]; P] {
    core::array::from_fn(|i| core::array::from_fn(|k| (0..P).map(|m| a[i][m] * b[m][k]).sum()))
}

pub(crate) fn transposed<const P: usize>(m: &[[f64; P]; P]) -> [[f64; P]; P] {
    core::array::from_fn(|i| core::array::from_fn(|k| m[k][i]))
}

/// Σ a_i b_i.
pub(crate) fn dot<const P: usize>(a: &[f64; P], b: &[f64; P]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// aᵀ M a.
pub(crate) fn form<const P: usize>(m: &[[f64; P]; P], a: &[f64; P]) -> f64 {
    m.iter().zip(a).map(|(row, a_i)| a_i * dot(row, a)).sum()
}

/// Eigenvalues of a symmetric matrix, and the eigenvectors as columns: Jacobi's rotations, until the off-diagonal is rounding.
pub(crate) fn eigen<const P: usize>(m: &[[f64; P]; P]) -> ([f64; P], [[f64; P]; P]) {
    let mut a = *m;
    let mut vectors = [[0.0; P]; P];
    for (i, row) in vectors.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    // convergence is quadratic: 7 × 7 takes about six sweeps, 18 × 18 a few more
    for _ in 0..30 {
        let mut rotated = false;
        for p in 0..P {
            for q in (p + 1)..P {
                if a[p][q].abs() <= f64::EPSILON * (a[p][p] * a[q][q]).abs().sqrt() {
                    continue;
                }
                rotated = true;
                let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
                let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for row in &mut a {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
                for k in 0..P {
                    (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                }
                for row in &mut vectors {
                    (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    (core::array::from_fn(|i| a[i][i]), vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rebuilds_its_matrix<const P: usize>(m: &[[f64; P]; P]) {
        let (values, u) = eigen(m);
        let rebuilt = |i: usize, k: usize| (0..P).map(|a| u[i][a] * values[a] * u[k][a]).sum::<f64>();
        let gram = |i: usize, k: usize| (0..P).map(|a| u[a][i] * u[a][k]).sum::<f64>();
        let size = values.iter().fold(0.0, |most: f64, value| most.max(*value));
        for i in 0..P {
            for k in 0..P {
                assert!((rebuilt(i, k) - m[i][k]).abs() < 1e-13 * size);
                assert!((gram(i, k) - f64::from(u8::from(i == k))).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn eigenvectors_are_orthonormal_and_rebuild_the_matrix() {
        let of = |v: usize, i: usize| ((v * v + 3 * i * v + i) as f64).sin() + 0.2 * i as f64;
        let gram = |i: usize, k: usize| (0..9).map(|v| of(v, i) * of(v, k)).sum();
        rebuilds_its_matrix::<7>(&core::array::from_fn(|i| core::array::from_fn(|k| gram(i, k))));
        // of rank 9: half of the eigenvalues are 0
        rebuilds_its_matrix::<18>(&core::array::from_fn(|i| core::array::from_fn(|k| gram(i, k))));
        rebuilds_its_matrix(&[[2.0, -0.3, 0.1], [-0.3, 1.0, 0.7], [0.1, 0.7, 0.5]]);
        rebuilds_its_matrix::<0>(&[]);
    }
}
