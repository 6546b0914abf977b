//! DHRF_spec of the GGX–Smith surface against values that share nothing with its nodes, and the laws it obeys.

mod common;
#[path = "common/hemisphere.rs"]
mod hemisphere;

use common::Table;
use hemisphere::{HalfMirror, illumination, integral_over_views, promise, relative, scattered};
use leafbrdf_core::{Absorbing, Angle, Dielectric, Grade, Illumination, Index, Normalization, Portable, Real, Surface};

fn dhrf(n: f64, sigma: f64, theta_s_deg: f64, grade: Grade) -> f64 {
    illumination(theta_s_deg).dhrf_ggx(Dielectric::new(n).unwrap(), sigma, grade)
}

#[derive(Clone, Copy, Debug)]
struct Row {
    index: Absorbing<f64>,
    sigma: f64,
    theta_s: f64,
    value: f64,
    mirror: f64,
    d_n: f64,
    d_sigma: f64,
}

fn reference() -> Vec<Row> {
    let table = Table::read(include_str!("golden/ggx_dhrf_reference.csv"));
    let names = ["n", "kappa", "sigma", "theta_s_deg", "dhrf_4pi", "dhrf_F1_4pi", "d_n", "d_sigma"];
    let places = names.map(|name| table.column(name));
    assert!(table.rows.len() >= 250);
    let rows = table.rows.iter().map(|row| places.map(|place| row[place]));
    rows.map(|[n, kappa, sigma, theta_s, value, mirror, d_n, d_sigma]| {
        let index = Absorbing::new(n, kappa).unwrap();
        Row { index, sigma, theta_s, value, mirror, d_n, d_sigma }
    })
    .collect()
}

#[test]
fn every_grade_keeps_its_promise_on_the_ggx_reference_values() {
    for grade in Grade::ALL {
        for row in reference() {
            let Row { index, sigma, theta_s, value, mirror, .. } = row;
            let error = relative(illumination(theta_s).dhrf_ggx(index, sigma, grade), value);
            assert!(error < promise(grade), "{grade:?} {row:?}: {error:e}");
            let half = illumination(theta_s).dhrf_ggx(HalfMirror, sigma, grade);
            let error = relative(2.0 * half, mirror);
            assert!(error < promise(grade), "{grade:?} F=1 {row:?}: {error:e}");
        }
    }
}

/// Against seven-point differences of an independent integral; logarithmic derivatives, absolute. Bounds: about twice the
/// largest error that `examples/dhrf_accuracy.rs` prints; by n where n ≥ 1.1, below which the value itself is a few 1e-4.
#[test]
fn both_ggx_derivatives_agree_with_an_independent_integral() {
    for (grade, bound_n, bound_sigma) in
        [(Grade::E4d, 2.5e-4, 2e-4), (Grade::E6, 2e-5, 1.5e-5), (Grade::E8, 2e-7, 1.2e-7), (Grade::E10, 2e-9, 1.4e-9)]
    {
        for row in reference() {
            let Row { index, sigma, theta_s, value, d_n, d_sigma, .. } = row;
            let gradient = illumination(theta_s).dhrf_ggx_with_gradient(index, sigma, grade);
            let error_n = (gradient.d_n - d_n).abs() * index.n() / value;
            let error_sigma = (gradient.d_sigma - d_sigma).abs() * sigma / value;
            assert!(error_n < bound_n || index.n() < 1.1, "{grade:?} {row:?}: {error_n:e}");
            assert!(error_sigma < bound_sigma, "{grade:?} {row:?}: {error_sigma:e}");
        }
    }
}

/// Truth is grade E10 in double precision at the same rounded inputs.
#[test]
fn ggx_in_single_precision_keeps_2e_5_with_at_most_180_evaluations() {
    for i in 0..10_000 {
        let (theta_s, sigma, n) = scattered(i, 1.05);
        let source = Illumination::new(Angle::from_degrees(theta_s)).unwrap();
        let value = source.dhrf_ggx(Dielectric::new(n).unwrap(), sigma, Grade::E4d);
        let error = relative(value.into(), dhrf(n.into(), sigma.into(), theta_s.into(), Grade::E10));
        assert!(error < 2e-5, "n={n} sigma={sigma} theta_s={theta_s}: {error:e}");
        let count = source.evaluations_ggx(sigma, Grade::E4d);
        assert!(count <= 180, "sigma={sigma} theta_s={theta_s}: {count}");
    }
}

#[test]
fn ggx_facets_never_create_energy() {
    // 2 × DHRF(F ≡ ½) is not cut at 1, so only the grade's own error may show
    for i in 0..4_000 {
        let (theta_s, sigma, _) = scattered(i, 1.05);
        for grade in Grade::ALL {
            let mirror = 2.0 * illumination::<f64>(theta_s.into()).dhrf_ggx(HalfMirror, sigma.into(), grade);
            assert!(mirror <= 1.0 + promise(grade), "{grade:?} sigma={sigma} theta_s={theta_s}: {mirror}");
            assert!(mirror > 0.0);
        }
    }
}

