//! One surface for the whole leaf: the laws that its fit must keep.

mod common;

use common::Random;
use leafbrdf_core::{Angle, DirectionVectors};
use leafbrdf_fit::surface::{
    DirectionalModel, Knowledge, LeafModel, NAMES, PARAMETERS, Place, Profile, SearchOptions, Spectra, SurfaceData,
    SurfaceFit, SurfaceOptions, Treatment, fit_surface, polish,
};

/// 41 directions at one θ_s, as on a hemispherical goniometer: θ_v 10–60° at seven azimuths, and nadir.
fn hemisphere(theta_s: f64) -> Vec<DirectionVectors<f64>> {
    let mut directions = vec![(0.0, 0.0)];
    for phi in [0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0] {
        directions.extend((1..=6).map(|i| (10.0 * f64::from(i), phi)));
    }
    directions.retain(|&(theta_v, phi)| !(phi == 0.0 && (10.0..=20.0).contains(&theta_v)));
    directions.iter().map(|&(theta_v, phi)| direction(theta_s, theta_v, phi)).collect()
}

/// 12 directions in the plane of incidence.
fn principal_plane(theta_s: f64) -> Vec<DirectionVectors<f64>> {
    let forward = [60.0, 50.0, 40.0, 30.0, 20.0, 10.0].map(|theta_v| (theta_v, 180.0));
    let backward = [10.0, 20.0, 30.0, 40.0, 50.0, 60.0].map(|theta_v| (theta_v, 0.0));
    forward.iter().chain(&backward).map(|&(theta_v, phi)| direction(theta_s, theta_v, phi)).collect()
}

fn direction(theta_s: f64, theta_v: f64, phi_v: f64) -> DirectionVectors<f64> {
    let deg = Angle::from_degrees;
    DirectionVectors::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

/// A green leaf's k_L: dark in the visible but for a hill at 550 nm, a red edge, a bright plateau.
fn k_lambert(band: usize, bands: usize) -> f64 {
    let nm = 480.0 + 400.0 * band as f64 / bands as f64;
    let hill = 0.08 * (-((nm - 550.0) / 35.0).powi(2)).exp();
    0.04 + hill + 0.42 / (1.0 + (-(nm - 715.0) / 12.0).exp())
}

/// BRDF of a leaf with the surface `x` of `options`.
fn leaf(
    directions: &[DirectionVectors<f64>],
    options: &SurfaceOptions,
    x: &[f64; PARAMETERS],
    bands: usize,
) -> Vec<f64> {
    let model = model(directions, options);
    let mut values = Vec::new();
    model.values(x, |value| values.push(value)).unwrap();
    (0..bands).flat_map(|b| values.iter().map(move |[s, p]| k_lambert(b, bands) * s + p).collect::<Vec<_>>()).collect()
}

fn model<'a>(directions: &'a [DirectionVectors<f64>], options: &SurfaceOptions) -> LeafModel<'a, f64> {
    LeafModel { directions, facets: options.facets, diffuse: options.diffuse, normalization: options.normalization }
}

fn fit(directions: &[DirectionVectors<f64>], brdf: &[f64], options: &SurfaceOptions) -> SurfaceFit {
    fit_surface(&SurfaceData { directions, brdf, sd: None }, options).unwrap()
}

fn every_kind() -> Vec<SurfaceOptions> {
    let mut all = Vec::new();
    for kind in 0..8 {
        let mut options = SurfaceOptions::paper();
        if kind & 1 > 0 {
            options = options.with_ggx();
        }
        if kind & 2 > 0 {
            options = options.with_p1();
        }
        if kind & 4 > 0 {
            options = options.with_tilt();
        }
        all.push(options);
    }
    all
}

/// A surface inside the bounds of `options`; held parameters stay where they are held.
fn surface(options: &SurfaceOptions, random: &mut Random) -> [f64; PARAMETERS] {
    let drawn = [
        random.uniform(1.25, 1.8),
        random.uniform(0.08, 0.5),
        random.uniform(0.0, 0.3),
        random.uniform(-0.15, 0.15),
        random.uniform(-4.0, 4.0).to_radians(),
        random.uniform(-4.0, 4.0).to_radians(),
    ];
    core::array::from_fn(|i| match options.parameters[i] {
        Treatment::Held(value) => value,
        Treatment::Free { .. } => drawn[i],
    })
}

