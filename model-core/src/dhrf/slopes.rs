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

use crate::real::device::F32;
use crate::real::fixed;
use crate::{Angle, DomainError, Real};

/// Cosine, sine and the kinks in closed form. Every one is free of cancellation up to grazing incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SlopePlane<T> {
    pub(super) cos_theta_s: T,
    pub(super) sin_theta_s: T,
    /// tan θ_s: the slope of w, and the end of the upper plateau.
    pub(super) tan_theta_s: T,
    /// Below the plateau; w ≤ 2; w ≥ 2, empty below 45°; beyond the plateau.
    pub(super) segments: [Segment<T>; 4],
}

/// A stretch of x between two kinks; it starts where the one before ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment<T> {
    pub(super) end: T,
    /// Zeros A and B of y_k², or of y_h² where there is no plateau. They anchor the map x = A + (B − A) sin²θ, in which y_k
    /// and y_h are nearly analytic, so that a Gauss rule converges exponentially.
    pub(super) a: T,
    pub(super) b: T,
}

impl<T: Real> Segment<T> {
    #[inline(always)]
    pub(super) fn span(&self) -> T {
        self.b - self.a
    }

    /// tan(θ/4) of the map, a rational stand-in for the angle; x beyond an anchor is taken as the anchor.
    #[inline(never)]
    pub(super) fn place(&self, x: T) -> T {
        let (low, high) = T::sqrt_of_both((x - self.a).max(T::ZERO), (self.b - x).max(T::ZERO));
        let tan_half = low / (self.span().sqrt() + high);
        tan_half / (T::ONE + (T::ONE + tan_half.squared()).sqrt())
    }
}

impl<T: Real> SlopePlane<T> {
    pub(super) fn new(theta_s: Angle<T>) -> Result<Self, DomainError> {
        let (sin, cos) = theta_s.sin_cos();
        if !(theta_s.radians() >= T::ZERO && theta_s.radians() < T::lit(1.6) && cos > T::ZERO) {
            return Err(DomainError::new("theta_s", "0° ≤ theta_s < 90°"));
        }
        // the complement keeps its digits where θ_s nears 90° (never 90° minus a rounded angle)
        let third_of_complement = theta_s.complement().radians() / T::lit(3.0);
        Ok(Self::from_sines(sin, cos, third_of_complement.tan()))
    }

    /// From sin θ_s, cos θ_s and b₁ = tan((90° − θ_s)/3), each with its own digits near 90°.
    #[inline]
    fn from_sines(sin: T, cos: T, b1: T) -> Self {
        let root3 = T::lit(1.732_050_807_568_877_3);
        let tan = sin / cos;
        // 10¹⁵ at normal incidence: beyond every slope, and its products stay finite in f32
        let cot = (cos / sin).min(T::lit(1e15));
        let (x0, x1) = (-cos / (T::ONE + sin), (T::ONE + sin) / cos);
        // tan(60° − t) by tan t
        let b2 = (root3 - b1) / (T::ONE + root3 * b1);
        SlopePlane {
            cos_theta_s: cos,
            sin_theta_s: sin,
            tan_theta_s: tan,
            segments: [
                Segment { end: -b1, a: x0, b: x1 },
                Segment { end: b2.min(cot), a: -b1, b: b2 },
                Segment { end: b2.max(tan), a: T::ZERO, b: tan },
                Segment { end: x1, a: x0, b: x1 },
            ],
        }
    }

    /// x₀ < 0 and x₁ > 0: beyond them no view is above the horizon.
    #[inline(always)]
    pub(super) fn horizon(&self) -> (T, T) {
        let [Segment { a, b, .. }, ..] = self.segments;
        (a, b)
    }

    /// Slopes smaller than this, b₁ or cot θ_s, meet no kink.
    #[inline(always)]
    pub(super) fn smooth_radius(&self) -> T {
        let [below, low, ..] = &self.segments;
        (-below.end).min(low.end)
    }

    /// w = 1 + x tan θ_s.
    #[inline(always)]
    pub(super) fn w(&self, x: T) -> T {
        T::ONE + x * self.tan_theta_s
    }
}

impl SlopePlane<F32> {
    /// [`new`](Self::new) for a device: by one sine in integers, from degrees.
    #[inline]
    pub(super) fn from_degrees(theta_s: F32) -> Result<Self, DomainError> {
        // to the last number below 90
        if !theta_s.is_within(0.0, 89.999_992) {
            return Err(DomainError::new("theta_s", "0° ≤ theta_s < 90°"));
        }
        // β = (90° − θ_s)/3 ≤ 30° has all the digits that cos θ_s = sin 3β and b₁ = tan β have near 90°
        let sin = F32(fixed::scaled(fixed::direction(((F32(90.0) - theta_s) / F32(3.0)).0, 0.0, 0.0).sin_theta_s, -30));
        let cos = ((F32(1.0) - sin) * (F32(1.0) + sin)).sqrt();
        let rest = (F32(1.0) - F32(2.0) * sin) * (F32(1.0) + F32(2.0) * sin);
        // cos 3β = cos β (1 − 4 sin²β), of which rounding may leave less than 0 at normal incidence
        Ok(Self::from_sines((cos * rest).max(F32(0.0)), sin * (F32(2.0) + rest), sin / cos))
    }
}
