//! PROSPECT as its user meets it: `leafbrdf prospect`, and `leafbrdf fit --model prospect` from files to files.
//!
//! The golden file is that of the crate `prospect`; what made it is said in its `tests/golden.rs`.

use std::collections::HashMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use leafbrdf::points::Points;

fn leafbrdf_with(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_leafbrdf"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_vec();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().unwrap();
    // A command that does not read its input closes it early.
    let _ = writer.join();
    output
}

/// The table that a successful run prints.
#[track_caller]
fn table(arguments: &[&str], input: &str) -> Points {
    let output = leafbrdf_with(arguments, input.as_bytes());
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    Points::from_bytes("output", &output.stdout).unwrap()
}

/// The run ends with this status and a message on standard error that has these parts.
#[track_caller]
fn fails(arguments: &[&str], input: &str, status: i32, parts: &[&str]) {
    let output = leafbrdf_with(arguments, input.as_bytes());
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}: no results are printed on failure");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: no {part:?} in: {message}");
    }
}

fn golden() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../prospect/tests/golden/prospect_reference.csv")
}

/// The numbers of some columns, row by row.
fn columns(points: &Points, names: &[&str]) -> Vec<Vec<f64>> {
    let places: Vec<usize> = names.iter().map(|name| points.require(name).unwrap()).collect();
    (0..points.len()).map(|row| places.iter().map(|place| points.number(row, *place).unwrap()).collect()).collect()
}

const INPUTS: [&str; 9] = ["n_struct", "cab", "car", "cant", "cbrown", "cw", "cm", "prot", "cbc"];

// `leafbrdf prospect`

/// Asked for: 1e-12. The file itself serves as points: its 1688 rows are 8 leaves and more, one spectrum each.
#[test]
fn spectra_agree_with_the_golden_file_through_the_command() {
    let path = golden();
    let reference = Points::read(&path).unwrap();
    let ours = table(&["prospect", "--points", path.to_str().unwrap(), "--wavelengths", "400:2500:10"], "");
    let key = |points: &Points, row: usize, numbers: &[f64]| {
        let version = points.text(row, points.require("version").unwrap()).to_string();
        (version, numbers[..10].iter().map(|number| (number + 0.0).to_bits()).collect::<Vec<u64>>())
    };
    let mut names = INPUTS.to_vec();
    names.extend(["wavelength_nm", "reflectance", "transmittance"]);
    let rows = columns(&ours, &names);
    let found: HashMap<_, _> = rows.iter().enumerate().map(|(row, numbers)| (key(&ours, row, numbers), row)).collect();
    assert_eq!(found.len(), rows.len(), "each leaf and wavelength once");
    let mut worst: f64 = 0.0;
    let expected = columns(&reference, &names);
    for (row, numbers) in expected.iter().enumerate() {
        let ours = &rows[found[&key(&reference, row, numbers)]];
        worst = worst.max((ours[10] - numbers[10]).abs()).max((ours[11] - numbers[11]).abs());
    }
    assert_eq!(expected.len(), rows.len());
    assert!(worst <= 1e-12, "largest difference {worst:e}");
}

#[test]
fn the_columns_are_those_of_the_contract() {
    let single = leafbrdf_with(&["prospect", "--model", "d", "--n-struct", "1.5", "--cab", "40"], b"");
    let text = String::from_utf8(single.stdout).unwrap();
    assert!(text.starts_with("wavelength_nm,reflectance,transmittance"), "{}", &text[..80]);
    assert_eq!(text.lines().count(), 2102);
    let points = leafbrdf_with(&["prospect", "--points", "-", "--wavelengths", "550"], b"n_struct\n1.5\n");
    let text = String::from_utf8(points.stdout).unwrap();
    let expected = "version,n_struct,cab,car,cant,cbrown,cw,cm,prot,cbc,wavelength_nm,reflectance,transmittance";
    assert!(text.starts_with(expected), "{text}");
    assert!(text.contains("\nD,1.5,0,0,0,0,0,0,0,0,550,0."), "{text}");
}