#[test]
fn without_noise_every_kind_of_surface_is_found_exactly() {
    // χ² falls to rounding, 1e-16 of the data; the flattest parameter (n of a rough lobe) then has 9 digits
    let mut random = Random(1);
    for options in every_kind() {
        for theta_s in [20.0, 40.0, 55.0] {
            let directions = hemisphere(theta_s);
            let truth = surface(&options, &mut random);
            let fit = fit(&directions, &leaf(&directions, &options, &truth, 60), &options);
            for (found, true_value) in fit.x.iter().zip(truth) {
                assert!((found - true_value).abs() < 1e-8, "{options:?}\n{truth:?}\n{:?} {}", fit.x, fit.rmse);
            }
            assert!(fit.rmse < 1e-9);
            for (b, band) in fit.bands.iter().enumerate() {
                assert!((band.k_lambert.unwrap() - k_lambert(b, 60)).abs() < 1e-8);
            }
        }
    }
}

#[test]
fn the_gradient_of_the_profile_is_the_slope_of_its_cost() {
    let mut random = Random(2);
    for options in every_kind() {
        let directions = hemisphere(40.0);
        let truth = surface(&options, &mut random);
        let mut brdf = leaf(&directions, &options, &truth, 20);
        brdf.iter_mut().for_each(|y| *y += 0.01 * random.normal());
        let holes: Vec<f64> = brdf.iter().enumerate().map(|(i, y)| if i % 17 == 3 { f64::NAN } else { *y }).collect();
        for data in [&brdf, &holes] {
            let spectra = Spectra::new(directions.len(), data, None).unwrap();
            let model = model(&directions, &options);
            let mut places = vec![Place::empty(); directions.len()];
            let x = surface(&options, &mut random);
            spectra.moments(|moments| {
                let mut profile = Profile::new(&model, moments, &mut places).unwrap();
                let at = profile.derivatives(&x).unwrap();
                assert!((at.chi2 / profile.chi2(&x).unwrap() - 1.0).abs() < 1e-13);
                for i in 0..PARAMETERS {
                    if !options.parameters[i].is_free() {
                        continue;
                    }
                    // central difference of step h: error h² f'''/6 ~ 1e-8, rounding 1e-16/h ~ 1e-11
                    let h = 1e-5;
                    let moved = |by: f64| core::array::from_fn(|k| x[k] + if k == i { by } else { 0.0 });
                    let slope = (profile.chi2(&moved(h)).unwrap() - profile.chi2(&moved(-h)).unwrap()) / (2.0 * h);
                    let scale = at.normal[i][i].sqrt() * at.chi2.sqrt();
                    assert!((slope - at.gradient[i]).abs() < 1e-6 * scale, "{i}: {slope} {}", at.gradient[i]);
                }
            });
        }
    }
}

#[test]
fn the_principal_plane_does_not_see_a_lateral_tilt() {
    let options = SurfaceOptions::paper().with_tilt();
    let directions = principal_plane(40.0);
    let truth = [1.5, 0.25, 0.0, 0.0, 3.0_f64.to_radians(), 0.0, 0.0];
    let fit = fit(&directions, &leaf(&directions, &options, &truth, 40), &options);
    assert_eq!(fit.errors.knowledge[5], Knowledge::NotIdentifiable);
    assert_eq!(fit.x[5], 0.0);
    assert_eq!(fit.errors.standard_errors[5], None);
    assert!((fit.x[4] - truth[4]).abs() < 1e-8, "{:?}", fit.x);
    assert_eq!(fit.parameters[5], Treatment::Held(0.0));
}

/// As [`surface`], what has a prior drawn from it: only then are a prior's share and the errors that rest on it to be tested.
fn drawn(options: &SurfaceOptions, random: &mut Random) -> [f64; PARAMETERS] {
    let mut x = surface(options, random);
    for (x, one) in x.iter_mut().zip(&options.parameters) {
        if let Treatment::Free { bounds, prior: Some(prior) } = one {
            *x = loop {
                let value = prior.mean + prior.sd * random.normal();
                if value > bounds.lower && value < bounds.upper {
                    break value;
                }
            };
        }
    }
    x
}

