//! `leafbrdf fit --model bands` as its user runs it: files in, files out, messages, exit status.

mod common;

use std::fmt::Write as _;
use std::fs;
use std::process::Command;

use common::{number, rows, run, stderr};
use leafbrdf_core::{Angle, Geometry, Leaf, Normalization, Surface};

const DIRECTIONS: [(f64, f64, f64); 14] = [
    (40.0, 0.0, 0.0),
    (40.0, 10.0, 180.0),
    (40.0, 20.0, 180.0),
    (40.0, 30.0, 180.0),
    (40.0, 40.0, 180.0),
    (40.0, 50.0, 180.0),
    (40.0, 60.0, 180.0),
    (40.0, 30.0, 150.0),
    (40.0, 45.0, 150.0),
    (40.0, 60.0, 120.0),
    (40.0, 30.0, 90.0),
    (40.0, 60.0, 0.0),
    (40.0, 50.0, 30.0),
    (40.0, 80.0, 180.0),
];

fn k_l(wavelength: u32) -> f64 {
    if wavelength < 700 { 0.05 } else { 0.45 }
}

/// A wide file of exact BRF (or BRDF) of a leaf with n = 1.5, σ = 0.25, six bands.
fn wide(normalization: Normalization, quantity: &str) -> String {
    let mut text = format!("# species: simulated\n# quantity: {quantity}\n");
    type AngleOf = fn(&(f64, f64, f64)) -> f64;
    let angles: [(&str, AngleOf); 3] = [("theta_s_deg", |d| d.0), ("theta_v_deg", |d| d.1), ("phi_v_deg", |d| d.2)];
    for (name, angle) in angles {
        text.push_str(name);
        DIRECTIONS.iter().for_each(|d| write!(text, ",{}", angle(d)).unwrap());
        text.push('\n');
    }
    for wavelength in [480, 550, 670, 700, 780, 879] {
        write!(text, "{wavelength}").unwrap();
        for d in DIRECTIONS {
            let value = leaf(wavelength, normalization).brdf(&geometry(d));
            let value = if quantity == "brf" { value * std::f64::consts::PI } else { value };
            write!(text, ",{value}").unwrap();
        }
        text.push('\n');
    }
    text
}

fn leaf(wavelength: u32, normalization: Normalization) -> Leaf<f64> {
    Leaf::new(k_l(wavelength), Surface::new(1.5, 0.25).unwrap().with_normalization(normalization)).unwrap()
}

fn geometry((theta_s, theta_v, phi_v): (f64, f64, f64)) -> Geometry<f64> {
    let deg = Angle::from_degrees;
    Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).unwrap()
}

#[test]
fn exact_data_give_the_truth_back_under_either_normalisation() {
    for (name, normalization) in
        [("bousquet2005", Normalization::Bousquet2005), ("cook-torrance", Normalization::CookTorrance)]
    {
        for quantity in ["brf", "brdf"] {
            let folder = tempfile::tempdir().unwrap();
            fs::write(folder.path().join("leaf.csv"), wide(normalization, quantity)).unwrap();
            let output =
                run(folder.path(), &["fit", "leaf.csv", "--model", "bands", "--normalization", name, "-o", "out"]);
            assert!(output.status.success(), "{}", stderr(&output));
            let bands = rows(&folder.path().join("out/bands.csv"));
            assert_eq!(bands.len(), 6);
            for row in &bands {
                let wavelength = number(row, "wavelength_nm") as u32;
                // data with 17 digits: the fit stops at rounding, about 1e-8 of each parameter
                assert!((number(row, "k_l") - k_l(wavelength)).abs() < 1e-7, "{row:?}");
                assert!((number(row, "n") - 1.5).abs() < 1e-6 && (number(row, "sigma") - 0.25).abs() < 1e-6, "{row:?}");
                // one direction lies beyond 70°
                assert_eq!(
                    (row["n_obs"].as_str(), row["status"].as_str(), row["at_bound"].as_str()),
                    ("13", "converged", "")
                );
                assert_eq!(row["normalization"], name);
                assert!(number(row, "rmse") < 1e-9 && number(row, "n_se") < 1e-6);
            }
            // DHRF: the diffuse part is k_L exactly (Eq. 13), and the sum is the sum
            let dhrf = rows(&folder.path().join("out/dhrf.csv"));
            assert_eq!(dhrf.len(), 6);
            for (row, band) in dhrf.iter().zip(&bands) {
                assert_eq!(row["dhrf_diffuse"], band["k_l"]);
                assert_eq!(number(row, "dhrf"), number(row, "dhrf_diffuse") + number(row, "dhrf_specular"));
                assert_eq!(row["theta_s_deg"], "40");
            }
            let summary: serde_json::Value =
                serde_json::from_slice(&fs::read(folder.path().join("out/summary.json")).unwrap()).unwrap();
            assert_eq!(summary["model"], "bands");
            assert_eq!(summary["normalization"], name);
            assert_eq!(summary["metadata"]["species"], "simulated");
            assert_eq!(summary["values"]["used"], 78);
            assert_eq!(summary["values"]["left_out"]["beyond_max_theta_v"], 6);
            assert!((summary["parameters"]["n"]["mean_over_bands"].as_f64().unwrap() - 1.5).abs() < 1e-6);
            assert!(summary["spectral_invariance"]["all"]["n"].as_f64().unwrap() < 1e-5);
            assert!(summary["r2"].as_f64().unwrap() > 0.999_999);
            let leaves = rows(&folder.path().join("out/leaves.csv"));
            assert_eq!((leaves.len(), leaves[0]["leaf"].as_str(), leaves[0]["status"].as_str()), (1, "leaf", "done"));
        }
    }
}

