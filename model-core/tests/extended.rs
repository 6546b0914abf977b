//! Laws of the extended surface: GGX–Smith, the diffuse term P1 and a tilted leaf.

mod common;
#[path = "common/random.rs"]
mod random;

use common::Table;
use leafbrdf_core::{
    Angle, Beckmann, Diffuse, DirectionCosines, DirectionVectors, Facets, Geometry, Ggx, GgxTerms, Index, Lambert,
    Leaf, Masking, Normalization, P1, Portable, Real, Smith, Surface, Tilt, VCavity, facet, masking,
};
use proptest::prelude::*;
use random::{cases, single};

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

/// One row of the golden file.
struct Golden {
    beckmann: bool,
    directions: [f64; 3],
    n: f64,
    sigma: f64,
    diffuse: P1<f64>,
    k_lambert: f64,
    tilt: Tilt<f64>,
    /// value, then ∂n, ∂σ, ∂a, ∂b, ∂t_x, ∂t_y
    expected: [f64; 7],
}

fn golden() -> Vec<Golden> {
    let table = Table::read(include_str!("golden/extended_reference.csv"));
    let at = |row: &Vec<f64>, name: &str| row[table.column(name)];
    assert!(table.rows.len() >= 800);
    table
        .rows
        .iter()
        .map(|row| Golden {
            beckmann: at(row, "facets") == 1.0,
            directions: ["theta_s_deg", "theta_v_deg", "phi_v_deg"].map(|name| at(row, name)),
            n: at(row, "n"),
            sigma: at(row, "sigma"),
            diffuse: P1::new(at(row, "a"), at(row, "b")).unwrap(),
            k_lambert: at(row, "k_l"),
            tilt: tilt(at(row, "in_plane_deg"), at(row, "lateral_deg")),
            expected: ["value", "d_n", "d_sigma", "d_a", "d_b", "d_in_plane", "d_lateral"].map(|name| at(row, name)),
        })
        .collect()
}

impl Golden {
    fn evaluate(&self) -> [f64; 7] {
        if self.beckmann {
            let surface = Surface::new(self.n, self.sigma).unwrap();
            self.with(surface.with_normalization(Normalization::CookTorrance))
        } else {
            self.with(Surface::ggx(self.n, self.sigma).unwrap())
        }
    }

    fn with<I: Index<f64>, D: Facets<f64>, G: Masking<f64>>(&self, surface: Surface<f64, I, D, G>) -> [f64; 7] {
        let tilted = vectors(self.directions).about(&self.tilt).unwrap();
        let leaf = Leaf::with_diffuse(self.k_lambert, surface, self.diffuse).unwrap();
        let at = leaf.brdf_tilted_with_gradient(&tilted);
        assert_eq!(at.d_k_lambert, tilted.diffuse_with_gradient(self.diffuse).value);
        [at.value, at.d_n, at.d_sigma, at.d_a, at.d_b, at.d_in_plane, at.d_lateral]
    }
}

/// 60 digits, vectors and printed equations. Near the mirror direction tan²α is the square of a difference of two directions,
/// each rounded to 1e-16: D changes by 2e-16/σ² · tan α of itself, and its slopes once more by 1/σ.
#[test]
fn the_tilted_leaf_is_that_of_60_digits_and_so_are_its_six_derivatives() {
    let (mut worst, mut worst_slope) = (0.0_f64, 0.0_f64);
    for (i, row) in golden().iter().enumerate() {
        let [value, slopes @ ..] = row.evaluate();
        let [expected, expected_slopes @ ..] = row.expected;
        let error = (value / expected - 1.0).abs();
        worst = worst.max(error);
        assert!(error < 1e-12, "row {i}: {value} {expected}");
        for (k, (slope, expected_slope)) in slopes.into_iter().zip(expected_slopes).enumerate() {
            // the scale on which the value changes: σ for σ and the tilt, 1 for the others
            let scale = if matches!(k, 1 | 4 | 5) { value / row.sigma } else { value };
            let error = (slope - expected_slope).abs() / (expected_slope.abs() + scale);
            worst_slope = worst_slope.max(error);
            assert!(error < 1e-12, "row {i}, derivative {k}: {slope} {expected_slope}");
        }
    }
    println!("worst relative error {worst:.1e}, of the derivatives {worst_slope:.1e}");
}

