//! A diffuse term one order beyond [`P1`]: it also knows how far the light turned.

use super::{Diffuse, DiffuseSlopes, P1, two_thirds};
use crate::{DomainError, Geometry, Real};

/// BRDF_diff = k_L/π · (1 − a cosθ_s cosθ_v − b sinθ_s sinθ_v cosφ_v − e cos²2θ_a)/N with N = 1 − 2a/3 − e/2.
///
/// As b weighs the first Legendre term of the phase angle 2θ_a between source and view, e weighs the second: e > 0 darkens
/// the views near the source and takes none from those at right angles to it. Reciprocal; positive everywhere while
/// max(|a|, |b|) + max(e, 0) < 1. N keeps k_L the DHRF at normal incidence. (a, b, 0) is [`P1`].
///
/// e is a nuisance parameter with a prior rather than a constant of a material: fitted to real leaves it falls with θ_s.
///
/// ```
/// use leafbrdf_core::{diffuse::P2, Diffuse};
/// // k_L is the DHRF at normal incidence; at 60° the bowl and e both return more
/// let bowl = P2::new(0.15_f64, 0.0, 0.1)?;
/// assert!((bowl.hemispherical(1.0) - 1.0).abs() < 1e-15);
/// assert!((bowl.hemispherical(0.5) - (1.0 - 0.05 - 0.03125) / 0.85).abs() < 1e-15);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct P2<T> {
    a: T,
    b: T,
    e: T,
    /// 1/N
    inverse_norm: T,
}

impl<T: Real> P2<T> {
    /// From a and b as in [`P1::new`], and e, unitless.
    ///
    /// # Errors
    /// [`DomainError`] unless |a| + max(e, 0) < 1, |b| + max(e, 0) < 1 and e > −1.
    #[inline]
    pub fn new(a: T, b: T, e: T) -> Result<Self, DomainError> {
        if !(e > -T::ONE && e < T::ONE) {
            return Err(DomainError::new("e", "-1 < e < 1"));
        }
        let room = T::ONE - e.max(T::ZERO);
        if !(a.abs() < room) {
            return Err(DomainError::new("a", "|a| + max(e, 0) < 1"));
        }
        if !(b.abs() < room) {
            return Err(DomainError::new("b", "|b| + max(e, 0) < 1"));
        }
        Ok(P2 { a, b, e, inverse_norm: T::ONE / (T::ONE - two_thirds::<T>() * a - T::HALF * e) })
    }

    /// a.
    #[inline(always)]
    pub fn a(self) -> T {
        self.a
    }

    /// b.
    #[inline(always)]
    pub fn b(self) -> T {
        self.b
    }

    /// e.
    #[inline(always)]
    pub fn e(self) -> T {
        self.e
    }

    /// Bihemispherical reflectance of the diffuse term for k_L = 1: (1 − 4a/9 − 3e/8)/N.
    #[inline(always)]
    pub fn bihemispherical(self) -> T {
        (T::ONE - T::lit(4.0 / 9.0) * self.a - T::lit(0.375) * self.e) * self.inverse_norm
    }

    /// ∂/∂a and ∂/∂e of [`hemispherical`](Diffuse::hemispherical). (∂/∂b is 0.)
    #[inline(always)]
    pub fn hemispherical_slopes(self, cos_theta_s: T) -> [T; 2] {
        let value = self.hemispherical(cos_theta_s);
        [
            two_thirds::<T>() * (value - cos_theta_s) * self.inverse_norm,
            (T::HALF * value - T::lit(0.25) * (T::ONE + cos_theta_s.squared())) * self.inverse_norm,
        ]
    }
}

impl<T: Real> From<P1<T>> for P2<T> {
    /// The same shape: e = 0.
    fn from(p1: P1<T>) -> Self {
        let (a, b) = (p1.a(), p1.b());
        P2 { a, b, e: T::ZERO, inverse_norm: T::ONE / (T::ONE - two_thirds::<T>() * a) }
    }
}

impl<T: Real> Diffuse<T> for P2<T> {
    #[inline(always)]
    fn shape(self, geometry: &Geometry<T>) -> T {
        let cos_cos = geometry.cos_theta_s() * geometry.cos_theta_v();
        let turn = geometry.cos_2_theta_a();
        let bowl = T::ONE - self.a * cos_cos - self.b * (turn - cos_cos) - self.e * turn.squared();
        bowl * (self.inverse_norm * T::lit(core::f64::consts::FRAC_1_PI))
    }

    #[inline(always)]
    fn shape_with_slopes(self, geometry: &Geometry<T>) -> DiffuseSlopes<T> {
        let (cos_s, cos_v) = (geometry.cos_theta_s(), geometry.cos_theta_v());
        let cos_cos = cos_s * cos_v;
        let turn = geometry.cos_2_theta_a();
        let lean = turn - cos_cos;
        let scale = self.inverse_norm * T::lit(core::f64::consts::FRAC_1_PI);
        let value = (T::ONE - self.a * cos_cos - self.b * lean - self.e * turn.squared()) * scale;
        // θ_a held: a tilt does not change how far the light turned
        let steepness = (self.b - self.a) * scale;
        DiffuseSlopes {
            value,
            d_a: two_thirds::<T>() * value * self.inverse_norm - cos_cos * scale,
            d_b: -(lean * scale),
            d_e: T::HALF * value * self.inverse_norm - turn.squared() * scale,
            d_cos_theta_s: steepness * cos_v,
            d_cos_theta_v: steepness * cos_s,
        }
    }

    /// (1 − (2a/3) cosθ_s − e (1 + cos²θ_s)/4)/N, exactly; b drops out.
    #[inline(always)]
    fn hemispherical(self, cos_theta_s: T) -> T {
        let turned = T::lit(0.25) * self.e * (T::ONE + cos_theta_s.squared());
        (T::ONE - two_thirds::<T>() * self.a * cos_theta_s - turned) * self.inverse_norm
    }
}
