//! The laws of the surface model, in f32 and f64. Each test is named after the law it defends.

#[path = "common/random.rs"]
mod random;

use leafbrdf_core::{
    Absorbing, Angle, Dielectric, Diffuse, DirectionTerms, Geometry, Index, Lambert, Leaf, Normalization, Portable,
    Real, Surface, facet, masking,
};
use proptest::prelude::*;
use random::{cases, single};

fn geometry<T: Real>(theta_s: f64, theta_v: f64, phi_v: f64) -> Geometry<T> {
    let deg = |x| Angle::from_degrees(T::lit(x));
    Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

fn zenith() -> impl Strategy<Value = f64> {
    prop_oneof![8 => 0.0..89.9_f64, 1 => Just(0.0), 1 => Just(89.9)]
}

/// n, κ, σ over the whole stated domain, logarithmic in σ and in n − 1.
fn surface() -> impl Strategy<Value = (f64, f64, f64)> {
    (
        prop_oneof![4 => 1.0..5.0_f64, 1 => (-7.0..4.0_f64).prop_map(|e| (1.0 + 10.0_f64.powf(e)).min(1e4)), 1 => Just(1.0)],
        prop_oneof![2 => Just(0.0), 2 => 0.0..10.0_f64, 1 => 0.0..1e4_f64],
        (-9.0..3.0_f64).prop_map(|e| 10.0_f64.powf(e)),
    )
}

fn reciprocal<T: Real>((n, kappa, sigma): (f64, f64, f64), s: f64, v: f64, phi: f64) -> Result<(), TestCaseError> {
    let (forth, back) = (geometry::<T>(s, v, phi), geometry::<T>(v, s, phi));
    let real = Surface::new(T::lit(n), T::lit(sigma)).unwrap();
    let complex = Surface::absorbing(T::lit(n), T::lit(kappa), T::lit(sigma)).unwrap();
    prop_assert_eq!(real.brdf(&forth), real.brdf(&back));
    prop_assert_eq!(complex.brdf(&forth), complex.brdf(&back));
    prop_assert_eq!(real.brdf_with_gradient(&forth), real.brdf_with_gradient(&back));
    Ok(())
}

fn sound<T: Real>((n, kappa, sigma): (f64, f64, f64), s: f64, v: f64, phi: f64) -> Result<(), TestCaseError> {
    let g = geometry::<T>(s, v, phi);
    let real = Surface::new(T::lit(n), T::lit(sigma)).unwrap();
    let complex = Surface::absorbing(T::lit(n), T::lit(kappa), T::lit(sigma)).unwrap();
    let gradient = real.brdf_with_gradient(&g);
    for value in [real.brdf(&g), complex.brdf(&g), gradient.value] {
        prop_assert!(value >= T::ZERO && value.is_finite(), "{:?}", value);
    }
    prop_assert!(gradient.d_n.is_finite() && gradient.d_sigma.is_finite(), "{:?}", gradient);
    let masked = masking::v_cavity(&g);
    prop_assert!(masked > T::ZERO && masked <= T::ONE);
    // |r| ≤ 1 holds exactly; squaring and summing rounds a few times
    let ceiling = T::ONE + T::lit(16.0) * T::EPSILON;
    for f in [real.index().fresnel(g.cos_theta_a()), complex.index().fresnel(g.cos_theta_a())] {
        prop_assert!(f >= T::ZERO && f <= ceiling, "{:?}", f);
    }
    Ok(())
}

fn mirrored<T: Real>((n, _, sigma): (f64, f64, f64), s: f64, v: f64, phi: f64) -> Result<(), TestCaseError> {
    let surface = Surface::new(T::lit(n), T::lit(sigma)).unwrap();
    prop_assert_eq!(surface.brdf(&geometry(s, v, phi)), surface.brdf(&geometry(s, v, -phi)));
    Ok(())
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn swapping_source_and_view_changes_no_bit(p in surface(), s in zenith(), v in zenith(), phi in -360.0..360.0_f64) {
        reciprocal::<f64>(p, s, v, phi)?;
        reciprocal::<f32>(p, s, v, phi)?;
        reciprocal::<Portable<f64>>(p, s, v, phi)?;
        reciprocal::<Portable<f32>>(p, s, v, phi)?;
    }

    #[test]
    fn reflectance_is_finite_and_not_negative(p in surface(), s in zenith(), v in zenith(), phi in -360.0..360.0_f64) {
        sound::<f64>(p, s, v, phi)?;
        sound::<f32>(p, s, v, phi)?;
        sound::<Portable<f64>>(p, s, v, phi)?;
        sound::<Portable<f32>>(p, s, v, phi)?;
    }

    #[test]
    fn the_principal_plane_is_a_mirror(p in surface(), s in zenith(), v in zenith(), phi in 0.0..360.0_f64) {
        mirrored::<f64>(p, s, v, phi)?;
        mirrored::<f32>(p, s, v, phi)?;
    }

    // φ and φ − 360° are the same direction; 1e-14 × exponent: the azimuth is reduced with the rounding of π only
    #[test]
    fn a_full_turn_changes_nothing(n in 1.1..5.0_f64, sigma in 0.05..2.0_f64, s in zenith(), v in zenith(), phi in 0.0..360.0_f64) {
        let surface = Surface::new(n, sigma).unwrap();
        let (a, b) = (surface.brdf(&geometry(s, v, phi)), surface.brdf(&geometry(s, v, phi - 360.0)));
        let exponent = geometry::<f64>(s, v, phi).tan2_alpha() / (sigma * sigma);
        prop_assert!((a - b).abs() <= 1e-14 * (10.0 + exponent) * a + 1e-300, "{a} {b}");
    }

    // Complex and real index meet at κ = 0. 64 ε: two different orders of the same operations.
    #[test]
    fn without_absorption_the_complex_index_is_the_real_one(n in 1.0..1e4_f64, cos in 1e-6..1.0_f64) {
        let (real, complex) = (Dielectric::new(n).unwrap(), Absorbing::new(n, 0.0).unwrap());
        prop_assert!((real.fresnel(cos) - complex.fresnel(cos)).abs() <= 64.0 * f64::EPSILON * real.fresnel(cos));
        let (slope, other) = (real.fresnel_with_slope(cos).1, complex.fresnel_with_slope(cos).1);
        // the s and p parts of the slope nearly cancel in places: the bound is on their size, about F/(n − 1)
        prop_assert!((slope - other).abs() <= 1e-12 * slope.abs().max(real.fresnel(cos)), "{slope} {other}");
    }

    // ((n−1)/(n+1))², and its complex form ((n−1)² + κ²)/((n+1)² + κ²)
    #[test]
    fn normal_incidence_is_the_textbook_value(n in 1.0..1e4_f64, kappa in 0.0..1e4_f64) {
        let f = Dielectric::new(n).unwrap().fresnel(1.0);
        prop_assert!((f - ((n - 1.0) / (n + 1.0)).powi(2)).abs() <= 1e-14 * f);
        let f = Absorbing::new(n, kappa).unwrap().fresnel(1.0);
        let textbook = ((n - 1.0).powi(2) + kappa * kappa) / ((n + 1.0).powi(2) + kappa * kappa);
        prop_assert!((f - textbook).abs() <= 1e-13 * textbook, "{f} {textbook}");
    }

    #[test]
    fn at_brewsters_angle_nothing_is_reflected_in_the_plane_of_incidence(n in 1.0..100.0_f64) {
        let cos = 1.0 / (1.0 + n * n).sqrt();
        prop_assert!(Dielectric::new(n).unwrap().polarized(cos).r_p < 1e-28);
    }

    // F → 1: 1 − F is of first order in cosθ_a, with slope 2(n² + 1)/√(n² − 1) at most for the sum of s and p
    #[test]
    fn at_grazing_incidence_all_is_reflected(n in 1.01..5.0_f64, kappa in 0.0..5.0_f64) {
        let f = Dielectric::new(n).unwrap().fresnel(0.0);
        prop_assert!((f - 1.0).abs() <= 8.0 * f64::EPSILON, "{f}");
        let f = Dielectric::new(n).unwrap().fresnel(1e-9);
        prop_assert!(1.0 - f >= -8.0 * f64::EPSILON && 1.0 - f < 1e-9 * 4.0 * (n * n + 1.0) / (n * n - 1.0).sqrt());
        let f = Absorbing::new(n, kappa).unwrap().fresnel(0.0);
        prop_assert!((f - 1.0).abs() < 1e-14, "{f}");
    }

    // D'(t) ∝ 2/(1 + t) − 1/σ² with t = tan²α: falls everywhere exactly while σ² ≤ 1/2 (Eq. 9 and the text under it)
    #[test]
    fn density_falls_with_tilt_exactly_while_sigma_is_at_most_one_over_root_two(sigma in 0.01..2.0_f64, tan2 in 0.0..50.0_f64) {
        let step = 1e-3;
        if sigma <= core::f64::consts::FRAC_1_SQRT_2 {
            // below the normal numbers D is a staircase of rounding
            prop_assume!(facet::beckmann(tan2, sigma) > 1e-290);
            prop_assert!(facet::beckmann(tan2 + step, sigma) <= facet::beckmann(tan2, sigma));
        } else if sigma > 0.708 {
            // just above, the top of the density has moved away from the leaf normal: t* = 2σ² − 1 > 0
            let top = 2.0 * sigma * sigma - 1.0;
            prop_assert!(facet::beckmann(top, sigma) > facet::beckmann(0.0, sigma));
        }
    }

    // Central differences: truncation h²/6 f''' against rounding ε/h, best at h ≈ ε^(1/3); 1e-7 of the scale holds both.
    #[test]
    fn gradient_agrees_with_differences(
        k in 0.0..1.0_f64, n in 1.05..5.0_f64, sigma in 0.05..1.5_f64, s in 0.0..89.0_f64, v in 0.0..89.0_f64, phi in 0.0..360.0_f64,
    ) {
        let g = geometry::<f64>(s, v, phi);
        let at = |n, sigma| Leaf::new(k, Surface::new(n, sigma).unwrap()).unwrap().brdf_with_gradient(&g);
        let gradient = at(n, sigma);
        let leaf = Leaf::new(k, Surface::new(n, sigma).unwrap()).unwrap();
        prop_assert_eq!(gradient.value, leaf.brdf(&g));
        prop_assert_eq!(leaf.brf(&g), core::f64::consts::PI * leaf.brdf(&g));
        prop_assert_eq!(gradient.d_k_lambert, core::f64::consts::FRAC_1_PI);

        let specular = gradient.value - k * core::f64::consts::FRAC_1_PI;
        let h = 1e-5 * (n - 1.0);
        let d_n = (at(n + h, sigma).value - at(n - h, sigma).value) / (2.0 * h);
        prop_assert!((gradient.d_n - d_n).abs() <= 1e-7 * (1.0 + gradient.value / (n - 1.0)), "{} {d_n}", gradient.d_n);
        let h = 1e-5 * sigma;
        let exponent = g.tan2_alpha() / (sigma * sigma);
        let d_sigma = (at(n, sigma + h).value - at(n, sigma - h).value) / (2.0 * h);
        let scale = (1.0 + exponent).powi(3) * specular / sigma + gradient.value / sigma;
        prop_assert!((gradient.d_sigma - d_sigma).abs() <= 1e-8 * scale, "{} {d_sigma}", gradient.d_sigma);
    }

    // The same law for a complex index, in n.
    #[test]
    fn complex_slope_agrees_with_differences(n in 1.05..10.0_f64, kappa in 0.0..10.0_f64, cos in 0.01..1.0_f64) {
        let at = |n| Absorbing::new(n, kappa).unwrap().fresnel(cos);
        let h = 1e-5 * (n - 1.0);
        let difference = (at(n + h) - at(n - h)) / (2.0 * h);
        let slope = Absorbing::new(n, kappa).unwrap().fresnel_with_slope(cos).1;
        prop_assert!((slope - difference).abs() <= 1e-8 * (1.0 / (n - 1.0)), "{slope} {difference}");
    }

    // ∂²F/∂n² against differences of the exact first derivative
    #[test]
    fn curvature_of_fresnel_agrees_with_differences(n in 1.05..5.0_f64, cos in 0.01..1.0_f64) {
        let at = |n| Dielectric::new(n).unwrap().fresnel_with_slope(cos).1;
        let h = 1e-5 * (n - 1.0);
        let difference = (at(n + h) - at(n - h)) / (2.0 * h);
        let curvature = Dielectric::new(n).unwrap().fresnel_to_second_order(cos)[2];
        prop_assert!((curvature - difference).abs() <= 1e-8 / (n - 1.0).powi(2), "{curvature} {difference}");
    }

    // The shared terms give the same BRDF (the factors in another order: 8 ε), and second derivatives that are the
    // differences of the exact first ones. 1e-300: where D is subnormal it has fewer digits.
    #[test]
    fn shared_direction_terms_give_the_same_surface(
        n in 1.05..5.0_f64, sigma in 0.05..1.5_f64, s in 0.0..89.0_f64, v in 0.0..89.0_f64, phi in 0.0..360.0_f64,
    ) {
        let g = geometry::<f64>(s, v, phi);
        let surface = Surface::new(n, sigma).unwrap();
        let terms = DirectionTerms::new(&g, surface.normalization());
        let index = Dielectric::new(n).unwrap();
        let at = |n, sigma| terms.brdf_to_second_order(Dielectric::new(n).unwrap(), sigma);
        let hessian = at(n, sigma);
        let gradient = surface.brdf_with_gradient(&g);
        prop_assert!((terms.brdf(index, sigma) - gradient.value).abs() <= 8.0 * f64::EPSILON * gradient.value + 1e-300);
        prop_assert!((hessian.d_n - gradient.d_n).abs() <= 8.0 * f64::EPSILON * gradient.d_n.abs() + 1e-300);
        prop_assert!((hessian.d_sigma - gradient.d_sigma).abs() <= 8.0 * f64::EPSILON * gradient.d_sigma.abs() + 1e-300);

        let exponent = g.tan2_alpha() / (sigma * sigma);
        // farther out the truncation of the difference, (exponent · step)², outgrows the bound
        prop_assume!(exponent < 30.0);
        let scale = (1.0 + exponent).powi(4) * hessian.value;
        let h = 1e-5 * (n - 1.0);
        let (up, down) = (at(n + h, sigma), at(n - h, sigma));
        prop_assert!((hessian.d_n_n - (up.d_n - down.d_n) / (2.0 * h)).abs() <= 1e-7 * scale / (n - 1.0).powi(2));
        prop_assert!((hessian.d_n_sigma - (up.d_sigma - down.d_sigma) / (2.0 * h)).abs() <= 1e-7 * scale / (sigma * (n - 1.0)));
        let h = 1e-5 * sigma;
        let (up, down) = (at(n, sigma + h), at(n, sigma - h));
        prop_assert!((hessian.d_sigma_sigma - (up.d_sigma - down.d_sigma) / (2.0 * h)).abs() <= 1e-7 * scale / sigma.powi(2));
    }

    // From cosines and from angles: two forms of the same half vector. In f64, 1e-14 of rounding, times the exponent.
    #[test]
    fn cosines_and_angles_give_the_same_geometry(s in 0.0..80.0_f64, v in 0.0..80.0_f64, phi in 0.0..360.0_f64) {
        let g = geometry::<f64>(s, v, phi);
        let (sin_theta_s, cos_theta_s) = Angle::from_degrees(s).sin_cos();
        let (sin_theta_v, cos_theta_v) = Angle::from_degrees(v).sin_cos();
        let cos_phi_v = Angle::from_degrees(phi).cos();
        let c = Geometry::from_cosines(leafbrdf_core::DirectionCosines {
            cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v,
        }).unwrap();
        prop_assert!((g.tan2_alpha() - c.tan2_alpha()).abs() <= 1e-14 * (1.0 + g.tan2_alpha()));
        prop_assert!((g.cos_theta_a() - c.cos_theta_a()).abs() <= 1e-14);
        prop_assert!((g.theta_a() - c.theta_a()).abs() <= 3e-8, "{} {}", g.theta_a(), c.theta_a());
    }

    #[test]
    fn outside_the_domain_is_an_error_that_names_the_parameter(bad in prop_oneof![
        Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), -1e3..-1e-12_f64,
    ]) {
        let deg = Angle::from_degrees;
        prop_assert_eq!(Surface::new(bad, 0.3).unwrap_err().parameter, "n");
        prop_assert_eq!(Surface::new(1.5, bad).unwrap_err().parameter, "sigma");
        prop_assert_eq!(Surface::absorbing(1.5, bad, 0.3).unwrap_err().parameter, "kappa");
        prop_assert_eq!(Leaf::new(bad, Surface::new(1.5, 0.3).unwrap()).unwrap_err().parameter, "k_lambert");
        prop_assert_eq!(Geometry::from_angles(deg(bad), deg(0.0), deg(0.0)).unwrap_err().parameter, "theta_s");
        prop_assert_eq!(Geometry::from_angles(deg(0.0), deg(bad), deg(0.0)).unwrap_err().parameter, "theta_v");
        let phi = if bad.abs() <= 360.0 { 361.0 } else { bad };
        prop_assert_eq!(Geometry::from_angles(deg(0.0), deg(0.0), deg(phi)).unwrap_err().parameter, "phi_v");
    }
}

