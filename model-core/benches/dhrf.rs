//! One DHRF_spec: each grade, value and gradient, at a smooth surface (Gauss–Hermite) and at beech's and a rough one's cost;
//! GGX beside it.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use leafbrdf_core::{Absorbing, Angle, Dielectric, Grade, Illumination, Real};

fn grades(c: &mut Criterion) {
    // laurel and beech (Table 4), and θ_s, σ where the rule is at its dearest
    for (name, n, sigma, theta_s) in
        [("laurel-0", 1.22, 0.078, 0.0), ("beech-60", 1.56, 0.29, 60.0), ("rough-50", 1.5, 0.9, 50.0)]
    {
        let mut group = c.benchmark_group(format!("dhrf/{name}"));
        for grade in Grade::ALL {
            group.bench_function(format!("{grade:?}/f64"), |b| value::<f64>(b, n, sigma, theta_s, grade));
            group.bench_function(format!("{grade:?}/f32"), |b| value::<f32>(b, n, sigma, theta_s, grade));
        }
        let illumination = Illumination::new(Angle::from_degrees(theta_s)).unwrap();
        let index = Dielectric::new(n).unwrap();
        group.bench_function("E4d/f64/gradient", |b| {
            b.iter(|| illumination.dhrf_with_gradient(black_box(index), black_box(sigma), Grade::E4d));
        });
        group.bench_function("E4d/f64/ggx", |b| {
            b.iter(|| illumination.dhrf_ggx(black_box(index), black_box(sigma), Grade::E4d));
        });
        group.bench_function("E4d/f64/ggx gradient", |b| {
            b.iter(|| illumination.dhrf_ggx_with_gradient(black_box(index), black_box(sigma), Grade::E4d));
        });
        let index = Absorbing::new(n, 0.5).unwrap();
        group.bench_function("E4d/f64/complex-index", |b| {
            b.iter(|| illumination.dhrf(black_box(index), black_box(sigma), Grade::E4d));
        });
        group.finish();
    }
}

fn value<T: Real>(bencher: &mut criterion::Bencher<'_>, n: f64, sigma: f64, theta_s: f64, grade: Grade) {
    let illumination = Illumination::new(Angle::from_degrees(T::lit(theta_s))).unwrap();
    let index = Dielectric::new(T::lit(n)).unwrap();
    let sigma = T::lit(sigma);
    bencher.iter(|| illumination.dhrf(black_box(index), black_box(sigma), grade));
}

criterion_group!(benches, grades);
criterion_main!(benches);
