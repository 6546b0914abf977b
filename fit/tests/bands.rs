//! The per-band inversion: what it must recover, what it must never do, what it must admit.

mod common;

use common::{Random, brdf, chi2, geometry, hemisphere};
use leafbrdf_core::{Dielectric, Geometry, Normalization, Surface};
use leafbrdf_fit::band::{Noise, Weights};
use leafbrdf_fit::{
    AtBound, BandBounds, BandFit, BandOptions, FitError, Identifiability, Interval, LeafBandsOptions, LeafData, Start,
    fit_bands,
};

const BOTH: [Normalization; 2] = [Normalization::Bousquet2005, Normalization::CookTorrance];

fn options(normalization: Normalization) -> LeafBandsOptions {
    LeafBandsOptions { normalization, ..LeafBandsOptions::default() }
}

fn fit(geometries: &[Geometry<f64>], y: &[f64], options: &LeafBandsOptions) -> Vec<Option<BandFit<f64>>> {
    fit_bands(&LeafData { geometries, brdf: y, sd: None }, options, &|_| ()).unwrap()
}

fn fit_one(geometries: &[Geometry<f64>], y: &[f64], options: &LeafBandsOptions) -> BandFit<f64> {
    fit(geometries, y, options)[0].unwrap()
}

/// A truth well inside Table 3's box.
fn truth(random: &mut Random) -> [f64; 3] {
    [random.uniform(0.02, 0.9), random.uniform(1.15, 3.0), random.uniform(0.05, 0.9)]
}

#[test]
fn parameters_of_500_random_leaves_are_recovered_from_20_exact_values() {
    let mut random = Random(1);
    let mut seen = 0;
    for case in 0..500 {
        // 20 random directions, one source angle
        let theta_s = random.uniform(10.0, 60.0);
        let directions: Vec<_> =
            (0..20).map(|_| geometry(theta_s, random.uniform(0.0, 70.0), random.uniform(0.0, 360.0))).collect();
        let truth = truth(&mut random);
        let normalization = BOTH[case % 2];
        let y = brdf(&directions, truth, normalization);
        let fit = fit_one(&directions, &y, &options(normalization));
        let lobes = brdf(&directions, [0.0, truth[1], truth[2]], normalization);
        let lobe = lobes.iter().copied().fold(0.0, f64::max);
        // rounding, 1e-16 of BRDF, is the only noise; 1e-6 leaves room for a weak lobe to be ill conditioned
        // three directions at least must see the lobe: two numbers cannot be told from one value
        if lobes.iter().filter(|lobe| **lobe > 1e-3).count() >= 3 {
            seen += 1;
            for (fitted, exact) in fit.parameters.iter().zip(truth) {
                assert!((fitted / exact - 1.0).abs() < 1e-6, "case {case}: {fit:?} for {truth:?}, lobe {lobe}");
            }
            assert!(fit.chi2 <= 1e-20, "case {case}: {} for {truth:?}", fit.chi2);
        }
        // and without a lobe to see, no more is left unexplained than that lobe
        assert!(fit.chi2 <= 20.0 * lobe * lobe, "case {case}: {} for {truth:?}", fit.chi2);
    }
    assert!(seen > 400, "{seen}");
}

/// Leaves that the model cannot fit: a second lobe, a bowl and noise, so that χ² has structure of its own.
fn awkward(random: &mut Random, directions: &[Geometry<f64>], normalization: Normalization) -> Vec<f64> {
    let main = brdf(directions, truth(random), normalization);
    let wide = brdf(directions, [0.0, random.uniform(1.1, 1.8), random.uniform(0.3, 0.95)], normalization);
    let bowl = random.uniform(-0.02, 0.02);
    main.iter()
        .zip(wide)
        .zip(directions)
        .map(|((a, b), g)| a + b + bowl * g.cos_theta_v() + 0.003 * random.normal())
        .collect()
}

