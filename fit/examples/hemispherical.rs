//! What inversions of PROSPECT recover: counts, errors, time. `cargo run --release -p leafbrdf-fit --example hemispherical [LEAVES]`
//!
//! Random leaves of `tests/common/leaves.rs`, 400–2500 nm at 1 nm, always the same ones.

#[path = "../tests/common/leaves.rs"]
mod leaves;
#[path = "../tests/common/random.rs"]
mod random;

use std::time::Instant;

use leafbrdf_fit::hemispherical::{
    HemisphericalProblem, LeafFit, LeafFitOptions, Measured, Spectra, default_free, fit_leaf, n_prior,
};
use leafbrdf_fit::{Identifiability, Interval};
use leafbrdf_prospect::{LeafParams, Parameter, Prospect, Version, table};
use leaves::random_leaf;
use random::Random;

struct Simulated {
    leaf: LeafParams<f64>,
    reflectance: Vec<f64>,
    transmittance: Vec<f64>,
}

fn simulate(version: Version, leaves: usize, noise: f64) -> Vec<Simulated> {
    let model = Prospect::new(table::full(version));
    let mut random = Random(2005);
    let mut errors = Random(1990);
    (0..leaves)
        .map(|_| {
            let leaf = random_leaf(&mut random, version);
            let (mut reflectance, mut transmittance) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
            model.spectrum(&leaf, &mut reflectance, &mut transmittance).expect("a possible leaf");
            for value in reflectance.iter_mut().chain(&mut transmittance) {
                *value += noise * errors.normal();
            }
            Simulated { leaf, reflectance, transmittance }
        })
        .collect()
}

fn invert(version: Version, one: &Simulated, use_r: bool, use_t: bool, options: &LeafFitOptions) -> LeafFit {
    invert_to(version, one, table::LAST_NM, use_r, use_t, options)
}

