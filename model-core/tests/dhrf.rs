//! DHRF_spec against values that share nothing with the fixed nodes, and the laws it obeys.

mod common;

use common::Table;
use leafbrdf_core::{Angle, Dielectric, Grade, Illumination, Index, Real};

/// F ≡ ½: half of a perfect mirror's DHRF, far from the bound 1 at which a result is cut.
#[derive(Clone, Copy)]
struct HalfMirror;

impl<T: Real> Index<T> for HalfMirror {
    fn fresnel(self, _: T) -> T {
        T::HALF
    }
    fn fresnel_with_slope(self, _: T) -> (T, T) {
        (T::HALF, T::ZERO)
    }
}

fn illumination(theta_s_deg: f64) -> Illumination<f64> {
    Illumination::new(Angle::from_degrees(theta_s_deg)).unwrap()
}

fn dhrf(n: f64, sigma: f64, theta_s_deg: f64, grade: Grade) -> f64 {
    illumination(theta_s_deg).dhrf(Dielectric::new(n).unwrap(), sigma, grade)
}

/// The named columns of a golden file.
fn columns<const N: usize>(text: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let table = Table::read(text);
    let places = names.map(|name| table.column(name));
    table.rows.iter().map(|row| places.map(|place| row[place])).collect()
}

fn relative(value: f64, reference: f64) -> f64 {
    (value / reference - 1.0).abs()
}

/// The promised relative error of each grade on n ∈ [1.1, 5], σ ∈ [0.01, 1], θ_s ≤ 89°.
fn promise(grade: Grade) -> f64 {
    match grade {
        Grade::E4d => 2e-5,
        Grade::E6 => 1e-6,
        Grade::E8 => 1e-8,
        _ => 2e-10,
    }
}

/// A sequence that fills the unit interval evenly (Weyl): the same points on every machine.
fn fill(i: usize, irrational: f64) -> f64 {
    (i as f64 * irrational).fract()
}

/// θ_s (half of them beyond 60°), σ (half of them logarithmic) and n over the golden file's domain, rounded to `f32`.
fn scattered(i: usize) -> (f32, f32, f32) {
    let t = fill(i, 0.754_877_666_246_693);
    let s = fill(i, 0.569_840_290_998_053);
    let theta = if i.is_multiple_of(2) { 89.0 * t } else { 60.0 + 29.0 * t };
    let sigma = if i.is_multiple_of(3) { 0.01 + 0.99 * s } else { 0.01 * 100.0_f64.powf(s) };
    let n = 1.1 * (5.0 / 1.1_f64).powf(fill(i, 0.618_033_988_749_895));
    (theta as f32, sigma as f32, n as f32)
}

#[test]
fn every_grade_keeps_its_promise_on_the_reference_values() {
    let rows =
        columns(include_str!("golden/dhrf_reference.csv"), ["n", "sigma", "theta_s_deg", "dhrf_4pi", "dhrf_F1_4pi"]);
    assert!(rows.len() > 800);
    for grade in Grade::ALL {
        for &[n, sigma, theta_s, value, mirror] in &rows {
            let error = relative(dhrf(n, sigma, theta_s, grade), value);
            assert!(error < promise(grade), "{grade:?} n={n} sigma={sigma} theta_s={theta_s}: {error:e}");
            let half = illumination(theta_s).dhrf(HalfMirror, sigma, grade);
            let error = relative(2.0 * half, mirror);
            assert!(error < promise(grade), "{grade:?} F=1 sigma={sigma} theta_s={theta_s}: {error:e}");
        }
    }
}

/// Truth is grade E10 in double precision at the same rounded inputs.
fn single_precision_error(theta_s: f32, sigma: f32, n: f32, grade: Grade) -> f64 {
    let value =
        Illumination::new(Angle::from_degrees(theta_s)).unwrap().dhrf(Dielectric::new(n).unwrap(), sigma, grade);
    relative(value.into(), dhrf(n.into(), sigma.into(), theta_s.into(), Grade::E10))
}

#[test]
fn single_precision_keeps_2e_5_on_the_reference_grid() {
    let rows = columns(include_str!("golden/dhrf_reference.csv"), ["n", "sigma", "theta_s_deg"]);
    for [n, sigma, theta_s] in rows {
        let error = single_precision_error(theta_s as f32, sigma as f32, n as f32, Grade::E4d);
        assert!(error < 2e-5, "n={n} sigma={sigma} theta_s={theta_s}: {error:e}");
    }
}

#[test]
fn single_precision_keeps_2e_5_everywhere_with_at_most_180_evaluations() {
    for i in 0..20_000 {
        let (theta_s, sigma, n) = scattered(i);
        let error = single_precision_error(theta_s, sigma, n, Grade::E4d);
        assert!(error < 2e-5, "n={n} sigma={sigma} theta_s={theta_s}: {error:e}");
        let count = Illumination::new(Angle::from_degrees(theta_s)).unwrap().evaluations(sigma, Grade::E4d);
        assert!(count <= 180, "sigma={sigma} theta_s={theta_s}: {count}");
    }
}

#[test]
fn a_mirror_of_facets_never_creates_energy() {
    // 2 × DHRF(F ≡ ½) is not cut at 1, so only the grade's own error may show
    for i in 0..4_000 {
        let (theta_s, sigma, _) = scattered(i);
        for grade in Grade::ALL {
            let mirror = 2.0 * illumination(theta_s.into()).dhrf(HalfMirror, sigma.into(), grade);
            assert!(mirror <= 1.0 + promise(grade), "{grade:?} sigma={sigma} theta_s={theta_s}: {mirror}");
            assert!(mirror > 0.0);
        }
    }
}
