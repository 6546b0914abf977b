//! F: the share of light that a facet reflects, for a real (Eq. 8) or a complex refractive index.
//!
//! Both indices use one form without cancellation. With m the index, e = m² − 1, c = cos θ_a, g = √(e + c²):
//!
//! ```text
//!        e                 e ((m² + 1) c² − 1)
//! r_s = ────────     r_p = ───────────────────      F = (|r_s|² + |r_p|²) / 2
//!       (g + c)²              (m² c + g)²
//! ```
//!
//! which equals Eq. 8 as printed; there g − c loses all its digits as n → 1.

use crate::{DomainError, Real, domain};

mod absorbing;
#[doc(hidden)]
pub mod squares;
pub use absorbing::Absorbing;

const N_DOMAIN: &str = "1 ≤ n ≤ 2^14";

/// The surface's refractive index, relative to air: what the Fresnel factor needs to know of the material.
pub trait Index<T: Real>: Copy {
    /// F(θ_a) for unpolarised light, unitless, in [0, 1]. `cos_theta_a` in (0, 1].
    fn fresnel(self, cos_theta_a: T) -> T;

    /// F and ∂F/∂n (κ held).
    fn fresnel_with_slope(self, cos_theta_a: T) -> (T, T);
}

/// Reflectance of a facet for the two linear polarisations.
///
/// ```
/// use leafbrdf_core::{Angle, Dielectric};
/// // at Brewster's angle, arctan n, no p-polarised light is reflected
/// let brewster = Angle::from_radians(1.5_f64.atan());
/// let polarized = Dielectric::new(1.5)?.polarized(brewster.cos());
/// assert!(polarized.r_p < 1e-30);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarized<T> {
    /// R_s, electric field perpendicular to the plane of incidence.
    pub r_s: T,
    /// R_p, electric field in the plane of incidence.
    pub r_p: T,
}

impl<T: Real> Polarized<T> {
    /// F = (R_s + R_p)/2, for unpolarised light.
    #[inline(always)]
    pub fn unpolarized(self) -> T {
        T::HALF * (self.r_s + self.r_p)
    }
}

/// A real refractive index: a transparent cuticle (§4.1).
///
/// ```
/// use leafbrdf_core::{Dielectric, Index};
/// // 4 % at normal incidence on n = 1.5
/// let f = Dielectric::new(1.5_f64)?.fresnel(1.0);
/// assert!((f - 0.04).abs() < 1e-16);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric<T> {
    n: T,
}

impl<T: Real> Dielectric<T> {
    /// The index n, unitless.
    ///
    /// # Errors
    /// [`DomainError`] unless 1 ≤ n ≤ 2¹⁴.
    #[inline]
    pub fn new(n: T) -> Result<Self, DomainError> {
        if !n.is_within(domain::N[0], domain::N[1]) {
            return Err(DomainError::new("n", N_DOMAIN));
        }
        Ok(Dielectric { n })
    }

    /// n.
    #[inline(always)]
    pub fn n(self) -> T {
        self.n
    }

    /// R_s and R_p at incidence θ_a; `cos_theta_a` in [0, 1].
    #[inline(always)]
    pub fn polarized(self, cos_theta_a: T) -> Polarized<T> {
        let Amplitudes { r_s, r_p, .. } = self.amplitudes(cos_theta_a);
        Polarized { r_s: r_s.squared(), r_p: r_p.squared() }
    }

    /// F, ∂F/∂n and ∂²F/∂n² at incidence θ_a, for Newton's method in n.
    #[inline(always)]
    pub fn fresnel_to_second_order(self, cos_theta_a: T) -> [T; 3] {
        let c = cos_theta_a;
        let n = self.n;
        let a = self.amplitudes(c);
        let two_c = T::TWO * c;

        // r_s' = 2c g'/u², r_s'' = 2c (g'' − 2 g'²/u)/u² with u = g + c, g' = n/g, g'' = (1 − g'²)/g
        let inv_g = a.inv_g;
        let g1 = n * inv_g;
        let g2 = (T::ONE - g1.squared()) * inv_g;
        let s1 = two_c * g1 * a.inv_u2;
        let s2 = two_c * a.inv_u2 * (g2 - T::TWO * g1.squared() * a.u * a.inv_u2);

        // r_p' = 2c w/v², r_p'' = 2c (w' − 2 w v'/v)/v² with v = n²c + g, w = 2ng − n²g'
        let n2 = n.squared();
        let w = T::TWO * n * a.g - n2 * g1;
        let w1 = T::TWO * a.g - n2 * g2;
        let v1 = two_c * n + g1;
        let p1 = two_c * w * a.inv_v2;
        let p2 = two_c * a.inv_v2 * (w1 - T::TWO * w * v1 * a.v * a.inv_v2);

        [
            T::HALF * (a.r_s.squared() + a.r_p.squared()),
            a.r_s * s1 + a.r_p * p1,
            s1.squared() + a.r_s * s2 + p1.squared() + a.r_p * p2,
        ]
    }

    /// The amplitudes r_s and r_p and their building blocks.
    #[inline(always)]
    fn amplitudes(self, c: T) -> Amplitudes<T> {
        let n2 = self.n.squared();
        let e = (self.n - T::ONE) * (self.n + T::ONE);
        let g2 = e + c.squared();
        let g = g2.sqrt();
        let u = g + c;
        let v = n2 * c + g;
        let (u2, v2) = (u.squared(), v.squared());
        // One division serves r_s, r_p and both derivatives. At n = 1 and grazing incidence all of g, u, v vanish;
        // there is no surface then, and the factor e = 0 says so once the inverses are finite.
        let denominator = u2 * v2 * g;
        let inverse = if denominator > T::ZERO { T::ONE / denominator } else { T::ZERO };
        let inv_u2 = v2 * g * inverse;
        let inv_v2 = u2 * g * inverse;
        let inv_g = u2 * v2 * inverse;
        let r_s = e * inv_u2;
        let r_p = e * ((n2 + T::ONE) * c.squared() - T::ONE) * inv_v2;
        Amplitudes { r_s, r_p, g, u, v, inv_g, inv_u2, inv_v2 }
    }
}

struct Amplitudes<T> {
    r_s: T,
    r_p: T,
    g: T,
    u: T,
    v: T,
    inv_g: T,
    inv_u2: T,
    inv_v2: T,
}

impl<T: Real> Index<T> for Dielectric<T> {
    #[inline(always)]
    fn fresnel(self, cos_theta_a: T) -> T {
        if T::FEWEST_OPERATIONS {
            return squares::fresnel_anywhere(squares::excess(self.n), cos_theta_a.squared());
        }
        self.polarized(cos_theta_a).unpolarized()
    }

    #[inline(always)]
    fn fresnel_with_slope(self, cos_theta_a: T) -> (T, T) {
        if T::FEWEST_OPERATIONS {
            let (f, by_e) = squares::fresnel_with_slope(squares::excess(self.n), cos_theta_a.squared());
            return (f, (self.n + self.n) * by_e);
        }
        let [f, f1, _] = self.fresnel_to_second_order(cos_theta_a);
        (f, f1)
    }
}
