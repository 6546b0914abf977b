//! Numbers that other people's code produced, and 40-digit references made by `golden/gen/reference.py`.

use leafbrdf_prospect::{Jacobian, LeafParams, Parameter, Prospect, Version, plates, table};

/// Spectra for this project in 30 digits, interface by integration of Stern's definition; within 2e-14 of published MATLAB
/// outputs (D, PRO) and of published 4-digit values (5B).
const SPECTRA: &str = include_str!("golden/prospect_reference.csv");
const DERIVATIVES: &str = include_str!("golden/derivatives_reference.csv");

/// One row: version, leaf, band from 400 nm, then the remaining numbers.
struct Row {
    version: Version,
    leaf: LeafParams<f64>,
    band: usize,
    values: Vec<f64>,
}

fn rows(text: &str) -> Vec<Row> {
    let rows: Vec<Row> = text
        .lines()
        .filter(|line| !line.starts_with('#') && !line.starts_with("version"))
        .map(|line| {
            let (name, rest) = line.split_once(',').expect("a version");
            let version = match name {
                "5B" => Version::P5B,
                "D" => Version::D,
                "PRO" => Version::Pro,
                other => panic!("version {other}"),
            };
            let numbers: Vec<f64> = rest.split(',').map(|cell| cell.parse().expect("a number")).collect();
            let mut leaf = LeafParams::with_n_struct(1.0);
            for (parameter, value) in Parameter::ALL.into_iter().zip(&numbers) {
                leaf.set(parameter, *value);
            }
            Row { version, leaf, band: numbers[9] as usize - 400, values: numbers[10..].to_vec() }
        })
        .collect();
    assert!(rows.len() > 500);
    rows
}

fn single(leaf: &LeafParams<f64>) -> LeafParams<f32> {
    let mut rounded = LeafParams::with_n_struct(1.0);
    for parameter in Parameter::ALL {
        rounded.set(parameter, leaf.get(parameter) as f32);
    }
    rounded
}

/// Largest absolute difference of R and T from the references, `f64`: whole spectra and single bands.
fn worst_f64(text: &str) -> f64 {
    let mut worst: f64 = 0.0;
    for row in rows(text) {
        let model = Prospect::new(table::full(row.version));
        let (mut r, mut t) = (vec![0.0; table::BANDS], vec![0.0; table::BANDS]);
        model.spectrum(&row.leaf, &mut r, &mut t).expect("a possible leaf");
        let band = model.band(&row.leaf, row.band).expect("a possible leaf");
        for (ours, reference) in [
            (r[row.band], row.values[0]),
            (t[row.band], row.values[1]),
            (band.reflectance, row.values[0]),
            (band.transmittance, row.values[1]),
            (band.absorptance, 1.0 - row.values[0] - row.values[1]),
        ] {
            worst = worst.max((ours - reference).abs());
            assert!(ours.is_finite());
        }
    }
    worst
}

/// The same in `f32`: coefficients, parameters and arithmetic in single precision.
fn worst_f32(text: &str) -> f64 {
    static P5B: table::Table5B<f32, 2101> = table::Table5B::<f32, 2101>::cut::<400, 1>();
    static D: table::TableD<f32, 2101> = table::TableD::<f32, 2101>::cut::<400, 1>();
    static PRO: table::TablePro<f32, 2101> = table::TablePro::<f32, 2101>::cut::<400, 1>();
    let mut worst: f64 = 0.0;
    for row in rows(text) {
        let view = match row.version {
            Version::P5B => P5B.view(),
            Version::D => D.view(),
            Version::Pro => PRO.view(),
        };
        let one = view.bands(row.band..row.band + 1).expect("a band of the table");
        let model = Prospect::new(one);
        let leaf = single(&row.leaf);
        let (mut r, mut t) = ([0.0; 1], [0.0; 1]);
        model.spectrum(&leaf, &mut r, &mut t).expect("a possible leaf");
        let band = model.band(&leaf, 0).expect("a possible leaf");
        for (ours, reference) in [
            (r[0], row.values[0]),
            (t[0], row.values[1]),
            (band.reflectance, row.values[0]),
            (band.transmittance, row.values[1]),
            (band.absorptance, 1.0 - row.values[0] - row.values[1]),
        ] {
            assert!(ours.is_finite());
            worst = worst.max((f64::from(ours) - reference).abs());
        }
    }
    worst
}

/// Tolerance: the reach asked for is 1e-12; the references agree with 40 digits to 1.8e-14.
#[test]
fn spectra_agree_with_thirty_digits_in_double_precision() {
    let worst = worst_f64(SPECTRA);
    assert!(worst <= 1e-13, "largest difference {worst:e}");
}

/// Tolerance: asked for 5e-6; one rounding of an input is 6e-8, amplified by the layers (2.3e-7 measured).
#[test]
fn spectra_agree_in_single_precision() {
    let worst = worst_f32(SPECTRA);
    assert!(worst <= 1e-6, "largest difference {worst:e}");
}

/// The file of derivatives holds harder limits: K ~ 1e-10, N = 1 + 1e-6, N = 9.5, opaque leaves.
#[test]
fn limits_agree_in_both_precisions() {
    let (double, single) = (worst_f64(DERIVATIVES), worst_f32(DERIVATIVES));
    assert!(double <= 1e-14, "largest difference {double:e}");
    assert!(single <= 1e-6, "largest difference {single:e}");
}

/// Relative to the derivative itself, down to slopes of 1e-290 under an opaque leaf. Asked for: 1e-8; measured 9.9e-14.
#[test]
fn derivatives_agree_with_250_digit_differences() {
    let (mut worst, mut place): (f64, String) = (0.0, String::new());
    let mut compared = 0;
    for row in rows(DERIVATIVES) {
        let view = table::full(row.version).bands(row.band..row.band + 1).expect("a band of the table");
        let (mut r, mut t, mut dr, mut dt) = ([0.0; 1], [0.0; 1], [0.0; 9], [0.0; 9]);
        let room =
            Jacobian { reflectance: &mut r, transmittance: &mut t, d_reflectance: &mut dr, d_transmittance: &mut dt };
        Prospect::new(view).jacobian(&row.leaf, &Parameter::ALL, room).expect("a possible leaf");
        let ours = dr.iter().chain(&dt);
        for (index, (ours, reference)) in ours.zip(&row.values[2..]).enumerate() {
            if *reference == 0.0 {
                assert_eq!(*ours, 0.0, "{:?} at {}, {index}", row.leaf, row.band);
                continue;
            }
            let error = (ours - reference).abs() / reference.abs();
            if error > worst {
                (worst, place) = (error, format!("{:?}, band {}, number {index}: {ours:e}", row.leaf, row.band));
            }
            compared += 1;
        }
    }
    assert!(compared > 3000, "{compared} derivatives compared");
    assert!(worst <= 1e-11, "largest relative difference {worst:e} at {place}");
}

/// PROSPECT's own special case: without absorption R + T = 1 and Stokes' pile is rational in N.
#[test]
fn a_leaf_without_absorbers_loses_nothing() {
    let faces = leafbrdf_prospect::Interface::new(1.4_f64);
    for n_struct in [1.0, 1.5, 2.0, 7.0] {
        let leaf = plates(faces, 0.0, n_struct);
        assert!((leaf.reflectance + leaf.transmittance - 1.0).abs() < 1e-15);
        assert!(leaf.absorptance.abs() < 1e-20);
    }
}
