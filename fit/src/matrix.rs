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