/// The same from the bands up to `last_nm`.
fn invert_to(
    version: Version,
    one: &Simulated,
    last_nm: u16,
    use_r: bool,
    use_t: bool,
    options: &LeafFitOptions,
) -> LeafFit {
    let bands = 0..usize::from(last_nm - table::FIRST_NM) + 1;
    let measured = |values| Some(Measured { values, weights: None });
    let problem = HemisphericalProblem {
        model: Prospect::new(table::full(version).bands(bands.clone()).expect("bands of the table")),
        spectra: Spectra {
            reflectance: measured(&one.reflectance[bands.clone()]).filter(|_| use_r),
            transmittance: measured(&one.transmittance[bands.clone()]).filter(|_| use_t),
        },
        held: LeafParams::with_n_struct(1.5),
    };
    fit_leaf(&problem, options).expect("a problem that can be set up")
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn main() {
    let leaves: usize = std::env::args().nth(1).and_then(|count| count.parse().ok()).unwrap_or(1000);

    println!("## noise-free, every parameter free, {leaves} leaves");
    println!("version data  recovered_1e-6 worst  agreeing_starts iterations_a_start ms_a_spectrum");
    for version in [Version::P5B, Version::D, Version::Pro] {
        let simulated = simulate(version, leaves, 0.0);
        let options = LeafFitOptions::new(&default_free(version));
        for (name, use_r, use_t) in [("R+T", true, true), ("R", true, false), ("T", false, true)] {
            let clock = Instant::now();
            let fits: Vec<LeafFit> = simulated.iter().map(|one| invert(version, one, use_r, use_t, &options)).collect();
            let time = clock.elapsed().as_secs_f64() * 1e3 / leaves as f64;
            // error in units of the parameter's interval
            let error = |one: &Simulated, fit: &LeafFit| {
                let scaled = options.free.iter().map(|free| {
                    let (truth, found) = (one.leaf.get(free.parameter), fit.leaf.get(free.parameter));
                    (truth - found).abs() / (free.bounds.upper - free.bounds.lower)
                });
                scaled.fold(0.0, f64::max)
            };
            let errors: Vec<f64> = simulated.iter().zip(&fits).map(|(one, fit)| error(one, fit)).collect();
            let starts: u32 = fits.iter().map(|fit| fit.starts).sum();
            println!(
                "{:7} {name:4}  {:6}/{leaves}  {:.1e}  {:.3}  {:.1}  {time:.2}",
                version.name(),
                errors.iter().filter(|error| **error < 1e-6).count(),
                errors.iter().copied().fold(0.0, f64::max),
                f64::from(fits.iter().map(|fit| fit.agreeing).sum::<u32>()) / f64::from(starts),
                f64::from(fits.iter().map(|fit| fit.iterations).sum::<u32>()) / f64::from(starts),
            );
            let unknown: Vec<String> = options
                .free
                .iter()
                .enumerate()
                .map(|(i, free)| {
                    let count =
                        fits.iter().filter(|f| f.estimates[i].identifiability == Identifiability::NotIdentifiable);
                    format!("{} {}", free.parameter.name(), count.count())
                })
                .collect();
            println!("        not identifiable: {}", unknown.join(", "));
        }
    }

    let noise = 0.005;
    println!(
        "## white noise of {noise}, every parameter free: median standard error, median |error|, share within 1 and 2 standard errors"
    );
    for version in [Version::P5B, Version::D, Version::Pro] {
        let simulated = simulate(version, leaves, noise);
        let options = LeafFitOptions::new(&default_free(version));
        for (name, use_r, use_t) in [("R+T", true, true), ("R", true, false)] {
            let clock = Instant::now();
            let fits: Vec<LeafFit> = simulated.iter().map(|one| invert(version, one, use_r, use_t, &options)).collect();
            let time = clock.elapsed().as_secs_f64() * 1e3 / leaves as f64;
            for (i, free) in options.free.iter().enumerate() {
                let pairs: Vec<(f64, f64)> = simulated
                    .iter()
                    .zip(&fits)
                    .filter_map(|(one, fit)| {
                        let error = (fit.estimates[i].value - one.leaf.get(free.parameter)).abs();
                        Some((error, fit.estimates[i].standard_error?))
                    })
                    .collect();
                let within = |k: f64| {
                    pairs.iter().filter(|(error, se)| *error <= k * se).count() as f64 / pairs.len().max(1) as f64
                };
                println!(
                    "{:4} {name:4} {:9} n {:4}  se {:.3e}  error {:.3e}  {:.3}  {:.3}",
                    version.name(),
                    free.parameter.name(),
                    pairs.len(),
                    median(pairs.iter().map(|(_, se)| *se).collect()),
                    median(pairs.iter().map(|(error, _)| *error).collect()),
                    within(1.0),
                    within(2.0),
                );
            }
            println!(
                "     n_effective/n_obs {:.3}, iterations a start {:.1}, {time:.2} ms a spectrum",
                median(fits.iter().map(|f| f.n_effective / f.n_obs as f64).collect()),
                median(fits.iter().map(|f| f64::from(f.iterations) / f64::from(f.starts)).collect())
            );
        }
    }

    println!(
        "## what reflectance alone tells, PROSPECT-D, white noise of {noise}: not identifiable / at a bound, median standard error"
    );
    let simulated = simulate(Version::D, leaves, noise);
    let options = LeafFitOptions::new(&default_free(Version::D));
    for (last_nm, use_t) in [(2500, true), (2500, false), (1000, true), (1000, false), (700, true), (700, false)] {
        let fits: Vec<LeafFit> =
            simulated.iter().map(|one| invert_to(Version::D, one, last_nm, true, use_t, &options)).collect();
        let cells: Vec<String> = options
            .free
            .iter()
            .enumerate()
            .map(|(i, free)| {
                let count = |what| fits.iter().filter(|fit| fit.estimates[i].identifiability == what).count();
                let error = median(fits.iter().filter_map(|fit| fit.estimates[i].standard_error).collect());
                let (unknown, held) = (count(Identifiability::NotIdentifiable), count(Identifiability::Held));
                format!("{} {unknown}/{held} {error:.1e}", free.parameter.name())
            })
            .collect();
        let cm = options.free.iter().position(|free| free.parameter == Parameter::Cm).expect("cm is free");
        let lean = median(fits.iter().filter_map(|fit| fit.estimates[0].correlations[cm]).collect());
        let data = if use_t { "R+T" } else { "R" };
        println!("400-{last_nm} nm {data:4} {}; correlation of N and cm {lean:.2}", cells.join(", "));
    }

    println!(
        "## reflectance (and transmittance) 2 % too bright, PROSPECT-D, no noise: median change of each parameter"
    );
    let mut bright = simulate(Version::D, leaves, 0.0);
    for value in bright.iter_mut().flat_map(|one| one.reflectance.iter_mut().chain(&mut one.transmittance)) {
        *value *= 1.02;
    }
    for (data, use_t) in [("R+T", true), ("R", false)] {
        let fits: Vec<LeafFit> = bright.iter().map(|one| invert(Version::D, one, true, use_t, &options)).collect();
        let changes = options.free.iter().map(|free| {
            let change = |(one, fit): (&Simulated, &LeafFit)| {
                (fit.leaf.get(free.parameter) / one.leaf.get(free.parameter) - 1.0) * 100.0
            };
            format!("{} {:+.1} %", free.parameter.name(), median(bright.iter().zip(&fits).map(change).collect()))
        });
        println!("{data:4} {}", changes.collect::<Vec<_>>().join(", "));
    }

    println!(
        "## N from reflectance alone (n_prior), water and dry matter of an ordinary leaf times 2 to a normal number"
    );
    let model = Prospect::new(table::full(Version::D));
    let mut random = Random(1131);
    let errors: Vec<(f64, f64)> = (0..leaves)
        .map(|_| {
            let leaf = LeafParams {
                cab: random.uniform(2.0, 90.0),
                cw: (0.012 * random.normal().exp2()).min(0.5),
                cm: (0.0065 * random.normal().exp2()).min(0.1),
                ..LeafParams::with_n_struct(random.uniform(1.0, 3.0))
            };
            let (mut reflectance, mut transmittance) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
            model.spectrum(&leaf, &mut reflectance, &mut transmittance).expect("a possible leaf");
            let prior = n_prior(&model, &reflectance, Interval::new(1.0, 5.0)).expect("a plateau");
            (prior.n_struct - leaf.n_struct, prior.standard_deviation)
        })
        .collect();
    println!(
        "bias {:.3}, rms {:.3}, median |error| {:.3}, within 1 standard deviation {:.3}",
        errors.iter().map(|(e, _)| e).sum::<f64>() / leaves as f64,
        (errors.iter().map(|(e, _)| e * e).sum::<f64>() / leaves as f64).sqrt(),
        median(errors.iter().map(|(e, _)| e.abs()).collect()),
        errors.iter().filter(|(e, sd)| e.abs() <= *sd).count() as f64 / leaves as f64
    );
}
