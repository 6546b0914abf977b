//! The plane of facet slopes for one illumination direction, and the lines in it where the integrand has a kink.
//!
//! Facet slopes: x = tan α cos φ, y = tan α sin φ, φ from the plane of incidence, x > 0 where the facet tilts towards the
//! source. With R² = 1 + x² + y² and w = 1 + x tan θ_s:
//!
//! - cos θ_a = (cos θ_s + x sin θ_s)/R;
//! - the facet density times the solid angle of the views is exp(−(x² + y²)/σ²)/(π σ²) dx dy times a factor that, with
//!   the masking G, becomes a plain minimum: W = max(0, min(w, 2, 4w/R² − 2)).
//!
//! So DHRF(θ_s; n, σ) = 1/(π σ²) ∬ F(n, cos θ_a) W exp(−(x² + y²)/σ²) dx dy under K = 4π. The kinks of W depend on
//! neither n nor σ. For a fixed x they are
//!
//! - the horizon of the views, W = 0: y_h² = (x − x₀)(x₁ − x), x₀ = −tan(45° − θ_s/2), x₁ = tan(45° + θ_s/2);
//! - the edge of the plateau W = min(w, 2): y_k² = (1 + x/b₁)(1 − x/b₂)(1 + x tan(θ_s/3))/(w + 2) where w ≤ 2, with
//!   b₁ = tan(30° − θ_s/3), b₂ = tan(30° + θ_s/3); y_k² = x (tan θ_s − x) where w ≥ 2.
//!
//! Both follow from solving for y; the cubic of the second factors by tan 3t = tan t tan(60° − t) tan(60° + t).

use crate::{Angle, DomainError, Real};

/// Cosine, sine and the kinks in closed form. Every one is free of cancellation up to grazing incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SlopePlane<T> {
    pub(super) cos_theta_s: T,
    pub(super) sin_theta_s: T,
    /// tan θ_s: the slope of w, and the end of the upper plateau.
    pub(super) tan_theta_s: T,
    /// cot θ_s, where w = 2; very large at normal incidence.
    pub(super) cot_theta_s: T,
    /// x₀ < 0 and x₁ > 0: beyond them no view is above the horizon.
    pub(super) horizon: (T, T),
    /// −b₁ and b₂: the ends of the plateau W = w.
    pub(super) plateau: (T, T),
    /// tan(θ_s/3).
    pub(super) tan_third: T,
}

impl<T: Real> SlopePlane<T> {
    pub(super) fn new(theta_s: Angle<T>) -> Result<Self, DomainError> {
        let (sin, cos) = theta_s.sin_cos();
        if !(theta_s.radians() >= T::ZERO && theta_s.radians() < T::lit(1.6) && cos > T::ZERO) {
            return Err(DomainError::new("theta_s", "0° ≤ theta_s < 90°"));
        }
        // the complement keeps its digits where θ_s nears 90° (never 90° minus a rounded angle)
        let third_of_complement = theta_s.complement().radians() / T::lit(3.0);
        let third = theta_s.radians() / T::lit(3.0);
        let upper = (T::ONE + sin) / cos;
        Ok(SlopePlane {
            cos_theta_s: cos,
            sin_theta_s: sin,
            tan_theta_s: sin / cos,
            // 10¹⁵ at normal incidence: beyond every slope, and its products stay finite in f32
            cot_theta_s: (cos / sin).min(T::lit(1e15)),
            horizon: (-cos / (T::ONE + sin), upper),
            plateau: (-third_of_complement.tan(), (T::PI / T::lit(6.0) + third).tan()),
            tan_third: third.tan(),
        })
    }

    /// Slopes smaller than this meet no kink.
    #[inline(always)]
    pub(super) fn smooth_radius(&self) -> T {
        (-self.plateau.0).min(self.cot_theta_s)
    }

    /// w = 1 + x tan θ_s.
    #[inline(always)]
    pub(super) fn w(&self, x: T) -> T {
        T::ONE + x * self.tan_theta_s
    }

    /// y_h², from x.
    #[inline(always)]
    pub(super) fn horizon2(&self, x: T) -> T {
        (x - self.horizon.0) * (self.horizon.1 - x)
    }

    /// y_k² / ((x + b₁)(b₂ − x)) on the plateau w ≤ 2.
    #[inline(always)]
    pub(super) fn plateau_shape(&self, x: T) -> T {
        // tan θ_s / tan(θ_s/3) = 1/(b₁ b₂), finite at normal incidence too
        (T::ONE + x * self.tan_third) / (-self.plateau.0 * self.plateau.1 * (self.w(x) + T::TWO))
    }
}
