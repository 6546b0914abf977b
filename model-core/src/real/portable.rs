//! `Portable<T>`: exponential and logarithm from plain arithmetic, so that a slice loop vectorises and every machine
//! gives the same bits (no fused multiply-add, no call into a system library).
//!
//! Measured against the standard library over the whole range (`tests/precision.rs`): `exp` and `ln` within 1 unit in
//! the last place in `f64` and in `f32`. Below e^−708 (`f64`) and e^−86.98 (`f32`), just above the
//! smallest normal number, the result is 0.

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use super::{Real, fixed, single};

/// An `f32` or `f64` whose `exp` and `ln` are plain, branch-free arithmetic.
///
/// The other functions are those of `T`. Use it where a loop over many directions or bands must vectorise, or where
/// host and device must agree to the bit.
///
/// ```
/// use leafbrdf_core::{Portable, Real};
/// assert_eq!(Portable(0.0_f64).exp(), Portable(1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
#[repr(transparent)]
pub struct Portable<T>(
    /// The number itself.
    pub T,
);

impl<T: Add<Output = T>> Add for Portable<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Portable(self.0 + other.0)
    }
}
impl<T: Sub<Output = T>> Sub for Portable<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Portable(self.0 - other.0)
    }
}
impl<T: Mul<Output = T>> Mul for Portable<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Portable(self.0 * other.0)
    }
}
impl<T: Div<Output = T>> Div for Portable<T> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Portable(self.0 / other.0)
    }
}
impl<T: Neg<Output = T>> Neg for Portable<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Portable(-self.0)
    }
}
impl<T: AddAssign> AddAssign for Portable<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}
impl<T: SubAssign> SubAssign for Portable<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.0 -= other.0;
    }
}
impl<T: MulAssign> MulAssign for Portable<T> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        self.0 *= other.0;
    }
}

/// 2^52 · 1.5: adding it rounds to an integer and leaves that integer in the low bits.
const ROUND_F64: f64 = 6_755_399_441_055_744.0;
/// 2^23 · 1.5, the same for `f32`.
const ROUND_F32: f32 = 12_582_912.0;

/// eˣ in double precision: x = k ln 2 + r, |r| ≤ ln 2 / 2, and the Taylor series of eʳ to degree 13.
#[inline(always)]
fn exp_f64(x: f64) -> f64 {
    // ln 2 in two words; the first has 32 significant bits, so that k · LN2_HI is exact.
    const LN2_HI: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
    const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;
    // Beyond these the result is not a normal number: flushed to 0, or infinite.
    const LOWEST: f64 = -708.0;
    const HIGHEST: f64 = 709.782_712_893_384;
    let inside = if x > LOWEST { x } else { LOWEST };
    let inside = if inside < HIGHEST { inside } else { HIGHEST };

    let shifted = inside * core::f64::consts::LOG2_E + ROUND_F64;
    let k = shifted - ROUND_F64;
    let r = (inside - k * LN2_HI) - k * LN2_LO;

    // eʳ = 1 + r + r² q(r), q by Horner
    let mut q = 1.0 / 6_227_020_800.0;
    q = q * r + 1.0 / 479_001_600.0;
    q = q * r + 1.0 / 39_916_800.0;
    q = q * r + 1.0 / 3_628_800.0;
    q = q * r + 1.0 / 362_880.0;
    q = q * r + 1.0 / 40_320.0;
    q = q * r + 1.0 / 5_040.0;
    q = q * r + 1.0 / 720.0;
    q = q * r + 1.0 / 120.0;
    q = q * r + 1.0 / 24.0;
    q = q * r + 1.0 / 6.0;
    q = q * r + 0.5;
    let exp_r = 1.0 + (r + r * r * q);

    // 2^(k−1), built in the exponent field; the other factor 2 keeps k = 1024 in range.
    let half_scale = f64::from_bits(shifted.to_bits().wrapping_add(1022) << 52);
    let y = exp_r * half_scale * 2.0;
    let y = if x < LOWEST { 0.0 } else { y };
    let y = if x > HIGHEST { f64::INFINITY } else { y };
    // NaN fails every comparison above
    if x.is_nan() { x } else { y }
}

