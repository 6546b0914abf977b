//! One band and one leaf (400 bands × 41 and × 260 directions), one thread, global optimum, errors included.
//! Run with `cargo bench -p leafbrdf-fit --bench bands`. Beside it, in the same session, for SciPy:
//! `python fit/benches/exhaustive.py check` (see its docstring).

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use leafbrdf_core::{Angle, Geometry, Leaf, Surface};
use leafbrdf_fit::{LeafBandsOptions, LeafData, fit_bands};

/// `views` directions at each θ_s.
fn directions(sources: &[f64], views: usize) -> Vec<Geometry<f64>> {
    let deg = Angle::from_degrees;
    let mut all = Vec::new();
    for theta_s in sources {
        for i in 0..views {
            let (ring, azimuth) = (i % 7, i / 7);
            let (theta_v, phi_v) = (10.0 * ring as f64, 180.0 * azimuth as f64 / (views / 7).max(1) as f64);
            all.push(
                Geometry::from_angles(deg(*theta_s), deg(theta_v), deg(phi_v.min(360.0))).expect("above the horizon"),
            );
        }
    }
    all
}

/// A leaf whose k_L rises at the red edge, with a small deterministic misfit, band by band.
fn leaf(geometries: &[Geometry<f64>], bands: usize) -> Vec<f64> {
    let mut brdf = Vec::new();
    for band in 0..bands {
        let k_l = 0.04 + 0.4 / (1.0 + (-(band as f64 - 220.0) / 12.0).exp());
        let leaf = Leaf::new(k_l, Surface::new(1.5, 0.25).expect("in the domain")).expect("in [0, 1]");
        brdf.extend(
            geometries.iter().enumerate().map(|(i, g)| leaf.brdf(g) + 0.003 * (((i * 37 + band) as f64).sin())),
        );
    }
    brdf
}

fn benches(c: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let options = LeafBandsOptions::default();
    for (name, sources, views) in [("41 directions", &[40.0][..], 41), ("260 directions", &[8.0, 21.0, 41.0, 60.0], 65)]
    {
        let geometries = directions(sources, views);
        for (bands, what) in [(1, "one band"), (400, "one leaf of 400 bands")] {
            let brdf = leaf(&geometries, bands);
            c.bench_function(&format!("{what}, {name}"), |b| {
                one_thread.install(|| {
                    b.iter(|| {
                        let data = LeafData { geometries: &geometries, brdf: black_box(&brdf), sd: None };
                        fit_bands(&data, &options, &|_| ()).expect("valid data")
                    });
                });
            });
        }
    }
}

criterion_group!(group, benches);
criterion_main!(group);
