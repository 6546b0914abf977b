//! F for a complex index n + iκ: the same form as for a real one, in complex arithmetic.

use super::{Dielectric, Index, Polarized};
use crate::{DomainError, Real};

/// A complex refractive index n + iκ, where absorption at the surface cannot be neglected (§4.1).
///
/// ```
/// use leafbrdf_core::{Absorbing, Index};
/// // aluminium at 550 nm, n = 0.96 + 6.7i in air; here with n = 1: 92 % at normal incidence
/// let f = Absorbing::new(1.0_f64, 6.7)?.fresnel(1.0);
/// assert!((f - 0.918).abs() < 1e-3);
/// # Ok::<(), leafbrdf_core::DomainError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Absorbing<T> {
    n: T,
    kappa: T,
}

impl<T: Real> Absorbing<T> {
    /// The index n + iκ, unitless.
    ///
    /// # Errors
    /// [`DomainError`] unless 1 ≤ n ≤ 2¹⁴ and 0 ≤ κ ≤ 10⁴.
    #[inline]
    pub fn new(n: T, kappa: T) -> Result<Self, DomainError> {
        Dielectric::new(n)?;
        if !kappa.is_within(0.0, 1e4) {
            return Err(DomainError::new("kappa", "0 ≤ kappa ≤ 1e4"));
        }
        Ok(Absorbing { n, kappa })
    }

    /// n.
    #[inline(always)]
    pub fn n(self) -> T {
        self.n
    }

    /// κ.
    #[inline(always)]
    pub fn kappa(self) -> T {
        self.kappa
    }

    /// R_s and R_p at incidence θ_a; `cos_theta_a` in [0, 1].
    #[inline]
    pub fn polarized(self, cos_theta_a: T) -> Polarized<T> {
        let (r_s, r_p, _) = self.amplitudes(cos_theta_a);
        Polarized { r_s: r_s.norm2(), r_p: r_p.norm2() }
    }

    #[inline(always)]
    fn amplitudes(self, c: T) -> (Complex<T>, Complex<T>, Parts<T>) {
        let (n, kappa) = (self.n, self.kappa);
        let m2 = Complex { re: (n - kappa) * (n + kappa), im: T::TWO * n * kappa };
        let e = Complex { re: (n - T::ONE) * (n + T::ONE) - kappa.squared(), im: m2.im };
        let c2 = c.squared();
        let g = Complex { re: e.re + c2, im: e.im }.sqrt();
        let inv_u = g.plus(c).inverse();
        let inv_v = m2.times(c).add(g).inverse();
        let brewster = Complex { re: (m2.re + T::ONE) * c2 - T::ONE, im: m2.im * c2 };
        let r_s = e.mul(inv_u).mul(inv_u);
        let r_p = e.mul(inv_v).mul(brewster.mul(inv_v));
        (r_s, r_p, Parts { m2, g, inv_u, inv_v })
    }
}

struct Parts<T> {
    m2: Complex<T>,
    g: Complex<T>,
    inv_u: Complex<T>,
    inv_v: Complex<T>,
}

impl<T: Real> Index<T> for Absorbing<T> {
    #[inline]
    fn fresnel(self, cos_theta_a: T) -> T {
        self.polarized(cos_theta_a).unpolarized()
    }

    #[inline]
    fn fresnel_with_slope(self, cos_theta_a: T) -> (T, T) {
        let (r_s, r_p, Parts { m2, g, inv_u, inv_v }) = self.amplitudes(cos_theta_a);
        let m = Complex { re: self.n, im: self.kappa };
        let two_c = T::TWO * cos_theta_a;
        // g' = m/g; r_s' = 2c g'/u², r_p' = 2c (2mg − m²g')/v², as for a real index
        let g1 = m.mul(g.inverse());
        let s1 = g1.mul(inv_u).mul(inv_u).times(two_c);
        let w = m.mul(g).times(T::TWO).sub(m2.mul(g1));
        let p1 = w.mul(inv_v).mul(inv_v).times(two_c);
        // d|r|²/dn = 2 Re(r̄ r'), and F has the factor ½
        (T::HALF * (r_s.norm2() + r_p.norm2()), r_s.dot(s1) + r_p.dot(p1))
    }
}

/// As much of a complex number as Fresnel's equations need.
#[derive(Clone, Copy)]
struct Complex<T> {
    re: T,
    im: T,
}

impl<T: Real> Complex<T> {
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Complex { re: self.re + other.re, im: self.im + other.im }
    }
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Complex { re: self.re - other.re, im: self.im - other.im }
    }
    #[inline(always)]
    fn plus(self, real: T) -> Self {
        Complex { re: self.re + real, im: self.im }
    }
    #[inline(always)]
    fn times(self, real: T) -> Self {
        Complex { re: self.re * real, im: self.im * real }
    }
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Complex { re: self.re * other.re - self.im * other.im, im: self.re * other.im + self.im * other.re }
    }
    /// |z|².
    #[inline(always)]
    fn norm2(self) -> T {
        self.re.squared() + self.im.squared()
    }
    /// Re(z̄ w).
    #[inline(always)]
    fn dot(self, other: Self) -> T {
        self.re * other.re + self.im * other.im
    }
    /// 1/z; 0 for z = 0, which is met only without a surface (n = 1, κ = 0) at grazing incidence.
    #[inline(always)]
    fn inverse(self) -> Self {
        let norm2 = self.norm2();
        let inverse = if norm2 > T::ZERO { T::ONE / norm2 } else { T::ZERO };
        Complex { re: self.re * inverse, im: -self.im * inverse }
    }
    /// √z with positive real part, for Im z ≥ 0. The smaller part follows from the larger one: no cancellation.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let modulus = self.norm2().sqrt();
        let large = (T::HALF * (modulus + self.re.abs())).sqrt();
        let small = if large > T::ZERO { T::HALF * self.im / large } else { T::ZERO };
        if self.re >= T::ZERO { Complex { re: large, im: small } } else { Complex { re: small, im: large } }
    }
}
