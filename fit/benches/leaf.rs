//! A whole leaf inverted: 12 directions × 2101 bands, one thread, each method with its defaults.

use criterion::{Criterion, criterion_group, criterion_main};
use leafbrdf_core::{Angle, DirectionVectors, Geometry, Surface};
use leafbrdf_fit::leaf::{DirectionalData, LeafOptions, Method, SurfaceFrom, fit};
use leafbrdf_prospect::{CoupledLeaf, Coupling, LeafParams, Prospect, Version, table};

fn leaf(criterion: &mut Criterion) {
    let deg = Angle::from_degrees;
    let views = [60.0, 50.0, 40.0, 30.0, 20.0, 10.0, 0.0, -10.0, -20.0, -40.0, -50.0, -60.0_f64];
    let of = |theta_v: f64| (deg(30.0), deg(theta_v.abs()), deg(if theta_v > 0.0 { 180.0 } else { 0.0 }));
    let directions: Vec<_> = views
        .iter()
        .map(|theta_v| {
            let (theta_s, theta_v, phi_v) = of(*theta_v);
            DirectionVectors::from_angles(theta_s, theta_v, phi_v).expect("above the horizon")
        })
        .collect();
    let interior = LeafParams {
        cab: 42.0,
        car: 9.0,
        cant: 1.0,
        cbrown: 0.02,
        cw: 0.013,
        cm: 0.006,
        ..LeafParams::with_n_struct(1.55)
    };
    let model = Prospect::new(table::full(Version::D));
    let surface = Surface::new(1.45, 0.25).expect("a surface");
    let coupled = CoupledLeaf::new(model, interior, Coupling::Bousquet, surface);
    let wavelengths_nm: Vec<f64> = (400..=2500).map(f64::from).collect();
    let mut brdf = Vec::new();
    for band in 0..wavelengths_nm.len() {
        for (v, theta_v) in views.iter().enumerate() {
            let (theta_s, theta_v, phi_v) = of(*theta_v);
            let geometry = Geometry::from_angles(theta_s, theta_v, phi_v).expect("above the horizon");
            // a model error as real leaves have it: smooth over the wavelengths
            let misfit = 3e-3 * (0.004 * band as f64 + v as f64).sin();
            brdf.push(coupled.band(band, &geometry).expect("a possible leaf").brdf + misfit);
        }
    }
    let data = DirectionalData { wavelengths_nm: &wavelengths_nm, directions: &directions, brdf: &brdf, sd: None };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let mut group = criterion.benchmark_group("leaf, 12 × 2101");
    group.sample_size(20);
    for (name, method, from) in [
        ("recommended", Method::Recommended, SurfaceFrom::Surface),
        ("two-step from one surface", Method::TwoStep, SurfaceFrom::Surface),
        ("two-step from bands", Method::TwoStep, SurfaceFrom::Bands),
        ("joint", Method::Joint, SurfaceFrom::Surface),
    ] {
        let mut options = LeafOptions::new(method);
        options.surface_from = from;
        group.bench_function(name, |bencher| {
            pool.install(|| bencher.iter(|| fit(&data, &options).expect("a fit")));
        });
    }
    group.finish();
}

criterion_group!(benches, leaf);
criterion_main!(benches);