#[test]
fn an_omitted_constituent_is_zero_and_energy_is_conserved() {
    let all = ["--cab", "0", "--car", "0", "--cant", "0", "--cbrown", "0", "--cw", "0", "--cm", "0"];
    let arguments = ["prospect", "--n-struct", "1.7", "--wavelengths", "400:2500:50"];
    let given = leafbrdf_with(&[&arguments[..], &all[..]].concat(), b"");
    let omitted = leafbrdf_with(&arguments, b"");
    assert_eq!(given.stdout, omitted.stdout);
    let names = ["reflectance", "transmittance", "absorptance"];
    for row in columns(&table(&["prospect", "--n-struct", "1.7", "--cab", "40", "--cw", "0.01"], ""), &names) {
        // one rounding of each
        assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}

#[test]
fn wavelengths_come_in_the_order_asked_for_and_between_the_tables_interpolated() {
    let names = ["wavelength_nm", "reflectance"];
    let leaf = ["prospect", "--n-struct", "1.5", "--cab", "40", "--cm", "0.005"];
    let at = |list: &str| columns(&table(&[&leaf[..], &["--wavelengths", list]].concat(), ""), &names);
    let rows = at("800,550,550.5,551,800");
    let order: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(order, [800.0, 550.0, 550.5, 551.0, 800.0]);
    assert_eq!(rows[0], rows[4]);
    // halfway between two neighbours, up to the curvature of R over 1 nm
    assert!((rows[2][1] - 0.5 * (rows[1][1] + rows[3][1])).abs() < 1e-5);
}

#[test]
fn a_sensor_band_averages_the_spectrum() {
    let leaf = ["prospect", "--n-struct", "1.5", "--cab", "40", "--cm", "0.005"];
    let bands = table(&[&leaf[..], &["--bands", "705:15,1100:2"]].concat(), "");
    let rows = columns(&bands, &["wavelength_nm", "reflectance", "fwhm_nm"]);
    assert_eq!((rows[0][0], rows[0][2], rows.len()), (705.0, 15.0, 2));
    let fine =
        columns(&table(&[&leaf[..], &["--wavelengths", "650:760"]].concat(), ""), &["wavelength_nm", "reflectance"]);
    let weight = |nm: f64| (-4.0 * std::f64::consts::LN_2 * ((nm - 705.0) / 15.0).powi(2)).exp();
    let sum: f64 = fine.iter().map(|row| weight(row[0]) * row[1]).sum();
    let mean = sum / fine.iter().map(|row| weight(row[0])).sum::<f64>();
    // a sum at 1 nm in place of the integral over R that is straight between them: R''/12, R'' below 1e-4 nm⁻² on the mean
    assert!((rows[0][1] - mean).abs() < 1e-5, "{} {mean}", rows[0][1]);
}

#[test]
fn carotenoids_may_follow_chlorophyll() {
    let tied = leafbrdf_with(&["prospect", "--n-struct", "1.5", "--cab", "40", "--car-per-cab", "0.25"], b"");
    let given = leafbrdf_with(&["prospect", "--n-struct", "1.5", "--cab", "40", "--car", "10"], b"");
    assert_eq!(tied.stdout, given.stdout);
}

#[test]
fn what_is_wrong_is_named_with_its_likely_unit() {
    let n = ["prospect", "--n-struct", "1.5"];
    let usage = |more: &[&str], parts: &[&str]| fails(&[&n[..], more].concat(), "", 2, parts);
    usage(&["--cm", "20"], &["--cm", "20 g m⁻² = 0.002 g cm⁻²"]);
    usage(&["--cw", "10"], &["--cw", "mg cm⁻² = 0.01 cm"]);
    usage(&["--cab", "-3"], &["--cab", "outside 0 to 300"]);
    usage(&["--cab", "NaN"], &["--cab", "NaN"]);
    usage(&["--model", "5B", "--cant", "3"], &["--cant", "5B has no coefficients for cant"]);
    usage(&["--model", "PRO", "--cm", "0.01", "--prot", "0.001"], &["prot + cbc"]);
    usage(&["--wavelengths", "350:500"], &["--wavelengths", "350 nm is outside the table"]);
    usage(&["--wavelengths", "0.55"], &["0.55 µm is 550 nm"]);
    usage(&["--bands", "405:20"], &["--bands", "outside the table"]);
    usage(&["--bands", "705"], &["CENTRE:FWHM"]);
    usage(&["--car", "8", "--car-per-cab", "0.25"], &["--car-per-cab"]);
    fails(&["prospect", "--cab", "40"], "", 2, &["--n-struct"]);
    fails(&["prospect", "--n-struct", "0.5"], "", 2, &["--n-struct", "outside 1 to 10"]);
    let points = |file: &str, parts: &[&str]| fails(&["prospect", "--points", "-"], file, 1, parts);
    points("n_struct,cm\n1.5,0.01\n1.4,20\n", &["line 3", "column 2", "cm", "0.002 g cm⁻²"]);
    points("version,n_struct\nD,1.5\nE,1.5\n", &["line 3", "version", "5B, D or PRO"]);
    points("cab\n40\n", &["no column n_struct"]);
    points("n_struct,cab\n1.5,\n", &["line 2", "cab", "expected a number"]);
    points("version,n_struct,cant\n5B,1.5,2\n", &["line 2", "cant", "use version D or PRO"]);
}