/// The best χ² that a fine grid and a shrinking pattern search find: other code, other method, no derivatives.
fn exhaustive(directions: &[Geometry<f64>], y: &[f64], normalization: Normalization) -> f64 {
    let at = |n: f64, sigma: f64| {
        let surface = Surface::new(n, sigma).unwrap().with_normalization(normalization);
        let lobe: Vec<f64> = directions.iter().map(|g| surface.brdf(g)).collect();
        let mean = lobe.iter().zip(y).map(|(s, y)| y - s).sum::<f64>() / y.len() as f64;
        let k = (mean * core::f64::consts::PI).clamp(0.01, 0.99);
        lobe.iter().zip(y).map(|(s, y)| (y - s - k / core::f64::consts::PI).powi(2)).sum::<f64>()
    };
    // √F₀ and ln σ: the lobe is smooth in both
    let n_of = |root: f64| ((1.0 + root) / (1.0 - root)).clamp(1.1, 5.0);
    let (low, high) = ((1.1_f64 - 1.0) / 2.1, 4.0 / 6.0);
    let grid = |i: usize, count: usize, from: f64, to: f64| from + (to - from) * i as f64 / (count - 1) as f64;
    let (rows, columns) = (48, 48);
    let cost: Vec<Vec<f64>> = (0..rows)
        .map(|i| {
            let sigma = grid(i, rows, 0.01_f64.ln(), 0.0).exp();
            (0..columns).map(|j| at(n_of(grid(j, columns, low, high)), sigma)).collect()
        })
        .collect();
    let lowest = cost.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let mut best = f64::INFINITY;
    for i in 0..rows {
        for j in 0..columns {
            let here = cost[i][j];
            let around = (i.saturating_sub(1)..=(i + 1).min(rows - 1))
                .flat_map(|a| (j.saturating_sub(1)..=(j + 1).min(columns - 1)).map(move |b| (a, b)));
            if here > 2.0 * lowest || around.clone().any(|(a, b)| cost[a][b] < here) {
                continue;
            }
            // pattern search with halving steps from every grid minimum, in the eight directions of the compass
            let (mut u, mut v) = (grid(j, columns, low, high), grid(i, rows, 0.01_f64.ln(), 0.0));
            let (mut du, mut dv, mut value) = ((high - low) / 47.0, 0.1, here);
            while du > 1e-7 {
                let mut moved = false;
                for (a, b) in [(1., 0.), (-1., 0.), (0., 1.), (0., -1.), (1., 1.), (1., -1.), (-1., 1.), (-1., -1.)] {
                    let (x, z) = ((u + a * du).clamp(low, high), (v + b * dv).clamp(0.01_f64.ln(), 0.0));
                    let trial = at(n_of(x), z.exp().clamp(0.01, 1.0));
                    if trial < value {
                        (u, v, value, moved) = (x, z, trial, true);
                    }
                }
                if !moved {
                    (du, dv) = (0.5 * du, 0.5 * dv);
                }
            }
            best = best.min(value);
        }
    }
    best
}

#[test]
fn the_minimum_is_the_global_one() {
    let mut random = Random(2);
    for theta_s in [20.0, 40.0, 50.0] {
        let directions = hemisphere(theta_s);
        for case in 0..16 {
            let normalization = BOTH[case % 2];
            let y = awkward(&mut random, &directions, normalization);
            let fit = fit_one(&directions, &y, &options(normalization));
            let best = exhaustive(&directions, &y, normalization);
            // the promise of the project
            assert!(fit.chi2 <= best * (1.0 + 1e-6), "{theta_s}° case {case}: {} against {best}", fit.chi2);
            let plain = chi2(&directions, &y, fit.parameters, normalization);
            assert!((fit.chi2 - plain).abs() <= 1e-10 * plain, "{} {plain}", fit.chi2);
        }
    }
}

#[test]
fn results_stay_inside_the_bounds_and_bounds_are_reported() {
    let mut random = Random(3);
    let directions = hemisphere(30.0);
    for _ in 0..200 {
        let y = awkward(&mut random, &directions, Normalization::Bousquet2005);
        let n = random.uniform(1.05, 2.0);
        let sigma = random.uniform(0.02, 0.5);
        let k = random.uniform(0.0, 0.5);
        let bounds = BandBounds {
            k_lambert: Interval::new(k, k + random.uniform(0.01, 0.5)),
            n: Interval::new(n, n + random.uniform(0.01, 2.0)),
            sigma: Interval::new(sigma, sigma + random.uniform(0.01, 0.5)),
        };
        let options =
            LeafBandsOptions { band: BandOptions { bounds, ..BandOptions::table_3() }, ..LeafBandsOptions::default() };
        let fit = fit_one(&directions, &y, &options);
        let intervals = [bounds.k_lambert, bounds.n, bounds.sigma];
        for (p, interval) in intervals.iter().enumerate() {
            let x = fit.parameters[p];
            assert!(x >= interval.lower && x <= interval.upper, "{x} {interval:?}");
            let bound = match fit.at_bound[p] {
                AtBound::Free => continue,
                AtBound::Lower => interval.lower,
                AtBound::Upper => interval.upper,
            };
            assert_eq!(x, bound);
            assert_eq!(fit.standard_errors[p], None);
            assert_eq!(fit.identifiability[p], Identifiability::Held);
            // held means: beyond the bound χ² would be lower
            let step = if fit.at_bound[p] == AtBound::Upper { 1e-4 } else { -1e-4 };
            let mut beyond = fit.parameters;
            beyond[p] += step * interval.upper;
            if let Ok(better) = std::panic::catch_unwind(|| chi2(&directions, &y, beyond, Normalization::Bousquet2005))
            {
                assert!(better < fit.chi2 * (1.0 + 1e-7), "{p} {fit:?}");
            }
        }
    }
}

