//! BRDF_spec of the paper's surface straight from sines and cosines, or from degrees, in the fewest operations: for devices.
//!
//! The same equations as [`Surface::brdf`], with what cancels taken out. With S = (cosθ_s + cosθ_v)²,
//! h = (sinθ_s − sinθ_v)² + 2 sinθ_s sinθ_v (1 + cosφ_v) and v = S + h:
//!
//! ```text
//! tan²α = h/S    cosθ_a = √v/2    G/cos⁴α = v min(v, 4 (cosθ_s + cosθ_v) min(cosθ_s, cosθ_v))/S²
//! ```
//!
//! Three divisions, two roots, one exponential.

use crate::real::device::F32;
use crate::real::fixed;
use crate::{DirectionCosines, DirectionTerms, DomainError, Normalization, Real, Surface};

/// What the lobe needs of a pair of directions.
#[derive(Clone, Copy)]
struct Pair<T> {
    cos_theta_s: T,
    cos_theta_v: T,
    /// cosθ_s + cosθ_v and its square S
    cos_sum: T,
    cos_sum2: T,
    sin_sin: T,
    /// sinθ_s − sinθ_v
    sin_difference: T,
    /// (1 + cosφ_v)/2 = cos²(φ_v/2)
    cos2_half_phi: T,
}

/// The half vector: S, h, v and 4 (cosθ_s + cosθ_v) min(cosθ_s, cosθ_v).
struct Half<T> {
    s: T,
    h: T,
    v: T,
    edge: T,
}

impl<T: Real> Pair<T> {
    /// Checks what a wrong table would most likely hold: a value outside its range. That a sine and a cosine belong
    /// together is not checked.
    #[inline(always)]
    fn from_cosines(directions: &DirectionCosines<T>) -> Result<Self, DomainError> {
        let DirectionCosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v } = *directions;
        // 10⁻⁹ is 0.06 µrad above the horizon; from there on no product below leaves the range of f32
        let inside = |cos: T, sin: T| cos.is_within(1e-9, 1.0) && sin.is_within(0.0, 1.0);
        if !inside(cos_theta_s, sin_theta_s) {
            return Err(DomainError::new("theta_s", "1e-9 ≤ cos ≤ 1 and 0 ≤ sin ≤ 1"));
        }
        if !inside(cos_theta_v, sin_theta_v) {
            return Err(DomainError::new("theta_v", "1e-9 ≤ cos ≤ 1 and 0 ≤ sin ≤ 1"));
        }
        if !cos_phi_v.abs().is_within(0.0, 1.0) {
            return Err(DomainError::new("cos_phi_v", "-1 ≤ cos phi_v ≤ 1"));
        }
        let cos_sum = cos_theta_s + cos_theta_v;
        Ok(Pair {
            cos_theta_s,
            cos_theta_v,
            cos_sum,
            cos_sum2: cos_sum.squared(),
            sin_sin: sin_theta_s * sin_theta_v,
            sin_difference: sin_theta_s - sin_theta_v,
            cos2_half_phi: T::HALF + T::HALF * cos_phi_v,
        })
    }

    #[inline(always)]
    fn half(&self) -> Half<T> {
        let s = self.cos_sum2;
        let h = self.sin_difference.squared() + T::lit(4.0) * (self.sin_sin * self.cos2_half_phi);
        // v = 4 cos²θ_a ≤ 4: absorbs rounding near the retro-direction
        let v = (s + h).min(T::lit(4.0));
        Half { s, h, v, edge: T::lit(4.0) * (self.cos_sum * self.cos_theta_s.min(self.cos_theta_v)) }
    }
}

