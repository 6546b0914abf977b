//! BRDF_spec of the paper's surface straight from sines and cosines, or from degrees, in the fewest operations: for devices.
//!
//! The same equations as [`Surface::brdf`], with what cancels taken out. With S = (cosθ_s + cosθ_v)² and
//! h = (sinθ_s − sinθ_v)² + 2 sinθ_s sinθ_v (1 + cosφ_v):
//!
//! ```text
//! tan²α = h/S    c² = cos²θ_a = (S + h)/4    G/cos⁴α = 16 c² min(c², (cosθ_s + cosθ_v) min(cosθ_s, cosθ_v))/S²
//! ```
//!
//! and with e = n² − 1, g = √(e + c²), a = g + c, the two amplitudes of F by one division (Cook and Torrance 1982; their g − c
//! is e/a here, which keeps its digits as n → 1):
//!
//! ```text
//!        e             c a − 1                        e            e a (c a − 1)
//! r_s = ───    r_p = ───────────── r_s    that is    ───  and  ───────────────────
//!        a²           c (g − c) + 1                   a²          a² (a + c e)
//! ```
//!
//! Four divisions, two roots, one exponential. (h/(S σ²) by a reciprocal would round twice what the exponential enlarges 80 times.)

use crate::real::device::F32;
use crate::real::fixed;
use crate::{DirectionCosines, DirectionTerms, DomainError, Normalization, Real, Surface, domain};

/// What the lobe needs of a pair of directions, all times 2^`UNIT`.
#[derive(Clone, Copy)]
struct Pair<T, const UNIT: u32> {
    /// S
    cos_sum2: T,
    /// h
    h: T,
    /// cosθ_s cosθ_v
    cos_cos: T,
    /// (cosθ_s + cosθ_v) min(cosθ_s, cosθ_v): where c² is larger, facets hide each other
    edge: T,
}

/// The angle that was refused.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    ThetaS,
    ThetaV,
    PhiV,
}

impl Refused {
    #[cold]
    fn cosine(self) -> DomainError {
        match self {
            Refused::ThetaS => DomainError::new("theta_s", "2^-30 ≤ cos ≤ 1 and 0 ≤ sin ≤ 1"),
            Refused::ThetaV => DomainError::new("theta_v", "2^-30 ≤ cos ≤ 1 and 0 ≤ sin ≤ 1"),
            Refused::PhiV => DomainError::new("cos_phi_v", "-1 ≤ cos phi_v ≤ 1"),
        }
    }

    #[cold]
    fn angle(self) -> DomainError {
        match self {
            Refused::ThetaS => DomainError::new("theta_s", "0° ≤ theta < 90°"),
            Refused::ThetaV => DomainError::new("theta_v", "0° ≤ theta < 90°"),
            Refused::PhiV => DomainError::new("phi_v", "-360° ≤ phi_v ≤ 360°"),
        }
    }
}

impl<T: Real> Pair<T, 0> {
    #[inline(always)]
    fn from_cosines(directions: &DirectionCosines<T>) -> Result<Self, Refused> {
        Self::check(directions)?;
        Ok(Self::unchecked(directions))
    }

    /// What a wrong table would most likely hold: a value outside its range. That a sine and a cosine belong together is not
    /// checked.
    #[inline(always)]
    fn check(directions: &DirectionCosines<T>) -> Result<(), Refused> {
        let DirectionCosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v } = *directions;
        // 2⁻³⁰ is 1 nrad above the horizon; from there on no product below leaves the range of f32
        let inside = |cos: T, sin: T| cos.is_within(domain::COS[0], domain::COS[1]) && sin.is_within(0.0, 1.0);
        if !inside(cos_theta_s, sin_theta_s) {
            return Err(Refused::ThetaS);
        }
        if !inside(cos_theta_v, sin_theta_v) {
            return Err(Refused::ThetaV);
        }
        if !cos_phi_v.abs().is_within(0.0, 1.0) {
            return Err(Refused::PhiV);
        }
        Ok(())
    }

    #[inline(always)]
    fn unchecked(directions: &DirectionCosines<T>) -> Self {
        let DirectionCosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v } = *directions;
        let product = sin_theta_s * sin_theta_v * (T::ONE + cos_phi_v);
        let cos_sum = cos_theta_s + cos_theta_v;
        Pair {
            cos_sum2: cos_sum.squared(),
            h: (sin_theta_s - sin_theta_v).squared() + (product + product),
            cos_cos: cos_theta_s * cos_theta_v,
            edge: cos_sum * cos_theta_s.min(cos_theta_v),
        }
    }
}

