//! Small symmetric systems: Cholesky's factor of a matrix of fixed size.

use leafbrdf_core::Real;

/// The lower factor L of A = L Lᵀ, with 1/L_ii on the diagonal; `None` unless A is positive definite.
#[cfg_attr(feature = "std", inline(always))]
fn factor<T: Real, const P: usize>(a: &[[T; P]; P]) -> Option<[[T; P]; P]> {
    let mut l = *a;
    for j in 0..P {
        let mut pivot = a[j][j];
        for k in 0..j {
            pivot -= l[j][k].squared();
        }
        // rounding leaves about ε of the diagonal; a smaller pivot is no pivot
        if !(pivot > T::lit(4.0) * T::EPSILON * a[j][j].abs() && pivot.is_finite()) {
            return None;
        }
        let inverse = T::ONE / pivot.sqrt();
        l[j][j] = inverse;
        for i in (j + 1)..P {
            let mut sum = a[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            l[i][j] = sum * inverse;
        }
    }
    Some(l)
}

/// A⁻¹b, or `None` unless A is positive definite.
#[cfg_attr(feature = "std", inline(always))]
pub fn solve_spd<T: Real, const P: usize>(a: &[[T; P]; P], b: &[T; P]) -> Option<[T; P]> {
    let l = factor(a)?;
    let mut x = *b;
    for i in 0..P {
        for k in 0..i {
            let known = x[k];
            x[i] -= l[i][k] * known;
        }
        x[i] *= l[i][i];
    }
    for i in (0..P).rev() {
        for k in (i + 1)..P {
            let known = x[k];
            x[i] -= l[k][i] * known;
        }
        x[i] *= l[i][i];
    }
    Some(x)
}

/// A⁻¹, or `None` unless A is positive definite.
#[cfg_attr(feature = "std", inline(always))]
pub fn invert_spd<T: Real, const P: usize>(a: &[[T; P]; P]) -> Option<[[T; P]; P]> {
    let mut inverse = [[T::ZERO; P]; P];
    for j in 0..P {
        let mut unit = [T::ZERO; P];
        unit[j] = T::ONE;
        let column = solve_spd(a, &unit)?;
        for i in 0..P {
            inverse[i][j] = column[i];
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_times_the_matrix_is_the_identity() {
        let a = [[4.0, 1.0, 0.5], [1.0, 3.0, -0.25], [0.5, -0.25, 2.0_f64]];
        let inverse = invert_spd(&a).unwrap();
        for i in 0..3 {
            for j in 0..3 {
                let product: f64 = (0..3).map(|k| a[i][k] * inverse[k][j]).sum();
                let identity = if i == j { 1.0 } else { 0.0 };
                assert!((product - identity).abs() < 1e-15, "{product}");
            }
        }
    }

    #[test]
    fn a_singular_or_indefinite_matrix_has_no_factor() {
        assert_eq!(solve_spd(&[[1.0, 1.0], [1.0, 1.0_f64]], &[1.0, 1.0]), None);
        assert_eq!(solve_spd(&[[1.0, 2.0], [2.0, 1.0_f64]], &[1.0, 1.0]), None);
        assert_eq!(solve_spd(&[[f64::NAN]], &[1.0]), None);
    }
}