/// Bounds of n and σ that a random leaf is mostly outside of.
fn small_box(random: &mut Random) -> BandBounds<f64> {
    let (n, sigma) = (random.uniform(1.05, 2.0), random.uniform(0.02, 0.5));
    BandBounds {
        n: Interval::new(n, n + random.uniform(0.01, 2.0)),
        sigma: Interval::new(sigma, sigma + random.uniform(0.01, 0.5)),
        ..BandBounds::table_3()
    }
}

/// In small boxes without noise, where the scan's corner is the minimum to the last digit: n or σ on its bound is held there.
#[test]
fn what_sits_on_a_bound_is_reported_there_in_corners_too() {
    let mut random = Random(3);
    let directions = hemisphere(30.0);
    let mut corners = 0;
    for _ in 0..2000 {
        let y = brdf(&directions, truth(&mut random), Normalization::Bousquet2005);
        let bounds = small_box(&mut random);
        let band = BandOptions { bounds, ..BandOptions::table_3() };
        let fit = fit_one(&directions, &y, &LeafBandsOptions { band, ..LeafBandsOptions::default() });
        let on = [(1, bounds.n), (2, bounds.sigma)].map(|(p, interval)| {
            let (place, inwards) = match fit.parameters[p] {
                x if x == interval.lower => (AtBound::Lower, 1e-5),
                x if x == interval.upper => (AtBound::Upper, -1e-5),
                _ => return false,
            };
            // do the data ask for a value beyond? k_L on a bound of its own makes a kink
            let mut inside = fit.parameters;
            inside[p] += inwards * (interval.upper - interval.lower);
            let beyond = chi2(&directions, &y, inside, Normalization::Bousquet2005) > fit.chi2;
            if beyond && fit.at_bound[0] == AtBound::Free {
                assert_eq!(fit.at_bound[p], place, "{p} {fit:?} {bounds:?}");
                assert_eq!(fit.standard_errors[p], None);
            }
            beyond
        });
        corners += u32::from(on == [true; 2]);
    }
    assert!(corners > 100, "{corners}");
}

#[test]
fn the_result_is_never_worse_than_a_start_of_the_callers() {
    let mut random = Random(4);
    let directions = hemisphere(40.0);
    for _ in 0..200 {
        let y = awkward(&mut random, &directions, Normalization::CookTorrance);
        let start = Start { n: random.uniform(1.1, 5.0), sigma: random.uniform(0.01, 1.0) };
        let options = LeafBandsOptions { starts: vec![start], ..options(Normalization::CookTorrance) };
        let fit = fit_one(&directions, &y, &options);
        let surface = [0.0, start.n, start.sigma];
        let lobe = brdf(&directions, surface, Normalization::CookTorrance);
        let mean = lobe.iter().zip(&y).map(|(s, y)| y - s).sum::<f64>() / y.len() as f64;
        let k = (mean * core::f64::consts::PI).clamp(0.01, 0.99);
        assert!(fit.chi2 <= chi2(&directions, &y, [k, start.n, start.sigma], Normalization::CookTorrance));
    }
}

