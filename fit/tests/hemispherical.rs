//! PROSPECT inverted: what comes back from spectra that the model made, and what is said where it cannot come back.
#![cfg(feature = "std")]

#[path = "common/leaves.rs"]
mod leaves;
#[path = "common/random.rs"]
mod random;

use leafbrdf_fit::hemispherical::{
    self, Free, HemisphericalError, HemisphericalOptions, HemisphericalProblem, LeafFit, LeafFitOptions, Measured,
    Spectra, default_free, fit_leaf, n_prior, workspace_len,
};
use leafbrdf_fit::{AtBound, Identifiability, Interval};
use leafbrdf_prospect::{LeafParams, Parameter, Prospect, Version, table};
use leaves::random_leaf;
use random::Random;

/// R and T of a leaf.
fn spectra(model: &Prospect<'_, f64>, leaf: &LeafParams<f64>) -> (Vec<f64>, Vec<f64>) {
    let bands = model.view().len();
    let (mut r, mut t) = (vec![0.0; bands], vec![0.0; bands]);
    model.spectrum(leaf, &mut r, &mut t).unwrap();
    (r, t)
}

fn plain(values: &[f64]) -> Option<Measured<'_, f64>> {
    Some(Measured { values, weights: None })
}

fn problem<'a>(
    model: Prospect<'a, f64>,
    reflectance: Option<Measured<'a, f64>>,
    transmittance: Option<Measured<'a, f64>>,
) -> HemisphericalProblem<'a, f64> {
    HemisphericalProblem {
        model,
        spectra: Spectra { reflectance, transmittance },
        held: LeafParams::with_n_struct(1.5),
    }
}

/// The largest error of any parameter in shares of its interval.
fn worst(truth: &LeafParams<f64>, fit: &LeafFit, options: &LeafFitOptions) -> f64 {
    let error = |free: &Free<f64>| {
        (truth.get(free.parameter) - fit.leaf.get(free.parameter)).abs() / (free.bounds.upper - free.bounds.lower)
    };
    options.free.iter().map(error).fold(0.0, f64::max)
}

/// Random leaves that come back to 1e-9 of each interval: far above what is left of rounding (1e-14), far below any other minimum.
fn recovered(version: Version, leaves: usize, use_r: bool, use_t: bool) -> usize {
    let model = Prospect::new(table::full(version));
    let options = LeafFitOptions::new(&default_free(version));
    let mut random = Random(2005);
    (0..leaves)
        .filter(|_| {
            let leaf = random_leaf(&mut random, version);
            let (r, t) = spectra(&model, &leaf);
            let fit = fit_leaf(&problem(model, plain(&r).filter(|_| use_r), plain(&t).filter(|_| use_t)), &options);
            let fit = fit.unwrap();
            fit.termination.converged() && worst(&leaf, &fit, &options) < 1e-9
        })
        .count()
}

#[test]
fn every_parameter_of_a_thousand_leaves_comes_back_from_reflectance_and_transmittance() {
    assert_eq!(recovered(Version::D, 1000, true, true), 1000);
}

#[test]
fn so_it_does_in_the_other_versions() {
    assert_eq!(recovered(Version::P5B, 150, true, true), 150);
    assert_eq!(recovered(Version::Pro, 150, true, true), 150);
}

#[test]
fn without_noise_one_of_the_two_spectra_is_enough() {
    assert_eq!(recovered(Version::D, 150, true, false), 150);
    assert_eq!(recovered(Version::D, 150, false, true), 150);
}

#[test]
fn held_parameters_stay_and_tied_carotenoids_follow() {
    let model = Prospect::new(table::full(Version::D)).with_car_per_cab(0.25).unwrap();
    let leaf = LeafParams { cab: 47.0, cw: 0.011, cm: 0.008, cant: 2.0, ..LeafParams::with_n_struct(1.7) };
    let (r, t) = spectra(&model, &leaf);
    let mut problem = problem(model, plain(&r), plain(&t));
    problem.held = LeafParams { cant: 2.0, cw: 0.011, ..LeafParams::with_n_struct(1.0) };
    let options = LeafFitOptions::new(&[Parameter::Cm, Parameter::NStruct, Parameter::Cab]);
    let fit = fit_leaf(&problem, &options).unwrap();
    assert!(worst(&leaf, &fit, &options) < 1e-9);
    assert_eq!((fit.leaf.cant, fit.leaf.cw, fit.leaf.car), (2.0, 0.011, 0.0));
    let order: Vec<Parameter> = fit.estimates.iter().map(|estimate| estimate.parameter).collect();
    assert_eq!(order, [Parameter::Cm, Parameter::NStruct, Parameter::Cab]);

    let free = LeafFitOptions::new(&[Parameter::Cab, Parameter::Car]);
    let error = fit_leaf(&problem, &free).unwrap_err();
    assert_eq!(error, HemisphericalError::Model(leafbrdf_prospect::Error::CarGivenAndTied));
}

