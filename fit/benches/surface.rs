//! One surface for a whole leaf, global optimum, errors and every k_L included, one thread.
//! Run with `cargo bench -p leafbrdf-fit --bench surface`.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use leafbrdf_core::{Angle, DirectionVectors};
use leafbrdf_fit::surface::{DirectionalModel, LeafModel, SurfaceData, SurfaceOptions, fit_surface};

fn direction(theta_s: f64, theta_v: f64, phi_v: f64) -> DirectionVectors<f64> {
    let deg = Angle::from_degrees;
    DirectionVectors::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).expect("above the horizon")
}

/// `azimuths` × θ_v 10–60°, and nadir.
fn directions(azimuths: &[f64]) -> Vec<DirectionVectors<f64>> {
    let views = azimuths.iter().flat_map(|phi| (1..=6).map(|ring| direction(40.0, 10.0 * f64::from(ring), *phi)));
    std::iter::once(direction(40.0, 0.0, 0.0)).chain(views).collect()
}

/// A leaf whose k_L rises at the red edge, with a misfit common to all bands.
fn leaf(directions: &[DirectionVectors<f64>], bands: usize) -> Vec<f64> {
    let options = SurfaceOptions::paper().with_ggx().with_p1();
    let model = LeafModel {
        directions,
        facets: options.facets,
        diffuse: options.diffuse,
        normalization: options.normalization,
    };
    let mut values = Vec::new();
    model.values(&[1.48, 0.22, 0.15, -0.05, 0.02, 0.0, 0.0], |value| values.push(value)).expect("in the domain");
    let mut brdf = Vec::new();
    for band in 0..bands {
        let k_l = 0.04 + 0.4 / (1.0 + (-(band as f64 - 220.0) / 12.0).exp());
        brdf.extend(values.iter().enumerate().map(|(i, [s, p])| k_l * s + p + 0.003 * ((i * 37) as f64).sin()));
    }
    brdf
}

fn benches(c: &mut Criterion) {
    for (azimuths, bands) in [(&[0.0, 180.0][..], 2101), (&[0.0, 30.0, 60.0, 90.0, 120.0, 150.0, 180.0], 400)] {
        let directions = directions(azimuths);
        let brdf = leaf(&directions, bands);
        let data = SurfaceData { directions: &directions, brdf: &brdf, sd: None };
        for (name, options) in [
            ("paper", SurfaceOptions::paper()),
            ("tilt", SurfaceOptions::paper().with_tilt()),
            ("ggx, p1, tilt", SurfaceOptions::paper().with_ggx().with_p1().with_tilt()),
        ] {
            c.bench_function(&format!("surface: {} x {bands}, {name}", directions.len()), |b| {
                b.iter(|| fit_surface(black_box(&data), &options).expect("a fit"));
            });
        }
    }
}

criterion_group!(surface, benches);
criterion_main!(surface);