/// Gaussian noise of known size: 68 % and 95 % of the errors lie within 1 and 2 standard errors. 1,200 trials have a sampling
/// error of 1.3 % and 0.6 %; Student's t with 38 degrees of freedom takes 0.7 % away.
#[test]
fn standard_errors_cover_the_truth_as_often_as_they_say() {
    let mut random = Random(5);
    let directions = hemisphere(40.0);
    let truth = [0.3, 1.5, 0.3];
    let exact = brdf(&directions, truth, Normalization::Bousquet2005);
    let trials = 1_200;
    let y: Vec<f64> =
        (0..trials).flat_map(|_| exact.iter().map(|y| y + 0.002 * random.normal()).collect::<Vec<_>>()).collect();
    let fits = fit(&directions, &y, &options(Normalization::Bousquet2005));
    for (p, exact) in truth.iter().enumerate() {
        let within = |errors: f64| {
            let inside = fits
                .iter()
                .flatten()
                .filter(|fit| (fit.parameters[p] - exact).abs() <= errors * fit.standard_errors[p].unwrap());
            inside.count() as f64 / f64::from(trials)
        };
        assert!((0.63..0.73).contains(&within(1.0)), "parameter {p}: {}", within(1.0));
        assert!((0.925..0.97).contains(&within(2.0)), "parameter {p}: {}", within(2.0));
    }
    // and correlations: those of the estimates over the trials
    for (pair, (p, q)) in [(0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
        let mean = |p: usize| fits.iter().flatten().map(|fit| fit.parameters[p]).sum::<f64>() / f64::from(trials);
        let product = |p: usize, q: usize| {
            fits.iter().flatten().map(|fit| (fit.parameters[p] - mean(p)) * (fit.parameters[q] - mean(q))).sum::<f64>()
        };
        let observed = product(p, q) / (product(p, p) * product(q, q)).sqrt();
        let reported =
            fits.iter().flatten().map(|fit| fit.correlations[pair].unwrap()).sum::<f64>() / f64::from(trials);
        assert!((observed - reported).abs() < 0.05, "{pair}: {observed} {reported}");
    }
}

/// A leaf whose k_L rises at the red edge, under a narrow peak.
fn glossy(directions: &[Geometry<f64>], bands: usize) -> (Vec<f64>, [f64; 2], Vec<f64>) {
    let [n, sigma] = [1.22, 0.078];
    let k_l: Vec<f64> =
        (0..bands).map(|band| 0.04 + 0.4 / (1.0 + (-(band as f64 - 0.5 * bands as f64) / 12.0).exp())).collect();
    let y = k_l.iter().flat_map(|k_l| brdf(directions, [*k_l, n, sigma], Normalization::Bousquet2005)).collect();
    (k_l, [n, sigma], y)
}

/// Shares of all bands whose parameter `p` lies within 1 and 1.96 standard errors of the truth.
fn covered<'a>(fits: impl Iterator<Item = (&'a BandFit<f64>, f64)>, p: usize) -> [f64; 2] {
    let z: Vec<f64> =
        fits.map(|(fit, truth)| (fit.parameters[p] - truth).abs() / fit.standard_errors[p].unwrap()).collect();
    [1.0, 1.96].map(|errors| z.iter().filter(|z| **z <= errors).count() as f64 / z.len() as f64)
}

/// Noise as large as the paper's RMSE, larger where more light comes from, values weighing the same (Eq. 11): 1 % and 0.003 sr⁻¹.
#[test]
fn a_noisy_peak_leaves_the_errors_of_a_leafs_bands_honest() {
    let mut random = Random(21);
    let directions: Vec<_> = [8.0, 21.0, 41.0, 60.0].into_iter().flat_map(hemisphere).collect();
    let (k_l, [n, sigma], exact) = glossy(&directions, 400);
    let mut all = Vec::new();
    for _ in 0..8 {
        let y: Vec<f64> = exact.iter().map(|y| y + (0.01 * y).hypot(0.003) * random.normal()).collect();
        all.push((fit(&directions, &y, &LeafBandsOptions::default()), y));
    }
    let bands = || all.iter().flat_map(|(fits, _)| fits.iter().flatten().zip(&k_l));
    assert!(bands().all(|(fit, _)| fit.noise == Noise::ByDirection));
    let shares =
        [0, 1, 2].map(|p| covered(bands().map(|(fit, k_l)| (fit, if p == 0 { *k_l } else { [n, sigma][p - 1] })), p));
    // 3200 bands that share sizes of noise by the hundred: ±1 %
    for (p, [one, two]) in shares.into_iter().enumerate() {
        assert!((0.60..0.76).contains(&one) && (0.90..0.98).contains(&two), "parameter {p}: {one} {two}");
    }
    // each band by itself knows no better than that all directions are alike: what this is about
    let (_, y) = &all[0];
    let alone: Vec<_> = y
        .chunks(directions.len())
        .map(|y| fit_one(&directions, y, &LeafBandsOptions::default()))
        .inspect(|fit| assert_eq!(fit.noise, Noise::Alike))
        .collect();
    let [one, two] = covered(alone.iter().map(|fit| (fit, sigma)), 2);
    assert!(one < 0.6 && two < 0.9, "{one} {two}");
}