impl<T: Real, const UNIT: u32> Pair<T, UNIT> {
    /// 1 in this unit.
    const ONE: f64 = (1_u64 << UNIT) as f64;

    /// A number in this unit as it is.
    #[inline(always)]
    fn unscaled(&self, x: T) -> T {
        // a product by 1 is a call like any other
        if UNIT == 0 { x } else { T::lit(1.0 / Self::ONE) * x }
    }

    /// c², in this unit.
    #[inline(always)]
    fn cos2_theta_a(&self) -> T {
        T::lit(0.25) * (self.cos_sum2 + self.h)
    }
}

/// The half vector of directions in degrees, computed once for all that use it; `cos_sum2` below 0 where an angle was refused.
#[repr(C)]
struct HalfVector {
    cos_sum2: f32,
    h: f32,
    cos_cos: f32,
    edge: f32,
}

/// Everything in integers until the last step: 1e-9 absolute.
///
/// By the calling convention of C, which returns four numbers in registers where there is a floating-point unit.
#[inline(never)]
extern "C" fn half_vector(theta_s: f32, theta_v: f32, phi_v: f32) -> HalfVector {
    let refused = |code: f32| HalfVector { cos_sum2: code, h: 0.0, cos_cos: 0.0, edge: 0.0 };
    // to the last number below 90
    let zenith = |theta: f32| F32(theta).is_within(0.0, 89.999_992);
    if !zenith(theta_s) {
        return refused(-1.0);
    }
    if !zenith(theta_v) {
        return refused(-2.0);
    }
    if !F32(phi_v).abs().is_within(0.0, 360.0) {
        return refused(-3.0);
    }
    let sines = fixed::direction_here(theta_s, theta_v, phi_v);
    // the unit of a sine is 2⁻³⁰, that of a product 2⁻⁶⁰: nothing is scaled
    let number = |q30: u32| F32(q30 as f32);
    // what the exponent takes is rounded after sum and difference, and after the square: near the mirror direction nothing is lost
    let cos_sum = sines.cos_theta_s + sines.cos_theta_v;
    let difference = number(sines.sin_theta_s.abs_diff(sines.sin_theta_v));
    let sin_sin = number(sines.sin_theta_s) * number(sines.sin_theta_v);
    let four_cos2_half_phi = F32(fixed::square(sines.cos_half_phi, -29));
    HalfVector {
        cos_sum2: fixed::square(cos_sum, 0),
        h: (difference.squared() + sin_sin * four_cos2_half_phi).0,
        cos_cos: (number(sines.cos_theta_s) * number(sines.cos_theta_v)).0,
        edge: (number(cos_sum) * number(sines.cos_theta_s.min(sines.cos_theta_v))).0,
    }
}

/// A pair of directions from degrees, or the angle that was refused.
#[doc(hidden)]
pub struct Degrees(HalfVector);

impl Degrees {
    /// Computed before anything else is looked at, so that nothing has to be kept meanwhile.
    #[doc(hidden)]
    #[inline(always)]
    pub fn new(theta_s: F32, theta_v: F32, phi_v: F32) -> Self {
        Degrees(half_vector(theta_s.0, theta_v.0, phi_v.0))
    }