/// What stands between a leaf and its measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Spoiled {
    /// White noise of the paper's goniometer: 1 % of the value and 0.003 sr⁻¹.
    Noise,
    /// The same, and every value with its standard deviation.
    NoiseWithSd,
    /// A misfit of the model: one draw a direction, common to all bands but for a slow change with the wavelength.
    Misfit,
}

impl Spoiled {
    fn sd(brdf: f64) -> f64 {
        (0.01 * brdf).hypot(0.003)
    }

    fn spoil(self, brdf: &[f64], directions: usize, random: &mut Random) -> Vec<f64> {
        match self {
            Spoiled::Noise | Spoiled::NoiseWithSd => with_noise(brdf, random),
            Spoiled::Misfit => with_misfit(brdf, directions, random),
        }
    }
}

/// White noise of the paper's goniometer: 1 % of the value and 0.003 sr⁻¹.
fn with_noise(brdf: &[f64], random: &mut Random) -> Vec<f64> {
    brdf.iter().map(|y| y * (1.0 + 0.01 * random.normal()) + 0.003 * random.normal()).collect()
}

/// A misfit of the model: one draw a direction, common to all bands but for a slow change with the wavelength.
fn with_misfit(brdf: &[f64], directions: usize, random: &mut Random) -> Vec<f64> {
    let bands = brdf.len() / directions;
    let draws: Vec<[f64; 2]> = (0..directions).map(|_| [0.004 * random.normal(), 0.002 * random.normal()]).collect();
    brdf.iter()
        .enumerate()
        .map(|(i, y)| {
            y + draws[i % directions][0]
                + draws[i % directions][1] * (3.0 * (i / directions) as f64 / bands as f64).sin()
        })
        .collect()
}

/// A parameter over many leaves.
#[derive(Clone, Copy, Debug, Default)]
struct Score {
    /// Leaves that have an error of it.
    count: f64,
    /// Leaves whose truth lies within 1 and within 1.96 standard errors.
    inside: [f64; 2],
    /// Σ (found − true)² and Σ (standard error)².
    squares: [f64; 2],
}

impl Score {
    fn shares(&self) -> [f64; 2] {
        self.inside.map(|inside| inside / self.count)
    }

    /// Root mean square of the errors made over that of the errors told.
    fn made_over_told(&self) -> f64 {
        (self.squares[0] / self.squares[1]).sqrt()
    }
}

/// How far off, and how far the standard errors say, over `leaves` leaves.
fn score(
    leaves: u64,
    directions: &[DirectionVectors<f64>],
    options: &SurfaceOptions,
    spoiled: Spoiled,
    truth: impl Fn(&mut Random) -> [f64; PARAMETERS],
) -> [Score; PARAMETERS] {
    let mut scores = [Score::default(); PARAMETERS];
    for seed in 0..leaves {
        let mut random = Random(1000 + seed);
        let truth = truth(&mut random);
        let clean = leaf(directions, options, &truth, 40);
        let data = spoiled.spoil(&clean, directions.len(), &mut random);
        let sd: Vec<f64> = clean.iter().map(|y| Spoiled::sd(*y)).collect();
        let sd = (spoiled == Spoiled::NoiseWithSd).then_some(&sd[..]);
        let found = fit_surface(&SurfaceData { directions, brdf: &data, sd }, options).unwrap();
        for (i, score) in scores.iter_mut().enumerate() {
            let Some(error) = found.errors.standard_errors[i] else { continue };
            let off = (found.x[i] - truth[i]).abs();
            score.count += 1.0;
            for (inside, errors) in score.inside.iter_mut().zip([1.0, 1.96]) {
                *inside += f64::from(u8::from(off < errors * error));
            }
            score.squares[0] += off * off;
            score.squares[1] += error * error;
        }
    }
    scores
}

/// 68 % and 95 % as issue and documentation promise them: 60–76 % and 90–98 %.
fn honest([one, two]: [f64; 2]) -> bool {
    one > 0.60 && one < 0.76 && two > 0.90 && two < 0.98
}

