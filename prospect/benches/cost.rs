//! Cost of one spectrum in microseconds, for `against_progeosail.py`, which runs this and the Python package by turns.
//!
//! `cargo bench -p leafbrdf-prospect --bench cost` prints `what,microseconds` (best of many: other programs only ever add);
//! with `-- --spectrum` it prints the spectrum itself.

use std::hint::black_box;
use std::time::Instant;

use leafbrdf_prospect::{Jacobian, LeafParams, Parameter, Prospect, Version, table};

/// Shortest of many runs, µs.
fn best(mut run: impl FnMut()) -> f64 {
    let mut best = f64::MAX;
    for _ in 0..2000 {
        let start = Instant::now();
        run();
        best = best.min(start.elapsed().as_secs_f64());
    }
    best * 1e6
}

fn main() {
    let model = Prospect::new(table::full(Version::D));
    let leaf = LeafParams {
        cab: 40.0,
        car: 8.0,
        cant: 1.0,
        cbrown: 0.1,
        cw: 0.012,
        cm: 0.009,
        ..LeafParams::with_n_struct(1.5)
    };
    let (mut r, mut t) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);

    if std::env::args().any(|argument| argument == "--spectrum") {
        model.spectrum(&leaf, &mut r, &mut t).expect("a possible leaf");
        println!("wavelength_nm,reflectance,transmittance");
        for (band, (r, t)) in r.iter().zip(&t).enumerate() {
            println!("{},{r:e},{t:e}", 400 + band);
        }
        return;
    }

    println!("what,microseconds");
    let scalar = best(|| {
        for (band, (r, t)) in r.iter_mut().zip(&mut t).enumerate() {
            let optics = model.band(black_box(&leaf), band).expect("a possible leaf");
            (*r, *t) = (optics.reflectance, optics.transmittance);
        }
        black_box((&r, &t));
    });
    println!("band by band,{scalar:.1}");
    let portable = best(|| {
        model.spectrum_portable(black_box(&leaf), &mut r, &mut t).expect("a possible leaf");
        black_box((&r, &t));
    });
    println!("portable,{portable:.1}");
    let vectorised = best(|| {
        model.spectrum(black_box(&leaf), &mut r, &mut t).expect("a possible leaf");
        black_box((&r, &t));
    });
    println!("vectorised,{vectorised:.1}");
    // N and the six constituents of PROSPECT-D
    let parameters = &Parameter::ALL[..7];
    let (mut dr, mut dt) = (vec![0.0; 7 * table::BANDS], vec![0.0; 7 * table::BANDS]);
    let derivatives = best(|| {
        let room =
            Jacobian { reflectance: &mut r, transmittance: &mut t, d_reflectance: &mut dr, d_transmittance: &mut dt };
        model.jacobian(black_box(&leaf), parameters, room).expect("a possible leaf");
        black_box((&dr, &dt));
    });
    println!("with all derivatives,{derivatives:.1}");
}