#[test]
fn the_columns_are_those_of_the_contract_in_its_order() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    assert!(run(folder.path(), &["fit", "leaf.csv", "--model", "bands", "-o", "out"]).status.success());
    let first_line = |name: &str| {
        fs::read_to_string(folder.path().join("out").join(name)).unwrap().lines().next().unwrap().to_string()
    };
    assert!(
        first_line("bands.csv")
            .starts_with("wavelength_nm,k_l,n,sigma,rmse,n_obs,status,at_bound,k_l_se,n_se,sigma_se,")
    );
    assert!(first_line("dhrf.csv").starts_with("wavelength_nm,theta_s_deg,dhrf_diffuse,dhrf_specular,dhrf,"));
    assert!(first_line("leaves.csv").starts_with(
        "leaf,status,model,normalization,n,sigma,tilt_in_plane_deg,tilt_lateral_deg,n_struct,cab,car,cant,cbrown,cw,cm,prot,cbc,rmse,r2,"
    ));
}

#[test]
fn every_model_names_value_standard_error_and_correlations_alike() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    for model in ["bands", "surface", "leaf"] {
        let output = run(folder.path(), &["fit", "leaf.csv", "--model", model, "-o", "out"]);
        assert!(output.status.success(), "{model}: {}", stderr(&output));
        let summary = fs::read(folder.path().join("out/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_slice(&summary).unwrap();
        for key in
            ["program", "model", "normalization", "rmse", "r2", "values", "spectral_invariance", "warnings", "errors"]
        {
            assert!(summary.get(key).is_some(), "{model}: no {key}");
        }
        let row = &rows(&folder.path().join("out/leaves.csv"))[0];
        for name in ["n", "sigma"] {
            let parameter = &summary["parameters"][name];
            // serde_json reads a number to a unit or two in its last place
            let same = |json: &serde_json::Value, cell: &str| match json.as_f64() {
                Some(value) => (value / cell.parse::<f64>().unwrap() - 1.0).abs() < 1e-15,
                None => cell.is_empty(),
            };
            assert!(same(&parameter["value"], &row[name]), "{model}: {name} {parameter}");
            assert!(same(&parameter["standard_error"], &row[&format!("{name}_se")]), "{model}: {name} {parameter}");
        }
        assert!(summary["correlations"]["n,sigma"].is_number(), "{model}: {}", summary["correlations"]);
    }
}

#[test]
fn several_leaves_get_a_folder_each_and_one_that_fails_stops_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("a.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    fs::write(path("b.csv"), wide(Normalization::Bousquet2005, "brdf")).unwrap();
    fs::write(path("broken.csv"), "# quantity: brf\ntheta_s_deg,30\ntheta_v_deg,60\nphi_v_deg,180\n550,x\n").unwrap();
    let output = run(folder.path(), &["fit", "a.csv", "broken.csv", "b.csv", "--model", "bands", "-o", "out"]);
    assert_eq!(output.status.code(), Some(1));
    let message = stderr(&output);
    assert!(message.contains("broken.csv") && message.contains("1 of 3 leaves failed"), "{message}");
    assert!(path("out/a/bands.csv").exists() && path("out/b/bands.csv").exists() && !path("out/broken").exists());
    let leaves = rows(&path("out/leaves.csv"));
    let status: Vec<_> = leaves.iter().map(|row| (row["leaf"].as_str(), row["status"].as_str())).collect();
    assert_eq!(status, [("a", "done"), ("broken", "failed"), ("b", "done")]);
    assert!(leaves[1]["message"].contains("line 5"), "{:?}", leaves[1]);
}

#[test]
fn a_leaf_named_like_a_file_of_the_output_leaves_it_its_place() {
    let folder = tempfile::tempdir().unwrap();
    let mut long = String::from("wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf,sample\n");
    for sample in ["leaves.csv", "figures"] {
        for theta_v in [0, 10, 20, 30, 40, 50] {
            writeln!(long, "550,30,{theta_v},180,0.1{theta_v},{sample}").unwrap();
        }
    }
    fs::write(folder.path().join("odd.csv"), long).unwrap();
    let output = run(folder.path(), &["fit", "odd.csv", "--model", "surface", "--plots", "-o", "out"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let leaves = rows(&folder.path().join("out/leaves.csv"));
    assert_eq!([&leaves[0]["leaf"], &leaves[1]["leaf"]], ["leaves.csv", "figures"]);
    assert!(folder.path().join("out/_leaves.csv/summary.json").exists());
    assert!(folder.path().join("out/_figures/figures").is_dir());
}

#[test]
fn two_leaves_of_one_name_do_not_overwrite_each_other() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("x")).unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    fs::write(folder.path().join("x/leaf.csv"), wide(Normalization::CookTorrance, "brf")).unwrap();
    let output = run(folder.path(), &["fit", "leaf.csv", "x/leaf.csv", "--model", "bands", "-o", "out"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("would overwrite"), "{}", stderr(&output));
    assert!((number(&rows(&folder.path().join("out/leaf/bands.csv"))[0], "n") - 1.5).abs() < 1e-6);
}

#[test]
fn wavelengths_directions_and_bounds_are_the_ones_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    let arguments = ["fit", "leaf.csv", "--model", "bands", "--wavelengths", "500:800", "--max-theta-v", "90"];
    let output = run(folder.path(), &[&arguments[..], &["--n-bounds", "1.1:1.4", "-o", "out"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("n sits at a bound in 4 of 4 bands"), "{}", stderr(&output));
    let bands = rows(&folder.path().join("out/bands.csv"));
    let wavelengths: Vec<_> = bands.iter().map(|row| row["wavelength_nm"].as_str()).collect();
    assert_eq!(wavelengths, ["550", "670", "700", "780"]);
    for row in &bands {
        assert_eq!((row["n"].as_str(), row["at_bound"].as_str(), row["n_se"].as_str()), ("1.4", "n=upper", ""));
        assert_eq!(row["n_obs"], "14");
        assert!(row["note"].contains("n held at its upper bound"), "{row:?}");
    }
}

#[test]
fn wrong_usage_is_status_2_and_says_what_was_expected() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    for (arguments, expected) in [
        (&["--wavelengths", "0.48:0.88"][..], "µm"),
        (&["--wavelengths", "900"], "FIRST:LAST"),
        (&["--n-bounds", "2:1"], "LOWER < UPPER"),
        (&["--n-bounds", "0.5:2"], "bounds of n"),
        (&["--sigma-bounds", "0:1"], "bounds of sigma"),
        (&["--start-n", "7"], "--start-n 7 lies outside"),
        (&["--max-theta-v=-3"], "0 to 90"),
        (&["--starts", "0"], "1..=12"),
        (&["--starts", "5"], "1 to 4 for --model bands"),
        (&["--normalization", "4pi"], "cook-torrance"),
    ] {
        let output = run(folder.path(), &[&["fit", "leaf.csv", "--model", "bands", "-o", "out"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
    }
    assert_eq!(run(folder.path(), &["fit", "leaf.csv", "-o", "out"]).status.code(), Some(2));
}

#[test]
fn a_selection_that_leaves_nothing_is_an_error_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    let oblique = "# quantity: brf\ntheta_s_deg,30\ntheta_v_deg,80\nphi_v_deg,180\n550,0.2\n";
    fs::write(folder.path().join("oblique.csv"), oblique).unwrap();
    for (arguments, expected) in [
        (&["leaf.csv", "--wavelengths", "1000:1100"][..], "the file has 480 to 879 nm"),
        (&["oblique.csv"], "--max-theta-v"),
        (&["none.csv"], "none.csv"),
    ] {
        let output = run(folder.path(), &[&["fit", "--model", "bands", "-o", "out"], arguments].concat());
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        assert!(stderr(&output).contains(expected), "{arguments:?}: {}", stderr(&output));
    }
}

#[test]
fn too_few_values_in_a_band_are_said_and_the_other_bands_are_done() {
    let folder = tempfile::tempdir().unwrap();
    let mut lines: Vec<String> = wide(Normalization::Bousquet2005, "brf").lines().map(String::from).collect();
    // 550 nm: two values are left; 670 nm: one is missing
    let cells: Vec<&str> = lines[6].split(',').collect();
    let shortened = std::iter::once(cells[0])
        .chain(cells[1..].iter().enumerate().map(|(i, cell)| if i < 2 { *cell } else { "NA" }));
    lines[6] = shortened.collect::<Vec<_>>().join(",");
    let cells: Vec<&str> = lines[7].split(',').collect();
    lines[7] = [&[cells[0], ""], &cells[2..]].concat().join(",");
    fs::write(folder.path().join("leaf.csv"), lines.join("\n")).unwrap();
    let output = run(folder.path(), &["fit", "leaf.csv", "--model", "bands", "-o", "out"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("1 of 6 bands have fewer than 3 values"), "{}", stderr(&output));
    let bands = rows(&folder.path().join("out/bands.csv"));
    assert_eq!((bands[1]["status"].as_str(), bands[1]["n"].as_str()), ("too_few_values", ""));
    assert!(bands[1]["note"].contains("fewer than 3"), "{:?}", bands[1]);
    assert_eq!((bands[2]["n_obs"].as_str(), bands[2]["status"].as_str()), ("12", "converged"));
    assert!((number(&bands[2], "n") - 1.5).abs() < 1e-6);
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["values"]["left_out"]["missing"], 12);
    // six bands cannot tell each direction's noise
    assert_eq!(summary["noise_of_standard_errors"], leafbrdf_fit::band::Noise::Alike.words());
}

#[test]
fn a_leaf_of_which_no_band_can_be_fitted_fails_with_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let two = "# quantity: brf\ntheta_s_deg,30,30\ntheta_v_deg,0,30\nphi_v_deg,0,180\n550,0.1,0.2\n600,0.1,0.2\n";
    fs::write(folder.path().join("two.csv"), two).unwrap();
    fs::write(folder.path().join("none.csv.gz"), "").unwrap();
    assert!(!run(folder.path(), &["fit", "none.csv.gz", "--model", "bands", "-o", "none"]).status.success());
    assert_eq!(
        rows(&folder.path().join("none/leaves.csv"))[0]["leaf"],
        "none",
        "as it would be called if it were read"
    );
    let output = run(folder.path(), &["fit", "two.csv", "--model", "bands", "-o", "out"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    assert!(stderr(&output).contains("no wavelength has the 3 values") && stderr(&output).contains("--hold n=1.5"));
    assert_eq!(rows(&folder.path().join("out/leaves.csv"))[0]["status"], "failed");
    assert!(!folder.path().join("out/bands.csv").exists());
}

#[test]
fn a_folder_named_like_standard_output_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    for call in [&["fit", "leaf.csv", "--model", "bands", "-o", "-"][..], &["demo", "-o", "-"]] {
        let output = run(folder.path(), call);
        assert_eq!(output.status.code(), Some(2), "{call:?}");
        assert!(stderr(&output).contains("name of a folder"), "{}", stderr(&output));
        assert!(!folder.path().join("-").exists());
    }
}

#[test]
fn values_in_per_cent_are_warned_of_by_every_model() {
    let folder = tempfile::tempdir().unwrap();
    let brf = wide(Normalization::Bousquet2005, "brf");
    let percent = |line: &str| {
        let mut cells = line.split(',');
        let first = cells.next().unwrap().to_string();
        let values = cells.map(|cell| (100.0 * cell.parse::<f64>().unwrap()).to_string());
        std::iter::once(first).chain(values).collect::<Vec<_>>().join(",")
    };
    let numbers = |line: &str| line.starts_with(|c: char| c.is_ascii_digit());
    let lines = brf.lines().map(|line| if numbers(line) { percent(line) } else { line.to_string() });
    fs::write(folder.path().join("percent.csv"), lines.collect::<Vec<_>>().join("\n")).unwrap();
    fs::write(folder.path().join("leaf.csv"), brf).unwrap();
    for model in ["bands", "surface", "leaf"] {
        let fit = |file: &str| stderr(&run(folder.path(), &["fit", file, "--model", model, "-o", "out"]));
        assert!(fit("percent.csv").contains("are they per cent"), "{model}");
        assert!(!fit("leaf.csv").contains("per cent"), "{model}");
    }
}

#[test]
fn a_file_read_with_the_wrong_azimuth_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    let output = run(folder.path(), &["fit", "leaf.csv", "--model", "bands", "--azimuth", "forward_0", "-o", "out"]);
    assert!(output.status.success());
    assert!(stderr(&output).contains("warning: leaf"), "{}", stderr(&output));
    let summary = fs::read_to_string(folder.path().join("out/summary.json")).unwrap();
    assert!(summary.contains("azimuth"), "{summary}");
}

#[test]
fn standard_deviations_of_the_file_are_weights_and_can_be_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let long = |sd: fn(usize) -> String| {
        let mut text = String::from("wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brdf,sd\n");
        for (i, d) in DIRECTIONS.iter().enumerate() {
            // one wild value, of which the file says that it is uncertain
            let wild = if i == 10 { 0.05 } else { 0.0 };
            let value = leaf(550, Normalization::Bousquet2005).brdf(&geometry(*d)) + wild;
            writeln!(text, "550,{},{},{},{value},{}", d.0, d.1, d.2, sd(i)).unwrap();
        }
        text
    };
    fs::write(folder.path().join("leaf.csv"), long(|i| if i == 10 { "100".into() } else { "0.001".into() })).unwrap();
    let n = |arguments: &[&str]| {
        let output = run(folder.path(), &[&["fit", "leaf.csv", "--model", "bands", "-o", "out"], arguments].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        let row = rows(&folder.path().join("out/bands.csv")).remove(0);
        (number(&row, "n"), number(&row, "n_se"), number(&row, "rmse"))
    };
    let (weighted, error, rmse) = n(&[]);
    assert!((weighted - 1.5).abs() < 1e-4 && error > 1e-3, "{weighted} {error}");
    // rmse is of BRDF in sr⁻¹ whatever the weights: one residual of 0.05 among 13 values
    assert!((rmse - 0.05 / 13.0_f64.sqrt()).abs() < 1e-4, "{rmse}");
    let (plain, ..) = n(&["--ignore-sd"]);
    assert!((plain - 1.5).abs() > 1e-3, "{plain}");

    fs::write(folder.path().join("leaf.csv"), long(|i| if i == 3 { String::new() } else { "0.001".into() })).unwrap();
    let output = run(folder.path(), &["fit", "leaf.csv", "--model", "bands", "-o", "out"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stderr(&output).contains("--ignore-sd") && stderr(&output).contains("theta_v 30"), "{}", stderr(&output));
}

#[test]
fn threads_change_no_byte_and_standard_input_is_a_file_too() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    let text = wide(Normalization::Bousquet2005, "brf");
    fs::write(folder.path().join("stdin.csv"), &text).unwrap();
    assert!(
        run(folder.path(), &["fit", "stdin.csv", "--model", "bands", "--threads", "1", "-o", "one"]).status.success()
    );
    assert!(
        run(folder.path(), &["fit", "stdin.csv", "--model", "bands", "--threads", "4", "-o", "four"]).status.success()
    );
    let mut child = Command::new(env!("CARGO_BIN_EXE_leafbrdf"))
        .current_dir(folder.path())
        .args(["fit", "-", "--model", "bands", "-o", "piped"])
        .stdin(std::process::Stdio::piped())
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    assert!(child.wait().unwrap().success());
    for name in ["bands.csv", "dhrf.csv"] {
        let read = |run: &str| fs::read(folder.path().join(run).join(name)).unwrap();
        assert_eq!(read("one"), read("four"));
        assert_eq!(read("one"), read("piped"));
    }
}

#[test]
fn robust_fits_and_starts_of_ones_own_are_accepted() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), wide(Normalization::Bousquet2005, "brf")).unwrap();
    let arguments =
        ["fit", "leaf.csv", "--model", "bands", "--robust", "--start-n", "2", "--start-sigma", "0.8", "--starts", "1"];
    let output = run(folder.path(), &[&arguments[..], &["-o", "out"]].concat());
    assert!(output.status.success(), "{}", stderr(&output));
    for row in rows(&folder.path().join("out/bands.csv")) {
        assert!((number(&row, "n") - 1.5).abs() < 1e-6, "{row:?}");
        assert_eq!(row["starts"], "2");
    }
}

