//! The inversion of a microcontroller against that of a server: the same optimum, the same standard errors, bounded work.

mod common;

use common::{Random, brdf, geometry, hemisphere};
use leafbrdf_core::real::device::F32;
use leafbrdf_core::{DirectionTerms, Geometry, Normalization, Real};
use leafbrdf_fit::device::{Workspace, fit_band};
use leafbrdf_fit::{
    AtBound, Band, BandFit, BandOptions, Directions, FitError, Identifiability, LeafBandsOptions, LeafData, fit_bands,
};

const NORMALIZATION: Normalization = Normalization::Bousquet2005;

/// 260 directions under a lamp at 40°: 13 zenith angles times 20 azimuths.
fn goniometer() -> Vec<Geometry<f64>> {
    (0..260).map(|i| geometry(40.0, 2.5 + 5.5 * f64::from(i % 13), 18.0 * f64::from(i / 13))).collect()
}

fn on_device(geometries: &[Geometry<f64>], y: &[f64], weight: &[f64], options: &BandOptions<F32>) -> BandFit<f64> {
    let terms: Vec<_> = geometries.iter().map(|g| DirectionTerms::new(g, NORMALIZATION)).collect();
    let column = |f: fn(&DirectionTerms<f64>) -> f64| -> Vec<F32> { terms.iter().map(|t| F32::lit(f(t))).collect() };
    let (cos_theta_a, tan2_alpha, lobe) = (column(|t| t.cos_theta_a), column(|t| t.tan2_alpha), column(|t| t.weight));
    let directions = Directions { cos_theta_a: &cos_theta_a, tan2_alpha: &tan2_alpha, weight: &lobe };
    let numbers = |values: &[f64]| -> Vec<F32> { values.iter().map(|x| F32::lit(*x)).collect() };
    let (y, weight) = (numbers(y), numbers(weight));
    let mut workspace = Workspace::new();
    fit_band(directions, Band { brdf: &y, weight: &weight }, options, &mut workspace).unwrap().unwrap().to_f64()
}

fn on_server(geometries: &[Geometry<f64>], y: &[f64]) -> BandFit<f64> {
    let options = LeafBandsOptions { normalization: NORMALIZATION, ..LeafBandsOptions::default() };
    fit_bands(&LeafData { geometries, brdf: y, sd: None }, &options, &|_| ()).unwrap()[0].unwrap()
}

/// χ² with k_L as given, in double precision.
fn chi2(geometries: &[Geometry<f64>], y: &[f64], fit: &BandFit<f64>) -> f64 {
    common::chi2(geometries, y, fit.parameters, NORMALIZATION)
}

/// A leaf and its measurement: noise of 2 % and 0.002 sr⁻¹, as of a good instrument.
fn measured(random: &mut Random, geometries: &[Geometry<f64>]) -> Vec<f64> {
    let truth = [random.uniform(0.02, 0.6), random.uniform(1.15, 2.2), random.uniform(0.06, 0.7)];
    brdf(geometries, truth, NORMALIZATION).iter().map(|y| y + (0.02 * y + 0.002) * random.normal()).collect()
}

/// What the model cannot fit: a second lobe, a bowl, noise; χ² has structure of its own then.
fn awkward(random: &mut Random, geometries: &[Geometry<f64>]) -> Vec<f64> {
    let main = measured(random, geometries);
    let wide = brdf(geometries, [0.0, random.uniform(1.1, 1.8), random.uniform(0.3, 0.95)], NORMALIZATION);
    let bowl = random.uniform(-0.02, 0.02);
    main.iter().zip(wide).zip(geometries).map(|((a, b), g)| a + b + bowl * g.cos_theta_v()).collect()
}

/// The share of leaves on which the device ends more than 1 % of χ² above the server's optimum, and the most steps it took.
fn misses(
    geometries: &[Geometry<f64>],
    leaves: u32,
    leaf: fn(&mut Random, &[Geometry<f64>]) -> Vec<f64>,
) -> (f64, u32) {
    let mut random = Random(20);
    let (mut missed, mut steps) = (0, 0);
    for _ in 0..leaves {
        let y = leaf(&mut random, geometries);
        let weight = vec![1.0; y.len()];
        let device = on_device(geometries, &y, &weight, &BandOptions::table_3());
        let server = on_server(geometries, &y);
        steps = steps.max(device.iterations);
        if chi2(geometries, &y, &device) > 1.01 * chi2(geometries, &y, &server) {
            missed += 1;
        }
    }
    (f64::from(missed) / f64::from(leaves), steps)
}

#[test]
fn the_device_finds_the_servers_optimum() {
    let directions = [("41", hemisphere(40.0)), ("260", goniometer())];
    for (name, geometries) in &directions {
        let (plain, steps) = misses(geometries, 1000, measured);
        let (rough, more_steps) = misses(geometries, 500, awkward);
        println!("{name} directions: misses {plain} in {steps} steps at most; model wrong: {rough}, {more_steps}");
        assert!(plain <= 0.01 && rough <= 0.02, "{name}: {plain}, {rough}");
    }
}

