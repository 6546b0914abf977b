//! BRDF_spec of the paper's surface straight from sines and cosines, or from degrees, in the fewest operations: for devices.
//!
//! The same equations as [`Surface::brdf`], with what cancels taken out. With S = (cosθ_s + cosθ_v)² and
//! h = (sinθ_s − sinθ_v)² + 2 sinθ_s sinθ_v (1 + cosφ_v):
//!
//! ```text
//! tan²α = h/S    c² = cos²θ_a = (S + h)/4    G/cos⁴α = 16 c² min(c², (cosθ_s + cosθ_v) min(cosθ_s, cosθ_v))/S²
//! ```
//!
//! and F from c² (`fresnel/squares.rs`). Four divisions, one root, one exponential. (h/(S σ²) by a
//! reciprocal would round twice what the exponential enlarges 80 times.)

use crate::fresnel::squares;
use crate::real::device::F32;
use crate::real::fixed;
use crate::{DirectionCosines, DirectionTerms, DomainError, Leaf, Normalization, Real, Surface, domain};

/// What the lobe needs of a pair of directions.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Pair<T> {
    /// S
    pub cos_sum2: T,
    /// h
    pub h: T,
    /// cosθ_s cosθ_v
    pub cos_cos: T,
    /// (cosθ_s + cosθ_v) min(cosθ_s, cosθ_v): where c² is larger, facets hide each other
    pub edge: T,
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

impl<T: Real> Pair<T> {
    #[inline(always)]
    fn from_cosines(directions: &DirectionCosines<T>) -> Result<Self, Refused> {
        Self::check(directions)?;
        Ok(Self::unchecked(directions))
    }

    /// What a wrong table would most likely hold: a value outside its range. That a sine and a cosine belong together is not
    /// checked.
    #[inline(always)]
    #[doc(hidden)]
    pub fn check(directions: &DirectionCosines<T>) -> Result<(), Refused> {
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
    #[doc(hidden)]
    pub fn unchecked(directions: &DirectionCosines<T>) -> Self {
        let d = directions;
        let product = d.sin_theta_s * d.sin_theta_v * (T::one() + d.cos_phi_v);
        let h = (d.sin_theta_s - d.sin_theta_v).squared() + (product + product);
        let cos_sum = d.cos_theta_s + d.cos_theta_v;
        Pair {
            cos_sum2: cos_sum.squared(),
            h,
            cos_cos: d.cos_theta_s * d.cos_theta_v,
            edge: cos_sum * d.cos_theta_s.min(d.cos_theta_v),
        }
    }

    /// c²
    #[inline(always)]
    fn cos2_theta_a(&self) -> T {
        T::lit(0.25) * (self.cos_sum2 + self.h)
    }

    /// π BRDF_spec = lobe · F · [`lobe_factor`], for a checked σ that is asked for when it is needed:
    ///
    /// ```text
    ///         4 c² min(c², edge) exp(−h/(S σ²))
    /// lobe = ─────────────────────────────────── DECAY_GAIN
    ///               S² σ² cosθ_s cosθ_v
    /// ```
    #[inline(always)]
    fn lobe(&self, sigma: impl FnOnce() -> T) -> T {
        let projected = self.cos2_theta_a().min(self.edge) / (self.cos_sum2 * self.cos_cos);
        let four_c2 = self.cos_sum2 + self.h;
        let sigma = sigma();
        let s_sigma2 = self.cos_sum2 * sigma * sigma;
        (self.h / (s_sigma2 * T::lit(T::DECAY_UNIT))).decay() * four_c2 / s_sigma2 * projected
    }

    /// F at a checked index.
    #[inline(always)]
    fn fresnel(&self, n: T) -> T {
        squares::fresnel(squares::excess(n), self.cos2_theta_a())
    }

    /// BRDF in sr⁻¹ of a leaf of checked parameters, each asked for when it is needed.
    #[doc(hidden)]
    #[inline(always)]
    pub fn leaf(
        &self,
        k_lambert: impl FnOnce() -> T,
        n: impl FnOnce() -> T,
        sigma: impl FnOnce() -> T,
        normalization: impl FnOnce() -> Normalization,
    ) -> T {
        let lobe = self.lobe(sigma) * self.fresnel(n());
        let lobe = lobe * lobe_factor(normalization());
        (k_lambert() + lobe) * T::lit(core::f64::consts::FRAC_1_PI)
    }
}

/// What [`Pair::lobe`] leaves to the constant K, 4π/K: 2/π or 1, over the gain of the exponential. The first needs no number that a
/// diffuse term does not.
#[inline(always)]
fn lobe_factor<T: Real>(normalization: Normalization) -> T {
    match normalization {
        Normalization::Bousquet2005 => T::lit(2.0 / T::DECAY_GAIN * core::f64::consts::FRAC_1_PI),
        Normalization::CookTorrance => T::lit(1.0 / T::DECAY_GAIN),
    }
}

/// The half vector of directions in degrees, computed once for all that use it; `cos_sum2` below 0 where an angle was refused.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct HalfVector {
    cos_sum2: f32,
    h: f32,
    cos_cos: f32,
    edge: f32,
}

