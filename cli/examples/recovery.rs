//! Are n, σ, k_L and the leaf's contents found again, and are the standard errors honest?
//!
//! ```sh
//! cargo run --release -p leafbrdf --example recovery -- 200
//! ```
//!
//! Three leaves, as many seeds as asked for (20 without), four estimators; equal weights as in Eq. 11, then weights by the
//! standard deviations of the noise.

use std::error::Error;

use leafbrdf::recovery::{Conditions, Estimator, Recovery, recover};
use leafbrdf::simulate::presets;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(Ok(20), |text| text.parse())?;
    let asked = arguments.next();
    for with_sd in [false, true] {
        let conditions = Conditions { with_sd, ..Conditions::PAPER };
        let weights = if with_sd { "1/sd^2" } else { "equal" };
        println!("\n{seeds} seeds, noise 1 % and 0.003 sr^-1, weights {weights}");
        println!(
            "{:<7} {:<9} {:<9} {:>9} {:>11} {:>10} {:>10} {:>6} {:>6}",
            "leaf", "model", "parameter", "truth", "mean", "rms error", "s.e.", "1 s.e.", "2 s.e."
        );
        for preset in presets() {
            for estimator in Estimator::ALL {
                if asked.as_deref().is_some_and(|name| name != estimator.name()) {
                    continue;
                }
                let time = std::time::Instant::now();
                print(preset.name, &recover(&preset, estimator, conditions, 1..seeds + 1)?);
                eprintln!(
                    "{} {}: {:.0} ms a fit",
                    preset.name,
                    estimator.name(),
                    1e3 * time.elapsed().as_secs_f64() / seeds as f64
                );
            }
        }
    }
    Ok(())
}

fn print(leaf: &str, recovery: &Recovery) {
    let model = recovery.estimator.name();
    for s in &recovery.scores {
        let [one, two] = s.within.map(|share| 100.0 * share);
        println!(
            "{leaf:<7} {model:<9} {:<9} {:>9} {:>11.6} {:>10.2e} {:>10.2e} {one:>5.1}% {two:>5.1}%",
            s.parameter, s.truth, s.mean, s.rms_error, s.rms_se
        );
    }
    let k = &recovery.k_lambert;
    let [one, two] = k.within.map(|share| 100.0 * share);
    println!(
        "{leaf:<7} {model:<9} {:<9} {:>9} {:>11} {:>10.2e} {:>10} {one:>5.1}% {two:>5.1}%   worst {:.5}, within 0.003: {:.3} %",
        "k_l",
        "",
        "",
        k.rms_error,
        "",
        k.worst,
        100.0 * k.within_3_thousandths
    );
}