impl Pair<F32> {
    /// Everything in fractions of the quarter turn until the last step: 1e-9 absolute.
    #[inline(always)]
    fn from_degrees(theta_s: F32, theta_v: F32, phi_v: F32) -> Result<Self, DomainError> {
        // to the last number below 90
        let zenith = |theta: F32| theta.is_within(0.0, 89.999_992);
        if !zenith(theta_s) {
            return Err(DomainError::new("theta_s", "0° ≤ theta < 90°"));
        }
        if !zenith(theta_v) {
            return Err(DomainError::new("theta_v", "0° ≤ theta < 90°"));
        }
        if !phi_v.abs().is_within(0.0, 360.0) {
            return Err(DomainError::new("phi_v", "-360° ≤ phi_v ≤ 360°"));
        }
        let (sin_s, cos_s) = fixed::zenith_sin_cos(theta_s.0);
        let (sin_v, cos_v) = fixed::zenith_sin_cos(theta_v.0);
        let number = |q31: u32| F32(fixed::scaled(q31, -31));
        // sum and difference before they are rounded: near the mirror direction nothing is lost
        let difference = sin_s.abs_diff(sin_v);
        let sum = (cos_s >> 1) + (cos_v >> 1);
        Ok(Pair {
            cos_theta_s: number(cos_s),
            cos_theta_v: number(cos_v),
            cos_sum: F32(fixed::scaled(sum, -30)),
            cos_sum2: F32(fixed::square(sum, -30)),
            sin_sin: number(sin_s) * number(sin_v),
            sin_difference: number(difference),
            cos2_half_phi: F32(fixed::square(fixed::cos_of_half_azimuth(phi_v.0), -31)),
        })
    }
}

impl<T: Real> Surface<T> {
    /// BRDF_spec in sr⁻¹ (Eq. 10) straight from sines and cosines: the value of [`brdf`](Self::brdf) up to rounding, for
    /// less than half the cost.
    ///
    /// `f32`: within 1e-5 where tan²α/σ² < 14, 2.5e-5 where < 80 (θ to 79°, σ ≥ 0.05).
    ///
    /// # Errors
    /// [`DomainError`] unless 10⁻⁹ ≤ cosθ ≤ 1, 0 ≤ sinθ ≤ 1 and |cosφ_v| ≤ 1. A sine and a cosine that do not belong
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
        Ok(self.lobe(&Pair::from_cosines(directions)?))
    }

    #[inline(always)]
    fn lobe(&self, pair: &Pair<T>) -> T {
        let Half { s, h, v, edge } = pair.half();

        // F = ½ (e²/u⁴ + e² q²/w⁴), see fresnel.rs
        let n = self.index().n();
        let n2 = n.squared();
        let e = (n - T::ONE) * (n + T::ONE);
        let c2 = T::lit(0.25) * v;
        let c = c2.sqrt();
        let g = (e + c2).sqrt();
        let u2 = (g + c).squared();
        let w2 = (n2 * c + g).squared();
        let q = (n2 + T::ONE) * c2 - T::ONE;
        let inverse = e / (u2 * w2);
        let twice_f = (w2 * inverse).squared() + (q * u2 * inverse).squared();

        //        F exp(−h/(S σ²)) v min(v, edge)           4π/K
        // BRDF = ─────────────────────────────── · ───────────────────
        //                S² σ²                      4π cosθ_s cosθ_v
        let inv_s_sigma2 = T::ONE / (s * self.sigma().squared());
        let k = match self.normalization() {
            Normalization::Bousquet2005 => T::lit(0.25 / (core::f64::consts::PI * core::f64::consts::PI)),
            Normalization::CookTorrance => T::lit(0.125 / core::f64::consts::PI),
        };
        let projected = k * v.min(edge) / (s * (pair.cos_theta_s * pair.cos_theta_v));
        twice_f * ((-(h * inv_s_sigma2)).exp() * (v * inv_s_sigma2) * projected)
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
        Ok(self.lobe(&Pair::from_degrees(theta_s, theta_v, phi_v)?))
    }
}

impl<T: Real> DirectionTerms<T> {
    #[inline(always)]
    fn of_pair(pair: &Pair<T>, normalization: Normalization) -> Self {
        let Half { s, h, v, edge } = pair.half();
        DirectionTerms {
            cos_theta_a: T::HALF * v.sqrt(),
            tan2_alpha: h / s,
            // G = min(1, edge/v)
            weight: normalization.factor::<T>() * v.min(edge)
                / (T::lit(4.0) * v * (pair.cos_theta_s * pair.cos_theta_v)),
        }
    }

    /// The terms of a direction given by its sines and cosines, in the fewest operations.
    ///
    /// # Errors
    /// As for [`Surface::brdf_at_cosines`].
    #[inline]
    pub fn at_cosines(directions: &DirectionCosines<T>, normalization: Normalization) -> Result<Self, DomainError> {
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
        Ok(Self::of_pair(&Pair::from_degrees(theta_s, theta_v, phi_v)?, normalization))
    }
}
