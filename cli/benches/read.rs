//! Reading a measurement file of 0.70 MB: 41 directions, 2101 bands, five decimals.

use std::hint::black_box;
use std::io::Write;

use criterion::{Criterion, criterion_group, criterion_main};
use leafbrdf::measurement::{Layout, ReadOptions, WriteOptions, read_bytes, render};

/// A wide file of the usual size; the values do not matter, their number of digits does.
fn wide() -> String {
    let mut text = "# quantity: brf\ntheta_s_deg".to_string();
    text.push_str(&",20".repeat(41));
    text.push_str("\ntheta_v_deg");
    (0..41).for_each(|i| text.push_str(&format!(",{}", 10 * (i % 7))));
    text.push_str("\nphi_v_deg");
    (0..41).for_each(|i| text.push_str(&format!(",{}", 30 * (i / 7))));
    let mut state = 1_u64;
    for wavelength in 400..=2500 {
        text.push_str(&format!("\n{wavelength}"));
        for _ in 0..41 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            text.push_str(&format!(",{:.5}", (state >> 40) as f64 / 2_f64.powi(24)));
        }
    }
    text.push('\n');
    text
}

fn reading(criterion: &mut Criterion) {
    let options = ReadOptions::default();
    let wide = wide();
    let leaf = read_bytes("leaf.csv", wide.as_bytes(), &options).expect("the file is sound");
    let long =
        render(&leaf, &WriteOptions { layout: Some(Layout::Long), ..WriteOptions::default() }).expect("writable");
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(wide.as_bytes()).expect("memory");
    let gzip = encoder.finish().expect("memory");

    let mut group = criterion.benchmark_group("read 86,141 values");
    for (name, bytes) in [("wide", wide.as_bytes()), ("wide, gzip", &gzip), ("long", long.as_bytes())] {
        let name = format!("{name} ({:.2} MB)", bytes.len() as f64 / 1e6);
        group.bench_function(name, |bencher| bencher.iter(|| read_bytes("leaf.csv", black_box(bytes), &options)));
    }
    group.finish();
}

criterion_group!(benches, reading);
criterion_main!(benches);
