//! One evaluation of the surface model, one with gradient: from angles, from a prepared geometry, and in batches of 4,096; the
//! paper's surface and, beside it, GGX–Smith over P1, level and tilted.
//! Run with `cargo bench -p leafbrdf-core --bench brdf`; compare ratios within one run.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use leafbrdf_core::{
    Angle, Dielectric, DirectionTerms, DirectionVectors, Geometry, GgxTerms, Leaf, Normalization, P1, Portable, Real,
    Surface, Tilt,
};

const BATCH: usize = 4_096;

fn geometries<T: Real>() -> Vec<Geometry<T>> {
    let deg = |x: f64| Angle::from_degrees(T::lit(x));
    (0..BATCH)
        .map(|i| {
            let (theta_v, phi_v) = ((i % 64) as f64, (i / 64) as f64 * 180.0 / 64.0);
            Geometry::from_angles(deg(40.0), deg(theta_v), deg(phi_v)).expect("above the horizon")
        })
        .collect()
}

fn one<T: Real>(c: &mut Criterion, name: &str) {
    let deg = |x: f64| Angle::from_degrees(T::lit(x));
    let leaf =
        Leaf::new(T::lit(0.3), Surface::new(T::lit(1.56), T::lit(0.29)).expect("in the domain")).expect("in [0, 1]");
    let geometry = geometries::<T>()[1_000];
    let mut group = c.benchmark_group(format!("one evaluation, {name}"));
    group.bench_function("geometry from angles", |b| {
        b.iter(|| Geometry::from_angles(black_box(deg(60.0)), black_box(deg(50.0)), black_box(deg(150.0))));
    });
    group.bench_function("brdf", |b| b.iter(|| black_box(&leaf).brdf(black_box(&geometry))));
    group.bench_function("brdf with gradient", |b| {
        b.iter(|| black_box(&leaf).brdf_with_gradient(black_box(&geometry)));
    });

    // the extended surface beside it
    let surface = Surface::ggx(T::lit(1.5), T::lit(0.25)).expect("in the domain");
    let diffuse = P1::new(T::lit(0.15), T::lit(-0.05)).expect("in the domain");
    let leaf = Leaf::with_diffuse(T::lit(0.3), surface, diffuse).expect("in [0, 1]");
    group.bench_function("ggx + p1: brdf", |b| b.iter(|| black_box(&leaf).brdf(black_box(&geometry))));
    group.bench_function("ggx + p1: brdf with gradient", |b| {
        b.iter(|| black_box(&leaf).brdf_with_gradient(black_box(&geometry)));
    });
    let vectors = DirectionVectors::from_angles(deg(40.0), deg(30.0), deg(170.0)).expect("above the horizon");
    let tilt = Tilt::new(deg(3.0), deg(-2.0)).expect("in the domain");
    group.bench_function("ggx + p1: tilt and brdf", |b| {
        b.iter(|| black_box(&vectors).about(black_box(&tilt)).map(|tilted| black_box(&leaf).brdf_tilted(&tilted)));
    });
    group.bench_function("ggx + p1: tilt and brdf with gradient", |b| {
        b.iter(|| {
            let tilted = black_box(&vectors).about(black_box(&tilt));
            tilted.map(|tilted| black_box(&leaf).brdf_tilted_with_gradient(&tilted))
        });
    });
}

fn batch<T: Real>(c: &mut Criterion, name: &str) {
    let index = Dielectric::new(T::lit(1.56)).expect("in the domain");
    let terms: Vec<DirectionTerms<T>> =
        geometries::<T>().iter().map(|g| DirectionTerms::new(g, Normalization::Bousquet2005)).collect();
    let columns = [
        terms.iter().map(|t| t.cos_theta_a).collect::<Vec<_>>(),
        terms.iter().map(|t| t.tan2_alpha).collect(),
        terms.iter().map(|t| t.weight).collect(),
    ];
    let mut out = [T::ZERO; BATCH];
    let mut group = c.benchmark_group(format!("4,096 evaluations, {name}"));
    group.throughput(Throughput::Elements(BATCH as u64));
    group.bench_function("brdf from direction terms", |b| {
        b.iter(|| {
            let [cos_theta_a, tan2_alpha, weight] = black_box(&columns);
            for (((out, c), t), w) in out.iter_mut().zip(cos_theta_a).zip(tan2_alpha).zip(weight) {
                let terms = DirectionTerms { cos_theta_a: *c, tan2_alpha: *t, weight: *w };
                *out = terms.brdf(index, T::lit(0.29));
            }
        });
    });
    let ggx: Vec<GgxTerms<T>> =
        geometries::<T>().iter().map(|g| GgxTerms::new(g, Normalization::CookTorrance)).collect();
    group.bench_function("ggx from direction terms", |b| {
        b.iter(|| {
            for (out, terms) in out.iter_mut().zip(black_box(&ggx)) {
                *out = terms.brdf(index, T::lit(0.29));
            }
        });
    });
}

fn benches(c: &mut Criterion) {
    one::<f64>(c, "f64");
    one::<f32>(c, "f32");
    batch::<f64>(c, "f64");
    batch::<Portable<f64>>(c, "portable f64");
    batch::<Portable<f32>>(c, "portable f32");
}

criterion_group!(group, benches);
criterion_main!(group);