    #[inline(always)]
    fn pair(self) -> Result<Pair<F32, 60>, Refused> {
        let HalfVector { cos_sum2, h, cos_cos, edge } = self.0;
        let code = cos_sum2.to_bits();
        if code >> 31 == 1 {
            const S: u32 = (-1.0_f32).to_bits();
            const V: u32 = (-2.0_f32).to_bits();
            return Err(match code {
                S => Refused::ThetaS,
                V => Refused::ThetaV,
                _ => Refused::PhiV,
            });
        }
        Ok(Pair { cos_sum2: F32(cos_sum2), h: F32(h), cos_cos: F32(cos_cos), edge: F32(edge) })
    }
}

impl<T: Real> Surface<T> {
    /// BRDF_spec in sr⁻¹ (Eq. 10) straight from sines and cosines: the value of [`brdf`](Self::brdf) up to rounding, for
    /// less than half the cost.
    ///
    /// `f32`: within 1e-5 where tan²α/σ² < 14, 2.5e-5 where < 80 (θ to 79°, σ ≥ 0.05).
    ///
    /// # Errors
    /// [`DomainError`] unless 2⁻³⁰ ≤ cosθ ≤ 1, 0 ≤ sinθ ≤ 1 and |cosφ_v| ≤ 1. A sine and a cosine that do not belong
    /// together give a meaningless number: [`Geometry::from_cosines`](crate::Geometry::from_cosines) tells.
    ///
    /// ```
    /// use leafbrdf_core::{DirectionCosines, Surface};
    /// // laurel (Table 4) in the mirror direction at 60°
    /// let (sin, cos) = (0.75_f64.sqrt(), 0.5);
    /// let mirror = DirectionCosines {
    ///     cos_theta_s: cos, sin_theta_s: sin, cos_theta_v: cos, sin_theta_v: sin, cos_phi_v: -1.0,
    /// };
    /// let peak = Surface::new(1.22_f64, 0.078)?.brdf_at_cosines(&mirror)?;
    /// assert!((peak - 1.25).abs() < 0.01);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    #[inline]
    pub fn brdf_at_cosines(&self, directions: &DirectionCosines<T>) -> Result<T, DomainError> {
        self.try_brdf_at_cosines(directions).map_err(Refused::cosine)
    }

    /// The same with an error that costs nothing.
    #[doc(hidden)]
    #[inline(always)]
    pub fn try_brdf_at_cosines(&self, directions: &DirectionCosines<T>) -> Result<T, Refused> {
        Ok(self.lobe(&Pair::from_cosines(directions)?))
    }

    #[inline(always)]
    fn lobe<const UNIT: u32>(&self, pair: &Pair<T, UNIT>) -> T {
        let one = Pair::<T, UNIT>::ONE;
        // the lobe first: then less is left to be kept

        //        F exp(−h/(S σ²)) 16 c² min(c², edge)         4π/K
        // BRDF = ────────────────────────────────────── · ───────────────
        //                     S² σ²                        4π cosθ_s cosθ_v
        let scaled_c2 = pair.cos2_theta_a();
        let k = |value: f64| T::lit(value * one / T::DECAY_GAIN);
        let k = match self.normalization() {
            Normalization::Bousquet2005 => k(4.0 / (core::f64::consts::PI * core::f64::consts::PI)),
            Normalization::CookTorrance => k(2.0 / core::f64::consts::PI),
        };
        let projected = k * scaled_c2.min(pair.edge) / (pair.cos_sum2 * pair.cos_cos);
        let s_sigma2 = pair.cos_sum2 * self.sigma().squared();
        let lobe = (pair.h / s_sigma2).decay() * (scaled_c2 / s_sigma2) * projected;

        let c2 = pair.unscaled(scaled_c2);
        let n = self.index().n();
        let e = (n - T::ONE) * (n + T::ONE);
        let (g, c) = T::sqrt_of_both(e + c2, c2);
        let a = g + c;
        let rest = a + c * e;
        let inverse = e / (a.squared() * rest);
        let twice_f = (rest * inverse).squared() + (a * (a * c - T::ONE) * inverse).squared();
        twice_f * lobe
    }
}

