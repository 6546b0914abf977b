//! `leafbrdf fit --model surface` as its user runs it: files in, files out, messages, exit status.

mod common;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use common::{number, rows, run, stderr};
use leafbrdf_core::diffuse::{Diffuse, P1};
use leafbrdf_core::{Angle, Grade, Illumination, Leaf, Normalization, Surface, Tilt};

const DEG: fn(f64) -> Angle<f64> = Angle::from_degrees;
const BANDS: [(u32, f64); 5] = [(480, 0.05), (550, 0.12), (670, 0.04), (780, 0.44), (879, 0.45)];

/// θ_s = 40°, θ_v 0–60°, at some azimuths; in the plane of incidence alone where `plane`.
fn directions(plane: bool) -> Vec<(f64, f64, f64)> {
    let azimuths: &[f64] = if plane { &[0.0, 180.0] } else { &[0.0, 60.0, 90.0, 150.0, 180.0] };
    let views = azimuths.iter().flat_map(|phi| [15.0, 30.0, 38.0, 45.0, 60.0].map(|theta| (40.0, theta, *phi)));
    std::iter::once((40.0, 0.0, 0.0)).chain(views).collect()
}

/// A wide file of exact BRDF: GGX with P1 and a tilt, or the paper's surface.
fn wide(extended: bool, plane: bool, gap: bool) -> String {
    let directions = directions(plane);
    let mut text = "# quantity: brdf\n".to_string();
    for (name, place) in [("theta_s_deg", 0), ("theta_v_deg", 1), ("phi_v_deg", 2)] {
        text.push_str(name);
        directions.iter().for_each(|d| write!(text, ",{}", [d.0, d.1, d.2][place]).unwrap());
        text.push('\n');
    }
    let tilt = Tilt::new(DEG(1.5), DEG(if plane { 0.0 } else { -1.0 })).unwrap();
    for (wavelength, k_l) in BANDS {
        write!(text, "{wavelength}").unwrap();
        for (i, d) in directions.iter().enumerate() {
            let level = leafbrdf_core::Geometry::from_angles(DEG(d.0), DEG(d.1), DEG(d.2)).unwrap();
            let value = if extended {
                let seen = leafbrdf_core::Geometry::tilted(DEG(d.0), DEG(d.1), DEG(d.2), &tilt).unwrap();
                let p1 = P1::new(0.15, -0.05).unwrap();
                Leaf::with_diffuse(k_l, Surface::ggx(1.48, 0.22).unwrap(), p1).unwrap().brdf_tilted(&seen)
            } else {
                Leaf::new(k_l, Surface::new(1.5, 0.25).unwrap()).unwrap().brdf(&level)
            };
            if gap && wavelength == 670 && i == 3 { text.push(',') } else { write!(text, ",{value}").unwrap() }
        }
        text.push('\n');
    }
    text
}

fn summary(folder: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(folder.join("summary.json")).unwrap()).unwrap()
}

