//! Noisy copies of the paper's leaves: their parameters come back, and the standard errors are honest.
//!
//! Few seeds, so that it takes seconds; `cargo run --release -p leafbrdf --example recovery -- 200` is the study.

use leafbrdf::recovery::{Conditions, Estimator, Recovery, recover};
use leafbrdf::simulate::presets;

fn all(estimator: Estimator, with_sd: bool, seeds: u64) -> Vec<Recovery> {
    let conditions = Conditions { with_sd, ..Conditions::PAPER };
    presets().iter().map(|preset| recover(preset, estimator, conditions, 1..seeds + 1).unwrap()).collect()
}

/// Share of all (leaf, seed, parameter) within `errors` standard errors, and how many there are.
fn within(recoveries: &[Recovery], errors: usize) -> (f64, f64) {
    let scores = || recoveries.iter().flat_map(|recovery| &recovery.scores);
    let count: f64 = scores().map(|score| score.seeds as f64).sum();
    (scores().map(|score| score.within[errors - 1] * score.seeds as f64).sum::<f64>() / count, count)
}

#[test]
fn one_surface_is_recovered_with_honest_standard_errors() {
    // equal weights, as in Eq. 11, too: the views of a peak are noisier than the rest, and the errors have to know
    for with_sd in [true, false] {
        let recoveries = all(Estimator::Surface, with_sd, 20);
        // binomial: 68.3 % and 95.4 % of 120, four standard deviations (n and σ of a leaf are correlated)
        for (errors, expected) in [(1, 0.683_f64), (2, 0.954)] {
            let (share, count) = within(&recoveries, errors);
            assert_eq!(count, 120.0);
            let sd = (expected * (1.0 - expected) / count).sqrt();
            assert!((share - expected).abs() < 4.0 * sd, "{with_sd} {errors}: {share}");
        }
        for recovery in &recoveries {
            for score in &recovery.scores {
                // a mean of 20 within four of its own standard errors: no bias
                assert!((score.mean - score.truth).abs() < 4.0 * score.rms_se / 20_f64.sqrt(), "{score:?}");
            }
            // 0.0006 is one standard error of k_L: 24,000 values stay within five
            let k_l = &recovery.k_lambert;
            assert!(k_l.worst < 0.0035 && k_l.within_3_thousandths > 0.9999, "{recovery:?}");
        }
    }
}

/// Two views see laurel's peak, and with equal weights the others cannot tell how noisy these are: other bands can.
#[test]
fn errors_of_a_narrow_noisy_peak_are_as_large_as_what_they_stand_for() {
    let laurel = &presets()[0];
    for estimator in [Estimator::Bands, Estimator::Joint] {
        let recovery = recover(laurel, estimator, Conditions::PAPER, 1..61).unwrap();
        for parameter in ["n", "sigma"] {
            let score = recovery.score(parameter).unwrap();
            // the mean of 60 squares of a standard normal number: 1 ± 0.18
            let square = (score.rms_error / score.rms_se).powi(2);
            assert!((square - 1.0).abs() < 3.0 * 0.18, "{estimator:?} {parameter}: {square}");
        }
    }
}

#[test]
fn five_parameters_at_once_give_chlorophyll_within_2_micrograms() {
    for recovery in all(Estimator::Joint, true, 5) {
        let chlorophyll = recovery.score("cab").unwrap();
        assert_eq!(chlorophyll.seeds, 5);
        assert!(chlorophyll.worst < 2.0 && chlorophyll.rms_error < 3.0 * chlorophyll.rms_se, "{chlorophyll:?}");
        // five parameters leave k_L no freedom to follow noise: a tenth of what a band alone gives
        assert!(recovery.k_lambert.worst < 0.0015, "{:?}", recovery.k_lambert);
        let surface = recovery.scores.iter().take(2);
        assert!(surface.clone().all(|score| score.worst < 4.0 * score.rms_se), "{recovery:?}");
    }
}
