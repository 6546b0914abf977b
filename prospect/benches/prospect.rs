//! Cost of a spectrum: `cargo bench -p leafbrdf-prospect`.
//!
//! Compare with the Python package progeosail in the same session: `benches/against_progeosail.py`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use leafbrdf_prospect::{Jacobian, LeafParams, Parameter, Prospect, Version, table};

fn leaf() -> LeafParams<f64> {
    LeafParams { cab: 40.0, car: 8.0, cant: 1.0, cbrown: 0.1, cw: 0.012, cm: 0.009, ..LeafParams::with_n_struct(1.5) }
}

fn spectra(c: &mut Criterion) {
    let model = Prospect::new(table::full(Version::D));
    let leaf = leaf();
    let (mut r, mut t) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
    let mut group = c.benchmark_group("prospect_d_2101_bands");
    group.throughput(Throughput::Elements(table::BANDS as u64));

    group.bench_function("scalar, std exp and ln", |b| {
        b.iter(|| {
            for band in 0..table::BANDS {
                let optics = model.band(black_box(&leaf), band).expect("a possible leaf");
                (r[band], t[band]) = (optics.reflectance, optics.transmittance);
            }
            black_box((&r, &t));
        });
    });
    group.bench_function("portable", |b| {
        b.iter(|| {
            model.spectrum_portable(black_box(&leaf), &mut r, &mut t).expect("a possible leaf");
            black_box((&r, &t));
        });
    });
    group.bench_function("vectorised", |b| {
        b.iter(|| {
            model.spectrum(black_box(&leaf), &mut r, &mut t).expect("a possible leaf");
            black_box((&r, &t));
        });
    });
    for (name, parameters) in [
        ("with derivatives by N and Cab", &[Parameter::NStruct, Parameter::Cab][..]),
        ("with all 7 derivatives", &Parameter::ALL[..7]),
    ] {
        let (mut dr, mut dt) = (vec![0.0; parameters.len() * r.len()], vec![0.0; parameters.len() * r.len()]);
        group.bench_function(name, |b| {
            b.iter(|| {
                let room = Jacobian {
                    reflectance: &mut r,
                    transmittance: &mut t,
                    d_reflectance: &mut dr,
                    d_transmittance: &mut dt,
                };
                model.jacobian(black_box(&leaf), parameters, room).expect("a possible leaf");
                black_box((&dr, &dt));
            });
        });
    }

    static SINGLE: table::TableD<f32, 2101> = table::TableD::<f32, 2101>::cut::<400, 1>();
    let single = Prospect::new(SINGLE.view());
    let leaf32 = LeafParams { cab: 40.0_f32, car: 8.0, cw: 0.012, cm: 0.009, ..LeafParams::with_n_struct(1.5) };
    let (mut r32, mut t32) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
    group.bench_function("vectorised, f32", |b| {
        b.iter(|| {
            single.spectrum(black_box(&leaf32), &mut r32, &mut t32).expect("a possible leaf");
            black_box((&r32, &t32));
        });
    });
    group.finish();
}

criterion_group!(benches, spectra);
criterion_main!(benches);