/// A misfit that all bands share is one draw a direction, however many bands look: there an error must not shrink, nor a
/// direction that alone decides make it boundless.
#[test]
fn other_bands_make_no_error_smaller_and_none_absurd() {
    let mut random = Random(22);
    let directions = hemisphere(40.0);
    let (_, _, exact) = glossy(&directions, 60);
    for _ in 0..20 {
        let misfit: Vec<f64> = directions.iter().map(|_| 0.004 * random.normal()).collect();
        let y: Vec<f64> =
            exact.iter().zip(misfit.iter().cycle()).map(|(y, misfit)| y + misfit + 1e-5 * random.normal()).collect();
        let fits = fit(&directions, &y, &LeafBandsOptions::default());
        for (y, together) in y.chunks(directions.len()).zip(fits.iter().flatten()) {
            let alone = fit_one(&directions, y, &LeafBandsOptions::default());
            assert_eq!(together.correlations, alone.correlations);
            for p in 0..3 {
                let (Some(together), Some(alone)) = (together.standard_errors[p], alone.standard_errors[p]) else {
                    assert_eq!(together.standard_errors[p], alone.standard_errors[p]);
                    continue;
                };
                assert!((1.0..40.0).contains(&(together / alone)), "{p}: {together} {alone}");
            }
        }
    }
}

#[test]
fn few_bands_known_standard_deviations_and_a_robust_fit_keep_the_errors_of_each_band_by_itself() {
    let mut random = Random(23);
    let directions = hemisphere(40.0);
    let (_, _, exact) = glossy(&directions, 40);
    let y: Vec<f64> = exact.iter().map(|y| y + (0.01 * y).hypot(0.003) * random.normal()).collect();
    let sd: Vec<f64> = exact.iter().map(|y| (0.01 * y).hypot(0.003)).collect();
    let known = LeafBandsOptions {
        band: BandOptions { weights: Weights::Absolute, ..BandOptions::table_3() },
        ..LeafBandsOptions::default()
    };
    let robust = LeafBandsOptions { robust: true, ..LeafBandsOptions::default() };
    let width = directions.len();
    for (bands, options, sd, noise) in [
        (19, LeafBandsOptions::default(), None, Noise::Alike),
        (40, robust, None, Noise::Alike),
        (40, known, Some(&sd), Noise::Known),
        (20, LeafBandsOptions::default(), None, Noise::ByDirection),
    ] {
        let run = |bands: core::ops::Range<usize>| {
            let place = bands.start * width..bands.end * width;
            let sd = sd.map(|sd| &sd[place.clone()]);
            fit_bands(&LeafData { geometries: &directions, brdf: &y[place], sd }, &options, &|_| ()).unwrap()
        };
        for (band, together) in run(0..bands).into_iter().enumerate() {
            let (together, alone) = (together.unwrap(), run(band..band + 1)[0].unwrap());
            assert_eq!(together.noise, noise);
            assert_eq!(together.parameters, alone.parameters);
            if noise != Noise::ByDirection {
                assert_eq!(together.standard_errors, alone.standard_errors);
            }
        }
    }
}

#[test]
fn with_known_standard_deviations_the_errors_do_not_depend_on_the_residuals() {
    let directions = hemisphere(40.0);
    let exact = brdf(&directions, [0.3, 1.5, 0.3], Normalization::Bousquet2005);
    let sd = vec![0.002; exact.len()];
    let band = BandOptions { weights: Weights::Absolute, ..BandOptions::table_3() };
    let options = LeafBandsOptions { band, ..LeafBandsOptions::default() };
    let run = |y: &[f64]| {
        fit_bands(&LeafData { geometries: &directions, brdf: y, sd: Some(&sd) }, &options, &|_| ()).unwrap()[0].unwrap()
    };
    let clean = run(&exact);
    let mut random = Random(6);
    let noisy: Vec<f64> = exact.iter().map(|y| y + 0.002 * random.normal()).collect();
    let noisy = run(&noisy);
    for p in 0..3 {
        let (a, b) = (clean.standard_errors[p].unwrap(), noisy.standard_errors[p].unwrap());
        // the normal matrix moves with the parameters only: a few per cent
        assert!((a / b - 1.0).abs() < 0.1, "{a} {b}");
    }
    // χ² is in units of variances: 41 values, 3 parameters
    assert!((10.0..80.0).contains(&noisy.chi2), "{}", noisy.chi2);
}

