//! The coupled leaf as its user meets it: `leafbrdf leaf --points`, and `leafbrdf fit --model leaf`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use leafbrdf::points::Points;

fn leafbrdf(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leafbrdf")).args(arguments).output().unwrap()
}

/// The table that a successful run prints, and what it says on standard error.
#[track_caller]
fn table(arguments: &[&str]) -> (Points, String) {
    let output = leafbrdf(arguments);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{arguments:?}: {message}");
    (Points::from_bytes("output", &output.stdout).unwrap(), message)
}

/// The run ends with this status and a message on standard error that has these parts.
#[track_caller]
fn fails(arguments: &[&str], status: i32, parts: &[&str]) {
    let output = leafbrdf(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}: no results are printed on failure");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: no {part:?} in: {message}");
    }
}

/// The golden file of the crate `prospect`; its first lines say what made it.
fn golden() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../prospect/tests/golden/leaf_reference.csv")
}

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_string()
}

// `leafbrdf leaf --points`

#[test]
fn every_golden_row_comes_back_within_a_billionth_inputs_first() {
    let reference = Points::read(&golden()).unwrap();
    let (ours, message) = table(&["leaf", "--points", golden().to_str().unwrap()]);
    assert_eq!(ours.len(), reference.len());
    for row in 0..ours.len() {
        for (name, tolerance) in [("n", 0.0), ("wavelength_nm", 0.0), ("phi_v_deg", 0.0), ("k_l", 1e-9), ("brdf", 1e-9)]
        {
            let number = |points: &Points| points.number(row, points.require(name).unwrap()).unwrap();
            // asked for: 1e-9; inputs come back as they were
            assert!((number(&ours) - number(&reference)).abs() <= tolerance, "row {row}, {name}");
        }
        for name in ["normalization", "coupling"] {
            let word = |points: &Points| points.text(row, points.require(name).unwrap()).to_string();
            assert_eq!(word(&ours), word(&reference), "row {row}");
        }
    }
    let place = ours.require("k_l_sign").unwrap();
    let negative = (0..ours.len()).filter(|row| ours.text(*row, place) == "negative").count();
    assert_eq!(negative, 13, "as many as the reference has below zero");
    assert!(message.contains("k_l is negative in 13 of 480 rows"), "{message}");
}

#[test]
fn what_a_row_does_not_say_the_options_do() {
    let folder = tempfile::tempdir().unwrap();
    let row = "1.4,0.3,1.5,40,0.01,800.5,45,30,180\n";
    let names = "n,sigma,n_struct,cab,cw,wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg";
    let plain = file(folder.path(), "plain.csv", &format!("{names}\n{row}"));
    let said = file(
        folder.path(),
        "said.csv",
        &format!("normalization,coupling,version,{names}\ncook-torrance,prospecular,pro,{row}"),
    );
    let brdf = |arguments: &[&str]| {
        let (points, _) = table(arguments);
        points.number(0, points.require("brdf").unwrap()).unwrap()
    };
    let options = ["--normalization", "cook-torrance", "--coupling", "prospecular", "--prospect", "PRO"];
    let by_options = brdf(&[&["leaf", "--points", &plain][..], &options[..]].concat());
    assert_eq!(by_options, brdf(&["leaf", "--points", &said]));
    assert_ne!(by_options, brdf(&["leaf", "--points", &plain]));
}

#[test]
fn an_impossible_row_is_named_with_its_column_and_nothing_is_printed() {
    let folder = tempfile::tempdir().unwrap();
    let names = "n,sigma,n_struct,cab,cm,wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg";
    let good = "1.4,0.3,1.5,40,0.005,800,45,30,180\n";
    for (bad, parts) in [
        ("0.9,0.3,1.5,40,0.005,800,45,30,180\n", &["line 3", "n"][..]),
        ("1.4,0.3,1.5,40,20,800,45,30,180\n", &["line 3", "cm", "did you mean 20 g m⁻²"][..]),
        ("1.4,0.3,1.5,40,0.005,8000,45,30,180\n", &["line 3", "wavelength_nm", "400 to 2500"][..]),
        ("1.4,0.3,1.5,40,0.005,800,45,90,180\n", &["line 3", "theta_v_deg"][..]),
        ("1.4,0.3,1.5,40,0.005,800,45,abc,180\n", &["line 3", "theta_v_deg", "number"][..]),
    ] {
        let path = file(folder.path(), "bad.csv", &format!("{names}\n{good}{bad}"));
        fails(&["leaf", "--points", &path], 1, parts);
    }
    let path = file(folder.path(), "word.csv", &format!("coupling,{names}\nnone,{good}"));
    fails(&["leaf", "--points", &path], 1, &["line 2", "coupling", "bousquet, prospecular, offset, gain-offset"]);
    fails(&["leaf"], 2, &["--points"]);
}
