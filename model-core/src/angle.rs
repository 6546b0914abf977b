//! Angles: radians inside, degrees at the door, and no digit lost on the way in.

use crate::{DomainError, Real};

/// An angle, held in radians.
///
/// 30° has no exact value in radians: rounding it costs half a unit in the last place, which near grazing incidence
/// (cos 89.9°) or for two nearly equal directions (θ_s − θ_v) becomes the largest error of the whole model in `f32`.
/// The angle therefore carries the rounded part as well: radians = `hi + lo`.
///
/// ```
/// use leafbrdf_core::Angle;
/// let theta = Angle::from_degrees(60.0_f64);
/// assert!((theta.cos() - 0.5).abs() < 1e-16);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle<T> {
    hi: T,
    lo: T,
}

// π/180, π/2 and π in two words for f64; `second_word` gives what is left after rounding the first one to `T`.
const RADIANS_PER_DEGREE: (f64, f64) = (0.017_453_292_519_943_295, 2.948_652_270_870_169_5e-19);
const HALF_PI: (f64, f64) = (core::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17);

/// The part of the constant `first + second` that `T::lit(first)` leaves out.
#[inline(always)]
fn second_word<T: Real>((first, second): (f64, f64)) -> T {
    T::lit((first - T::lit(first).to_f64()) + second)
}

/// Twice the significant bits' half, plus one: 2¹² + 1 for f32, 2²⁷ + 1 for f64 (Dekker 1971, Veltkamp's splitting).
#[inline(always)]
fn splitter<T: Real>() -> T {
    if T::EPSILON < T::lit(1e-10) { T::lit(134_217_729.0) } else { T::lit(4_097.0) }
}

/// a · b = product + error, exactly (Dekker 1971), without a fused multiply-add.
#[inline]
fn two_product<T: Real>(a: T, b: T) -> (T, T) {
    let product = a * b;
    let ta = splitter::<T>() * a;
    let a_hi = ta - (ta - a);
    let a_lo = a - a_hi;
    let tb = splitter::<T>() * b;
    let b_hi = tb - (tb - b);
    let b_lo = b - b_hi;
    let error = ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo;
    (product, error)
}

impl<T: Real> Angle<T> {
    /// From degrees, as in files and on the command line.
    #[inline]
    pub fn from_degrees(degrees: T) -> Self {
        let (hi, rounding) = two_product(degrees, T::lit(RADIANS_PER_DEGREE.0));
        Angle { hi, lo: rounding + degrees * second_word(RADIANS_PER_DEGREE) }
    }

    /// From radians, taken as exact.
    #[inline]
    pub fn from_radians(radians: T) -> Self {
        Angle { hi: radians, lo: T::ZERO }
    }

    /// The angle in radians.
    #[inline]
    pub fn radians(self) -> T {
        self.hi
    }

    /// The angle in degrees.
    #[inline]
    pub fn degrees(self) -> T {
        self.hi * T::lit(57.295_779_513_082_32)
    }

    /// sin and cos. The cosine is taken as the sine of the complement beyond 45°, so it keeps its digits near 90°.
    #[inline]
    pub fn sin_cos(self) -> (T, T) {
        let complement = self.complement();
        let (sin, cos) = self.hi.sin_cos();
        if self.hi.abs() > T::lit(core::f64::consts::FRAC_PI_4) {
            (sin + cos * self.lo, complement.sin())
        } else {
            (sin + cos * self.lo, cos - sin * self.lo)
        }
    }

    /// sin x.
    #[inline]
    pub fn sin(self) -> T {
        let (sin, cos) = self.hi.sin_cos();
        sin + cos * self.lo
    }

    /// cos x.
    #[inline]
    pub fn cos(self) -> T {
        self.sin_cos().1
    }

    /// cos θ_a of an incidence angle on a facet, grazing incidence included.
    ///
    /// # Errors
    /// [`DomainError`] unless 0° ≤ θ_a ≤ 90°.
    pub fn incidence_cosine(self) -> Result<T, DomainError> {
        if !(self.hi >= T::ZERO && self.hi <= T::HALF * T::PI) {
            return Err(DomainError::new("theta_a", "0° ≤ theta_a ≤ 90°"));
        }
        // at 90° itself rounding leaves ±1e-33
        Ok(self.cos().max(T::ZERO))
    }

    /// tan x.
    #[inline]
    pub fn tan(self) -> T {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }

    /// π/2 − x for x ≥ 0 and π/2 + x for x < 0, so that its sine is cos x.
    #[inline]
    pub(crate) fn complement(self) -> Self {
        let (hi, lo) = if self.hi < T::ZERO { (-self.hi, -self.lo) } else { (self.hi, self.lo) };
        Angle::from_sum(T::lit(HALF_PI.0), -hi, second_word::<T>(HALF_PI) - lo)
    }

    /// (x − y)/2.
    #[inline]
    pub(crate) fn half_difference(self, other: Self) -> Self {
        let difference = Angle::from_sum(self.hi, -other.hi, self.lo - other.lo);
        difference.scaled(T::HALF)
    }

    /// x/2 (exact) or another power of two; with other factors the rounding of the first word is lost.
    #[inline]
    pub(crate) fn scaled(self, factor: T) -> Self {
        Angle { hi: self.hi * factor, lo: self.lo * factor }
    }

    /// a + b + rest, a + b without rounding (Knuth's two-sum).
    #[inline]
    fn from_sum(a: T, b: T, rest: T) -> Self {
        let sum = a + b;
        let b_part = sum - a;
        let rounding = (a - (sum - b_part)) + (b - b_part);
        Angle { hi: sum, lo: rounding + rest }
    }

    pub(crate) fn is_finite(self) -> bool {
        self.hi.is_finite() && self.lo.is_finite()
    }
}