proptest! {
    #![proptest_config(cases(20_000))]

    #[test]
    fn swapping_source_and_view_changes_no_bit_of_ggx_and_p1(
        d in directions(), n in 1.0..5.0_f64, sigma in 0.01..2.0_f64, a in -0.99..0.99_f64, b in -0.99..0.99_f64,
    ) {
        let leaf = Leaf::with_diffuse(0.4, Surface::ggx(n, sigma).unwrap(), P1::new(a, b).unwrap()).unwrap();
        let [theta_s, theta_v, phi_v] = d;
        prop_assert_eq!(leaf.brdf(&level(d)), leaf.brdf(&level([theta_v, theta_s, phi_v])));
    }

    /// The same leaf, tilted the same way in space, with source and view exchanged: the frame turns by φ_v.
    #[test]
    fn a_tilted_leaf_is_reciprocal_in_its_own_frame(
        d in directions(), t_x in -10.0..10.0_f64, t_y in -10.0..10.0_f64, sigma in 0.05..1.0_f64,
    ) {
        let [theta_s, theta_v, phi_v] = d;
        let (sin, cos) = phi_v.to_radians().sin_cos();
        let (m_x, m_y) = (t_x.to_radians().tan(), t_y.to_radians().tan());
        // azimuths from the view, counted backwards so that the view's is again φ_v
        let turned = Tilt::new(
            Angle::from_radians((m_x * cos + m_y * sin).atan()),
            Angle::from_radians((m_x * sin - m_y * cos).atan()),
        );
        let (there, back) = (vectors(d).about(&tilt(t_x, t_y)), vectors([theta_v, theta_s, phi_v]).about(&turned.unwrap()));
        prop_assume!(there.is_ok() && back.is_ok());
        let leaf = Leaf::with_diffuse(0.4, Surface::ggx(1.5, sigma).unwrap(), P1::new(0.2, -0.1).unwrap()).unwrap();
        let (there, back) = (leaf.brdf(there.unwrap().geometry()), leaf.brdf(back.unwrap().geometry()));
        // two directions of rounding 1e-16 against a lobe of width σ ≥ 0.05, near the tilted horizon relative to its cosine
        prop_assert!(close(there, back, 1e-10, 0.0), "{there} {back}");
    }

    #[test]
    fn ggx_and_p1_are_finite_and_not_negative(
        theta_s in 0.0..89.9_f64, theta_v in 0.0..89.9_f64, phi_v in -360.0..360.0_f64,
        n in 1.0..100.0_f64, log_sigma in -9.0..3.0_f64, a in -1.0..1.0_f64, b in -1.0..1.0_f64,
    ) {
        prop_assume!(a.abs() < 1.0 && b.abs() < 1.0);
        fn check<T: Real>(d: [f64; 3], n: f64, sigma: f64, a: f64, b: f64) -> Result<(), TestCaseError> {
            let [theta_s, theta_v, phi_v] = d.map(|x| Angle::from_degrees(T::lit(x)));
            let geometry = Geometry::from_angles(theta_s, theta_v, phi_v).unwrap();
            let surface = Surface::ggx(T::lit(n), T::lit(sigma)).unwrap();
            let at = surface.brdf_with_gradient(&geometry);
            prop_assert!(at.value >= T::ZERO && at.value.is_finite(), "{at:?}");
            prop_assert!(at.d_n.is_finite() && at.d_sigma.is_finite(), "{at:?}");
            let (g, g_sigma) = Smith.masking_with_slope(&geometry, T::lit(sigma));
            prop_assert!(g >= T::ZERO && g <= T::ONE && g_sigma <= T::ZERO, "{g:?} {g_sigma:?}");
            if let Ok(diffuse) = P1::new(T::lit(a), T::lit(b)) {
                prop_assert!(diffuse.shape(&geometry) >= -T::EPSILON);
            }
            Ok(())
        }
        check::<f64>([theta_s, theta_v, phi_v], n, 10.0_f64.powf(log_sigma), a, b)?;
        check::<f32>([theta_s, theta_v, phi_v], n, 10.0_f64.powf(log_sigma), a, b)?;
    }

    // The bar for Beckmann's surface; the tail is no steeper than a Gaussian below its exponent of 14.
    #[test]
    fn f32_ggx_is_within_1e_5(
        theta_s in single(0.0..89.9), theta_v in single(0.0..89.9), phi_v in single(-180.0..180.0),
        n in single(1.001..5.0), log_sigma in single(-2.0..0.3), near in single(0.0..1.0),
    ) {
        let sigma = 10.0_f32.powf(log_sigma);
        // half of the points near the mirror direction, where the lobe is
        let (theta_v, phi_v) =
            if near < 0.5 { ((theta_s + 40.0 * sigma * (near - 0.25)).clamp(0.0, 89.9), 180.0 + 0.5 * sigma * phi_v) } else { (theta_v, phi_v) };
        fn evaluate<T: Real>([theta_s, theta_v, phi_v, n, sigma]: [f32; 5]) -> f64 {
            let lit = |x: f32| T::lit(f64::from(x));
            let deg = |x: f32| Angle::from_degrees(lit(x));
            let g = Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap();
            Surface::ggx(lit(n), lit(sigma)).unwrap().brdf(&g).to_f64()
        }
        let point = [theta_s, theta_v, phi_v, n, sigma];
        let exact = evaluate::<f64>(point);
        for (name, value) in [("std", evaluate::<f32>(point)), ("portable", evaluate::<Portable<f32>>(point))] {
            prop_assert!((value / exact - 1.0).abs() < 1e-5, "{name} {point:?}: {value} against {exact}");
        }
    }

    // Each direction is rounded to 6e-8: against the lobe's width that is 6e-8/σ, and against a cosine 6e-8/cosθ. The largest
    // error among 20 million points is 5.0e-7 (1/σ + 1/cosθ).
    #[test]
    fn f32_tilt_is_within_1e_6_over_sigma_and_the_smaller_cosine(
        theta_s in single(0.0..80.0), theta_v in single(0.0..80.0), phi_v in single(-180.0..180.0),
        t_x in single(-8.0..8.0), t_y in single(-8.0..8.0), sigma in single(0.03..1.0),
    ) {
        fn evaluate<T: Real>([theta_s, theta_v, phi_v, t_x, t_y, sigma]: [f32; 6]) -> Option<(f64, f64)> {
            let lit = |x: f32| T::lit(f64::from(x));
            let deg = |x: f32| Angle::from_degrees(lit(x));
            let tilt = Tilt::new(deg(t_x), deg(t_y)).unwrap();
            let tilted = Geometry::tilted(deg(theta_s), deg(theta_v), deg(phi_v), &tilt).ok()?;
            let cosine = tilted.geometry().cos_theta_s().min(tilted.geometry().cos_theta_v());
            Some((Surface::ggx(lit(1.5), lit(sigma)).unwrap().brdf_tilted(&tilted).to_f64(), cosine.to_f64()))
        }
        let point = [theta_s, theta_v, phi_v, t_x, t_y, sigma];
        if let (Some((exact, cosine)), Some((value, _))) = (evaluate::<f64>(point), evaluate::<f32>(point)) {
            let bound = 1e-6 * (1.0 / f64::from(sigma) + 1.0 / cosine);
            prop_assert!((value / exact - 1.0).abs() < bound, "{point:?}: {value} against {exact}");
        }
    }

    #[test]
    fn cosines_and_angles_give_the_same_tilted_leaf(d in directions(), t_x in -8.0..8.0_f64, t_y in -8.0..8.0_f64) {
        let [(sin_theta_s, cos_theta_s), (sin_theta_v, cos_theta_v), (sin_phi_v, cos_phi_v)] =
            d.map(|angle| deg(angle).sin_cos());
        let table = DirectionCosines { cos_theta_s, sin_theta_s, cos_theta_v, sin_theta_v, cos_phi_v };
        let from_cosines = DirectionVectors::from_cosines(table, sin_phi_v).unwrap().about(&tilt(t_x, t_y));
        let from_angles = vectors(d).about(&tilt(t_x, t_y));
        prop_assert_eq!(from_cosines.is_ok(), from_angles.is_ok());
        if let (Ok(one), Ok(other)) = (from_cosines, from_angles) {
            let (one, other) = (one.geometry(), other.geometry());
            prop_assert!(close(one.cos_theta_s(), other.cos_theta_s(), 1e-14, 1e-15));
            prop_assert!(close(one.cos_theta_v(), other.cos_theta_v(), 1e-14, 1e-15));
            prop_assert!(close(one.tan2_alpha(), other.tan2_alpha(), 1e-12, 1e-14));
        }
    }
}