/// Everything in integers until the last step: 1e-9 absolute.
///
/// By the calling convention of C, which returns four numbers in registers where there is a floating-point unit.
#[doc(hidden)]
#[inline(never)]
pub extern "C" fn half_vector(theta_s: f32, theta_v: f32, phi_v: f32) -> HalfVector {
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
    // the unit of a sine is 2⁻³⁰
    let number = |q30: u32| F32(q30 as f32);
    let product = |a: u32, b: u32| number(a) * F32(fixed::scaled(b, -60));
    // what the exponent takes is rounded after sum and difference, and after the square: near the mirror direction nothing is lost
    let cos_sum = sines.cos_theta_s + sines.cos_theta_v;
    let difference = F32(fixed::scaled(sines.sin_theta_s.abs_diff(sines.sin_theta_v), -30));
    let four_cos2_half_phi = F32(fixed::square(sines.cos_half_phi, -29));
    HalfVector {
        cos_sum2: fixed::square(cos_sum, -30),
        h: (difference.squared() + product(sines.sin_theta_s, sines.sin_theta_v) * four_cos2_half_phi).0,
        cos_cos: product(sines.cos_theta_s, sines.cos_theta_v).0,
        edge: product(cos_sum, sines.cos_theta_s.min(sines.cos_theta_v)).0,
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

    #[doc(hidden)]
    #[inline(always)]
    pub fn pair(self) -> Result<Pair<F32>, Refused> {
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
        Ok(self.lobe(&Pair::from_cosines(directions).map_err(Refused::cosine)?))
    }

    #[inline(always)]
    fn lobe(&self, pair: &Pair<T>) -> T {
        let lobe = pair.lobe(|| self.sigma()) * pair.fresnel(self.index().n());
        T::lit(core::f64::consts::FRAC_1_PI) * (lobe * lobe_factor(self.normalization()))
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
        Ok(self.lobe(&Degrees::new(theta_s, theta_v, phi_v).pair().map_err(Refused::angle)?))
    }
}

impl<T: Real> Leaf<T> {
    /// BRDF in sr⁻¹ (Eq. 3) straight from sines and cosines: k_L/π and [`Surface::brdf_at_cosines`], which says what it takes and how
    /// exact it is.
    ///
    /// # Errors
    /// As for [`Surface::brdf_at_cosines`].
    #[inline]
    pub fn brdf_at_cosines(&self, directions: &DirectionCosines<T>) -> Result<T, DomainError> {
        Ok(self.at_pair(&Pair::from_cosines(directions).map_err(Refused::cosine)?))
    }

    #[inline(always)]
    fn at_pair(&self, pair: &Pair<T>) -> T {
        let surface = self.surface();
        pair.leaf(|| self.k_lambert(), || surface.index().n(), || surface.sigma(), || surface.normalization())
    }
}

impl Leaf<F32> {
    /// BRDF in sr⁻¹ (Eq. 3) straight from degrees: k_L/π and [`Surface::brdf_at_degrees`].
    ///
    /// ```
    /// use leafbrdf_core::{Leaf, Surface, real::device::F32};
    /// // laurel (Table 4) in the mirror direction at 60°, with 3 % of diffuse light
    /// let laurel = Leaf::new(F32(0.03), Surface::new(F32(1.22), F32(0.078))?)?;
    /// let peak = laurel.brdf_at_degrees(F32(60.0), F32(60.0), F32(180.0))?;
    /// assert!((peak.0 - 1.26).abs() < 0.01);
    /// # Ok::<(), leafbrdf_core::DomainError>(())
    /// ```
    ///
    /// # Errors
    /// As for [`Surface::brdf_at_degrees`].
    #[inline]
    pub fn brdf_at_degrees(&self, theta_s: F32, theta_v: F32, phi_v: F32) -> Result<F32, DomainError> {
        Ok(self.at_pair(&Degrees::new(theta_s, theta_v, phi_v).pair().map_err(Refused::angle)?))
    }
}

impl<T: Real> DirectionTerms<T> {
    #[inline(always)]
    fn of_pair(pair: &Pair<T>, normalization: Normalization) -> Self {
        let c2 = pair.cos2_theta_a();
        DirectionTerms {
            // absorbs rounding near the retro-direction
            cos_theta_a: c2.min(T::ONE).sqrt(),
            tan2_alpha: pair.h / pair.cos_sum2,
            // G = min(1, edge/c²)
            weight: T::lit(0.25) * normalization.factor::<T>() * c2.min(pair.edge) / (c2 * pair.cos_cos),
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
