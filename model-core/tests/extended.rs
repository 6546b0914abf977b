//! Laws of the extended surface: GGX–Smith, the diffuse term P1 and a tilted leaf.

use leafbrdf_core::{Angle, DirectionVectors, Geometry, GgxTerms, Index, Leaf, Normalization, P1, Surface, Tilt};
use proptest::prelude::*;

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, max_global_rejects: 20 * cases, failure_persistence: None, ..ProptestConfig::default() }
}

fn deg(x: f64) -> Angle<f64> {
    Angle::from_degrees(x)
}

fn tilt(in_plane: f64, lateral: f64) -> Tilt<f64> {
    Tilt::new(deg(in_plane), deg(lateral)).unwrap()
}

/// θ_s, θ_v, φ_v in degrees.
fn directions() -> impl Strategy<Value = [f64; 3]> {
    [0.0..85.0_f64, 0.0..85.0_f64, -180.0..180.0_f64]
}

fn vectors([theta_s, theta_v, phi_v]: [f64; 3]) -> DirectionVectors<f64> {
    DirectionVectors::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

fn level([theta_s, theta_v, phi_v]: [f64; 3]) -> Geometry<f64> {
    Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

/// Central difference of fourth order; h is chosen by the caller.
fn slope(h: f64, f: impl Fn(f64) -> f64) -> f64 {
    (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h)
}

fn close(value: f64, expected: f64, relative: f64, absolute: f64) -> bool {
    (value - expected).abs() <= relative * expected.abs() + absolute
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn ggx_is_the_formula_of_the_specification(d in directions(), n in 1.05..5.0_f64, sigma in 0.05..1.0_f64) {
        let g = level(d);
        let (c_s, c_v) = (g.cos_theta_s(), g.cos_theta_v());
        let cos2_alpha = 1.0 / (1.0 + g.tan2_alpha());
        let q = 1.0 - (1.0 - sigma * sigma) * cos2_alpha;
        let density = sigma * sigma / (core::f64::consts::PI * q * q);
        let r = |c: f64| (c * c + sigma * sigma * (1.0 - c * c)).sqrt();
        let surface = Surface::ggx(n, sigma).unwrap();
        let expected = surface.index().fresnel(g.cos_theta_a()) * density / (2.0 * (c_v * r(c_s) + c_s * r(c_v)));
        // q cancels to σ² = 0.0025: 2⁻⁵³/σ², squared
        prop_assert!(close(surface.brdf(&g), expected, 5e-13, 0.0), "{} {expected}", surface.brdf(&g));
        let terms = GgxTerms::new(&g, Normalization::CookTorrance);
        prop_assert!(close(terms.brdf(surface.index(), sigma), surface.brdf(&g), 2e-15, 0.0));
        let (one, other) = (terms.brdf_with_gradient(surface.index(), sigma), surface.brdf_with_gradient(&g));
        prop_assert!(close(one.value, other.value, 2e-15, 0.0));
        prop_assert!(close(one.d_n, other.d_n, 2e-15, 0.0));
        prop_assert!(close(one.d_sigma, other.d_sigma, 1e-14, 1e-13 * other.value / sigma));
    }

    #[test]
    fn a_level_tilt_changes_nothing(d in directions(), n in 1.05..5.0_f64, sigma in 0.05..1.0_f64) {
        let level = level(d);
        let tilted = vectors(d).about(&tilt(0.0, 0.0)).unwrap();
        prop_assert_eq!(tilted.factor(), 1.0);
        prop_assert_eq!(tilted.geometry().cos_theta_s(), level.cos_theta_s());
        prop_assert_eq!(tilted.geometry().cos_theta_v(), level.cos_theta_v());
        prop_assert_eq!(tilted.geometry().cos_theta_a(), level.cos_theta_a());
        let surface = Surface::ggx(n, sigma).unwrap();
        // tan²α from another grouping of the same terms; its rounding is some 4 ulp of tan²α + ε
        prop_assert!(close(surface.brdf_tilted(&tilted), surface.brdf(&level), 1e-13, 0.0));
    }
}

/// The angles of two directions about a tilted normal, by rotating every vector: no formula of the library.
fn rotated([theta_s, theta_v, phi_v]: [f64; 3], t_x: f64, t_y: f64) -> [f64; 3] {
    let direction = |theta: f64, phi: f64| {
        let (theta, phi) = (theta.to_radians(), phi.to_radians());
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let cross =
        |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let unit = |a: [f64; 3]| a.map(|x| x / dot(a, a).sqrt());
    let normal = unit([t_x.to_radians().tan(), t_y.to_radians().tan(), 1.0]);
    let zenith = |u: [f64; 3]| {
        let c = cross(u, normal);
        dot(c, c).sqrt().atan2(dot(u, normal))
    };
    let (s, v) = (direction(theta_s, 0.0), direction(theta_v, phi_v));
    let flat = |u: [f64; 3]| {
        let along = dot(u, normal);
        [u[0] - along * normal[0], u[1] - along * normal[1], u[2] - along * normal[2]]
    };
    let (s_flat, v_flat) = (flat(s), flat(v));
    let phi = dot(cross(s_flat, v_flat), normal).atan2(dot(s_flat, v_flat));
    [zenith(s).to_degrees(), zenith(v).to_degrees(), phi.to_degrees()]
}

/// f(0), and its derivatives by n, σ, a, b, t_x, t_y from differences.
fn tilted_leaf_differences(value: impl Fn([f64; 6]) -> f64, at: [f64; 6], step: [f64; 6]) -> [f64; 6] {
    std::array::from_fn(|i| {
        slope(step[i], |h| {
            let mut p = at;
            p[i] += h;
            value(p)
        })
    })
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn tilting_is_rotating_both_directions(
        d in directions(), t_x in -20.0..20.0_f64, t_y in -20.0..20.0_f64, n in 1.05..5.0_f64, sigma in 0.05..1.0_f64,
    ) {
        let [theta_s, theta_v, phi_v] = rotated(d, t_x, t_y);
        prop_assume!(theta_s < 89.0 && theta_v < 89.0);
        let turned = level([theta_s, theta_v, phi_v]);
        let tilted = vectors(d).about(&tilt(t_x, t_y)).unwrap();
        prop_assert!(close(tilted.geometry().cos_theta_s(), turned.cos_theta_s(), 1e-13, 1e-15));
        prop_assert!(close(tilted.geometry().cos_theta_v(), turned.cos_theta_v(), 1e-13, 1e-15));
        prop_assert!(close(tilted.geometry().cos_theta_a(), turned.cos_theta_a(), 1e-12, 1e-14));
        // angles near 0° through atan2 and degrees: 1e-15 in tan α, and up to 1e-12 of itself at 89°
        prop_assert!(close(tilted.geometry().tan2_alpha(), turned.tan2_alpha(), 1e-11, 1e-14));
        let surface = Surface::ggx(n, sigma).unwrap();
        prop_assert!(close(surface.brdf_tilted(&tilted), tilted.factor() * surface.brdf(&turned), 1e-9, 0.0));
    }

    #[test]
    fn the_gradient_of_a_tilted_leaf_agrees_with_differences(
        d in directions(), t_x in -10.0..10.0_f64, t_y in -10.0..10.0_f64, n in 1.1..3.0_f64, sigma in 0.1..0.8_f64,
        a in -0.8..0.8_f64, b in -0.8..0.8_f64, k in 0.0..1.0_f64,
    ) {
        let at = [n, sigma, a, b, t_x.to_radians(), t_y.to_radians()];
        let step = [1e-3, 1e-3 * sigma, 1e-3, 1e-3, 2e-4 * sigma, 2e-4 * sigma];
        let vectors = vectors(d);
        let about = |p: [f64; 6]| {
            let tilt = Tilt::new(Angle::from_radians(p[4]), Angle::from_radians(p[5])).unwrap();
            vectors.about(&tilt).ok()
        };
        let tilted = about(at);
        // differences near the tilted horizon leave the domain
        prop_assume!(tilted.is_some_and(|t| t.geometry().cos_theta_v() > 0.05 && t.geometry().cos_theta_s() > 0.05));
        let tilted = tilted.unwrap();
        let leaf = |p: [f64; 6]| {
            Leaf::with_diffuse(k, Surface::ggx(p[0], p[1]).unwrap(), P1::new(p[2], p[3]).unwrap()).unwrap()
        };
        let gradient = leaf(at).brdf_tilted_with_gradient(&tilted);
        let value = |p: [f64; 6]| leaf(p).brdf_tilted(&about(p).unwrap());
        prop_assert!(close(gradient.value, value(at), 1e-14, 0.0));
        let expected = tilted_leaf_differences(value, at, step);
        let exact =
            [gradient.d_n, gradient.d_sigma, gradient.d_a, gradient.d_b, gradient.d_in_plane, gradient.d_lateral];
        for (i, (exact, expected)) in exact.into_iter().zip(expected).enumerate() {
            // truncation h⁴ f⁗⁺¹/30 with h = 2e-4 … 1e-3 of the scale on which f changes, and rounding 1e-16/h
            prop_assert!(close(exact, expected, 1e-7, 1e-7 * gradient.value), "{i}: {exact} {expected}");
        }
    }
}