/// ∫ D cosα dΩ = π ∫ D/(1 + t)² dt, t = tan²α; with t = σ² u/(1 − u) the integrand is 1 exactly, so a midpoint rule suffices.
#[test]
fn ggx_facet_areas_project_to_the_leaf_area() {
    for sigma in [0.01_f64, 0.1, 0.3, 1.0, 2.0] {
        let steps = 1_000;
        let sum: f64 = (0..steps)
            .map(|i| {
                let u = (f64::from(i) + 0.5) / f64::from(steps);
                let t = sigma * sigma * u / (1.0 - u);
                let dt = sigma * sigma / (1.0 - u).powi(2) / f64::from(steps);
                core::f64::consts::PI * facet::ggx(t, sigma) / (1.0 + t).powi(2) * dt
            })
            .sum();
        assert!((sum - 1.0).abs() < 1e-13, "{sigma}: {sum}");
    }
}

#[test]
fn half_of_the_ggx_facets_area_is_steeper_than_sigma() {
    // P(tan α > t) = σ²/(σ² + t²): what sets the tail apart, by the same midpoint rule from the middle on
    let sigma = 0.2_f64;
    let steps = 1_000;
    let sum: f64 = (0..steps)
        .map(|i| {
            let u = 0.5 + 0.5 * (f64::from(i) + 0.5) / f64::from(steps);
            let t = sigma * sigma * u / (1.0 - u);
            let dt = 0.5 * sigma * sigma / (1.0 - u).powi(2) / f64::from(steps);
            core::f64::consts::PI * facet::ggx(t, sigma) / (1.0 + t).powi(2) * dt
        })
        .sum();
    assert!((sum - 0.5).abs() < 1e-13, "{sum}");
}