#[test]
fn a_leaf_beyond_a_bound_is_held_there_and_the_rest_still_found() {
    let model = Prospect::new(table::full(Version::D));
    let leaf = LeafParams { cab: 60.0, car: 12.0, cw: 0.01, cm: 0.01, ..LeafParams::with_n_struct(1.8) };
    let (r, t) = spectra(&model, &leaf);
    let mut options = LeafFitOptions::new(&default_free(Version::D));
    options.free[1].bounds = Interval::new(0.0, 50.0);
    let fit = fit_leaf(&problem(model, plain(&r), plain(&t)), &options).unwrap();
    let cab = fit.estimate(Parameter::Cab).unwrap();
    assert_eq!((cab.value, cab.at_bound, cab.identifiability), (50.0, AtBound::Upper, Identifiability::Held));
    assert_eq!((cab.standard_error, cab.why_no_error()), (None, Some("held at its upper bound")));
    // no anthocyanins nor brown pigments in the leaf: a bound that is the truth
    for estimate in &fit.estimates {
        let Free { bounds, .. } = options.free.iter().find(|free| free.parameter == estimate.parameter).unwrap();
        assert!(estimate.value >= bounds.lower && estimate.value <= bounds.upper);
    }
    // water absorbs where chlorophyll does not
    assert!((fit.leaf.cw - 0.01).abs() < 2e-4, "{}", fit.leaf.cw);
}

#[test]
fn what_the_bands_do_not_see_is_not_identifiable() {
    // 400–700 nm: no water
    let visible = table::full(Version::D).bands(0..301).unwrap();
    let model = Prospect::new(visible);
    let leaf = LeafParams { cab: 40.0, car: 9.0, cw: 0.012, cm: 0.006, ..LeafParams::with_n_struct(1.5) };
    let (mut r, mut t) = spectra(&model, &leaf);
    let mut random = Random(7);
    for value in r.iter_mut().chain(&mut t) {
        *value += 0.002 * random.normal();
    }
    let free = [Parameter::NStruct, Parameter::Cab, Parameter::Car, Parameter::Cw];
    let mut problem = problem(model, plain(&r), plain(&t));
    problem.held = leaf;
    let fit = fit_leaf(&problem, &LeafFitOptions::new(&free)).unwrap();
    let water = fit.estimate(Parameter::Cw).unwrap();
    assert_ne!(water.identifiability, Identifiability::Identified);
    assert_eq!(water.standard_error, None);
    assert!(water.correlations.iter().all(Option::is_none));
    let chlorophyll = fit.estimate(Parameter::Cab).unwrap();
    let error = chlorophyll.standard_error.expect("chlorophyll is identifiable");
    assert!((chlorophyll.value - 40.0).abs() < 5.0 * error && error < 1.0, "{chlorophyll:?}");
}

#[test]
fn values_of_weight_zero_do_not_exist() {
    let model = Prospect::new(table::full(Version::D));
    let leaf = LeafParams { cab: 30.0, car: 7.0, cw: 0.013, cm: 0.005, ..LeafParams::with_n_struct(1.4) };
    let (mut r, t) = spectra(&model, &leaf);
    let mut weights = vec![1.0; r.len()];
    for i in (0..r.len()).step_by(3) {
        (r[i], weights[i]) = (17.0, 0.0);
    }
    let reflectance = Some(Measured { values: &r, weights: Some(&weights) });
    let mut problem = problem(model, reflectance, plain(&t));
    problem.held = leaf;
    let options = LeafFitOptions::new(&[Parameter::NStruct, Parameter::Cab, Parameter::Cw]);
    let fit = fit_leaf(&problem, &options).unwrap();
    assert!(worst(&leaf, &fit, &options) < 1e-9);
    assert_eq!((fit.n_obs, fit.reflectance.unwrap().n_obs), (2101 + 1400, 1400));
}

