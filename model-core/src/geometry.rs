//! θ_s, θ_v, φ_v → the cosines and the half vector that every other equation takes (§4.1).

use crate::{Angle, DomainError, Real};

mod tilt;
pub use tilt::{DirectionVectors, Tilt, TiltSlopes, Tilted};

/// One pair of directions: source and view, as the equations need them.
///
/// Built once for each direction and shared by all wavelengths. Swapping source and view gives the same numbers to the
/// last bit, except that `cos_theta_s` and `cos_theta_v` change places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry<T> {
    cos_theta_s: T,
    cos_theta_v: T,
    cos_theta_a: T,
    sin2_theta_a: T,
    tan2_alpha: T,
}

/// Sines and cosines of one pair of directions, for callers that keep them in a table (a fixed goniometer head).
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct DirectionCosines<T> {
    /// cos θ_s, in (0, 1].
    pub cos_theta_s: T,
    /// sin θ_s, in [0, 1).
    pub sin_theta_s: T,
    /// cos θ_v, in (0, 1].
    pub cos_theta_v: T,
    /// sin θ_v, in [0, 1).
    pub sin_theta_v: T,
    /// cos φ_v, in [−1, 1]; −1 is the forward, specular side.
    pub cos_phi_v: T,
}

impl<T: Real> Geometry<T> {
    /// From the zenith angles θ_s, θ_v in [0°, 90°) and the view azimuth φ_v in [−360°, 360°] (0 = illumination side,
    /// 180° = forward, specular side).
    ///
    /// tan²α = tan²((θ_s − θ_v)/2) + 4 sinθ_s sinθ_v cos²(φ_v/2) / (cosθ_s + cosθ_v)² and
    /// cosθ_a = (cosθ_s + cosθ_v) √(1 + tan²α)/2: the half vector of §4.1 in the form that keeps its digits where the
    /// lobe is narrow. The printed form loses 6e-8/σ² of the exponent in `f32`.
    ///
    /// # Errors
    /// [`DomainError`] for an angle outside its range, the horizon included, and for NaN.
    ///
    /// ```
    /// use leafbrdf_core::{Angle, Geometry};
    /// // mirror direction: the facet that reflects is flat, and the incidence on it is θ_s
    /// let deg = Angle::from_degrees;
    /// let mirror = Geometry::from_angles(deg(60.0), deg(60.0), deg(180.0))?;
    /// assert!(mirror.tan2_alpha() < 1e-30);
    /// assert!((mirror.cos_theta_a() - 0.5_f64).abs() < 1e-15);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    pub fn from_angles(theta_s: Angle<T>, theta_v: Angle<T>, phi_v: Angle<T>) -> Result<Self, DomainError> {
        let (sin_theta_s, cos_theta_s) = zenith(theta_s, "theta_s")?;
        let (sin_theta_v, cos_theta_v) = zenith(theta_v, "theta_v")?;
        if !(phi_v.is_finite() && phi_v.radians().abs() <= T::lit(6.283_186)) {
            return Err(DomainError::new("phi_v", "-360° ≤ phi_v ≤ 360°"));
        }
        let (sin_half, cos_half) = theta_s.half_difference(theta_v).sin_cos();
        let tan_half_difference = sin_half / cos_half;
        let (sin_half_phi, cos_half_phi) = phi_v.scaled(T::HALF).sin_cos();
        let sin_sin = sin_theta_s * sin_theta_v;
        let sum = cos_theta_s + cos_theta_v;
        let tan2_alpha =
            tan_half_difference.squared() + T::lit(4.0) * (sin_sin * cos_half_phi.squared()) / sum.squared();
        let sin2_theta_a = sin_half.squared() + sin_sin * sin_half_phi.squared();
        Ok(Self::from_half_vector(cos_theta_s, cos_theta_v, tan2_alpha, sin2_theta_a))
    }

    /// From sines and cosines: two square roots and two divisions fewer than from angles, for firmware that keeps its
    /// directions in a table.
    ///
    /// With S = (cosθ_s + cosθ_v)² and h = (sinθ_s − sinθ_v)² + 2 sinθ_s sinθ_v (1 + cosφ_v): tan²α = h/S and
    /// 4 cos²θ_a = S + h. Relative error of BRDF_spec in `f32`: 7e-6 where tan²α/σ² < 14.
    ///
    /// # Errors
    /// [`DomainError`] for a value outside its range, the horizon included, for NaN, and where sin² + cos² differs from 1
    /// by more than 10⁻⁴ (a sine and a cosine that do not belong together).
    pub fn from_cosines(directions: DirectionCosines<T>) -> Result<Self, DomainError> {
        let DirectionCosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v } = directions;
        pair(sin_theta_s, cos_theta_s, "theta_s")?;
        pair(sin_theta_v, cos_theta_v, "theta_v")?;
        if !(cos_phi_v.abs() <= T::ONE) {
            return Err(DomainError::new("cos_phi_v", "-1 ≤ cos phi_v ≤ 1"));
        }
        let sum = cos_theta_s + cos_theta_v;
        let sin_sin = sin_theta_s * sin_theta_v;
        let sin_difference2 = (sin_theta_s - sin_theta_v).squared();
        let h = sin_difference2 + T::TWO * (sin_sin * (T::ONE + cos_phi_v));
        // 4 sin²θ_a = |s − v|²
        let chord2 =
            (cos_theta_s - cos_theta_v).squared() + sin_difference2 + T::TWO * (sin_sin * (T::ONE - cos_phi_v));
        Ok(Self::from_half_vector(cos_theta_s, cos_theta_v, h / sum.squared(), T::lit(0.25) * chord2))
    }

    #[inline(always)]
    fn from_half_vector(cos_theta_s: T, cos_theta_v: T, tan2_alpha: T, sin2_theta_a: T) -> Self {
        let cos_theta_a = T::HALF * (cos_theta_s + cos_theta_v) * (T::ONE + tan2_alpha).sqrt();
        Geometry {
            cos_theta_s,
            cos_theta_v,
            // cos θ_a ≤ 1; absorbs rounding only, near the retro-direction
            cos_theta_a: cos_theta_a.min(T::ONE),
            sin2_theta_a,
            tan2_alpha,
        }
    }

    /// cos θ_s.
    #[inline(always)]
    pub fn cos_theta_s(&self) -> T {
        self.cos_theta_s
    }

    /// cos θ_v.
    #[inline(always)]
    pub fn cos_theta_v(&self) -> T {
        self.cos_theta_v
    }

    /// cos θ_a: cosine of the incidence angle on the facet, half the phase angle.
    #[inline(always)]
    pub fn cos_theta_a(&self) -> T {
        self.cos_theta_a
    }

    /// cos 2θ_a = s·v: cosine of the phase angle between source and view.
    #[inline(always)]
    pub fn cos_2_theta_a(&self) -> T {
        T::ONE - T::TWO * self.sin2_theta_a
    }

    /// tan²α: squared tangent of the tilt of the facet that reflects from source to view.
    #[inline(always)]
    pub fn tan2_alpha(&self) -> T {
        self.tan2_alpha
    }

    /// α in radians.
    pub fn alpha(&self) -> T {
        // sin α = tan α / √(1 + tan²α): no cancellation at small tilt
        (self.tan2_alpha / (T::ONE + self.tan2_alpha)).sqrt().asin()
    }

    /// θ_a in radians.
    pub fn theta_a(&self) -> T {
        // from the smaller of sine and cosine: the arc sine of the other one has no digits left
        if self.cos_theta_a < T::lit(core::f64::consts::FRAC_1_SQRT_2) {
            T::HALF * T::PI - self.cos_theta_a.asin()
        } else {
            self.sin2_theta_a.sqrt().asin()
        }
    }
}

/// Sine and cosine of a zenith angle strictly above the horizon.
fn zenith<T: Real>(theta: Angle<T>, name: &'static str) -> Result<(T, T), DomainError> {
    let (sin, cos) = theta.sin_cos();
    if !(theta.radians() >= T::ZERO && theta.radians() <= T::HALF * T::PI && cos > T::ZERO) {
        return Err(DomainError::new(name, "0° ≤ theta < 90°, strictly above the horizon"));
    }
    Ok((sin, cos))
}

/// A sine and a cosine that belong to one zenith angle above the horizon.
fn pair<T: Real>(sin: T, cos: T, name: &'static str) -> Result<(), DomainError> {
    let sum = sin.squared() + cos.squared();
    if !(cos > T::ZERO && sin >= T::ZERO && (sum - T::ONE).abs() <= T::lit(1e-4)) {
        return Err(DomainError::new(name, "cos > 0, sin ≥ 0 and sin² + cos² = 1 within 1e-4"));
    }
    Ok(())
}
