//! Accuracy of the building blocks, against 40 to 60 digits (`golden/gen/reference.py`).
//!
//! | function | type | asked | bound here |
//! |---|---|---|---|
//! | E₁(x), 1e-300 … 700 | `f64` | 1e-14 relative | 2e-15 |
//! | | `Portable<f64>` | | 2e-15 |
//! | τ(K) | `f64` | | 1e-15 absolute, 5e-14 relative |
//! | 1 − τ(K), 1e-25 … 700 | `f64` | | 2e-15 relative |
//! | (dτ/dK)/τ | `f64` | 1e-8 relative | 5e-14 |
//! | t_av(α, n), n from 1 + 1e-10 to 3 | `f64` | 1e-12 | 2e-15 |
//! | E₁ (relative, per x), τ, 1 − τ (relative), t_av | `f32` | | 3e-7, 5e-7, 5e-7, 3e-7 |

use leafbrdf_core::{Portable, Real};
use leafbrdf_prospect::expint::{e1, transmission, transmission_log_slope};
use leafbrdf_prospect::interface::t_av;
use leafbrdf_prospect::{Version, table};

const E1: &str = include_str!("golden/e1_reference.csv");
const TAU: &str = include_str!("golden/tau_reference.csv");
const T_AV: &str = include_str!("golden/t_av_reference.csv");

fn rows<const N: usize>(text: &str) -> Vec<[f64; N]> {
    let rows: Vec<[f64; N]> = text
        .lines()
        .filter(|line| line.starts_with(|first: char| first.is_ascii_digit()))
        .map(|line| {
            let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            numbers.try_into().expect("the right number of columns")
        })
        .collect();
    assert!(rows.len() > 60);
    rows
}

fn relative(ours: f64, reference: f64) -> f64 {
    (ours - reference).abs() / reference.abs()
}

fn worst(errors: impl Iterator<Item = f64>) -> f64 {
    let mut worst: f64 = 0.0;
    for error in errors {
        assert!(error.is_finite(), "not a number");
        worst = worst.max(error);
    }
    worst
}

fn e1_error<T: Real>() -> f64 {
    worst(rows::<2>(E1).into_iter().map(|[x, reference]| relative(e1(T::lit(x)).to_f64(), reference)))
}

#[test]
fn e1_is_exact_from_1e_minus_300_to_700() {
    let (own, portable) = (e1_error::<f64>(), e1_error::<Portable<f64>>());
    assert!(own <= 2e-15 && portable <= 2e-15, "E1: {own:e}, portable {portable:e}");
}

/// Where the result is a normal number. The rounded argument alone moves E₁ by x · 6e-8, relative.
#[test]
fn e1_in_single_precision() {
    let errors = rows::<2>(E1)
        .into_iter()
        .filter(|[x, _]| (1e-30..80.0).contains(x))
        .map(|[x, reference]| relative(f64::from(e1(x as f32)), reference) / x.max(2.0));
    let worst = worst(errors);
    assert!(worst <= 3e-7, "{worst:e}");
}

#[test]
fn e1_ends_as_it_should() {
    assert_eq!(e1(0.0_f64), f64::INFINITY);
    assert_eq!(e1(f64::INFINITY), 0.0);
    assert!(e1(-1.0_f64).is_nan() && e1(f64::NAN).is_nan());
}