#[test]
fn weights_scale_chi2_and_nothing_else() {
    let model = Prospect::new(table::full(Version::D).bands(0..600).unwrap());
    let mut random = Random(3);
    let leaf = LeafParams { cab: 30.0, car: 7.0, cm: 0.005, ..LeafParams::with_n_struct(1.4) };
    let (mut r, _) = spectra(&model, &leaf);
    for value in &mut r {
        *value += 0.01 * random.normal();
    }
    let weights = vec![1e4; r.len()];
    let options = LeafFitOptions::new(&[Parameter::NStruct, Parameter::Cab]);
    let mut unweighted = problem(model, plain(&r), None);
    unweighted.held = leaf;
    let mut weighted = unweighted;
    weighted.spectra.reflectance = Some(Measured { values: &r, weights: Some(&weights) });
    let (a, b) = (fit_leaf(&unweighted, &options).unwrap(), fit_leaf(&weighted, &options).unwrap());
    // both searches end within 1e-10 of χ² of the minimum: 1e-5 of a standard error
    assert!((b.chi2 / a.chi2 / 1e4 - 1.0).abs() < 1e-9);
    assert!((a.rmse / b.rmse - 1.0).abs() < 1e-9);
    for (a, b) in a.estimates.iter().zip(&b.estimates) {
        assert!((a.value - b.value).abs() < 1e-4 * a.standard_error.unwrap());
        assert!((a.standard_error.unwrap() / b.standard_error.unwrap() - 1.0).abs() < 1e-6);
    }
}

/// White noise, 300 leaves, R and T and R alone: the share of truths within one standard error is 0.683, to four standard
/// deviations of a share of all parameters of all leaves (those of a leaf being hardly correlated).
#[test]
fn standard_errors_cover_the_truth_as_often_as_they_say() {
    let view = table::full(Version::D);
    let model = Prospect::new(view);
    for use_t in [true, false] {
        let mut random = Random(11);
        let (mut within, mut all) = (0.0, 0.0);
        for _ in 0..300 {
            let leaf = random_leaf(&mut random, Version::D);
            let (mut r, mut t) = spectra(&model, &leaf);
            for value in r.iter_mut().chain(&mut t) {
                *value += 0.003 * random.normal();
            }
            let options = LeafFitOptions::new(&default_free(Version::D));
            let fit = fit_leaf(&problem(model, plain(&r), plain(&t).filter(|_| use_t)), &options).unwrap();
            for estimate in fit.estimates {
                let Some(error) = estimate.standard_error else { continue };
                all += 1.0;
                within += f64::from(u8::from((estimate.value - leaf.get(estimate.parameter)).abs() <= error));
            }
        }
        let share = within / all;
        assert!(all > 2000.0 && (share - 0.683).abs() < 4.0 * (0.683_f64 * 0.317 / all).sqrt(), "{share} of {all}");
    }
}

#[test]
fn errors_that_repeat_themselves_widen_the_standard_errors() {
    let model = Prospect::new(table::full(Version::D));
    let leaf = LeafParams { cab: 45.0, car: 9.0, cw: 0.012, cm: 0.006, ..LeafParams::with_n_struct(1.5) };
    let (mut r, t) = spectra(&model, &leaf);
    for (i, value) in r.iter_mut().enumerate() {
        *value += 0.004 * (i as f64 / 40.0).sin();
    }
    let mut options = LeafFitOptions::new(&[Parameter::NStruct, Parameter::Cab, Parameter::Cw, Parameter::Cm]);
    let mut problem = problem(model, plain(&r), plain(&t));
    problem.held = leaf;
    let aware = fit_leaf(&problem, &options).unwrap();
    options.solver.correlated_residuals = false;
    let naive = fit_leaf(&problem, &options).unwrap();
    assert_eq!(aware.leaf, naive.leaf);
    assert_eq!(naive.n_effective, naive.n_obs as f64);
    let inflation = (aware.n_obs as f64 / aware.n_effective).sqrt();
    assert!(inflation > 5.0, "{inflation}");
    for (aware, naive) in aware.estimates.iter().zip(&naive.estimates) {
        let ratio = aware.standard_error.unwrap() / naive.standard_error.unwrap();
        assert!((ratio / inflation - 1.0).abs() < 1e-12);
    }
}

#[test]
fn what_cannot_be_set_up_is_refused_with_the_reason() {
    let model = Prospect::new(table::full(Version::Pro));
    let values = vec![0.3; table::BANDS];
    let refused = |problem: &HemisphericalProblem<'_, f64>, free: &[Parameter]| {
        fit_leaf(problem, &LeafFitOptions::new(free)).unwrap_err().to_string()
    };
    let good = problem(model, plain(&values), None);
    use Parameter::{Cab, Cbc, Cm, NStruct, Prot};
    for (free, part) in [
        (&[][..], "no parameter is free"),
        (&[Cab, NStruct, Cab], "cab is free twice"),
        (&[Cab; 10], "cab is free twice"),
        (&[Cm, Prot, Cbc], "cm and prot or cbc"),
    ] {
        let message = refused(&good, free);
        assert!(message.contains(part), "{message}");
    }
    let d = problem(Prospect::new(table::full(Version::D)), plain(&values), None);
    assert!(refused(&d, &[Prot]).contains("no coefficients for prot"));
    let mut scaled = d;
    scaled.held.cw = 10.0;
    assert!(refused(&scaled, &[Cab]).contains("did you mean"), "{}", refused(&scaled, &[Cab]));
    assert!(refused(&problem(model, None, None), &[Cab]).contains("no usable value"));
    assert!(
        refused(&problem(model, plain(&values[1..]), None), &[Cab])
            .contains("reflectance has 2100 values: expected 2101")
    );
    let mut holed = values.clone();
    holed[5] = f64::NAN;
    assert!(refused(&problem(model, None, plain(&holed)), &[Cab]).contains("transmittance has a value that is not"));
    let mut options = LeafFitOptions::new(&[Cab]);
    options.free[0].bounds = Interval::new(-1.0, 10.0);
    assert!(fit_leaf(&good, &options).unwrap_err().to_string().contains("bounds of cab: expected 0"));
}