impl Surface<F32> {
    /// BRDF_spec in sr⁻¹ (Eq. 10) straight from degrees: θ_s and θ_v in [0, 90), φ_v in [−360, 360].
    ///
    /// Within 1e-5 where tan²α/σ² < 14, 2.5e-5 where < 80 (θ to 79°, σ ≥ 0.01), at a fraction of the cost of
    /// [`Geometry::from_angles`](crate::Geometry::from_angles): no angle is ever rounded.
    ///
    /// # Errors
    /// [`DomainError`] for an angle outside its range, and for NaN.
    ///
    /// ```
    /// use leafbrdf_core::{Surface, real::device::F32};
    /// // laurel (Table 4) in the mirror direction at 60°
    /// let laurel = Surface::new(F32(1.22), F32(0.078))?;
    /// let peak = laurel.brdf_at_degrees(F32(60.0), F32(60.0), F32(180.0))?;
    /// assert!((peak.0 - 1.25).abs() < 0.01);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    #[inline]
    pub fn brdf_at_degrees(&self, theta_s: F32, theta_v: F32, phi_v: F32) -> Result<F32, DomainError> {
        self.try_brdf_at_degrees(Degrees::new(theta_s, theta_v, phi_v)).map_err(Refused::angle)
    }

    /// The same with an error that costs nothing.
    #[doc(hidden)]
    #[inline(always)]
    pub fn try_brdf_at_degrees(&self, directions: Degrees) -> Result<F32, Refused> {
        Ok(self.lobe(&directions.pair()?))
    }
}

impl<T: Real> DirectionTerms<T> {
    #[inline(always)]
    fn of_pair<const UNIT: u32>(pair: &Pair<T, UNIT>, normalization: Normalization) -> Self {
        let one = Pair::<T, UNIT>::ONE;
        let c2 = pair.cos2_theta_a();
        DirectionTerms {
            // absorbs rounding near the retro-direction
            cos_theta_a: pair.unscaled(c2).min(T::ONE).sqrt(),
            tan2_alpha: pair.h / pair.cos_sum2,
            // G = min(1, edge/c²)
            weight: T::lit(0.25 * one) * normalization.factor::<T>() * c2.min(pair.edge) / (c2 * pair.cos_cos),
        }
    }

    /// The terms of a direction given by its sines and cosines, in the fewest operations.
    ///
    /// # Errors
    /// As for [`Surface::brdf_at_cosines`].
    #[inline]
    pub fn at_cosines(directions: &DirectionCosines<T>, normalization: Normalization) -> Result<Self, DomainError> {
        Self::try_at_cosines(directions, normalization).map_err(Refused::cosine)
    }

    /// The same with an error that costs nothing.
    #[doc(hidden)]
    #[inline(always)]
    pub fn try_at_cosines(directions: &DirectionCosines<T>, normalization: Normalization) -> Result<Self, Refused> {
        Ok(Self::of_pair(&Pair::from_cosines(directions)?, normalization))
    }
}

impl DirectionTerms<F32> {
    /// The terms of a direction given in degrees: θ_s and θ_v in [0, 90), φ_v in [−360, 360].
    ///
    /// # Errors
    /// [`DomainError`] for an angle outside its range, and for NaN.
    #[inline]
    pub fn at_degrees(
        theta_s: F32,
        theta_v: F32,
        phi_v: F32,
        normalization: Normalization,
    ) -> Result<Self, DomainError> {
        Self::try_at_degrees(Degrees::new(theta_s, theta_v, phi_v), normalization).map_err(Refused::angle)
    }

    /// The same with an error that costs nothing.
    #[doc(hidden)]
    #[inline(always)]
    pub fn try_at_degrees(directions: Degrees, normalization: Normalization) -> Result<Self, Refused> {
        Ok(Self::of_pair(&directions.pair()?, normalization))
    }
}