/// Light that a facet throws onto another facet is not counted. Figures of `tools/ggx_dhrf_reference.py`, to their digits.
#[test]
fn single_scattering_loses_8_percent_at_sigma_0_25_and_31_percent_at_0_5() {
    let loss = |sigma, theta_s| 1.0 - 2.0 * illumination::<f64>(theta_s).dhrf_ggx(HalfMirror, sigma, Grade::E10);
    for (sigma, theta_s, expected) in
        [(0.25, 0.0, 0.0842), (0.25, 45.0, 0.1138), (0.25, 70.0, 0.1607), (0.5, 0.0, 0.3122), (0.5, 60.0, 0.3017)]
    {
        assert!((loss(sigma, theta_s) - expected).abs() < 5e-5, "{sigma} {theta_s}: {}", loss(sigma, theta_s));
    }
}

/// Eq. 2 as it stands: the BRDF over all views, a midpoint rule that knows nothing of facet slopes.
#[test]
fn ggx_dhrf_is_the_integral_of_its_brdf_over_the_views() {
    for (n, sigma, theta_s) in [(1.5, 0.3, 0.0), (1.45, 0.5, 30.0), (1.56, 0.29, 45.0), (1.68, 0.46, 60.0)] {
        let surface = Surface::ggx(n, sigma).unwrap();
        let integral = integral_over_views(&surface, theta_s);
        let value = surface.dhrf(&illumination(theta_s), Grade::E10);
        // the midpoint rule's error is of second order in the step; it leaves at most 3e-5 here
        assert!(relative(value, integral) < 1e-4, "n={n} sigma={sigma} theta_s={theta_s}: {value} {integral}");
    }
}

#[test]
fn a_ggx_surface_answers_in_its_own_normalisation() {
    let source = illumination(50.0);
    let surface = Surface::ggx(1.5_f64, 0.3).unwrap();
    let value = surface.dhrf(&source, Grade::E8);
    assert_eq!(value, source.dhrf_ggx(surface.index(), 0.3, Grade::E8));
    let gradient = surface.dhrf_with_gradient(&source, Grade::E8);
    assert_eq!(gradient.value, value);
    let printed = surface.with_normalization(Normalization::Bousquet2005).dhrf_with_gradient(&source, Grade::E8);
    for (printed, derived) in
        [(printed.value, gradient.value), (printed.d_n, gradient.d_n), (printed.d_sigma, gradient.d_sigma)]
    {
        assert!(relative(printed, derived * core::f64::consts::FRAC_2_PI) < 1e-15);
    }
}

/// A smooth surface is a mirror, whatever the facets' distribution; the GGX tail adds what is beyond: some σ² ln(1/σ).
#[test]
fn a_smooth_ggx_surface_is_a_mirror() {
    for theta_s in [0.0, 30.0, 60.0, 80.0] {
        let mirror: f64 = Dielectric::new(1.5).unwrap().fresnel(Angle::from_degrees(theta_s).cos());
        let error = relative(dhrf(1.5, 1e-5, theta_s, Grade::E10), mirror);
        assert!(error < 1e-6, "{theta_s}: {error:e}");
    }
}

#[test]
fn outside_the_promised_domain_ggx_stays_between_0_and_1() {
    for &theta_s in &[0.0, 1e-6, 44.999, 45.0, 60.0, 89.0, 89.9, 89.999, 89.99999] {
        for exponent in -18..=6 {
            let sigma = 10.0_f64.powf(f64::from(exponent) / 2.0);
            for grade in Grade::ALL {
                check_range::<f64>(theta_s, sigma, grade);
                check_range::<f32>(theta_s, sigma, grade);
            }
        }
    }
}

fn check_range<T: Real>(theta_s: f64, sigma: f64, grade: Grade) {
    let source = illumination::<T>(theta_s);
    let sigma = T::lit(sigma);
    for n in [1.0, 1.000_001, 1.4, 5.0, 1e4] {
        for kappa in [0.0, 0.5, 1e4] {
            let index = Absorbing::new(T::lit(n), T::lit(kappa)).unwrap();
            let gradient = source.dhrf_ggx_with_gradient(index, sigma, grade);
            let name = format!("{grade:?} {theta_s} {sigma:?} {n} + {kappa} i: {gradient:?}");
            assert!(gradient.value >= T::ZERO && gradient.value <= T::ONE, "{name}");
            assert!(gradient.d_n.is_finite() && gradient.d_sigma.is_finite(), "{name}");
            assert_eq!(gradient.value, source.dhrf_ggx(index, sigma, grade), "{name}");
        }
    }
    // the cut at 1 must not hide a sum that is none
    let mirror = T::TWO * source.dhrf_ggx(HalfMirror, sigma, grade);
    assert!(mirror >= T::ZERO && mirror < T::lit(1.01), "{grade:?} {theta_s} {sigma:?}: {mirror:?}");
}

/// `exp` and `ln` differ by one unit in the last place; a count of nodes may differ only at a step.
#[test]
fn portable_arithmetic_gives_the_same_ggx_dhrf() {
    for i in 0..300 {
        let (theta_s, sigma, n) = scattered(i, 1.05);
        let (theta_s, sigma, n) = (f64::from(theta_s), f64::from(sigma), f64::from(n));
        let index = Dielectric::new(Portable(n)).unwrap();
        let value = illumination::<Portable<f64>>(theta_s).dhrf_ggx(index, Portable(sigma), Grade::E10);
        let error = relative(value.0, dhrf(n, sigma, theta_s, Grade::E10));
        assert!(error < 1e-13, "n={n} sigma={sigma} theta_s={theta_s}: {error:e}");
    }
}