#[test]
fn a_missing_value_is_as_if_the_direction_were_not_there() {
    let mut random = Random(7);
    let directions = hemisphere(30.0);
    let y = awkward(&mut random, &directions, Normalization::Bousquet2005);
    let holes = [3, 17, 18, 40];
    let with_holes: Vec<f64> =
        y.iter().enumerate().map(|(i, y)| if holes.contains(&i) { f64::NAN } else { *y }).collect();
    let kept: Vec<usize> = (0..y.len()).filter(|i| !holes.contains(i)).collect();
    let fewer: Vec<_> = kept.iter().map(|&i| directions[i]).collect();
    let shorter: Vec<f64> = kept.iter().map(|&i| y[i]).collect();
    let a = fit_one(&directions, &with_holes, &LeafBandsOptions::default());
    let b = fit_one(&fewer, &shorter, &LeafBandsOptions::default());
    assert_eq!((a.n_obs, b.n_obs), (37, 37));
    // the same sums in another order of lanes
    for p in 0..3 {
        assert!((a.parameters[p] / b.parameters[p] - 1.0).abs() < 1e-6, "{a:?} {b:?}");
        assert!((a.standard_errors[p].unwrap() / b.standard_errors[p].unwrap() - 1.0).abs() < 1e-6);
    }
    assert!((a.chi2 / b.chi2 - 1.0).abs() < 1e-10);
}

#[test]
fn a_value_of_twice_the_weight_counts_as_two_values() {
    let mut random = Random(8);
    let directions = hemisphere(30.0);
    let y = awkward(&mut random, &directions, Normalization::Bousquet2005);
    let sd: Vec<f64> = (0..y.len()).map(|i| if i % 3 == 0 { 0.5_f64.sqrt() } else { 1.0 }).collect();
    let weighted = fit_bands(
        &LeafData { geometries: &directions, brdf: &y, sd: Some(&sd) },
        &LeafBandsOptions::default(),
        &|_| (),
    );
    let weighted = weighted.unwrap()[0].unwrap();
    let twice = |i: usize| core::iter::repeat_n(i, if i.is_multiple_of(3) { 2 } else { 1 });
    let repeated: Vec<_> = (0..y.len()).flat_map(twice).map(|i| (directions[i], y[i])).collect();
    let (directions, y): (Vec<_>, Vec<_>) = repeated.into_iter().unzip();
    let repeated = fit_one(&directions, &y, &LeafBandsOptions::default());
    for p in 0..3 {
        assert!((weighted.parameters[p] / repeated.parameters[p] - 1.0).abs() < 1e-6);
    }
    assert!((weighted.chi2 / repeated.chi2 - 1.0).abs() < 1e-10);
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let mut random = Random(9);
    let directions = hemisphere(40.0);
    let y: Vec<f64> = (0..150).flat_map(|_| awkward(&mut random, &directions, Normalization::Bousquet2005)).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| fit(&directions, &y, &LeafBandsOptions::default()))
    };
    for (a, b) in run(1).iter().zip(run(5)) {
        let (a, b) = (a.unwrap(), b.unwrap());
        assert_eq!(a.parameters.map(f64::to_bits), b.parameters.map(f64::to_bits));
        assert_eq!((a.chi2.to_bits(), a.iterations), (b.chi2.to_bits(), b.iterations));
        assert_eq!(a.standard_errors, b.standard_errors);
    }
}

