//! Functions of an `f32` in plain single-precision arithmetic: the same bits on every machine.

use super::Real;

/// 2^23 · 1.5: adding it puts an integer into the low bits.
const ROUND_F32: f32 = 12_582_912.0;

/// A type of single-precision numbers: one whose arithmetic is `f32`'s.
pub(crate) trait Single: Real {
    fn bits(self) -> u32;
    fn from_bits(bits: u32) -> Self;
}

/// ln x in single precision; the same steps, the series to z⁵.
#[inline(always)]
pub(crate) fn ln<T: Single>(x: T) -> T {
    let ln2_hi = T::from_bits(0x3F31_7200);
    let ln2_lo = T::lit(1.428_606_8e-6);
    const SQRT_HALF: u32 = 0x3F35_04F3;
    let shifted = x.bits().wrapping_sub(SQRT_HALF);
    let m = T::from_bits((shifted & 0x007F_FFFF).wrapping_add(SQRT_HALF));
    let biased = (shifted >> 23) & 0x1FF;
    let signed = (biased ^ 0x100).wrapping_sub(0x100);
    let k = T::from_bits(ROUND_F32.to_bits().wrapping_add(signed)) - T::from_bits(ROUND_F32.to_bits());

    let f = m - T::ONE;
    let s = f / (T::TWO + f);
    let z = s * s;
    let mut p = T::lit(2.0 / 11.0);
    p = p * z + T::lit(2.0 / 9.0);
    p = p * z + T::lit(2.0 / 7.0);
    p = p * z + T::lit(2.0 / 5.0);
    p = p * z + T::lit(2.0 / 3.0);
    p *= z;
    let half_f2 = T::HALF * f * f;
    let y = k * ln2_hi + (f - (half_f2 - (s * (half_f2 + p) + k * ln2_lo)));
    let y = if x > T::ZERO { y } else { T::lit(f64::NAN) };
    let y = if x == T::ZERO { T::lit(f64::NEG_INFINITY) } else { y };
    if x < T::lit(f64::INFINITY) { y } else { x }
}

/// Arc sine in radians; NaN outside [−1, 1].
#[inline]
pub(crate) fn asin<T: Single>(x: T) -> T {
    let magnitude = x.abs();
    if magnitude <= T::HALF {
        return x + x * asin_rest(x * x);
    }
    // π/2 − 2 asin √((1 − x)/2)
    let z = T::HALF * (T::ONE - magnitude);
    let half = T::from_bits(super::root::sqrt(f32::from_bits(z.bits())).to_bits());
    let angle = T::lit(core::f64::consts::FRAC_PI_2) - (T::TWO * half + T::TWO * (half * asin_rest(z)));
    if x.bits() >> 31 == 1 { -angle } else { angle }
}

/// asin(x)/x − 1 by z = x², z ≤ 1/4: 5e-9.
#[inline(always)]
fn asin_rest<T: Real>(z: T) -> T {
    let mut p = T::lit(0.042_166_22);
    p = p * z + T::lit(0.024_179_56);
    p = p * z + T::lit(0.045_470_37);
    p = p * z + T::lit(0.074_952_98);
    p = p * z + T::lit(0.166_667_52);
    p * z
}

#[cfg(any(feature = "std", feature = "libm"))]
impl Single for f32 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.to_bits()
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        f32::from_bits(bits)
    }
}

impl Single for super::device::F32 {
    #[inline(always)]
    fn bits(self) -> u32 {
        self.0.to_bits()
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        super::device::F32(f32::from_bits(bits))
    }
}