/// Single precision stops at a predicted decrease of 1e-4 χ²: with 257 degrees of freedom a sixth of a standard error.
#[test]
fn parameters_and_their_errors_are_the_servers() {
    let geometries = goniometer();
    let mut random = Random(4);
    for case in 0..200 {
        let y = measured(&mut random, &geometries);
        let device = on_device(&geometries, &y, &[1.0; 260], &BandOptions::table_3());
        let server = on_server(&geometries, &y);
        for p in 0..3 {
            assert_eq!(device.identifiability[p], server.identifiability[p], "{case}: {device:?} {server:?}");
            if let (Some(ours), Some(theirs)) = (device.standard_errors[p], server.standard_errors[p]) {
                assert!(
                    (device.parameters[p] - server.parameters[p]).abs() < 0.1 * theirs,
                    "{case}: {device:?} {server:?}"
                );
                assert!((ours / theirs - 1.0).abs() < 0.05, "{case}: {device:?} {server:?}");
            }
        }
        assert!((device.rmse() / server.rmse() - 1.0).abs() < 1e-3, "{case}: {device:?} {server:?}");
    }
}

#[test]
fn a_missing_value_counts_for_nothing() {
    let geometries = hemisphere(40.0);
    let mut random = Random(9);
    let y = measured(&mut random, &geometries);
    let mut weight = vec![1.0; y.len()];
    let mut spoiled = y.clone();
    for gone in [3, 17, 30] {
        weight[gone] = 0.0;
        spoiled[gone] = 1e3;
    }
    let options = BandOptions::table_3();
    let with = on_device(&geometries, &spoiled, &weight, &options);
    let present: Vec<usize> = (0..y.len()).filter(|i| weight[*i] > 0.0).collect();
    let fewer: Vec<_> = present.iter().map(|i| geometries[*i]).collect();
    let values: Vec<_> = present.iter().map(|i| y[*i]).collect();
    let without = on_device(&fewer, &values, &vec![1.0; values.len()], &options);
    assert_eq!((with.parameters, with.n_obs), (without.parameters, without.n_obs));
}

/// A leaf without any lobe: k_L as it is, and no claim about n and σ.
#[test]
fn where_there_is_no_lobe_the_device_says_so() {
    let geometries = hemisphere(40.0);
    let fit =
        on_device(&geometries, &vec![0.1; geometries.len()], &vec![1.0; geometries.len()], &BandOptions::table_3());
    assert!((fit.parameters[0] - 0.1 * core::f64::consts::PI).abs() < 0.01, "{fit:?}");
    assert!(
        fit.at_bound[1] == AtBound::Lower || fit.identifiability[1] != Identifiability::Identified,
        "n is no more than the data can tell: {fit:?}"
    );
}

#[test]
fn what_cannot_be_fitted_is_refused_by_name() {
    let number = |x: f32| F32(x);
    let terms = [number(0.9), number(0.8), number(0.7), number(0.6)];
    let directions = Directions { cos_theta_a: &terms, tan2_alpha: &terms, weight: &terms };
    let fit = |brdf: &[F32], weight: &[F32]| {
        fit_band(directions, Band { brdf, weight }, &BandOptions::table_3(), &mut Workspace::new())
    };
    let ones = [number(1.0); 4];
    assert!(fit(&ones, &ones).unwrap().is_some());
    assert!(fit(&ones, &[number(1.0), number(1.0), number(0.0), number(0.0)]).unwrap().is_none());
    assert!(matches!(fit(&ones[..3], &ones), Err(FitError::Length { what: "brdf", .. })));
    let not_a_number = [number(1.0), number(f32::NAN), number(1.0), number(1.0)];
    assert!(matches!(fit(&not_a_number, &ones), Err(FitError::NotFinite { what: "brdf", index: 1 })));
    assert!(fit(&ones, &[number(-1.0); 4]).is_err());
}

/// Whatever the data: 2 starts of at most `max_iterations` steps, each with at most two passes over the values.
#[test]
fn no_data_take_more_steps_than_the_bound() {
    let geometries = hemisphere(40.0);
    let mut random = Random(31);
    let mut most = 0;
    for case in 0..2000 {
        let scale = 10.0_f64.powf(random.uniform(-6.0, 3.0));
        let y: Vec<f64> = geometries.iter().map(|_| scale * random.normal()).collect();
        let fit = on_device(&geometries, &y, &vec![1.0; y.len()], &BandOptions::table_3());
        assert!(fit.starts <= 2 && fit.iterations <= 2 * 200, "{case}: {fit:?}");
        let bounds = BandOptions::<f64>::table_3().bounds;
        for (value, bound) in fit.parameters.iter().zip([bounds.k_lambert, bounds.n, bounds.sigma]) {
            // f32's rounding of the bounds
            assert!(*value >= bound.lower * 0.999_999 && *value <= bound.upper * 1.000_001, "{case}: {fit:?}");
        }
        most = most.max(fit.iterations);
    }
    println!("random data: {most} steps at most");
}
