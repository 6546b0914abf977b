//! The number of a microcontroller: [`F32`], single precision with its own elementary functions.
//!
//! IEEE operations as the hardware (or the compiler's software) does them, and everything else in integers: `exp`, `sin`,
//! `cos`; √ is VSQRT where there is a floating-point unit. No feature is needed, nothing is computed in `f64`, and every
//! target gives the same bits, so that what a device computes can be checked on a desk.
//!
//! | function | largest error, units in the last place | domain |
//! |---|---|---|
//! | `sqrt` | 0.5 (correctly rounded) | all |
//! | `exp` | 1 | all; 0 below 2⁻¹²⁶, infinite above 2¹²⁶ |
//! | `sin_cos` | 1 | all |
//! | `tan` | 2.5 | all |
//! | `asin` | 2.5 | [−1, 1] |
//! | `ln` | 1 | normal numbers |

use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

#[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
use super::soft;
use super::{Real, fixed, root, single};

/// Single precision for devices: small, no `libm`, no `f64`, the same bits everywhere.
///
/// ```
/// use leafbrdf_core::{Angle, Geometry, Surface, real::device::F32};
/// // laurel (Table 4) in the mirror direction at 60°
/// let deg = |x| Angle::from_degrees(F32(x));
/// let mirror = Geometry::from_angles(deg(60.0), deg(60.0), deg(180.0))?;
/// let laurel = Surface::new(F32(1.22), F32(0.078))?;
/// assert!((laurel.brdf(&mirror).0 - 1.25).abs() < 0.01);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(not(all(target_arch = "arm", not(target_abi = "eabihf"))), derive(PartialEq, PartialOrd))]
#[repr(transparent)]
pub struct F32(
    /// The number itself.
    pub f32,
);

#[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
impl PartialEq for F32 {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        soft::compare(self.0, other.0) == 0
    }
}
#[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
impl PartialOrd for F32 {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
        match soft::compare(self.0, other.0) {
            2 => None,
            order => Some(order.cmp(&0)),
        }
    }
    #[inline(always)]
    fn lt(&self, other: &Self) -> bool {
        soft::compare(self.0, other.0) < 0
    }
    #[inline(always)]
    fn gt(&self, other: &Self) -> bool {
        soft::compare(self.0, other.0) == 1
    }
    #[inline(always)]
    fn le(&self, other: &Self) -> bool {
        soft::compare(self.0, other.0) <= 0
    }
    #[inline(always)]
    fn ge(&self, other: &Self) -> bool {
        soft::compare(other.0, self.0) <= 0
    }
}

impl Add for F32 {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
        {
            F32(self.0 + other.0)
        }
        #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
        {
            F32(soft::add(self.0, other.0))
        }
    }
}
impl Sub for F32 {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
        {
            F32(self.0 - other.0)
        }
        #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
        {
            F32(soft::sub(self.0, other.0))
        }
    }
}
impl Mul for F32 {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
        {
            F32(self.0 * other.0)
        }
        #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
        {
            F32(soft::mul(self.0, other.0))
        }
    }
}
impl Div for F32 {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
        {
            F32(self.0 / other.0)
        }
        #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
        {
            F32(soft::div(self.0, other.0))
        }
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
        *self = *self + other;
    }
}
impl SubAssign for F32 {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
impl MulAssign for F32 {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Real for F32 {
    const ZERO: Self = F32(0.0);
    const HALF: Self = F32(0.5);
    const ONE: Self = F32(1.0);
    const TWO: Self = F32(2.0);
    #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
    #[inline(always)]
    fn one() -> Self {
        F32(soft::one())
    }
    const PI: Self = F32(core::f32::consts::PI);
    const EPSILON: Self = F32(f32::EPSILON);
    const MAX: Self = F32(f32::MAX);

    #[inline(always)]
    fn lit(x: f64) -> Self {
        F32(x as f32)
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        f64::from(self.0)
    }
    #[inline(always)]
    fn to_usize(self) -> usize {
        #[cfg(not(all(target_arch = "arm", not(target_abi = "eabihf"))))]
        {
            self.0 as usize
        }
        #[cfg(all(target_arch = "arm", not(target_abi = "eabihf")))]
        {
            // what is negative, and NaN, lies above infinity
            if self.0.to_bits() > f32::INFINITY.to_bits() { 0 } else { fixed::truncated(self.0, 0) as usize }
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        F32(root::sqrt(self.0))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        F32(fixed::exp(self.0))
    }
    const FEWEST_OPERATIONS: bool = true;
    const DECAY_GAIN: f64 = fixed::DECAY_GAIN;
    const DECAY_UNIT: f64 = fixed::DECAY_UNIT;
    #[inline(always)]
    fn decay(self) -> Self {
        F32(fixed::decay(self.0))
    }
    #[inline(always)]
    fn sqrt_of_both(x: Self, y: Self) -> (Self, Self) {
        let (x, y) = root::sqrt_of_both(x.0, y.0);
        (F32(x), F32(y))
    }
    #[inline]
    fn ln(self) -> Self {
        single::ln(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = fixed::sin_cos(self.0);
        (F32(sin), F32(cos))
    }
    #[inline]
    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }
    #[inline]
    fn asin(self) -> Self {
        single::asin(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        F32(self.0.abs())
    }
    /// One comparison of integers: positive numbers have the order of their bits, and NaN and what is negative lie above them all.
    #[inline(always)]
    fn is_within(self, lower: f64, upper: f64) -> bool {
        let (lower, upper) = (lower as f32, upper as f32);
        let bits = self.0.to_bits();
        let (least, span) = (lower.to_bits(), upper.to_bits() - lower.to_bits());
        if least == 0 {
            // −0 is 0
            return !(bits > span && bits != 1 << 31);
        }
        bits.wrapping_sub(least) <= span
    }
}
