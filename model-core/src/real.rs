//! The number type of every equation: one small trait, and one file per back-end that implements it.
//!
//! | type | elementary functions from | feature |
//! |---|---|---|
//! | `f64`, `f32` | the standard library | `std` |
//! | `f64`, `f32` | the `libm` crate, where `std` is off | `libm` |
//! | [`Portable<f64>`](Portable), [`Portable<f32>`](Portable) | plain arithmetic for `exp` and `ln` (vectorises; in `f32` same bits on every machine) | either |
//! | [`device::F32`] | own, in integers; the hardware's square root: for microcontrollers, same bits everywhere | none |
//! | `micromath::F32` | the `micromath` crate: rough | `micromath` |

use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

pub mod device;
pub(crate) mod fixed;
#[cfg(all(feature = "libm", not(feature = "std")))]
mod libm;
#[cfg(feature = "micromath")]
pub mod micromath;
#[cfg(any(feature = "std", feature = "libm"))]
mod portable;
mod root;
mod single;
// a Cortex-M0's arithmetic; tested on the host
#[cfg(any(test, all(target_arch = "arm", not(target_abi = "eabihf"))))]
mod soft;
#[cfg(feature = "std")]
mod std;

#[cfg(any(feature = "std", feature = "libm"))]
pub use portable::Portable;

/// A real number, as far as the equations of this crate need one.
///
/// Comparisons are IEEE: everything compared with NaN is false, and the domain checks are written so that NaN fails them.
#[diagnostic::on_unimplemented(
    message = "`{Self}` has no elementary functions here",
    note = "enable feature `std` or `libm` of leafbrdf-core for f32 and f64, or `micromath` for micromath::F32"
)]
pub trait Real:
    Copy
    + Debug
    + PartialOrd
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// 0.
    const ZERO: Self;
    /// 1/2.
    const HALF: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// π.
    const PI: Self;
    /// Distance from 1 to the next larger number.
    const EPSILON: Self;
    /// The largest finite number.
    const MAX: Self;

    /// The number nearest to `x`.
    fn lit(x: f64) -> Self;
    /// The same number in double precision (exact for `f32`).
    fn to_f64(self) -> f64;
    /// The whole part of a number that is not negative; 0 for NaN and below 0.
    #[inline(always)]
    fn to_usize(self) -> usize {
        self.to_f64() as usize
    }
    /// √x; NaN for x < 0.
    fn sqrt(self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Tangent of an angle in radians.
    fn tan(self) -> Self;
    /// Arc sine, radians; NaN outside [−1, 1].
    fn asin(self) -> Self;
    /// |x|.
    fn abs(self) -> Self;

    /// Sine of an angle in radians.
    #[inline]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Cosine of an angle in radians.
    #[inline]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// x².
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }

    /// The smaller of two numbers; `other` where either is NaN.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    /// The larger of two numbers; `other` where either is NaN.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// (√x, √y).
    #[doc(hidden)]
    #[inline(always)]
    fn sqrt_of_both(x: Self, y: Self) -> (Self, Self) {
        (x.sqrt(), y.sqrt())
    }

    /// 1, for where it is needed now and then: not kept from one use to the next where that costs stack.
    #[doc(hidden)]
    #[inline(always)]
    fn one() -> Self {
        Self::ONE
    }

    /// Of two forms of an equation the one of fewer operations, for devices; else the one that results have always been computed by.
    #[doc(hidden)]
    const FEWEST_OPERATIONS: bool = false;

    /// By how much [`decay`](Self::decay) is too large: for the caller to fold into a constant of its own.
    #[doc(hidden)]
    const DECAY_GAIN: f64 = 1.0;
    /// What [`decay`](Self::decay) counts in; likewise. Negative, as its argument is.
    #[doc(hidden)]
    const DECAY_UNIT: f64 = -1.0;

    /// `DECAY_GAIN` · exp(−x `DECAY_UNIT`), x ≤ 0.
    #[doc(hidden)]
    #[inline(always)]
    fn decay(self) -> Self {
        self.exp()
    }

    /// `lower` ≤ x ≤ `upper` for two constants, neither negative; false for NaN.
    #[inline(always)]
    fn is_within(self, lower: f64, upper: f64) -> bool {
        self >= Self::lit(lower) && self <= Self::lit(upper)
    }

    /// Neither infinite nor NaN.
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.abs() <= Self::MAX
    }
}