proptest! {
    #![proptest_config(cases(20_000))]

    // The laws above that are stated in f64, once more in f32; bounds are those of f32 rounding (6e-8) times the number of
    // operations and, in the tail, the exponent.
    #[test]
    fn single_precision_keeps_the_limits_of_fresnel(n in single(1.01..100.0), kappa in single(0.0..100.0)) {
        let real = Dielectric::new(n).unwrap();
        prop_assert!((real.fresnel(0.0) - 1.0).abs() <= 8.0 * f32::EPSILON);
        prop_assert!((Absorbing::new(n, kappa).unwrap().fresnel(0.0) - 1.0).abs() <= 16.0 * f32::EPSILON);
        let normal = ((f64::from(n) - 1.0) / (f64::from(n) + 1.0)).powi(2);
        prop_assert!((f64::from(real.fresnel(1.0)) / normal - 1.0).abs() <= 1e-6);
        // r_p changes sign at Brewster's angle: what is left of it is the rounding of the angle
        let brewster = 1.0 / (1.0 + n * n).sqrt();
        prop_assert!(real.polarized(brewster).r_p <= 1e-11, "{:?}", real.polarized(brewster));
    }

    #[test]
    fn single_precision_density_falls_with_tilt_exactly_while_sigma_is_at_most_one_over_root_two(
        sigma in single(0.01..2.0), tan2 in single(0.0..50.0),
    ) {
        if sigma <= core::f32::consts::FRAC_1_SQRT_2 {
            prop_assume!(facet::beckmann(tan2, sigma) > 1e-30);
            // a step that the fall outweighs the rounding of: D'/D ≥ 2 (1/(2σ²) − 1/(1 + t)) ≥ 2t/(1 + t) at σ = 1/√2
            let step = 0.1 * (1.0 + tan2);
            prop_assert!(facet::beckmann(tan2 + step, sigma) <= facet::beckmann(tan2, sigma));
        } else if sigma > 0.72 {
            let top = 2.0 * sigma * sigma - 1.0;
            prop_assert!(facet::beckmann(top, sigma) > facet::beckmann(0.0, sigma));
        }
    }

    #[test]
    fn single_precision_gradient_is_the_double_precision_one(
        k in single(0.0..1.0), n in single(1.05..5.0), sigma in single(0.05..1.5), s in single(0.0..89.0), v in single(0.0..89.0),
        phi in single(0.0..360.0),
    ) {
        let single = Leaf::new(k, Surface::new(n, sigma).unwrap()).unwrap();
        let double = Leaf::new(f64::from(k), Surface::new(f64::from(n), f64::from(sigma)).unwrap()).unwrap();
        let (s, v, phi) = (f64::from(s), f64::from(v), f64::from(phi));
        let exact = double.brdf_with_gradient(&geometry(s, v, phi));
        let gradient = single.brdf_with_gradient(&geometry(s, v, phi));
        let exponent = geometry::<f64>(s, v, phi).tan2_alpha() / f64::from(sigma).powi(2);
        prop_assume!(exponent < 14.0);
        let specular = exact.value - f64::from(k) / core::f64::consts::PI;
        // 1e-5 of the terms' size: (1 + exponent) F D/σ for σ, F D/(n − 1) for n, where differences cancel
        let close = |single: f32, double: f64, size: f64| (f64::from(single) - double).abs() <= 1e-5 * size + 1e-7;
        prop_assert!(close(gradient.value, exact.value, exact.value));
        prop_assert!(close(gradient.d_n, exact.d_n, specular / f64::from(n - 1.0)), "{} {}", gradient.d_n, exact.d_n);
        let size = specular * (1.0 + exponent) / f64::from(sigma);
        prop_assert!(close(gradient.d_sigma, exact.d_sigma, size), "{} {}", gradient.d_sigma, exact.d_sigma);
    }
}