#[test]
fn transmission_keeps_its_digits_on_both_ends() {
    let (mut tau, mut tau_relative, mut absorbed, mut slope) = (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
    for [k, tau_reference, absorbed_reference, slope_reference] in rows::<4>(TAU) {
        let ours = transmission(k);
        tau = tau.max((ours.tau - tau_reference).abs());
        tau_relative = tau_relative.max(relative(ours.tau, tau_reference));
        absorbed = absorbed.max(relative(ours.absorbed, absorbed_reference));
        slope = slope.max(relative(transmission_log_slope(k, ours.tau), slope_reference));
    }
    assert!(tau <= 1e-15, "tau: {tau:e}");
    assert!(tau_relative <= 5e-14, "tau, relative: {tau_relative:e}");
    assert!(absorbed <= 2e-15, "1 - tau, relative: {absorbed:e}");
    assert!(slope <= 5e-14, "slope: {slope:e}");
}

#[test]
fn transmission_in_single_precision() {
    let (mut tau, mut absorbed) = (0.0_f64, 0.0_f64);
    for [k, tau_reference, absorbed_reference, _] in rows::<4>(TAU) {
        let ours = transmission(k as f32);
        tau = tau.max((f64::from(ours.tau) - tau_reference).abs());
        absorbed = absorbed.max(relative(f64::from(ours.absorbed), absorbed_reference));
    }
    assert!(tau <= 5e-7, "tau: {tau:e}");
    assert!(absorbed <= 5e-7, "1 - tau, relative: {absorbed:e}");
}

#[test]
fn interface_agrees_with_sterns_integral_for_any_cone_and_index() {
    let rows = rows::<3>(T_AV);
    let double = worst(rows.iter().map(|[cone, n, reference]| (t_av(*cone, *n) - reference).abs()));
    // what is reflected, from single precision inputs: n − 1 near 1 has no digits left
    let single = worst(
        rows.iter()
            .filter(|[_, n, _]| *n > 1.04)
            .map(|[cone, n, reference]| (f64::from(t_av(*cone as f32, *n as f32)) - reference).abs()),
    );
    assert!(double <= 2e-15, "{double:e}");
    assert!(single <= 3e-7, "{single:e}");
}

#[test]
fn interface_without_a_step_in_index_lets_everything_through() {
    assert_eq!(t_av(40.0_f64, 1.0), 1.0);
    assert_eq!(t_av(90.0_f64, 1.0), 1.0);
    for (cone, n) in [(40.0, 0.99), (0.0, 1.5), (90.1, 1.5), (f64::NAN, 1.5), (40.0, f64::NAN)] {
        assert!(t_av(cone, n).is_nan(), "cone {cone}, n {n}");
    }
}

/// The tables hold what the function returns, and the file's index. They are computed with `Portable`, whose exp may differ from
/// the standard library's in the last place; the index comes back through a square root.
#[test]
fn tables_hold_the_interface_of_their_own_index() {
    for (version, file) in [
        (Version::P5B, include_str!("../data/prospect_5b.csv")),
        (Version::D, include_str!("../data/prospect_pro.csv")),
        (Version::Pro, include_str!("../data/prospect_pro.csv")),
    ] {
        let view = table::full(version);
        let mut compared = 0;
        for (band, line) in file.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).enumerate() {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().expect("a number")).collect();
            assert_eq!(view.wavelengths().get(band), Some(cells[0]));
            let faces = view.interface(band).expect("a band of the table");
            assert!((faces.t_alpha - t_av(40.0, cells[1])).abs() <= 4.0 * f64::EPSILON);
            assert!((faces.t_90 - t_av(90.0, cells[1])).abs() <= 4.0 * f64::EPSILON);
            let n = view.refractive_index(band).expect("a band of the table");
            assert!((n - cells[1]).abs() < 1e-15 * n * 2.0);
            for (column, k) in view.coefficients().zip(&cells[2..]) {
                assert_eq!(column[band], *k);
            }
            compared += 1;
        }
        assert_eq!(compared, table::BANDS);
    }
}

/// Whatever machine, library and features build them: the sum of all bits of the transmissivities of PROSPECT-D.
#[test]
fn tables_are_the_same_wherever_they_are_built() {
    let view = table::full(Version::D);
    let sum = |column: &[f64]| column.iter().fold(0_u64, |sum, value| sum.rotate_left(7) ^ value.to_bits());
    assert_eq!((sum(view.t_alpha()), sum(view.t_90())), (0xb242e46974310490, 0x9f617f287a595b9d));
}
