//! `f32` and `f64` with the `libm` crate, for targets without the standard library.
//!
//! Not every function of `f32` is the crate's: there `sinf`, `cosf`, `tanf` and `asinf` compute in `f64` (1,180 instructions each on
//! a Cortex-M4F) and `sqrtf` does not use the hardware's root. Ours do not, and do.

use super::{Real, fixed, root, single};

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const HALF: f64 = 0.5;
    const ONE: f64 = 1.0;
    const TWO: f64 = 2.0;
    const PI: f64 = core::f64::consts::PI;
    const EPSILON: f64 = f64::EPSILON;
    const MAX: f64 = f64::MAX;

    #[inline(always)]
    fn lit(x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
    #[inline(always)]
    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }
    #[inline(always)]
    fn exp(self) -> f64 {
        libm::exp(self)
    }
    #[inline(always)]
    fn ln(self) -> f64 {
        libm::log(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (f64, f64) {
        libm::sincos(self)
    }
    #[inline(always)]
    fn tan(self) -> f64 {
        libm::tan(self)
    }
    #[inline(always)]
    fn asin(self) -> f64 {
        libm::asin(self)
    }
    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }
}

impl Real for f32 {
    const ZERO: f32 = 0.0;
    const HALF: f32 = 0.5;
    const ONE: f32 = 1.0;
    const TWO: f32 = 2.0;
    const PI: f32 = core::f32::consts::PI;
    const EPSILON: f32 = f32::EPSILON;
    const MAX: f32 = f32::MAX;

    #[inline(always)]
    fn lit(x: f64) -> f32 {
        x as f32
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn sqrt(self) -> f32 {
        root::sqrt(self)
    }
    #[inline(always)]
    fn exp(self) -> f32 {
        libm::expf(self)
    }
    #[inline(always)]
    fn ln(self) -> f32 {
        libm::logf(self)
    }
    #[inline(always)]
    fn sin_cos(self) -> (f32, f32) {
        fixed::sin_cos(self)
    }
    #[inline(always)]
    fn tan(self) -> f32 {
        let (sin, cos) = fixed::sin_cos(self);
        sin / cos
    }
    #[inline(always)]
    fn asin(self) -> f32 {
        single::asin(self)
    }
    #[inline(always)]
    fn abs(self) -> f32 {
        f32::abs(self)
    }
}