#[test]
fn what_the_directions_cannot_tell_is_said() {
    // Only the nadir: k_L and the lobe cannot be told apart. A repeated direction adds no information.
    let nadir = vec![geometry(0.0, 0.0, 0.0); 5];
    let y = [0.1, 0.1001, 0.0999, 0.1, 0.1];
    let fit = fit_one(&nadir, &y, &LeafBandsOptions::default());
    assert!(
        fit.identifiability.iter().any(|i| matches!(i, Identifiability::NotIdentifiable | Identifiability::Held)),
        "{fit:?}"
    );
    assert!(fit.standard_errors.iter().any(Option::is_none));

    // As many values as parameters: no residual is left to estimate errors from.
    let three = [geometry(30.0, 30.0, 180.0), geometry(30.0, 50.0, 180.0), geometry(30.0, 20.0, 0.0)];
    let y = brdf(&three, [0.2, 1.5, 0.3], Normalization::Bousquet2005);
    let fit = fit_one(&three, &y, &LeafBandsOptions::default());
    assert_eq!(fit.standard_errors, [None; 3]);
    assert!(fit.identifiability.contains(&Identifiability::NoDegreesOfFreedom), "{fit:?}");

    // Fewer values than parameters: no fit at all.
    assert!(super_few(&[f64::NAN, 0.1, 0.2]).is_none());
    assert!(super_few(&[f64::NAN; 3]).is_none());
}

fn super_few(y: &[f64]) -> Option<BandFit<f64>> {
    let three = [geometry(30.0, 30.0, 180.0), geometry(30.0, 50.0, 180.0), geometry(30.0, 20.0, 0.0)];
    fit(&three, y, &LeafBandsOptions::default())[0]
}

#[test]
fn a_lambertian_leaf_has_no_roughness() {
    let directions = hemisphere(30.0);
    let mut random = Random(10);
    let y: Vec<f64> = directions.iter().map(|_| 0.1 + 1e-4 * random.normal()).collect();
    let fit = fit_one(&directions, &y, &LeafBandsOptions::default());
    // the weakest lobe allowed is still there: n at its lower bound, and k_L short of 0.1 π by what that lobe reflects
    assert_eq!(fit.at_bound[1], AtBound::Lower, "{fit:?}");
    assert!((fit.parameters[0] - 0.1 * core::f64::consts::PI).abs() < 0.01);
}

#[test]
fn one_wild_value_moves_a_robust_fit_less() {
    let directions = hemisphere(40.0);
    let truth = [0.3, 1.5, 0.3];
    let mut random = Random(11);
    let mut y: Vec<f64> =
        brdf(&directions, truth, Normalization::Bousquet2005).iter().map(|y| y + 0.001 * random.normal()).collect();
    y[12] += 0.1;
    let plain = fit_one(&directions, &y, &LeafBandsOptions::default());
    let robust = fit_one(&directions, &y, &LeafBandsOptions { robust: true, ..LeafBandsOptions::default() });
    for (p, exact) in truth.iter().enumerate() {
        let error = |fit: &BandFit<f64>| (fit.parameters[p] - exact).abs();
        assert!(error(&robust) < 0.25 * error(&plain), "{p}: {robust:?} {plain:?}");
    }
    // least squares is what χ² measures: the robust fit cannot have less of it
    assert!(robust.chi2 >= plain.chi2);
}

#[test]
fn input_that_no_fit_can_start_from_is_an_error_that_names_the_place() {
    let directions = hemisphere(30.0);
    let y = brdf(&directions, [0.3, 1.5, 0.3], Normalization::Bousquet2005);
    let run = |y: &[f64], sd: Option<&[f64]>, options: &LeafBandsOptions| {
        fit_bands(&LeafData { geometries: &directions, brdf: y, sd }, options, &|_| ()).unwrap_err()
    };
    let default = LeafBandsOptions::default();
    assert!(matches!(run(&y[..40], None, &default), FitError::Length { what: "brdf", found: 40, expected: 41 }));
    assert!(matches!(run(&y, Some(&y[..3]), &default), FitError::Length { what: "sd", found: 3, .. }));
    let mut infinite = y.clone();
    infinite[7] = f64::INFINITY;
    assert!(matches!(run(&infinite, None, &default), FitError::NotFinite { what: "brdf", index: 7 }));
    let mut sd = vec![1.0; y.len()];
    sd[5] = 0.0;
    assert!(matches!(run(&y, Some(&sd), &default), FitError::NotFinite { index: 5, .. }));
    for (bounds, name) in [
        (BandBounds { n: Interval::new(2.0, 1.5), ..BandBounds::table_3() }, "n"),
        (BandBounds { n: Interval::new(0.5, 1.5), ..BandBounds::table_3() }, "n"),
        (BandBounds { sigma: Interval::new(0.0, 1.0), ..BandBounds::table_3() }, "sigma"),
        (BandBounds { sigma: Interval::new(f64::NAN, 1.0), ..BandBounds::table_3() }, "sigma"),
        (BandBounds { k_lambert: Interval::new(0.5, 0.5), ..BandBounds::table_3() }, "k_l"),
    ] {
        let options = LeafBandsOptions { band: BandOptions { bounds, ..BandOptions::table_3() }, ..default.clone() };
        match run(&y, None, &options) {
            FitError::Bounds { parameter, .. } => assert_eq!(parameter, name),
            other => panic!("{other}"),
        }
    }
}