#[test]
fn standard_errors_cover_the_truth_as_often_as_they_say() {
    // 300 leaves: a share of 0.68 is known to ±0.027, one of 0.95 to ±0.013
    let directions = hemisphere(40.0);
    for options in [SurfaceOptions::paper(), SurfaceOptions::paper().with_ggx().with_p1().with_tilt()] {
        for spoiled in [Spoiled::Noise, Spoiled::Misfit] {
            let scores = score(300, &directions, &options, spoiled, |random| drawn(&options, random));
            for i in (0..PARAMETERS).filter(|&i| options.parameters[i].is_free()) {
                assert_eq!(scores[i].count, 300.0);
                assert!(honest(scores[i].shares()), "{spoiled:?} {}: {:?}", NAMES[i], scores[i].shares());
            }
        }
    }
}

#[test]
fn errors_are_honest_where_two_or_three_views_see_a_peak_that_is_noisier_than_the_rest() {
    // Table 4's leaves. 100 of each: a root mean square is known to ±7 %, and errors made and told both are one. With one noise
    // for all directions laurel's σ has 1.4.
    let four_sources: Vec<_> = [8.0, 21.0, 41.0, 60.0].into_iter().flat_map(hemisphere).collect();
    let options = SurfaceOptions::paper();
    for (leaf, n, sigma) in [("laurel", 1.22, 0.078), ("beech", 1.56, 0.29), ("hazel", 1.68, 0.46)] {
        for spoiled in [Spoiled::Noise, Spoiled::NoiseWithSd] {
            let scores = score(100, &four_sources, &options, spoiled, |_| [n, sigma, 0.0, 0.0, 0.0, 0.0, 0.0]);
            for i in [0, 1] {
                let ratio = scores[i].made_over_told();
                assert!(ratio > 0.8 && ratio < 1.2, "{leaf} {spoiled:?} {}: {ratio}", NAMES[i]);
                assert!(scores[i].shares()[1] > 0.90, "{leaf} {spoiled:?} {}: {:?}", NAMES[i], scores[i]);
            }
        }
    }
}

#[test]
fn errors_from_twelve_views_are_honest_under_noise_that_grows_with_the_light() {
    // 300 leaves: ±0.027, ±0.013
    let directions = principal_plane(40.0);
    for options in [SurfaceOptions::paper(), SurfaceOptions::paper().with_tilt()] {
        for spoiled in [Spoiled::Noise, Spoiled::NoiseWithSd] {
            let scores = score(300, &directions, &options, spoiled, |random| {
                let mut x = drawn(&options, random);
                // the plane of incidence does not see it
                x[5] = 0.0;
                x
            });
            for i in [0, 1, 4].into_iter().filter(|&i| options.parameters[i].is_free()) {
                assert!(honest(scores[i].shares()), "{spoiled:?} {}: {:?}", NAMES[i], scores[i].shares());
            }
        }
    }
}

/// A leaf with noise, and its fit.
fn noisy(options: &SurfaceOptions, seed: u64) -> (Vec<DirectionVectors<f64>>, Vec<f64>, SurfaceFit) {
    let mut random = Random(seed);
    let directions = hemisphere(40.0);
    let truth = surface(options, &mut random);
    let data = with_noise(&leaf(&directions, options, &truth, 30), &mut random);
    let found = fit(&directions, &data, options);
    (directions, data, found)
}

fn close(a: &[f64; PARAMETERS], b: &[f64; PARAMETERS], tolerance: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= tolerance)
}