#[test]
fn single_precision_facet_areas_project_to_the_leaf_area() {
    for sigma in [0.01_f32, 0.078, 0.29, 0.46, 1.0, 2.0] {
        let steps = 1_000_u16;
        let h = 40.0 * sigma * sigma / f32::from(steps);
        // the sum in f64: what is tested is D, not 1,000 additions
        let sum: f64 = (0..=steps)
            .map(|i| {
                let t = h * f32::from(i);
                let simpson = if i == 0 || i == steps {
                    1.0
                } else if i % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                simpson * f64::from(core::f32::consts::PI * facet::beckmann(t, sigma) / (1.0 + t).powi(2))
            })
            .sum();
        // Simpson with h = 0.04 in t/σ²: 6e-7; f32: a few 1e-7
        assert!((sum * f64::from(h) / 3.0 - 1.0).abs() < 2e-6, "{sigma}: {}", sum * f64::from(h) / 3.0);
    }
}

#[test]
fn the_horizon_itself_is_an_error() {
    for horizon in [90.0_f64, 90.0 + 1e-12, 180.0] {
        let deg = Angle::from_degrees;
        assert!(Geometry::from_angles(deg(horizon), deg(0.0), deg(0.0)).is_err());
        let deg = Angle::from_degrees;
        assert!(Geometry::from_angles(deg(0.0_f32), deg(horizon as f32), deg(0.0)).is_err());
    }
}