#[test]
fn a_device_with_single_precision_and_little_memory_finds_the_same_leaf() {
    static BANDS: table::TableD<f32, 121> = table::TableD::<f32, 121>::cut::<400, 5>();
    let model = Prospect::new(BANDS.view());
    let leaf = LeafParams { cab: 42.0_f32, car: 9.0, cw: 0.01, cm: 0.007, ..LeafParams::with_n_struct(1.6) };
    let (mut r, mut t) = ([0.0_f32; 121], [0.0_f32; 121]);
    model.spectrum(&leaf, &mut r, &mut t).unwrap();
    let problem = HemisphericalProblem {
        model,
        spectra: Spectra {
            reflectance: Some(Measured { values: &r, weights: None }),
            transmittance: Some(Measured { values: &t, weights: None }),
        },
        held: leaf,
    };
    let free = [Parameter::NStruct, Parameter::Cab, Parameter::Car, Parameter::Cm].map(Free::<f32>::new);
    let mut least = [0.0_f32; 10];
    let mut full = [0.0_f32; workspace_len(4)];
    for workspace in [&mut least[..], &mut full[..]] {
        let fit = hemispherical::fit(&problem, &free, &[], &HemisphericalOptions::default(), workspace).unwrap();
        // single precision: 2e-7 in R and T, over a sensitivity of 1e-3 per µg of chlorophyll
        assert!((fit.leaf.cab - 42.0).abs() < 0.01, "{}", fit.leaf.cab);
        assert!((fit.leaf.n_struct - 1.6).abs() < 1e-4 && (fit.leaf.cm - 0.007).abs() < 1e-5);
    }
    let error =
        hemispherical::fit(&problem, &free, &[], &HemisphericalOptions::default(), &mut least[1..]).unwrap_err();
    assert_eq!(error, HemisphericalError::Length { what: "workspace", found: 9, expected: 10 });
}

#[test]
fn the_prior_of_n_is_exact_for_an_ordinary_leaf_and_its_spread_honest_for_others() {
    let model = Prospect::new(table::full(Version::D));
    let ordinary = LeafParams { cab: 40.0, car: 8.0, cw: 0.012, cm: 0.0065, ..LeafParams::with_n_struct(1.83) };
    let (mut r, _) = spectra(&model, &ordinary);
    let bounds = Interval::new(1.0, 5.0);
    // bisection to 4·2⁻³² of the interval
    let prior = n_prior(&model, &r, bounds).unwrap();
    assert!((prior.n_struct - 1.83).abs() < 1e-8 && prior.wavelength_nm == 1131.0, "{prior:?}");
    // without the short-wave infrared
    r[700..].fill(f64::NAN);
    let prior = n_prior(&model, &r, bounds).unwrap();
    assert!((prior.n_struct - 1.83).abs() < 1e-6 && prior.wavelength_nm == 800.0, "{prior:?}");
    r[350..].fill(f64::NAN);
    assert_eq!(n_prior(&model, &r, bounds), Err(HemisphericalError::NoPlateau));

    // leaves whose water and dry matter scatter by a factor of two
    let mut random = Random(5);
    let inside = (0..500)
        .filter(|_| {
            let leaf = LeafParams {
                cab: random.uniform(5.0, 80.0),
                cw: (0.012 * (random.normal() * std::f64::consts::LN_2).exp()).min(0.5),
                cm: (0.0065 * (random.normal() * std::f64::consts::LN_2).exp()).min(0.1),
                ..LeafParams::with_n_struct(random.uniform(1.1, 2.8))
            };
            let (r, _) = spectra(&model, &leaf);
            let prior = n_prior(&model, &r, bounds).unwrap();
            (prior.n_struct - leaf.n_struct).abs() <= prior.standard_deviation
        })
        .count();
    // at least the 68 % of a normal error, less four standard deviations of a share of 500
    assert!(inside >= 300, "{inside} of 500");
}