#[test]
fn no_random_start_is_better_than_the_default() {
    // narrow and broad lobes trade places where the views hardly see the peak: a single search ends in the wrong one at times
    let mut random = Random(5);
    let mut wrong = 0;
    for round in 0..12 {
        let options =
            if round % 2 == 0 { SurfaceOptions::paper() } else { SurfaceOptions::paper().with_p1().with_tilt() };
        let directions = if round % 3 == 0 { hemisphere(50.0) } else { principal_plane(50.0) };
        let mut truth = surface(&options, &mut random);
        truth[1] = random.uniform(0.03, 0.12);
        truth[5] = if round % 3 == 0 { truth[5] } else { 0.0 };
        let data = with_misfit_of(0.01, &leaf(&directions, &options, &truth, 10), directions.len(), &mut random);
        let found = fit(&directions, &data, &options);
        let default = found.valleys.best().unwrap().cost;
        let spectra = Spectra::new(directions.len(), &data, None).unwrap();
        let model = model(&directions, &options);
        let mut places = vec![Place::empty(); directions.len()];
        let search = SearchOptions {
            parameters: found.parameters,
            draws: found.draws,
            tolerance: options.tolerance,
            max_iterations: options.max_iterations,
            scan: options.scan,
            valleys: options.valleys,
        };
        spectra.moments(|moments| {
            let mut profile = Profile::new(&model, moments, &mut places).unwrap();
            for _ in 0..40 {
                let start = found.parameters.map(|one| match one {
                    Treatment::Held(value) => value,
                    Treatment::Free { bounds, .. } => random.uniform(bounds.lower, bounds.upper),
                });
                let cost = polish(&mut profile, &search, &start).cost;
                assert!(cost > default * (1.0 - 1e-9), "{round}: {cost} below {default}, {:?}", found.x);
                wrong += usize::from(cost > 1.001 * default);
            }
        });
    }
    assert!(wrong > 0, "these leaves are meant to be ambiguous");
}

fn with_misfit_of(size: f64, brdf: &[f64], directions: usize, random: &mut Random) -> Vec<f64> {
    let draws: Vec<f64> = (0..directions).map(|_| size * random.normal()).collect();
    brdf.iter().enumerate().map(|(i, y)| y + draws[i % directions]).collect()
}

#[test]
fn the_order_of_bands_and_of_directions_is_irrelevant() {
    let options = SurfaceOptions::paper().with_p1().with_tilt();
    let (directions, data, found) = noisy(&options, 7);
    let width = directions.len();
    let turned: Vec<f64> = data.chunks_exact(width).rev().flat_map(|band| band.iter().rev().copied()).collect();
    let backwards: Vec<DirectionVectors<f64>> = directions.iter().rev().copied().collect();
    let again = fit(&backwards, &turned, &options);
    // the minimum is found to √1e-12 of a standard error
    assert!(close(&found.x, &again.x, 1e-6), "{:?} {:?}", found.x, again.x);
    assert!((found.chi2 / again.chi2 - 1.0).abs() < 1e-9);
    let (a, b) = (found.errors.standard_errors, again.errors.standard_errors);
    let same = |(a, b): (&Option<f64>, Option<f64>)| match (*a, b) {
        (Some(a), Some(b)) => (a / b - 1.0).abs() < 1e-4,
        (a, b) => a == b,
    };
    assert!(a[0].is_some() && a.iter().zip(b).all(same), "{a:?} {b:?}");
}

#[test]
fn a_band_without_values_changes_nothing_but_the_counts() {
    let options = SurfaceOptions::paper().with_tilt();
    let (directions, data, found) = noisy(&options, 8);
    let mut longer = data.clone();
    longer.extend(std::iter::repeat_n(f64::NAN, directions.len()));
    let again = fit(&directions, &longer, &options);
    assert!(close(&found.x, &again.x, 1e-9));
    assert_eq!((again.n_obs, again.bands.len()), (found.n_obs, found.bands.len() + 1));
    assert_eq!(again.bands.last().unwrap().k_lambert, None);
}

#[test]
fn without_noise_missing_values_change_nothing() {
    let options = SurfaceOptions::paper().with_ggx().with_p1().with_tilt();
    let directions = hemisphere(40.0);
    let truth = surface(&options, &mut Random(9));
    let mut data = leaf(&directions, &options, &truth, 40);
    data.iter_mut().enumerate().filter(|(i, _)| i % 7 == 2).for_each(|(_, y)| *y = f64::NAN);
    let found = fit(&directions, &data, &options);
    assert!(close(&found.x, &truth, 1e-8), "{:?} {truth:?}", found.x);
    assert_eq!(found.n_obs, data.iter().filter(|y| !y.is_nan()).count());
}