/// The standard errors come from exact derivatives; here the same matrix from differences of the model.
#[test]
fn standard_errors_are_those_of_a_differenced_jacobian() {
    let mut random = Random(12);
    let directions = hemisphere(40.0);
    let y: Vec<f64> = brdf(&directions, [0.3, 1.5, 0.3], Normalization::CookTorrance)
        .iter()
        .map(|y| y + 0.002 * random.normal())
        .collect();
    let fit = fit_one(&directions, &y, &options(Normalization::CookTorrance));
    let step = 1e-5;
    let columns: Vec<Vec<f64>> = (0..3)
        .map(|p| {
            let shifted = |sign: f64| {
                let mut parameters = fit.parameters;
                parameters[p] += sign * step;
                brdf(&directions, parameters, Normalization::CookTorrance)
            };
            shifted(1.0).iter().zip(shifted(-1.0)).map(|(up, down)| (up - down) / (2.0 * step)).collect()
        })
        .collect();
    let m = |p: usize, q: usize| columns[p].iter().zip(&columns[q]).map(|(a, b)| a * b).sum::<f64>();
    let minor = |a: usize, b: usize, c: usize, d: usize| m(a, c) * m(b, d) - m(a, d) * m(b, c);
    let determinant = m(0, 0) * minor(1, 2, 1, 2) - m(0, 1) * minor(1, 2, 0, 2) + m(0, 2) * minor(1, 2, 0, 1);
    let cofactors = [minor(1, 2, 1, 2), minor(0, 2, 0, 2), minor(0, 1, 0, 1)];
    for (p, cofactor) in cofactors.iter().enumerate() {
        let expected = (fit.chi2 / 38.0 * cofactor / determinant).sqrt();
        // differences with step 1e-5: 1e-8 relative, times the condition of the matrix
        assert!((fit.standard_errors[p].unwrap() / expected - 1.0).abs() < 1e-5, "{p}");
    }
    assert!(Dielectric::new(fit.parameters[1]).is_ok());
}

/// The least cost inside a small box is a least one along each of its edges: where n or σ is held, letting it go lowers nothing.
#[test]
fn nothing_is_held_on_a_bound_that_the_data_do_not_press_it_against() {
    let directions = hemisphere(30.0);
    let mut random = Random(6);
    let mut held = 0;
    for _ in 0..6000 {
        let y = brdf(&directions, truth(&mut random), Normalization::Bousquet2005);
        let bounds = small_box(&mut random);
        let band = BandOptions { bounds, ..BandOptions::table_3() };
        let fit = fit_one(&directions, &y, &LeafBandsOptions { band, ..LeafBandsOptions::default() });
        for (p, interval) in [(1, bounds.n), (2, bounds.sigma)] {
            let width = interval.upper - interval.lower;
            let near = (fit.parameters[p] - interval.lower).min(interval.upper - fit.parameters[p]) < 1e-4 * width;
            held += u32::from(near);
            let inwards = if fit.parameters[p] - interval.lower < 0.5 * width { width } else { -width };
            for share in [1e-3, 1e-2] {
                let mut moved = fit.parameters;
                moved[p] += share * inwards;
                let lobe = brdf(&directions, [0.0, moved[1], moved[2]], Normalization::Bousquet2005);
                let rest = lobe.iter().zip(&y).map(|(s, y)| y - s).sum::<f64>() / y.len() as f64;
                moved[0] = (core::f64::consts::PI * rest).clamp(0.01, 0.99);
                let there = chi2(&directions, &y, moved, Normalization::Bousquet2005);
                // 1e-6 of χ²: what the search promises
                assert!(!near || there > fit.chi2 * (1.0 - 1e-6), "{p} {share} {fit:?} {bounds:?}: {there}");
            }
        }
    }
    assert!(held > 5000, "{held}");
}
