//! A diffuse term with a bowl: the first two reciprocal polynomials in the directions.

use super::{Diffuse, DiffuseSlopes, two_thirds};
use crate::{DomainError, Geometry, Real};

/// BRDF_diff = k_L/π · (1 − a cosθ_s cosθ_v − b sinθ_s sinθ_v cosφ_v)/N with N = 1 − 2a/3.
///
/// The simplest reciprocal term beyond Lambert's: a > 0 darkens the views near the normal (a bowl), b > 0 those on the
/// side of the source. Positive everywhere while max(|a|, |b|) < 1, for cosθ_s cosθ_v + |sinθ_s sinθ_v| ≤ 1. N keeps k_L the
/// DHRF at normal incidence, which the coupling with PROSPECT needs. (0, 0) is Lambert's term.
///
/// ```
/// use leafbrdf_core::{diffuse::P1, Diffuse};
/// // k_L is the DHRF at normal incidence; under grazing light the bowl returns more
/// let bowl = P1::new(0.15_f64, 0.0)?;
/// assert_eq!(bowl.hemispherical(1.0), 1.0);
/// assert!((bowl.hemispherical(0.5) - 0.95 / 0.9).abs() < 1e-15);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct P1<T> {
    a: T,
    b: T,
    /// 1/N
    inverse_norm: T,
}

impl<T: Real> P1<T> {
    /// From a, the depth of the bowl, and b, its lean away from the source, both unitless.
    ///
    /// # Errors
    /// [`DomainError`] unless |a| < 1 and |b| < 1.
    #[inline]
    pub fn new(a: T, b: T) -> Result<Self, DomainError> {
        if !(a.abs() < T::ONE) {
            return Err(DomainError::new("a", "-1 < a < 1"));
        }
        if !(b.abs() < T::ONE) {
            return Err(DomainError::new("b", "-1 < b < 1"));
        }
        Ok(P1 { a, b, inverse_norm: T::ONE / (T::ONE - two_thirds::<T>() * a) })
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

    /// Bihemispherical reflectance of the diffuse term for k_L = 1: (1 − 4a/9)/(1 − 2a/3).
    #[inline(always)]
    pub fn bihemispherical(self) -> T {
        (T::ONE - T::lit(4.0 / 9.0) * self.a) * self.inverse_norm
    }

    /// ∂/∂a of [`hemispherical`](Diffuse::hemispherical): (2/3)(1 − cosθ_s)/N². (∂/∂b is 0.)
    #[inline(always)]
    pub fn hemispherical_slope(self, cos_theta_s: T) -> T {
        two_thirds::<T>() * (T::ONE - cos_theta_s) * self.inverse_norm.squared()
    }
}

impl<T: Real> Diffuse<T> for P1<T> {
    #[inline(always)]
    fn shape(self, geometry: &Geometry<T>) -> T {
        let cos_cos = geometry.cos_theta_s() * geometry.cos_theta_v();
        // sinθ_s sinθ_v cosφ_v, which is cos 2θ_a − cosθ_s cosθ_v
        let lean = geometry.cos_2_theta_a() - cos_cos;
        (T::ONE - self.a * cos_cos - self.b * lean) * (self.inverse_norm * T::lit(core::f64::consts::FRAC_1_PI))
    }

    #[inline(always)]
    fn shape_with_slopes(self, geometry: &Geometry<T>) -> DiffuseSlopes<T> {
        let (cos_s, cos_v) = (geometry.cos_theta_s(), geometry.cos_theta_v());
        let cos_cos = cos_s * cos_v;
        let lean = geometry.cos_2_theta_a() - cos_cos;
        let scale = self.inverse_norm * T::lit(core::f64::consts::FRAC_1_PI);
        let value = (T::ONE - self.a * cos_cos - self.b * lean) * scale;
        // θ_a held: ∂lean/∂cosθ_s is −cosθ_v
        let steepness = (self.b - self.a) * scale;
        DiffuseSlopes {
            value,
            d_a: two_thirds::<T>() * value * self.inverse_norm - cos_cos * scale,
            d_b: -(lean * scale),
            d_e: T::ZERO,
            d_cos_theta_s: steepness * cos_v,
            d_cos_theta_v: steepness * cos_s,
        }
    }

    /// (1 − (2a/3) cosθ_s)/(1 − 2a/3), exactly; b drops out.
    #[inline(always)]
    fn hemispherical(self, cos_theta_s: T) -> T {
        (T::ONE - two_thirds::<T>() * self.a * cos_theta_s) * self.inverse_norm
    }
}