/// Three directions in one band, two in the next.
const THREE_DIRECTIONS: &str = "wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brdf
550,40,0,0,0.03
550,40,40,180,0.09
550,40,60,180,0.05
650,40,0,0,0.02
650,40,40,180,0.08
";

#[test]
fn data_that_any_parameters_meet_are_refused_by_every_model_with_their_count_and_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), THREE_DIRECTIONS).unwrap();
    fs::write(folder.path().join("oak.csv"), "wavelength_nm,reflectance\n550,0.1\n700,0.2\n").unwrap();
    let reason = "no more values than parameters";
    for (arguments, parts) in [
        (&["leaf.csv", "--model", "bands"][..], ["3 values", "3 parameters: k_l, n, sigma", "more directions"]),
        (&["leaf.csv", "--model", "surface"], ["3 directions", "3 parameters: k_l, n, sigma", "--hold n=1.5"]),
        (&["leaf.csv", "--model", "leaf", "--method", "joint"], ["5 values", "n, sigma, n_struct, cab", "--hold"]),
        (&["oak.csv", "--model", "prospect"], ["2 values", "7 parameters: n_struct, cab", "--fix"]),
    ] {
        let output = run(folder.path(), &[&["fit"], arguments, &["-o", "out"]].concat());
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        for part in parts.into_iter().chain([reason, arguments[0]]) {
            assert!(message.contains(part), "{arguments:?}: no {part:?} in: {message}");
        }
        let leaves = rows(&folder.path().join("out/leaves.csv"));
        assert_eq!((leaves[0]["status"].as_str(), leaves[0]["rmse"].as_str()), ("failed", ""), "{arguments:?}");
        assert!(leaves[0]["message"].contains(reason), "{arguments:?}");
    }
}

#[test]
fn a_parameter_held_or_standard_deviations_give_few_directions_their_standard_errors() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("leaf.csv"), THREE_DIRECTIONS).unwrap();
    let with_sd = THREE_DIRECTIONS
        .replace("brdf\n", "brdf,sd\n")
        .lines()
        .enumerate()
        .fold(String::new(), |text, (line, row)| text + row + if line > 0 { ",0.002\n" } else { "\n" });
    fs::write(folder.path().join("sd.csv"), with_sd).unwrap();
    for (arguments, known) in [
        (&["leaf.csv", "--model", "surface", "--hold", "n=1.4"][..], "sigma_se"),
        (&["sd.csv", "--model", "surface"], "sigma_se"),
        (&["sd.csv", "--model", "bands"], "sigma_se"),
    ] {
        let output = run(folder.path(), &[&["fit"], arguments, &["-o", "out"]].concat());
        assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
        let bands = rows(&folder.path().join("out/bands.csv"));
        assert!(number(&bands[0], known) > 0.0, "{arguments:?}: {:?}", bands[0]);
    }
}
