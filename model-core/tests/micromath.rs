//! micromath as a back-end: how rough it is, and which laws hold all the same.
//!
//! Runs with feature `micromath` alone, so the reference here is the printed form in `f64`, not this crate's.
#![cfg(feature = "micromath")]

use leafbrdf_core::real::micromath::F32;
use leafbrdf_core::{Angle, DirectionCosines, Geometry, Normalization, Real, Surface};

/// `count` values from `first` to `last`, both included.
fn even(first: f64, last: f64, count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| first + (last - first) * f64::from(i) / f64::from(count - 1))
}

/// The same in equal ratios.
fn geometric(first: f64, last: f64, count: u32) -> impl Iterator<Item = f64> {
    even(first.ln(), last.ln(), count).map(f64::exp)
}

/// Greatest error of `found` against `exact` at inputs that are exact in both.
fn worst(
    inputs: impl Iterator<Item = f64>,
    relative: bool,
    found: impl Fn(F32) -> F32,
    exact: impl Fn(f64) -> f64,
) -> f64 {
    inputs
        .map(|x| {
            let x = F32::lit(x);
            let exact = exact(x.to_f64());
            let scale = if relative { exact.abs() } else { 1.0 };
            (found(x).to_f64() - exact).abs() / scale
        })
        .fold(0.0, f64::max)
}

/// Rows of the tables of `real::micromath` (what, measured here, stated there): measured again, none may be worse than it
/// says, nor better by more than a tenth.
fn stated(rows: &[(&str, f64, f64)]) {
    for (what, measured, stated) in rows {
        println!("{what}: measured {measured:.3e}, stated {stated:.3e}");
    }
    for (what, measured, stated) in rows {
        assert!(measured <= stated && *measured > 0.9 * stated, "{what}: {measured:.3e}, stated {stated:.3e}");
    }
}

#[test]
fn elementary_functions_are_as_rough_as_the_table_says() {
    let turn = || even(0.0, 360.0, 100_001).map(f64::to_radians);
    let steep = even(0.0, 80.0, 100_001).map(f64::to_radians);
    stated(&[
        ("sqrt", worst(geometric(1e-6, 1e6, 100_001), true, Real::sqrt, f64::sqrt), 0.061),
        ("exp", worst(even(-80.0, 0.0, 100_001), true, Real::exp, f64::exp), 0.0025),
        ("ln", worst(geometric(1e-6, 1e6, 100_001), false, Real::ln, f64::ln), 0.12),
        ("sin", worst(turn(), false, Real::sin, f64::sin), 1.2e-3),
        ("cos", worst(turn(), false, Real::cos, f64::cos), 1.2e-3),
        ("tan", worst(steep, true, Real::tan, f64::tan), 0.021),
        ("asin", worst(even(0.0, 0.99, 100_001), false, Real::asin, f64::asin), 0.018),
    ]);
}

/// BRDF_spec in sr⁻¹, K = 2π² (Eqs 7, 8, 10), printed form except for tan²α.
fn printed(n: f64, sigma: f64, theta_s: f64, theta_v: f64, phi_v: f64) -> (f64, f64) {
    let ((ss, cs), (sv, cv)) = (theta_s.to_radians().sin_cos(), theta_v.to_radians().sin_cos());
    let half = ((180.0 - phi_v).to_radians() / 2.0).sin();
    let tan2 = ((theta_s - theta_v).to_radians() / 2.0).tan().powi(2) + 4.0 * ss * sv * (half / (cs + cv)).powi(2);
    let cos_alpha = (1.0 + tan2).sqrt().recip();
    let c = (cs + cv) / (2.0 * cos_alpha);
    let g = (n * n + c * c - 1.0).sqrt();
    let f = 0.5 * ((g - c) / (g + c)).powi(2) * (1.0 + ((c * (g + c) - 1.0) / (c * (g - c) + 1.0)).powi(2));
    let masking = (2.0 * cos_alpha * cv / c).min(2.0 * cos_alpha * cs / c).min(1.0);
    let k = 2.0 * std::f64::consts::PI.powi(2);
    let exponent = tan2 / (sigma * sigma);
    (f * masking / (k * cs * cv) * (-exponent).exp() / (sigma * sigma * cos_alpha.powi(4)), exponent)
}