#[test]
fn an_exact_leaf_gives_back_its_surface_and_every_k_l() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("laurel.csv"), wide(false, false, true)).unwrap();
    let output = run(folder.path(), &["fit", "laurel.csv", "--model", "surface", "-o", "out"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let out = folder.path().join("out");

    let bands = rows(&out.join("bands.csv"));
    assert_eq!(bands.len(), BANDS.len());
    for (row, (wavelength, k_l)) in bands.iter().zip(BANDS) {
        assert_eq!(number(row, "wavelength_nm"), f64::from(wavelength));
        // the file has all digits: what is left is the search's tolerance
        assert!((number(row, "k_l") - k_l).abs() < 1e-8);
        assert!((number(row, "n") - 1.5).abs() < 1e-7 && (number(row, "sigma") - 0.25).abs() < 1e-7);
        assert_eq!(number(row, "n_obs"), if wavelength == 670 { 25.0 } else { 26.0 });
        assert_eq!((row["status"].as_str(), row["normalization"].as_str()), ("converged", "bousquet2005"));
        assert!(number(row, "k_l_se") < 1e-6 && number(row, "n_se") < 1e-6);
    }
    let source = Illumination::new(DEG(40.0)).unwrap();
    let specular = Surface::new(1.5, 0.25).unwrap().dhrf(&source, Grade::E10);
    for (row, (_, k_l)) in rows(&out.join("dhrf.csv")).iter().zip(BANDS) {
        assert!((number(row, "dhrf_diffuse") - k_l).abs() < 1e-7);
        assert!((number(row, "dhrf_specular") - specular).abs() < 1e-7);
    }
    let leaves = rows(&out.join("leaves.csv"));
    assert_eq!((leaves[0]["leaf"].as_str(), leaves[0]["model"].as_str()), ("laurel", "surface"));
    assert_eq!(leaves[0]["tilt_in_plane_deg"], "");
    let summary = summary(&out);
    assert_eq!(summary["values"]["left_out"]["missing"], 1);
    assert_eq!(summary["k_l"]["negative"], 0);
}

#[test]
fn the_extended_surface_is_named_with_its_convention_and_its_budget() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(true, false, false)).unwrap();
    let ask = ["fit", "leaf.csv", "--model", "surface", "--facets", "ggx", "--diffuse", "p1", "--tilt", "-o", "out"];
    let output = run(folder.path(), &ask);
    assert!(output.status.success(), "{}", stderr(&output));
    let out = folder.path().join("out");
    let leaf = &rows(&out.join("leaves.csv"))[0];
    for (column, truth) in [
        ("n", 1.48),
        ("sigma", 0.22),
        ("p1_a", 0.15),
        ("p1_b", -0.05),
        ("tilt_in_plane_deg", 1.5),
        ("tilt_lateral_deg", -1.0),
    ] {
        assert!((number(leaf, column) - truth).abs() < 1e-6, "{column} {}", leaf[column]);
    }
    assert_eq!((leaf["facets"].as_str(), leaf["diffuse"].as_str()), ("ggx", "p1"));
    // GGX has no printed convention: it comes normalised, and says so
    assert_eq!(leaf["normalization"], "cook-torrance");
    let row = &rows(&out.join("dhrf.csv"))[3];
    let source = Illumination::new(DEG(40.0)).unwrap();
    let specular = Surface::ggx(1.48, 0.22).unwrap().dhrf(&source, Grade::E10);
    let diffuse = 0.44 * P1::new(0.15, -0.05).unwrap().hemispherical(DEG(40.0).cos());
    assert!((number(row, "dhrf_specular") - specular).abs() < 1e-6);
    assert!((number(row, "dhrf_diffuse") - diffuse).abs() < 1e-6);
    let summary = summary(&out);
    assert_eq!(summary["parameters"]["tilt_lateral_deg"]["prior"]["sd"].as_f64().unwrap().round(), 3.0);
    assert!(summary["correlations"]["n,sigma"].is_number());

    // an explicit convention is honoured: a smaller factor asks for a larger index
    let output = run(folder.path(), &[&ask[..9], &["--normalization", "bousquet2005", "-o", "other"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    let other = &rows(&folder.path().join("other/leaves.csv"))[0];
    assert_eq!(other["normalization"], Normalization::Bousquet2005.name());
    assert!(number(other, "n") > 1.5);
}

#[test]
fn a_lateral_tilt_that_the_plane_of_incidence_cannot_see_is_held_and_told() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("plane.csv"), wide(true, true, false)).unwrap();
    let ask = ["fit", "plane.csv", "--model", "surface", "--facets", "ggx", "--diffuse", "p1", "--tilt", "-o", "out"];
    let output = run(folder.path(), &ask);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("tilt_lateral_deg is held at 0"), "{}", stderr(&output));
    let leaf = &rows(&folder.path().join("out/leaves.csv"))[0];
    assert_eq!((leaf["tilt_lateral_deg"].as_str(), leaf["tilt_lateral_deg_se"].as_str()), ("", ""));
    assert!((number(leaf, "tilt_in_plane_deg") - 1.5).abs() < 1e-6);
    assert!(summary(&folder.path().join("out"))["warnings"].to_string().contains("tilt_lateral_deg"));
}

#[test]
fn parameters_can_be_held_and_priors_given() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(false, false, false)).unwrap();
    let fit =
        |more: &[&str]| run(folder.path(), &[&["fit", "leaf.csv", "--model", "surface", "-o", "out"], more].concat());
    assert!(fit(&["--hold", "n=1.4"]).status.success());
    let leaf = &rows(&folder.path().join("out/leaves.csv"))[0];
    assert_eq!((leaf["n"].as_str(), leaf["n_se"].as_str()), ("1.4", ""));
    assert!(fit(&["--prior", "n=1.48:0.03"]).status.success());
    for (wrong, word) in [
        (["--hold", "p1_a=0.1"], "--diffuse p1"),
        (["--prior", "tilt_in_plane_deg=0:2"], "--tilt"),
        (["--hold", "k=1"], "no parameter"),
        (["--prior", "n=1.48:0"], "MEAN:SD"),
        (["--hold", "sigma=-1"], "sigma"),
        (["--start-n", "9"], "--start-n 9"),
    ] {
        let output = fit(&wrong);
        assert_eq!(output.status.code(), Some(2), "{wrong:?}");
        assert!(stderr(&output).contains(word), "{wrong:?}: {}", stderr(&output));
    }
}

#[test]
fn a_leaf_that_fails_is_named_and_the_others_are_done() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("good.csv"), wide(false, false, false)).unwrap();
    fs::write(folder.path().join("bad.csv"), "nothing\n").unwrap();
    let output = run(folder.path(), &["fit", "good.csv", "bad.csv", "--model", "surface", "-o", "out"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("bad.csv"));
    let leaves = rows(&folder.path().join("out/leaves.csv"));
    assert_eq!((leaves[0]["status"].as_str(), leaves[1]["status"].as_str()), ("done", "failed"));
    assert!(folder.path().join("out/good/summary.json").exists());
}

#[test]
fn options_of_a_surface_are_refused_where_they_mean_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(false, false, false)).unwrap();
    for option in [&["--tilt"][..], &["--facets", "ggx"], &["--diffuse", "p1"], &["--hold", "n=1.4"]] {
        let output = run(folder.path(), &[&["fit", "leaf.csv", "--model", "bands", "-o", "out"], option].concat());
        assert_eq!(output.status.code(), Some(2), "{option:?}");
        assert!(stderr(&output).contains(option[0]));
    }
}
