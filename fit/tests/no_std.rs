//! The heart of the solver as a device uses it: slices in, caller-owned memory, one lane, single precision.

mod common;

use common::{Random, hemisphere};
use leafbrdf_core::{DirectionTerms, Leaf, Normalization, Portable, Real, Surface};
use leafbrdf_fit::band::scan::{GridSize, Scan, ScanTable};
use leafbrdf_fit::{Band, BandFit, BandOptions, BandSolver, Directions, Start};

/// Fits one band in any number type, with or without a scan.
fn fit<T: Real, const L: usize>(y: &[f64], scanned: bool, starts: &[Start<T>]) -> BandFit<f64> {
    let geometries = hemisphere(40.0);
    let width = geometries.len().next_multiple_of(L);
    let padding = Directions::<f64>::padding();
    let terms: Vec<DirectionTerms<f64>> = geometries
        .iter()
        .map(|g| DirectionTerms::new(g, Normalization::Bousquet2005))
        .chain(core::iter::repeat(padding))
        .take(width)
        .collect();
    let column = |f: fn(&DirectionTerms<f64>) -> f64| -> Vec<T> { terms.iter().map(|t| T::lit(f(t))).collect() };
    let (cos_theta_a, tan2_alpha, weight) = (column(|t| t.cos_theta_a), column(|t| t.tan2_alpha), column(|t| t.weight));
    let directions = Directions { cos_theta_a: &cos_theta_a, tan2_alpha: &tan2_alpha, weight: &weight };
    let mut brdf: Vec<T> = y.iter().map(|y| T::lit(*y)).collect();
    brdf.resize(width, T::ZERO);
    let mut omega = vec![T::ONE; y.len()];
    omega.resize(width, T::ZERO);

    let options = BandOptions::table_3();
    // a grid that 16 KB of RAM can hold
    let size = GridSize { sigma: 8, n: 4 };
    let mut memory = vec![T::ZERO; size.workspace(width)];
    let mut cost = vec![T::ZERO; size.points()];
    let table = ScanTable::new(size, options.bounds, directions, y.len(), &mut memory).unwrap();
    let scan = if scanned { Scan::new(table, &mut cost) } else { None };
    let mut solver = BandSolver::<T, L>::new(directions, options, scan).unwrap();
    solver.fit(Band { brdf: &brdf, weight: &omega }, starts).unwrap().unwrap().to_f64()
}

fn measured(seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    let surface = Surface::new(random.uniform(1.3, 1.7), random.uniform(0.15, 0.4)).unwrap();
    let leaf = Leaf::new(random.uniform(0.05, 0.4), surface).unwrap();
    hemisphere(40.0).iter().map(|g| leaf.brdf(g) + 0.002 * random.normal()).collect()
}

#[test]
fn single_precision_finds_the_same_parameters_within_a_tenth_of_their_errors() {
    for seed in 0..50 {
        let y = measured(seed);
        let exact = fit::<f64, 8>(&y, true, &[]);
        for single in [fit::<f32, 1>(&y, true, &[]), fit::<Portable<f32>, 4>(&y, true, &[])] {
            for p in 0..3 {
                let error = exact.standard_errors[p].unwrap();
                assert!(
                    (single.parameters[p] - exact.parameters[p]).abs() < 0.1 * error,
                    "{seed}: {single:?} {exact:?}"
                );
                assert!(
                    (single.standard_errors[p].unwrap() / error - 1.0).abs() < 0.02,
                    "{seed}: {single:?} {exact:?}"
                );
            }
        }
    }
}

#[test]
fn the_number_of_lanes_changes_rounding_only() {
    for seed in 0..20 {
        let y = measured(seed);
        let (one, eight) = (fit::<f64, 1>(&y, true, &[]), fit::<f64, 8>(&y, true, &[]));
        for p in 0..3 {
            assert!((one.parameters[p] / eight.parameters[p] - 1.0).abs() < 1e-6);
        }
        assert!((one.chi2 / eight.chi2 - 1.0).abs() < 1e-10);
    }
}

#[test]
fn without_a_scan_the_start_of_table_3_is_enough_for_an_ordinary_leaf() {
    for seed in 0..20 {
        let y = measured(seed);
        let start = Start { n: 1.47, sigma: 0.3 };
        let (scanned, started) = (fit::<f64, 8>(&y, true, &[]), fit::<f64, 8>(&y, false, &[start]));
        assert!((scanned.chi2 / started.chi2 - 1.0).abs() < 1e-9, "{seed}");
        assert_eq!(started.starts, 1);
    }
}

#[test]
fn memory_that_is_too_small_gives_no_scan_instead_of_a_panic() {
    let options = BandOptions::<f64>::table_3();
    let (zeros, ones) = ([0.0; 8], [1.0; 8]);
    let directions = Directions { cos_theta_a: &ones, tan2_alpha: &zeros, weight: &ones };
    let size = GridSize { sigma: 4, n: 4 };
    let mut small = vec![0.0; size.workspace(8) - 1];
    assert!(ScanTable::new(size, options.bounds, directions, 8, &mut small).is_none());
    let mut enough = vec![0.0; size.workspace(8)];
    let table = ScanTable::new(size, options.bounds, directions, 8, &mut enough).unwrap();
    let mut small = vec![0.0; size.points() - 1];
    assert!(Scan::new(table, &mut small).is_none());
    let mut none = vec![0.0; 1000];
    assert!(ScanTable::new(GridSize { sigma: 1, n: 4 }, options.bounds, directions, 8, &mut none).is_none());
}
