//! Laws of the diffuse term P2.

use leafbrdf_core::{Angle, Diffuse, DirectionVectors, Geometry, Leaf, P1, P2, Surface, Tilt};
use proptest::prelude::*;

fn geometry([theta_s, theta_v, phi_v]: [f64; 3]) -> Geometry<f64> {
    let deg = Angle::from_degrees;
    Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

/// Midpoint rule in sin²θ_v (equal areas of the disc) and φ_v. The shape is a polynomial in cosθ_v and sinθ_v cosφ_v, so
/// the azimuth is exact and the rest falls with the square of the number of rings.
fn hemisphere(diffuse: P2<f64>, theta_s: f64, rings: usize) -> f64 {
    const AZIMUTHS: usize = 8;
    let mut sum = 0.0;
    for ring in 0..rings {
        let theta_v = ((ring as f64 + 0.5) / rings as f64).sqrt().asin().to_degrees();
        for azimuth in 0..AZIMUTHS {
            sum += diffuse.shape(&geometry([theta_s, theta_v, 360.0 * azimuth as f64 / AZIMUTHS as f64]));
        }
    }
    sum * core::f64::consts::PI / (rings * AZIMUTHS) as f64
}

/// a, b, e inside the domain.
fn terms() -> impl Strategy<Value = [f64; 3]> {
    (-0.9..0.9_f64, -0.99..0.99_f64, -0.99..0.99_f64).prop_map(|(e, a, b)| {
        let room = 1.0 - e.max(0.0);
        [a * room, b * room, e]
    })
}

fn directions() -> impl Strategy<Value = [f64; 3]> {
    [0.0..89.9_f64, 0.0..89.9_f64, -180.0..180.0_f64]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 5_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_diffuse_term_p2_is_positive_and_reciprocal(d in directions(), [a, b, e] in terms()) {
        let diffuse = P2::new(a, b, e).unwrap();
        let shape = diffuse.shape(&geometry(d));
        prop_assert!(shape > 0.0, "{shape}");
        let swapped = diffuse.shape(&geometry([d[1], d[0], d[2]]));
        prop_assert!((shape - swapped).abs() <= 1e-15 * shape.max(1.0));
    }

    #[test]
    fn p2_without_its_second_order_is_p1(d in directions(), a in -0.9..0.9_f64, b in -0.9..0.9_f64) {
        let (one, two) = (P1::new(a, b).unwrap(), P2::new(a, b, 0.0).unwrap());
        prop_assert_eq!(P2::from(one), two);
        prop_assert_eq!(one.shape(&geometry(d)), two.shape(&geometry(d)));
        prop_assert_eq!(one.bihemispherical(), two.bihemispherical());
    }

    #[test]
    fn the_gradient_of_a_leaf_with_p2_agrees_with_differences(
        [theta_s, theta_v, phi_v] in [0.0..75.0_f64, 0.0..75.0_f64, -180.0..180.0_f64],
        [a, b, e] in [-0.4..0.4_f64, -0.4..0.4_f64, -0.4..0.4_f64], k in 0.05..1.0_f64,
        t_x in -0.1..0.1_f64, t_y in -0.1..0.1_f64,
    ) {
        let deg = Angle::from_degrees;
        let vectors = DirectionVectors::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap();
        let seen = |[_, _, _, t_x, t_y]: [f64; 5]| {
            vectors.about(&Tilt::new(Angle::from_radians(t_x), Angle::from_radians(t_y)).unwrap()).unwrap()
        };
        let at = [a, b, e, t_x, t_y];
        let shape = |p: [f64; 5]| {
            let seen = seen(p);
            seen.factor() * P2::new(p[0], p[1], p[2]).unwrap().shape(seen.geometry())
        };
        let leaf = Leaf::with_diffuse(k, Surface::new(1.0, 0.3).unwrap(), P2::new(a, b, e).unwrap()).unwrap();
        let g = leaf.brdf_tilted_with_gradient(&seen(at));
        let exact = [g.d_a, g.d_b, g.d_e, g.d_in_plane, g.d_lateral];
        for (i, exact) in exact.into_iter().enumerate() {
            let h = 1e-3;
            let moved = |step: f64| { let mut p = at; p[i] += step; k * shape(p) };
            let slope = (8.0 * (moved(h) - moved(-h)) - (moved(2.0 * h) - moved(-2.0 * h))) / (12.0 * h);
            // truncation h⁴ times a fifth derivative of order 30, rounding 1e-16/h
            prop_assert!((exact - slope).abs() < 1e-9, "{i}: {exact} {slope}");
        }
    }
}

#[test]
fn the_hemisphere_of_p2_is_its_closed_form() {
    for [a, b, e] in [[0.15, -0.05, 0.1], [0.3, 0.2, -0.4], [0.0, 0.0, 0.8], [-0.5, 0.4, 0.3]] {
        let diffuse = P2::new(a, b, e).unwrap();
        let mut bihemispherical = 0.0;
        for step in 0..200 {
            let theta_s = ((step as f64 + 0.5) / 200.0).sqrt().asin();
            bihemispherical += diffuse.hemispherical(theta_s.cos()) / 200.0;
            if step % 20 == 0 {
                let sum = hemisphere(diffuse, theta_s.to_degrees(), 2000);
                // √(1 − x) at the rim: the midpoint rule converges as rings^−3/2
                assert!((sum - diffuse.hemispherical(theta_s.cos())).abs() < 1e-5, "{a} {b} {e} {theta_s}: {sum}");
            }
            let h = 1e-4;
            let moved = |da: f64, de: f64| P2::new(a + da, b, e + de).unwrap().hemispherical(theta_s.cos());
            let [by_a, by_e] = diffuse.hemispherical_slopes(theta_s.cos());
            assert!((by_a - (moved(h, 0.0) - moved(-h, 0.0)) / (2.0 * h)).abs() < 1e-6);
            assert!((by_e - (moved(0.0, h) - moved(0.0, -h)) / (2.0 * h)).abs() < 1e-6);
        }
        assert!((bihemispherical - diffuse.bihemispherical()).abs() < 1e-4);
        assert!((diffuse.hemispherical(1.0) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn p2_refuses_what_could_turn_dark() {
    for [a, b, e] in
        [[0.5, 0.0, 0.5], [0.0, -0.95, 0.1], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, f64::NAN], [1.0, 0.0, 0.0]]
    {
        assert!(P2::new(a, b, e).is_err(), "{a} {b} {e}");
    }
}
