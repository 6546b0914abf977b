//! `f32` with the elementary functions of the `micromath` crate (2.1), used as they are: small, and rough.
//!
//! **Too rough for this model:** BRDF_spec is off by up to a third. A fit or a calibration needs `f32` with feature `libm`, or
//! `Portable<f32>`; this type shows what a program would lose. It is a type of its own, so that low precision is visible where
//! it is used, and never arrives because another crate has turned a feature on.
//!
//! Worst errors, measured and held there by `tests/micromath.rs` (`just features`):
//!
//! | function | over | worst error |
//! |---|---|---|
//! | `sqrt` | 10⁻⁶ to 10⁶ | 6.1 % relative |
//! | `exp` | −80 to 0 | 0.25 % relative |
//! | `ln` | 10⁻⁶ to 10⁶ | 0.12 absolute |
//! | `sin`, `cos` | 0° to 360° | 1.2e-3 absolute |
//! | `tan` | 0° to 80° | 2.1 % relative |
//! | `asin` | 0 to 0.99 | 0.018 absolute |
//!
//! | BRDF_spec, n from 1.125 to 2, θ to 75°, tan²α/σ² < 14 | σ = 0.0625 | σ = 0.5 |
//! |---|---|---|
//! | from sines and cosines ([`Geometry::from_cosines`](crate::Geometry::from_cosines)) | 13 % | 32 % |
//! | from angles | 19 % | 32 % |
//!
//! The same grid with `f32` from libm or the standard library stays below 10⁻⁵. What is lost is lost in cosθ_a and in g of the
//! Fresnel factor, both square roots. Two laws hold all the same: values are finite and not negative, and swapping source and
//! view changes no bit from sines and cosines. From angles it does, by up to 2e-5, because micromath's sin(−x) is not −sin(x).

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

use ::micromath::F32Ext;

use super::Real;

/// An `f32` whose elementary functions are micromath's. See the [module](self) for their errors.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Default)]
#[repr(transparent)]
pub struct F32(
    /// The number itself.
    pub f32,
);

impl Add for F32 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        F32(self.0 + other.0)
    }
}
impl Sub for F32 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        F32(self.0 - other.0)
    }
}
impl Mul for F32 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        F32(self.0 * other.0)
    }
}
impl Div for F32 {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        F32(self.0 / other.0)
    }
}
impl Neg for F32 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        F32(-self.0)
    }
}
impl AddAssign for F32 {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.0 += other.0;
    }
}
impl SubAssign for F32 {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        self.0 -= other.0;
    }
}
impl MulAssign for F32 {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        self.0 *= other.0;
    }
}

impl Real for F32 {
    const ZERO: F32 = F32(0.0);
    const HALF: F32 = F32(0.5);
    const ONE: F32 = F32(1.0);
    const TWO: F32 = F32(2.0);
    const PI: F32 = F32(core::f32::consts::PI);
    const EPSILON: F32 = F32(f32::EPSILON);
    const MAX: F32 = F32(f32::MAX);

    #[inline(always)]
    fn lit(x: f64) -> F32 {
        F32(x as f32)
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self.0)
    }
    #[inline(always)]
    fn sqrt(self) -> F32 {
        F32(F32Ext::sqrt(self.0))
    }
    #[inline(always)]
    fn exp(self) -> F32 {
        F32(F32Ext::exp(self.0))
    }
    #[inline(always)]
    fn ln(self) -> F32 {
        F32(F32Ext::ln(self.0))
    }
    #[inline(always)]
    fn sin_cos(self) -> (F32, F32) {
        (F32(F32Ext::sin(self.0)), F32(F32Ext::cos(self.0)))
    }
    #[inline(always)]
    fn tan(self) -> F32 {
        F32(F32Ext::tan(self.0))
    }
    #[inline(always)]
    fn asin(self) -> F32 {
        F32(F32Ext::asin(self.0))
    }
    #[inline(always)]
    fn abs(self) -> F32 {
        F32(F32Ext::abs(self.0))
    }
}