#[test]
fn standard_deviations_that_are_all_equal_change_nothing() {
    let options = SurfaceOptions::paper().with_tilt();
    let (directions, data, found) = noisy(&options, 10);
    let sd = vec![0.02; data.len()];
    let again = fit_surface(&SurfaceData { directions: &directions, brdf: &data, sd: Some(&sd) }, &options).unwrap();
    assert!(close(&found.x, &again.x, 1e-7), "{:?} {:?}", found.x, again.x);
    for (a, b) in found.errors.standard_errors.iter().zip(again.errors.standard_errors) {
        match (a, b) {
            (Some(a), Some(b)) => assert!((a / b - 1.0).abs() < 1e-4),
            (a, b) => assert_eq!(*a, b),
        }
    }
    assert!((found.rmse / again.rmse - 1.0).abs() < 1e-9);
    // each value by itself: bands that cannot be rotated together
    let mut sd: Vec<f64> = data.iter().map(|y| 0.003 + 0.01 * y.abs()).collect();
    let weighted = fit_surface(&SurfaceData { directions: &directions, brdf: &data, sd: Some(&sd) }, &options).unwrap();
    // ten times the sd of everything is the same fit
    sd.iter_mut().for_each(|sd| *sd *= 10.0);
    let scaled = fit_surface(&SurfaceData { directions: &directions, brdf: &data, sd: Some(&sd) }, &options).unwrap();
    assert!(close(&weighted.x, &scaled.x, 1e-7));
    assert!((weighted.chi2 / scaled.chi2 / 100.0 - 1.0).abs() < 1e-9);
}

#[test]
fn brighter_bands_with_the_same_lobe_leave_the_surface_alone() {
    // k_L is eliminated: what is added to it in every band is found again, and nothing else
    let options = SurfaceOptions::paper();
    let (directions, data, found) = noisy(&options, 11);
    let brighter: Vec<f64> = data.iter().map(|y| y + 0.2 * core::f64::consts::FRAC_1_PI).collect();
    let again = fit(&directions, &brighter, &options);
    assert!(close(&found.x, &again.x, 1e-6));
    for (a, b) in found.bands.iter().zip(&again.bands) {
        assert!((b.k_lambert.unwrap() - a.k_lambert.unwrap() - 0.2).abs() < 1e-6);
    }
}

#[test]
fn the_other_convention_scales_the_lobe_and_nothing_else() {
    let options = SurfaceOptions::paper();
    let (directions, data, _) = noisy(&options, 12);
    let derived = SurfaceOptions { normalization: leafbrdf_core::Normalization::CookTorrance, ..options.clone() };
    let (printed, derived) = (fit(&directions, &data, &options), fit(&directions, &data, &derived));
    assert!(derived.x[0] < printed.x[0], "a larger factor asks for a smaller index");
    assert!((derived.x[1] / printed.x[1] - 1.0).abs() < 0.05);
    assert!((derived.rmse / printed.rmse - 1.0).abs() < 0.02);
}

#[test]
fn a_parameter_at_its_bound_is_named_and_has_no_error() {
    let mut options = SurfaceOptions::paper();
    options.parameters[1] = Treatment::within(0.3, 1.0);
    let directions = hemisphere(40.0);
    let data = leaf(&directions, &options, &[1.5, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0], 20);
    let found = fit(&directions, &data, &options);
    assert_eq!((found.x[1], found.errors.knowledge[1]), (0.3, Knowledge::AtBound));
    assert_eq!(found.errors.standard_errors[1], None);
    assert!(found.errors.standard_errors[0].is_some());
}

#[test]
fn one_direction_tells_nothing_of_a_surface() {
    let options = SurfaceOptions::paper();
    let directions = [direction(40.0, 0.0, 0.0)];
    let found = fit(&directions, &[0.1, 0.2, 0.3], &options);
    assert!(found.errors.standard_errors.iter().all(Option::is_none));
    assert!(matches!(
        found.errors.knowledge[0],
        Knowledge::NoDegreesOfFreedom | Knowledge::AtBound | Knowledge::NotIdentifiable
    ));
}

