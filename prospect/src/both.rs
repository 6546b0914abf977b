//! Numbers in both precisions.
//!
//! A single-precision machine that reads a table of doubles converts every entry when it is used, with the emulated arithmetic of a
//! precision that it otherwise never needs. Where a table stands in both, only the one that is used is linked.

use leafbrdf_core::Real;

/// The same numbers in single precision; in a `const`, so that the compiler does the rounding.
pub(crate) const fn single<const N: usize>(double: [f64; N]) -> [f32; N] {
    let mut single = [0.0; N];
    let mut i = 0;
    while i < N {
        single[i] = double[i] as f32;
        i += 1;
    }
    single
}

/// The number nearest to `double` in `T`, given the nearest `f32` too: the same as [`Real::lit`] of the double.
#[inline(always)]
pub(crate) fn pick<T: Real>(double: f64, single: f32) -> T {
    // known when compiled; widened and narrowed again is no instruction
    if T::EPSILON.to_f64() > 1e-10 { T::lit(f64::from(single)) } else { T::lit(double) }
}

/// A table in the precision of `T`, from the table of doubles and its [`single`].
#[inline(always)]
pub(crate) fn numbers<'a, T: Real, const N: usize>(
    double: &'a [f64; N],
    single: &'a [f32; N],
) -> impl Iterator<Item = T> + 'a {
    double.iter().zip(single).map(|(double, single)| pick(*double, *single))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_a_table_is_the_nearest_in_each_precision() {
        const TABLE: [f64; 4] = [0.1, 1.0 / 3.0, -2.5e-16, 1.0];
        const SINGLE: [f32; 4] = single(TABLE);
        assert!(numbers::<f64, 4>(&TABLE, &SINGLE).eq(TABLE));
        assert!(numbers::<f32, 4>(&TABLE, &SINGLE).eq(TABLE.map(f32::lit)));
    }
}