/// Smith's condition: the visible facets' projected areas are that of the surface, ∫ G₁ D max(0, cos θ_a) dΩ = cos θ_s. With
/// G₁ = 2 c/(c + r) the closed form must be c; integrated over slopes in polar coordinates.
#[test]
fn what_smiths_masking_leaves_visible_projects_to_the_surface() {
    for (theta, sigma) in [(0.0_f64, 0.3), (40.0, 0.1), (60.0, 0.5), (80.0, 1.0)] {
        let (sin, cos) = theta.to_radians().sin_cos();
        let (rings, spokes) = (4_000, 400);
        let mut visible = 0.0;
        for i in 0..rings {
            // equal areas of the facets; r dr D cos⁴α = du/2π
            let u = (f64::from(i) + 0.5) / f64::from(rings);
            let r = sigma * (u / (1.0 - u)).sqrt();
            for j in 0..spokes {
                let psi = core::f64::consts::PI * (f64::from(j) + 0.5) / f64::from(spokes);
                visible += (cos + r * psi.cos() * sin).max(0.0);
            }
        }
        visible /= f64::from(rings * spokes);
        // G₁ from the two-sided G with the other direction at the zenith, where Λ = 0
        let zenith = Geometry::from_angles(deg(theta), deg(0.0), deg(0.0)).unwrap();
        let g1 = masking::smith(&zenith, sigma);
        // midpoint rule: the tail beyond the last ring leaves r sinθ/√rings
        assert!(
            (g1 * visible / cos - 1.0).abs() < 2e-2 * sigma.max(0.1) * (sin / cos).max(0.01),
            "{theta} {sigma}: {}",
            g1 * visible / cos
        );
    }
}

