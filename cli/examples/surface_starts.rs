//! Is the default fit of a surface the global optimum? Every leaf is fitted as by default, and again from random starts in the
//! whole box; nothing may be better than the default by more than 0.1 %.
//!
//! ```sh
//! cargo run --release -p leafbrdf --example surface_starts -- 200 leaves/*.csv
//! ```
//!
//! Prints aggregate figures for each kind of surface: the worst ratio of the default's cost to the best known, how many leaves
//! lie above it by more than 0.1 %, which share of the random starts ends within 0.1 % of the best, and the time of a default fit.

use std::path::Path;
use std::time::Instant;

use leafbrdf::fit::{Selected, Selection};
use leafbrdf::measurement::{ReadOptions, read_path};
use leafbrdf_core::Normalization;
use leafbrdf_fit::surface::{
    LeafModel, PARAMETERS, Place, Profile, SearchOptions, Spectra, SurfaceData, SurfaceOptions, Treatment, fit_surface,
    polish,
};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let starts: usize = arguments.next().and_then(|n| n.parse().ok()).expect("usage: surface_starts STARTS FILE…");
    let selection = Selection { wavelengths: "480:879".parse().ok(), ..Selection::default() };
    let leaves: Vec<Selected> = arguments
        .flat_map(|file| read_path(Path::new(&file), &ReadOptions::default()).expect("a measurement file"))
        .map(|leaf| Selected::new(&leaf, &selection).expect("bands between 480 and 879 nm"))
        .collect();

    println!("surface                            leaves  worst ratio  above 0.1 %  starts within 0.1 %  ms a leaf");
    for kind in 0..12 {
        let mut options = SurfaceOptions::paper();
        if kind >= 8 {
            options = options.with_ggx();
        } else if kind >= 4 {
            options.normalization = Normalization::CookTorrance;
        }
        if kind & 1 > 0 {
            options = options.with_p1();
        }
        if kind & 2 > 0 {
            options = options.with_tilt();
        }
        let (mut worst, mut above, mut good, mut tried, mut seconds) = (0.0_f64, 0, 0, 0, 0.0);
        let mut seed = 1_u64;
        for leaf in &leaves {
            let clock = Instant::now();
            let data = SurfaceData { directions: &leaf.vectors, brdf: &leaf.brdf, sd: None };
            let fit = fit_surface(&data, &options).expect("a fit");
            seconds += clock.elapsed().as_secs_f64();
            let default = fit.valleys.best().expect("a valley").cost;
            let costs = random_starts(leaf, &options, fit.parameters, fit.draws, starts, &mut seed);
            let best = costs.iter().copied().fold(default, f64::min);
            worst = worst.max(default / best);
            above += usize::from(default > 1.001 * best);
            good += costs.iter().filter(|cost| **cost <= 1.001 * best).count();
            tried += costs.len();
        }
        println!(
            "{:<8} {:<7} {:<13} {:<5} {:6}  {:11.7}  {:11}  {:18.1}%  {:9.2}",
            options.facets.name(),
            options.diffuse.name(),
            options.normalization.name(),
            if kind & 2 > 0 { "tilt" } else { "level" },
            leaves.len(),
            worst,
            above,
            100.0 * good as f64 / tried.max(1) as f64,
            1e3 * seconds / leaves.len() as f64,
        );
    }
}

/// Costs where searches from random starts end.
fn random_starts(
    leaf: &Selected,
    options: &SurfaceOptions,
    parameters: [Treatment<f64>; PARAMETERS],
    draws: f64,
    starts: usize,
    seed: &mut u64,
) -> Vec<f64> {
    let spectra = Spectra::new(leaf.vectors.len(), &leaf.brdf, None).expect("rows");
    let model = LeafModel {
        directions: &leaf.vectors,
        facets: options.facets,
        diffuse: options.diffuse,
        normalization: options.normalization,
    };
    let search = SearchOptions {
        parameters,
        draws,
        tolerance: options.tolerance,
        max_iterations: 300,
        scan: options.scan,
        valleys: options.valleys,
    };
    let mut places = vec![Place::empty(); leaf.vectors.len()];
    spectra.moments(|moments| {
        let mut profile = Profile::new(&model, moments, &mut places).expect("a place a direction");
        (0..starts)
            .map(|_| {
                let start = parameters.map(|one| match one {
                    Treatment::Held(value) => value,
                    Treatment::Free { bounds, .. } => bounds.lower + uniform(seed) * (bounds.upper - bounds.lower),
                });
                polish(&mut profile, &search, &start).cost
            })
            .collect()
    })
}

/// Uniform in [0, 1) (splitmix64, Steele et al. 2014).
fn uniform(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *seed;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}