fn from_angles(n: f64, sigma: f64, theta_s: f64, theta_v: f64, phi_v: f64) -> f64 {
    let deg = |x| Angle::from_degrees(F32::lit(x));
    let geometry = Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap();
    Surface::new(F32::lit(n), F32::lit(sigma)).unwrap().brdf(&geometry).to_f64()
}

fn from_table(n: f64, sigma: f64, theta_s: f64, theta_v: f64, phi_v: f64) -> f64 {
    let ((ss, cs), (sv, cv)) = (theta_s.to_radians().sin_cos(), theta_v.to_radians().sin_cos());
    let directions = DirectionCosines {
        cos_theta_s: F32::lit(cs),
        sin_theta_s: F32::lit(ss),
        cos_theta_v: F32::lit(cv),
        sin_theta_v: F32::lit(sv),
        cos_phi_v: F32::lit(phi_v.to_radians().cos()),
    };
    let geometry = Geometry::from_cosines(directions).unwrap();
    Surface::new(F32::lit(n), F32::lit(sigma)).unwrap().brdf(&geometry).to_f64()
}

/// Whole degrees, exact in `f32`.
fn directions() -> impl Iterator<Item = (f64, f64, f64)> {
    let zenith = || (0..=75).step_by(5).map(f64::from);
    zenith().flat_map(move |s| zenith().flat_map(move |v| (0..=180).step_by(15).map(move |phi| (s, v, f64::from(phi)))))
}

/// Worst relative error of BRDF_spec over the directions where tan²α/σ² < 14, n from 1.1 to 2.
fn worst_brdf(sigma: f64, found: fn(f64, f64, f64, f64, f64) -> f64) -> f64 {
    let mut worst: f64 = 0.0;
    for (s, v, phi) in directions() {
        for n in [1.125, 1.25, 1.5, 2.0] {
            let (exact, exponent) = printed(n, sigma, s, v, phi);
            if exponent < 14.0 {
                worst = worst.max((found(n, sigma, s, v, phi) / exact - 1.0).abs());
            }
        }
    }
    worst
}

#[test]
fn the_brdf_is_too_rough_for_the_model_and_the_documentation_says_so() {
    stated(&[
        ("sigma 0.5, from cosines", worst_brdf(0.5, from_table), 0.32),
        ("sigma 0.0625, from cosines", worst_brdf(0.0625, from_table), 0.13),
        ("sigma 0.5, from angles", worst_brdf(0.5, from_angles), 0.32),
        ("sigma 0.0625, from angles", worst_brdf(0.0625, from_angles), 0.19),
    ]);
}

#[test]
fn values_are_finite_and_not_negative() {
    for (s, v, phi) in directions() {
        for (n, sigma) in [(1.125, 0.0625), (1.5, 0.25), (2.0, 1.0)] {
            for brdf in [from_table, from_angles] {
                let value = brdf(n, sigma, s, v, phi);
                assert!(value.is_finite() && value >= 0.0, "{value} at {s} {v} {phi}, n {n}, sigma {sigma}");
            }
        }
    }
}

#[test]
fn swapping_source_and_view_changes_no_bit_from_cosines_and_a_little_from_angles() {
    let mut worst: f64 = 0.0;
    for (s, v, phi) in directions() {
        for (n, sigma) in [(1.125, 0.0625), (1.5, 0.25), (2.0, 1.0)] {
            assert_eq!(from_table(n, sigma, s, v, phi), from_table(n, sigma, v, s, phi), "{s} {v} {phi}, {n} {sigma}");
            let (there, back) = (from_angles(n, sigma, s, v, phi), from_angles(n, sigma, v, s, phi));
            if printed(n, sigma, s, v, phi).1 < 14.0 {
                worst = worst.max((there / back - 1.0).abs());
            }
        }
    }
    // micromath's sin(−x) is not −sin(x)
    stated(&[("reciprocity, from angles", worst, 2e-5)]);
}

#[test]
fn the_convention_for_k_is_the_same_factor_as_everywhere() {
    let factor = Normalization::Bousquet2005.factor::<F32>().to_f64();
    assert!((factor - std::f64::consts::FRAC_2_PI).abs() < 1e-7);
}