#[test]
fn the_dhrf_of_p1_is_its_closed_form() {
    let n = 64;
    for (a, b) in [(0.0, 0.0), (0.15, 0.0), (0.15, -0.05), (-0.9, 0.7), (0.99, -0.99)] {
        let diffuse = P1::new(a, b).unwrap();
        for theta_s in [0.0, 21.0, 60.0, 85.0] {
            // midpoint in cos²θ_v (∫ cosθ sinθ dθ = ½ ∫ d cos²θ) and in φ; a polynomial in cosθ_v and sinθ_v
            let mut sum = 0.0;
            let rings = 4_000;
            for i in 0..rings {
                let cos2 = (f64::from(i) + 0.5) / f64::from(rings);
                let theta_v = cos2.sqrt().acos();
                for j in 0..8 {
                    let phi_v = 45.0 * (f64::from(j) + 0.5);
                    let g = Geometry::from_angles(deg(theta_s), Angle::from_radians(theta_v), deg(phi_v)).unwrap();
                    sum += diffuse.shape(&g) * core::f64::consts::PI / f64::from(rings * 8);
                }
            }
            let exact: f64 = diffuse.hemispherical(deg(theta_s).cos());
            // midpoint: the square root at cos²θ = 0 leaves rings^(−3/2)
            assert!((sum - exact).abs() < 1e-5, "{a} {b} {theta_s}: {sum} {exact}");
        }
        // bihemispherical: 2 ∫ DHRF cosθ d cosθ, exact for a midpoint rule but for its h²/12 on a cubic
        let bihemispherical: f64 = (0..n)
            .map(|i| (f64::from(i) + 0.5) / f64::from(n))
            .map(|c| 2.0 * diffuse.hemispherical(c) * c / f64::from(n))
            .sum();
        assert!((bihemispherical - diffuse.bihemispherical()).abs() < 2e-3, "{a}: {bihemispherical}");
        assert_eq!(diffuse.hemispherical(1.0), 1.0);
        let h = 1e-3;
        let slope = |c: f64| slope(h, |da| P1::new((a + da).min(1.0 - 1e-12), b).unwrap().hemispherical(c));
        if a < 0.9 {
            assert!((diffuse.hemispherical_slope(0.3) - slope(0.3)).abs() < 1e-8);
        }
    }
}

#[test]
fn without_a_and_b_p1_is_lambert() {
    let flat = P1::new(0.0, 0.0).unwrap();
    for d in [[0.0, 0.0, 0.0], [40.0, 50.0, 120.0], [85.0, 85.0, 180.0]] {
        assert_eq!(flat.shape(&level(d)), Lambert.shape(&level(d)));
        assert_eq!(flat.hemispherical(0.3_f64), Lambert.hemispherical(0.3_f64));
    }
}

#[test]
fn p1_refuses_what_could_turn_negative() {
    for (a, b, parameter) in
        [(1.0, 0.0, "a"), (-1.0, 0.0, "a"), (0.0, 1.0, "b"), (f64::NAN, 0.0, "a"), (0.0, f64::NAN, "b")]
    {
        assert_eq!(P1::new(a, b).unwrap_err().parameter, parameter);
    }
}

#[test]
fn below_the_tilted_horizon_there_is_an_error_that_names_the_direction() {
    let (theta_s, theta_v, forward) = (deg(80.0), deg(80.0), deg(180.0));
    let towards = Geometry::tilted(theta_s, theta_v, forward, &tilt(15.0, 0.0));
    assert_eq!(towards.unwrap_err().parameter, "theta_v");
    let away = Geometry::tilted(theta_s, theta_v, forward, &tilt(-15.0, 0.0));
    assert_eq!(away.unwrap_err().parameter, "theta_s");
    assert!(Geometry::tilted(theta_s, theta_v, forward, &tilt(5.0, 0.0)).is_ok());
    for bad in [81.0, -90.0, f64::NAN, f64::INFINITY] {
        assert_eq!(Tilt::new(deg(bad), deg(0.0)).unwrap_err().parameter, "in_plane");
        assert_eq!(Tilt::new(deg(0.0), deg(bad)).unwrap_err().parameter, "lateral");
    }
}

#[test]
fn at_zero_tilt_the_slopes_are_the_sines() {
    let tilted = vectors([40.0, 50.0, 70.0]).about(&tilt(0.0, 0.0)).unwrap();
    let (x, y) = (tilted.d_in_plane(), tilted.d_lateral());
    assert!((x.cos_theta_s - deg(40.0).sin()).abs() < 1e-15 && y.cos_theta_s == 0.0);
    assert!((x.cos_theta_v - deg(50.0).sin() * deg(70.0).cos()).abs() < 1e-15);
    assert!((y.cos_theta_v - deg(50.0).sin() * deg(70.0).sin()).abs() < 1e-15);
    assert!((x.factor - deg(40.0).tan()).abs() < 1e-15 && y.factor == 0.0);
}

