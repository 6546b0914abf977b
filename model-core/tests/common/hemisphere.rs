//! DHRF as both surfaces' tests ask for it: promises, points, and the integral over the views.

use leafbrdf_core::{Angle, Facets, Geometry, Grade, Illumination, Index, Masking, Real, Surface};

/// F ≡ ½: half of a perfect mirror's DHRF, far from the bound 1 at which a result is cut.
#[derive(Clone, Copy)]
pub struct HalfMirror;

impl<T: Real> Index<T> for HalfMirror {
    fn fresnel(self, _: T) -> T {
        T::HALF
    }
    fn fresnel_with_slope(self, _: T) -> (T, T) {
        (T::HALF, T::ZERO)
    }
}

pub fn illumination<T: Real>(theta_s_deg: f64) -> Illumination<T> {
    Illumination::new(Angle::from_degrees(T::lit(theta_s_deg))).unwrap()
}

pub fn relative(value: f64, reference: f64) -> f64 {
    (value / reference - 1.0).abs()
}

/// The promised relative error of each grade for n to 5, σ ≤ 1, θ_s ≤ 89° (`Grade` states the measured one).
pub fn promise(grade: Grade) -> f64 {
    match grade {
        Grade::E4d => 2e-5,
        Grade::E6 => 1e-6,
        Grade::E8 => 1e-8,
        _ => 2e-10,
    }
}

/// A sequence that fills the unit interval evenly (Weyl): the same points on every machine.
pub fn fill(i: usize, irrational: f64) -> f64 {
    (i as f64 * irrational).fract()
}

/// θ_s (half of them beyond 60°), σ from 0.01 to 1 (two thirds of them logarithmic) and n from `least_n` to 5, rounded to `f32`.
pub fn scattered(i: usize, least_n: f64) -> (f32, f32, f32) {
    let t = fill(i, 0.754_877_666_246_693);
    let s = fill(i, 0.569_840_290_998_053);
    let theta = if i.is_multiple_of(2) { 89.0 * t } else { 60.0 + 29.0 * t };
    let sigma = if i.is_multiple_of(3) { 0.01 + 0.99 * s } else { 0.01 * 100.0_f64.powf(s) };
    let n = least_n * (5.0 / least_n).powf(fill(i, 0.618_033_988_749_895));
    (theta as f32, sigma as f32, n as f32)
}

/// ∫ BRDF_spec cosθ_v dω over the views: the midpoint rule on 400 × 400 angles, whose error is of second order in the step.
pub fn integral_over_views<I, D, G>(surface: &Surface<f64, I, D, G>, theta_s_deg: f64) -> f64
where
    I: Index<f64>,
    D: Facets<f64>,
    G: Masking<f64>,
{
    let steps = 400;
    let half_pi = core::f64::consts::FRAC_PI_2;
    let mut sum = 0.0;
    for i in 0..steps {
        let theta_v = half_pi * (i as f64 + 0.5) / steps as f64;
        for j in 0..steps {
            let phi_v = 2.0 * half_pi * (j as f64 + 0.5) / steps as f64;
            let geometry = Geometry::from_angles(
                Angle::from_degrees(theta_s_deg),
                Angle::from_radians(theta_v),
                Angle::from_radians(phi_v),
            );
            sum += surface.brdf(&geometry.unwrap()) * theta_v.cos() * theta_v.sin();
        }
    }
    // both halves of the azimuth
    sum * 2.0 * (half_pi / steps as f64) * (2.0 * half_pi / steps as f64)
}