#[test]
fn a_value_far_off_hardly_moves_a_robust_fit() {
    let options = SurfaceOptions::paper();
    let (directions, mut data, clean) = noisy(&options, 13);
    let robust = SurfaceOptions { robust: true, ..options.clone() };
    (0..30).for_each(|band| data[band * directions.len() + 20] += 0.2);
    let (plain, robust) = (fit(&directions, &data, &options), fit(&directions, &data, &robust));
    let off = |fit: &SurfaceFit| (fit.x[0] - clean.x[0]).abs() + (fit.x[1] - clean.x[1]).abs();
    assert!(off(&robust) < 0.3 * off(&plain), "{} {}", off(&robust), off(&plain));
    assert!(robust.chi2 >= plain.chi2);
}

#[test]
fn a_basis_with_every_spectrum_is_no_bond_and_a_true_one_costs_nothing() {
    let options = SurfaceOptions::paper();
    let directions = hemisphere(40.0);
    let (bands, truth) = (25, [1.45, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let data = leaf(&directions, &options, &truth, bands);
    let spectrum: Vec<f64> = (0..bands).map(|b| 3.0 * k_lambert(b, bands) - 0.1).collect();
    let flat = vec![1.0; bands];
    let bound = Spectra::with_basis(directions.len(), &data, &[&spectrum, &flat]).unwrap();
    let free = Spectra::new(directions.len(), &data, None).unwrap();
    let model = model(&directions, &options);
    let cost = |spectra: &Spectra, x: &[f64; PARAMETERS]| {
        let mut places = vec![Place::empty(); directions.len()];
        spectra.moments(|moments| Profile::new(&model, moments, &mut places).unwrap().chi2(x).unwrap())
    };
    // rounding of sums of squares of about 1
    assert!(cost(&bound, &truth) < 1e-24);
    let elsewhere = [1.6, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0];
    // the lobe's error is the same in all bands, and a flat offset follows it as well as free k_L do
    assert!((cost(&bound, &elsewhere) / cost(&free, &elsewhere) - 1.0).abs() < 1e-10);
    assert!(Spectra::with_basis(directions.len(), &data, &[&spectrum]).is_err(), "no constant in it");
}

#[test]
fn input_that_no_fit_can_start_from_is_refused() {
    let directions = hemisphere(40.0);
    let options = SurfaceOptions::paper();
    let refused = |brdf: &[f64], sd: Option<&[f64]>, options: &SurfaceOptions| {
        fit_surface(&SurfaceData { directions: &directions, brdf, sd }, options).unwrap_err().to_string()
    };
    let fine = vec![0.1; directions.len()];
    assert!(refused(&fine[1..], None, &options).contains("brdf"));
    assert!(refused(&vec![f64::NAN; directions.len()], None, &options).contains("missing"));
    assert!(refused(&fine, Some(&vec![0.0; directions.len()]), &options).contains("sd"));
    let mut wrong = options.clone();
    wrong.parameters[0] = Treatment::within(5.0, 1.1);
    assert!(refused(&fine, None, &wrong).contains("bounds of n"));
}

#[test]
fn the_second_order_of_the_diffuse_term_comes_back() {
    let mut options = SurfaceOptions::paper().with_ggx().with_p2().with_tilt();
    // nothing known beforehand: what comes back is the data's
    for one in &mut options.parameters {
        if let Treatment::Free { prior, .. } = one {
            *prior = None;
        }
    }
    let truth = [1.5, 0.3, 0.2, -0.08, 0.03, -0.02, 0.12];
    let directions = hemisphere(40.0);
    let found = fit(&directions, &leaf(&directions, &options, &truth, 30), &options);
    for (place, (found, truth)) in found.x.iter().zip(truth).enumerate() {
        // noise-free: the solver's tolerance, 1e-12 of a cost that is 0
        assert!((found - truth).abs() < 1e-6, "{}: {found} {truth}", NAMES[place]);
    }
    // with P1 in its place the misfit says so
    let p1 = SurfaceOptions::paper().with_ggx().with_p1().with_tilt();
    assert!(fit(&directions, &leaf(&directions, &options, &truth, 30), &p1).rmse > 1e-4);
}