#[test]
fn in_the_principal_plane_everything_is_even_in_the_lateral_tilt() {
    for phi_v in [0.0, 180.0] {
        let leaf = Leaf::with_diffuse(0.4, Surface::ggx(1.5, 0.2).unwrap(), P1::new(0.15, -0.05).unwrap()).unwrap();
        let at =
            |lateral| leaf.brdf_tilted_with_gradient(&vectors([40.0, 35.0, phi_v]).about(&tilt(3.0, lateral)).unwrap());
        // sin 180° is 1e-16, not 0
        assert!(at(0.0).d_lateral.abs() < 1e-12 * at(0.0).d_in_plane.abs());
        assert!((at(4.0).value / at(-4.0).value - 1.0).abs() < 1e-13);
    }
}

#[test]
fn the_ggx_surface_is_energy_normalised_unless_told_otherwise() {
    let surface = Surface::ggx(1.5_f64, 0.2).unwrap();
    assert_eq!(surface.normalization(), Normalization::CookTorrance);
    let g = level([40.0, 40.0, 180.0]);
    let printed = surface.with_normalization(Normalization::Bousquet2005).brdf(&g);
    assert!((printed / surface.brdf(&g) - core::f64::consts::FRAC_2_PI).abs() < 1e-15);
    assert_eq!(Surface::ggx(0.9_f64, 0.2).unwrap_err().parameter, "n");
    assert_eq!(Surface::ggx(1.5_f64, f64::NAN).unwrap_err().parameter, "sigma");
}

/// Each derivative that a tilt needs, on its own: by tan²α, by σ, and of the masking by either cosine at a fixed θ_a.
#[test]
fn the_parts_slopes_agree_with_differences() {
    fn facets<D: Facets<f64>>(facets: D, t: f64, sigma: f64) {
        let exact = facets.density_with_slopes(t, sigma);
        let by_t = slope(1e-3 * sigma * sigma, |h| facets.density(t + h, sigma));
        let by_sigma = slope(1e-3 * sigma.powi(3) / (sigma * sigma + t), |h| facets.density(t, sigma + h));
        assert!(close(exact.value, facets.density(t, sigma), 4e-16, 0.0));
        // steps of 1e-3 or less of the scale on which D changes: truncation (1e-2)⁴/30 at most
        assert!(close(exact.d_tan2_alpha, by_t, 1e-8, 1e-8 * exact.value), "{} {by_t}", exact.d_tan2_alpha);
        assert!(close(exact.d_sigma, by_sigma, 1e-8, 1e-8 * exact.value), "{} {by_sigma}", exact.d_sigma);
    }
    for t in [0.01, 0.1, 0.5, 2.0] {
        for sigma in [0.2, 0.4, 0.9] {
            facets(Beckmann, t, sigma);
            facets(Ggx, t, sigma);
            let (first, second) = facet::ggx_log_slopes(t, sigma);
            let by_sigma = slope(1e-4, |h| facet::ggx(t, sigma + h).ln());
            let twice = slope(1e-4, |h| facet::ggx_log_slopes(t, sigma + h).0);
            assert!(close(first, by_sigma, 1e-8, 1e-9) && close(second, twice, 1e-8, 1e-9), "{t} {sigma}");
        }
    }
    // masking only through the tilted gradient above, and here at a kink-free place on either side of θ_s = θ_v
    for d in [[70.0, 40.0, 150.0], [40.0, 75.0, 120.0]] {
        let tilted = vectors(d).about(&tilt(1.0, 2.0)).unwrap();
        let exact = VCavity.masking_with_slopes(tilted.geometry(), 0.3);
        let (x, along) = (tilted.d_in_plane(), |h: f64| {
            vectors(d).about(&Tilt::new(Angle::from_radians(1.0_f64.to_radians() + h), deg(2.0)).unwrap()).unwrap()
        });
        let by_tilt = slope(1e-4, |h| masking::v_cavity(along(h).geometry()));
        let chained = exact.d_cos_theta_s * x.cos_theta_s + exact.d_cos_theta_v * x.cos_theta_v;
        assert!(close(chained, by_tilt, 1e-8, 1e-9), "{chained} {by_tilt}");
    }
}