/// ∫ D cosα dΩ = 2π ∫ D cosα sinα dα = π ∫ D/(1 + t)² dt with t = tan²α; composite Simpson in t/σ², to 40.
#[test]
fn facet_areas_project_to_the_leaf_area() {
    for sigma in [0.01_f64, 0.078, 0.29, 0.46, 1.0, 2.0] {
        let steps = 4_000;
        let h = 40.0 * sigma * sigma / f64::from(steps);
        let integrand = |i: u32| {
            let t = h * f64::from(i);
            core::f64::consts::PI * facet::beckmann(t, sigma) / (1.0 + t).powi(2)
        };
        let sum: f64 = (0..=steps)
            .map(|i| {
                integrand(i)
                    * if i == 0 || i == steps {
                        1.0
                    } else if i % 2 == 1 {
                        4.0
                    } else {
                        2.0
                    }
            })
            .sum();
        // Simpson: h⁴/180 × 40 with h = 0.01 in t/σ²: 2e-9
        assert!((sum * h / 3.0 - 1.0).abs() < 1e-8, "{sigma}: {}", sum * h / 3.0);
    }
}

#[test]
fn a_lambertian_leaf_reflects_k_l_into_the_hemisphere() {
    // ∫ (1/π) cosθ dΩ = 2 ∫ cosθ sinθ dθ, midpoint rule; error h²/12
    let g = geometry::<f64>(30.0, 40.0, 50.0);
    let steps = 100_000;
    let h = core::f64::consts::FRAC_PI_2 / f64::from(steps);
    let sum: f64 = (0..steps)
        .map(|i| {
            let theta = h * (f64::from(i) + 0.5);
            2.0 * core::f64::consts::PI * Lambert.shape(&g) * theta.cos() * theta.sin() * h
        })
        .sum();
    let exact: f64 = Lambert.hemispherical(0.5);
    assert_eq!(exact, 1.0);
    assert!((sum - exact).abs() < 1e-9);
}

#[test]
fn the_two_normalisations_differ_by_two_over_pi() {
    let g = geometry::<f64>(60.0, 60.0, 180.0);
    // Table 4 at θ_s = θ_v = 60°, φ_v = 180°, to the digits that physics.md gives
    for (n, sigma, printed, derived) in [(1.22, 0.078, 1.25, 1.96), (1.56, 0.29, 0.24, 0.37), (1.68, 0.46, 0.11, 0.18)]
    {
        let surface = Surface::new(n, sigma).unwrap();
        assert_eq!(surface.normalization(), Normalization::Bousquet2005);
        let bousquet = surface.brdf(&g);
        let cook_torrance = surface.with_normalization(Normalization::CookTorrance).brdf(&g);
        assert!(
            (bousquet - printed).abs() < 0.005 && (cook_torrance - derived).abs() < 0.006,
            "{bousquet} {cook_torrance}"
        );
        assert!((bousquet / cook_torrance - core::f64::consts::FRAC_2_PI).abs() < 1e-15);
    }
}
