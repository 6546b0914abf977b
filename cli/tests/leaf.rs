//! The coupled leaf as its user meets it: `leafbrdf leaf --points`, and `leafbrdf fit --model leaf`.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::leafbrdf;
use leafbrdf::points::Points;

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
    common::fails(arguments, "", status, parts);
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
fn a_wavelength_in_micrometres_is_told_so() {
    let rows = "n,sigma,n_struct,wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg\n1.5,0.3,1.5,0.55,30,30,180\n";
    let folder = tempfile::tempdir().unwrap();
    let points = file(folder.path(), "points.csv", rows);
    fails(&["leaf", "--points", &points], 1, &["line 2, column 4", "did you mean nm"]);
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

// `leafbrdf fit --model leaf`

/// A wide file of the principal plane, every 10 nm, from `leafbrdf leaf --points`: PROSPECT-D under a rough surface.
fn measured(folder: &Path, name: &str) -> String {
    let views = [(50, 180), (40, 180), (30, 180), (20, 180), (10, 180), (0, 0), (20, 0), (40, 0), (50, 0)];
    let names = "n,sigma,n_struct,cab,car,cant,cbrown,cw,cm,wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg";
    let mut points = format!("{names}\n");
    for nm in (400..=2500).step_by(10) {
        for (theta_v, phi_v) in views {
            points.push_str(&format!("1.45,0.25,1.5,42,9,1,0.005,0.013,0.006,{nm},35,{theta_v},{phi_v}\n"));
        }
    }
    let points = file(folder, "points.csv", &points);
    let (table, _) = table(&["leaf", "--points", &points]);
    let brdf = table.require("brdf").unwrap();
    let row = |of: &dyn Fn(&(i32, i32)) -> i32| views.iter().map(|v| of(v).to_string()).collect::<Vec<_>>().join(",");
    let mut text = format!(
        "# quantity: brdf\ntheta_s_deg,{}\ntheta_v_deg,{}\nphi_v_deg,{}\n",
        row(&|_| 35),
        row(&|view| view.0),
        row(&|view| view.1)
    );
    for (place, nm) in (400..=2500).step_by(10).enumerate() {
        text.push_str(&nm.to_string());
        for view in 0..views.len() {
            text.push_str(&format!(",{}", table.number(place * views.len() + view, brdf).unwrap()));
        }
        text.push('\n');
    }
    file(folder, name, &text)
}

/// The only row of DIR/leaves.csv.
fn leaves(folder: &Path) -> Points {
    Points::read(&folder.join("leaves.csv")).unwrap()
}

fn cell(points: &Points, name: &str) -> String {
    points.text(0, points.require(name).unwrap()).to_string()
}

#[track_caller]
fn number(points: &Points, name: &str) -> f64 {
    points.number(0, points.require(name).unwrap()).unwrap()
}

#[test]
fn the_default_call_gives_contents_surface_and_says_what_it_assumed() {
    let folder = tempfile::tempdir().unwrap();
    let input = measured(folder.path(), "leaf.csv");
    let out = folder.path().join("out");
    let output = leafbrdf(&["fit", &input, "--model", "leaf", "-o", out.to_str().unwrap()]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let row = leaves(&out);
    assert_eq!([cell(&row, "status"), cell(&row, "method"), cell(&row, "model")], ["done", "recommended", "leaf"]);
    // pigments evenly spread in this leaf, which the recipe does not assume: C_ab within its own error, the others close
    assert!((number(&row, "cab") - 42.0).abs() < 2.0 * number(&row, "cab_se"));
    assert!((number(&row, "cw") / 0.013 - 1.0).abs() < 0.1 && (number(&row, "cm") / 0.006 - 1.0).abs() < 0.3);
    assert_eq!(number(&row, "n_struct"), 1.5);
    assert!(number(&row, "n") > 1.2 && number(&row, "gain") > 0.8 && cell(&row, "facets") == "ggx");
    let summary = fs::read_to_string(out.join("summary.json")).unwrap();
    for part in ["chosen_by_chemistry", "upper_share", "n_struct_held", "gain-offset", "directions_kept", "length_nm"] {
        assert!(summary.contains(part), "no {part} in summary.json");
    }
    let bands = Points::read(&out.join("bands.csv")).unwrap();
    let dhrf = Points::read(&out.join("dhrf.csv")).unwrap();
    assert_eq!((bands.len(), dhrf.len()), (211, 211));
    bands.require("k_l_se").unwrap();
    let total = dhrf.number(50, dhrf.require("dhrf").unwrap()).unwrap();
    let parts = ["dhrf_diffuse", "dhrf_specular"].map(|name| dhrf.number(50, dhrf.require(name).unwrap()).unwrap());
    assert!((total - parts[0] - parts[1]).abs() < 1e-15 && parts[1] > 0.0);
}

#[test]
fn a_joint_fit_through_files_finds_the_leaf_and_holds_what_it_is_told_to() {
    let folder = tempfile::tempdir().unwrap();
    let input = measured(folder.path(), "leaf.csv");
    let out = folder.path().join("out");
    let options = ["--method", "joint", "--fix", "cbrown=0.005,cant=1", "--bounds", "cab=1:90"];
    let call = [&["fit", &input, "--model", "leaf", "-o", out.to_str().unwrap()][..], &options[..]].concat();
    let output = leafbrdf(&call);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let row = leaves(&out);
    for (name, truth) in [
        ("n", 1.45),
        ("sigma", 0.25),
        ("n_struct", 1.5),
        ("cab", 42.0),
        ("car", 9.0),
        ("cant", 1.0),
        ("cbrown", 0.005),
        ("cw", 0.013),
        ("cm", 0.006),
    ] {
        // noise-free: converged to 1e-10 of a χ² that is rounding
        assert!((number(&row, name) / truth - 1.0).abs() < 1e-3, "{name}: {}", number(&row, name));
    }
    assert_eq!(cell(&row, "gain"), "", "this coupling has none");
}

#[test]
fn a_prior_of_any_content_pulls_it_frees_what_is_held_and_is_stated() {
    let folder = tempfile::tempdir().unwrap();
    let input = measured(folder.path(), "leaf.csv");
    let fit = |options: &[&str]| {
        let out = folder.path().join("out");
        let output = leafbrdf(&[&["fit", &input, "--model", "leaf", "-o", out.to_str().unwrap()], options].concat());
        assert!(output.status.success(), "{options:?}: {}", String::from_utf8_lossy(&output.stderr));
        let summary: serde_json::Value = serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
        (leaves(&out), summary)
    };
    let (plain, summary) = fit(&[]);
    assert_eq!(summary["parameters"]["cab"]["prior"]["from"], "the method");
    let away = |row: &Points| (number(row, "cab") - 60.0).abs();
    // N(60, 1) is ten times narrower than what the data say, the logarithmic one as wide: both pull most of the way
    for (prior, sd) in [("cab=60:1", "sd"), ("cab=60:0.02:ln", "sd_of_ln")] {
        let (row, summary) = fit(&["--prior", prior]);
        assert!(away(&row) < 0.3 * away(&plain), "{prior}: {} from {}", number(&row, "cab"), number(&plain, "cab"));
        let stated = &summary["parameters"]["cab"]["prior"];
        assert_eq!((&stated["centre"], &stated["from"]), (&60.0.into(), &"--prior".into()), "{prior}");
        assert!(stated[sd].is_number(), "{prior}: {stated}");
        assert_eq!(summary["recipe"]["priors"]["cab"]["centre"], 60.0);
    }
    let (row, _) = fit(&["--prior", "n_struct=1.6:0.05,gain=1:0.02"]);
    assert!(number(&row, "n_struct") != 1.5 && number(&row, "n_struct_se") > 0.0);
    // the methods without priors of their own take them too, and all at once
    for method in ["joint", "two-step"] {
        let (row, summary) = fit(&[
            "--method",
            method,
            "--fix",
            "cant=1",
            "--prior",
            "cbrown=0.005:0.001,cw=0.012:0.5:ln,sigma=0.25:0.1",
        ]);
        assert!(number(&row, "cab_se") > 0.0);
        assert_eq!(summary["parameters"]["cw"]["prior"]["sd_of_ln"], 0.5);
        assert_eq!(summary["parameters"]["cab"].get("prior"), None, "{method}: what has no prior gets none");
    }
}

#[test]
fn two_step_gives_a_held_or_known_n_to_sigma_too() {
    let folder = tempfile::tempdir().unwrap();
    let input = measured(folder.path(), "leaf.csv");
    let out = folder.path().join("out");
    let surface = |options: &[&str]| {
        let call = ["fit", &input, "--model", "leaf", "--method", "two-step", "-o", out.to_str().unwrap()];
        let output = leafbrdf(&[&call[..], options].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (number(&leaves(&out), "n"), number(&leaves(&out), "sigma"))
    };
    let free = surface(&[]);
    let held = surface(&["--hold", "n=1.6"]);
    // the means over the bands know nothing of what is held: n = 1.6 beside the sigma of another n fits neither
    assert_eq!(held, surface(&["--hold", "n=1.6", "--surface-from", "surface"]));
    assert!(held.0 == 1.6 && (held.1 - free.1).abs() > 0.005, "{held:?} {free:?}");
    assert!(surface(&["--prior", "n=1.6:0.0001"]).0 > free.0);
}

#[test]
fn a_leaf_says_how_much_n_and_sigma_depend_on_wavelength_and_whose_angle_its_dhrf_has() {
    let folder = tempfile::tempdir().unwrap();
    let input = measured(folder.path(), "leaf.csv");
    let out = folder.path().join("out");
    for (coupling, least, most) in [("bousquet", 0.0, 0.0), ("prospecular", 0.05, 0.2)] {
        let call = ["fit", &input, "--model", "leaf", "--method", "joint", "--coupling", coupling, "-o"];
        assert!(leafbrdf(&[&call[..], &[out.to_str().unwrap()]].concat()).status.success());
        let summary: serde_json::Value = serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
        let n = summary["spectral_invariance"]["n"].as_f64().unwrap();
        // PROSPECT's index falls from 1.52 to 1.27 or so over 400 to 2500 nm
        assert!((least..=most).contains(&n), "{coupling}: {n}");
        assert_eq!(summary["spectral_invariance"]["sigma"], 0);
        assert!(summary["dhrf"].as_str().unwrap().contains("leaf's own normal"));
    }
}

#[test]
fn a_prior_in_another_unit_or_of_what_is_not_free_is_refused() {
    let call = |options: &[&str], parts: &[&str]| {
        fails(&[&["fit", "none.csv", "-o", "nowhere", "--model"][..], options].concat(), 2, parts);
    };
    call(&["leaf", "--prior", "cw=10:2"], &["--prior", "did you mean 10 mg cm⁻²"]);
    call(&["leaf", "--prior", "cm=20:0.5:ln"], &["--prior", "did you mean 20 g m⁻²"]);
    call(&["leaf", "--prior", "cab=0:0.5:ln"], &["MEDIAN > 0"]);
    call(&["leaf", "--prior", "cab=40:20:log"], &["NAME=MEAN:SD"]);
    call(&["leaf", "--prior", "n=1.5:0.1:ln"], &["n=MEAN:SD"]);
    call(&["leaf", "--prior", "cab=200:20"], &["0:150", "--bounds"]);
    call(&["leaf", "--prior", "cab=none"], &["cab=MEDIAN:3:ln"]);
    call(&["leaf", "--prior", "cab=40:20", "--fix", "cab=40"], &["--prior cab: the parameter is not free"]);
    call(&["leaf", "--prior", "cab=40:20", "--free", "cw"], &["--prior cab: the parameter is not free"]);
    call(&["leaf", "--prior", "cant=1:1", "--prospect", "5B"], &["--prior cant: the parameter is not free"]);
    call(&["leaf", "--prior", "cm=0.005:0.001", "--prospect", "PRO"], &["prot + cbc"]);
    call(&["leaf", "--prior", "car=8:2", "--car-per-cab", "0.25"], &["tied"]);
    call(&["leaf", "--prior", "gain=1:0.1", "--gain", "1"], &["gain is held and has a prior"]);
    call(&["leaf", "--prior", "gain=1:0.1", "--method", "joint"], &["--coupling gain-offset"]);
    call(&["leaf", "--prior", "cab=40:20,cab=30:20"], &["--prior cab stands twice"]);
    call(&["leaf", "--prior", "n=1.5:0.1", "--hold", "n=1.5"], &["n is held and has a prior"]);
    call(&["surface", "--hold", "n=1.5,n=1.6"], &["--hold n stands twice"]);
    call(&["surface", "--prior", "cab=40:20"], &["--prior cab", "--model leaf"]);
    call(&["bands", "--prior", "cab=40:20"], &["--prior"]);
    call(&["prospect", "--prior", "cab=40:20"], &["--prior"]);
}

#[test]
fn options_that_mean_nothing_and_values_in_other_units_are_refused_with_a_remedy() {
    let call = |options: &[&str], parts: &[&str]| {
        fails(&[&["fit", "none.csv", "-o", "nowhere"][..], options].concat(), 2, parts);
    };
    call(&["--model", "bands", "--method", "joint"], &["--method", "--model leaf"]);
    call(&["--model", "leaf", "--fix", "cm=20"], &["did you mean 20 g m⁻²"]);
    call(&["--model", "leaf", "--coupling", "bousquet"], &["--method joint"]);
    call(&["--model", "leaf", "--method", "joint", "--gain", "1"], &["--coupling gain-offset"]);
    call(&["--model", "leaf", "--free", "cab", "--fix", "cab=40"], &["cab is free and fixed"]);
    call(&["--model", "leaf", "--prospect", "5B", "--fix", "cant=2"], &["5B"]);
    call(&["--model", "leaf", "--n-prior"], &["--n-prior"]);
    call(&["--model", "leaf", "--hold", "cab=40"], &["--fix"]);
    call(&["--model", "leaf", "--fix", "n=1.5"], &["--hold"]);
    for cm in ["--bounds=cm=0:0.02", "--fix=cm=0.005"] {
        call(&["--model", "leaf", "--prospect", "PRO", cm], &["prot + cbc", "--fix prot=0,cbc=0"]);
    }
    call(&["--model", "leaf", "--bounds", "cw=0:10"], &["within 0:1", "did you mean 10 mg cm⁻²"]);
    call(&["--model", "prospect", "--bounds", "cm=0:20"], &["did you mean 20 g m⁻²"]);
    let two_step = ["--model", "leaf", "--method", "two-step", "--surface-from", "bands"];
    for (option, named) in [
        ("--facets=ggx", "--facets"),
        ("--diffuse=p1", "--diffuse"),
        ("--tilt", "a tilt"),
        ("--prior=n=1.5:0.1", "--prior"),
    ] {
        call(&[&two_step[..], &[option]].concat(), &["--surface-from bands", named]);
    }
    assert!(!Path::new("nowhere").exists());
}

#[test]
fn a_single_value_has_neither_infinities_nor_a_condition_number_in_its_words() {
    let folder = tempfile::tempdir().unwrap();
    let pixel = "# quantity: brf\ntheta_s_deg,30\ntheta_v_deg,0\nphi_v_deg,0\n550,0.1\n";
    let (input, out) = (file(folder.path(), "pixel.csv", pixel), folder.path().join("out"));
    let output = leafbrdf(&["fit", &input, "--model", "leaf", "-o", out.to_str().unwrap()]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{message}");
    assert!(message.contains("R2 undefined") && !message.contains("e307") && !message.contains("inf"), "{message}");
    assert_eq!(cell(&leaves(&out), "r2"), "");
}

#[test]
fn wavelengths_that_prospect_does_not_know_fail_by_name_and_the_others_are_done() {
    let folder = tempfile::tempdir().unwrap();
    let good = measured(folder.path(), "good.csv");
    let text = "# quantity: brf\ntheta_s_deg,30,30,30,30\ntheta_v_deg,0,20,40,60\nphi_v_deg,0,180,180,180\n300,0.1,0.1,0.1,0.1\n";
    let bad = file(folder.path(), "bad.csv", text);
    let out = folder.path().join("out");
    let output = leafbrdf(&["fit", &bad, &good, "--model", "leaf", "-o", out.to_str().unwrap()]);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("bad.csv: leaf bad:") && message.contains("400 to 2500 nm"), "{message}");
    let rows = leaves(&out);
    let status = rows.require("status").unwrap();
    assert_eq!([rows.text(0, status), rows.text(1, status)], ["failed", "done"]);
}