/// eˣ in single precision; the same steps, the series to degree 7.
#[inline(always)]
fn exp_f32(x: f32) -> f32 {
    const LN2_HI: f32 = f32::from_bits(0x3F31_7200);
    const LN2_LO: f32 = 1.428_606_8e-6;
    const LOWEST: f32 = -86.98;
    const HIGHEST: f32 = 88.722_83;
    let inside = if x > LOWEST { x } else { LOWEST };
    let inside = if inside < HIGHEST { inside } else { HIGHEST };

    let shifted = inside * core::f32::consts::LOG2_E + ROUND_F32;
    let k = shifted - ROUND_F32;
    let r = (inside - k * LN2_HI) - k * LN2_LO;

    let mut q = 1.0 / 5_040.0;
    q = q * r + 1.0 / 720.0;
    q = q * r + 1.0 / 120.0;
    q = q * r + 1.0 / 24.0;
    q = q * r + 1.0 / 6.0;
    q = q * r + 0.5;
    let exp_r = 1.0 + (r + r * r * q);

    let half_scale = f32::from_bits(shifted.to_bits().wrapping_add(126) << 23);
    let y = exp_r * half_scale * 2.0;
    let y = if x < LOWEST { 0.0 } else { y };
    let y = if x > HIGHEST { f32::INFINITY } else { y };
    if x.is_nan() { x } else { y }
}

/// ln x in double precision for normal x > 0: x = 2ᵏ m, m in [√½, √2), ln m = 2 artanh((m−1)/(m+1)).
#[inline(always)]
fn ln_f64(x: f64) -> f64 {
    const LN2_HI: f64 = f64::from_bits(0x3FE6_2E42_FEE0_0000);
    const LN2_LO: f64 = 1.908_214_929_270_587_7e-10;
    // bits of √½: subtracting them puts the border between two exponents at √½
    const SQRT_HALF: u64 = 0x3FE6_A09E_667F_3BCD;
    let bits = x.to_bits();
    let shifted = bits.wrapping_sub(SQRT_HALF);
    let m = f64::from_bits((shifted & 0x000F_FFFF_FFFF_FFFF).wrapping_add(SQRT_HALF));
    // the exponent as a small integer, turned into a number through the mantissa of ROUND_F64
    let biased = (shifted >> 52) & 0xFFF;
    let signed = (biased ^ 0x800).wrapping_sub(0x800);
    let k = f64::from_bits(ROUND_F64.to_bits().wrapping_add(signed)) - ROUND_F64;

    // ln m = 2s + 2s³/3 + …, and with f = m − 1: 2s = f − s f, which keeps the leading term exact
    let f = m - 1.0;
    let s = f / (2.0 + f);
    let z = s * s;
    let mut p = 2.0 / 21.0;
    p = p * z + 2.0 / 19.0;
    p = p * z + 2.0 / 17.0;
    p = p * z + 2.0 / 15.0;
    p = p * z + 2.0 / 13.0;
    p = p * z + 2.0 / 11.0;
    p = p * z + 2.0 / 9.0;
    p = p * z + 2.0 / 7.0;
    p = p * z + 2.0 / 5.0;
    p = p * z + 2.0 / 3.0;
    p *= z;
    let half_f2 = 0.5 * f * f;
    // f − s f = f − f²/2 + s f²/2
    let y = k * LN2_HI + (f - (half_f2 - (s * (half_f2 + p) + k * LN2_LO)));
    let y = if x > 0.0 { y } else { f64::NAN };
    let y = if x == 0.0 { f64::NEG_INFINITY } else { y };
    if x < f64::INFINITY { y } else { x }
}

impl Real for Portable<f64> {
    const ZERO: Self = Portable(0.0);
    const HALF: Self = Portable(0.5);
    const ONE: Self = Portable(1.0);
    const TWO: Self = Portable(2.0);
    const PI: Self = Portable(core::f64::consts::PI);
    const EPSILON: Self = Portable(f64::EPSILON);
    const MAX: Self = Portable(f64::MAX);

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Portable(x)
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.0
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Portable(Real::sqrt(self.0))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Portable(exp_f64(self.0))
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Portable(ln_f64(self.0))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Real::sin_cos(self.0);
        (Portable(sin), Portable(cos))
    }
    #[inline(always)]
    fn tan(self) -> Self {
        Portable(Real::tan(self.0))
    }
    #[inline(always)]
    fn asin(self) -> Self {
        Portable(Real::asin(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Portable(self.0.abs())
    }
}

impl Real for Portable<f32> {
    const ZERO: Self = Portable(0.0);
    const HALF: Self = Portable(0.5);
    const ONE: Self = Portable(1.0);
    const TWO: Self = Portable(2.0);
    const PI: Self = Portable(core::f32::consts::PI);
    const EPSILON: Self = Portable(f32::EPSILON);
    const MAX: Self = Portable(f32::MAX);

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Portable(x as f32)
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self.0)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Portable(Real::sqrt(self.0))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        Portable(exp_f32(self.0))
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Portable(single::ln(self.0))
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = fixed::sin_cos(self.0);
        (Portable(sin), Portable(cos))
    }
    #[inline(always)]
    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }
    #[inline(always)]
    fn asin(self) -> Self {
        Portable(single::asin(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Portable(self.0.abs())
    }
}
