//! PROSPECT as its user meets it: `leafbrdf prospect`, and `leafbrdf fit --model prospect` from files to files.
//!
//! The golden file is that of the crate `prospect`; what made it is said in its `tests/golden.rs`.

mod common;

use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use common::{fails, leafbrdf_with, table_with};
use leafbrdf::points::Points;

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
    let ours = table_with(&["prospect", "--points", path.to_str().unwrap(), "--wavelengths", "400:2500:10"], "");
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
    for row in columns(&table_with(&["prospect", "--n-struct", "1.7", "--cab", "40", "--cw", "0.01"], ""), &names) {
        // one rounding of each
        assert!((row.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}

#[test]
fn wavelengths_come_in_the_order_asked_for_and_between_the_tables_interpolated() {
    let names = ["wavelength_nm", "reflectance"];
    let leaf = ["prospect", "--n-struct", "1.5", "--cab", "40", "--cm", "0.005"];
    let at = |list: &str| columns(&table_with(&[&leaf[..], &["--wavelengths", list]].concat(), ""), &names);
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
    let bands = table_with(&[&leaf[..], &["--bands", "705:15,1100:2"]].concat(), "");
    let rows = columns(&bands, &["wavelength_nm", "reflectance", "fwhm_nm"]);
    assert_eq!((rows[0][0], rows[0][2], rows.len()), (705.0, 15.0, 2));
    let fine = columns(
        &table_with(&[&leaf[..], &["--wavelengths", "650:760"]].concat(), ""),
        &["wavelength_nm", "reflectance"],
    );
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

// `leafbrdf fit --model prospect`

const LEAVES: &str = "leaf,version,n_struct,cab,car,cant,cbrown,cw,cm
green,D,1.45,42,9,1.2,0.03,0.011,0.006
thick,D,2.3,66,14,4,0.2,0.027,0.015
pale,D,1.2,9,4,0.5,0.1,0.006,0.0035
";

/// A file of spectra of several samples, simulated by the command.
fn simulated(leaves: &str, wavelengths: &str, columns: &[&str]) -> String {
    let points = Points::from_bytes("leaves", leaves.as_bytes()).unwrap();
    let spectra = table_with(&["prospect", "--points", "-", "--wavelengths", wavelengths], leaves);
    let bands = spectra.len() / points.len();
    let mut text = format!("# species: simulated\nsample,wavelength_nm,{}\n", columns.join(","));
    for (row, numbers) in self::columns(&spectra, &[&["wavelength_nm"], columns].concat()).iter().enumerate() {
        text.push_str(points.text(row / bands, points.require("leaf").unwrap()));
        numbers.iter().for_each(|number| write!(text, ",{number}").unwrap());
        text.push('\n');
    }
    text
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            fs::write(folder.path().join(name), text).unwrap();
        }
        Folder(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().unwrap().to_string()
    }

    /// Runs the fit of some files into `out`; status and standard error.
    fn fit(&self, files: &[&str], more: &[&str]) -> (Option<i32>, String) {
        let paths: Vec<String> = files.iter().map(|file| self.path(file)).collect();
        let mut arguments = vec!["fit"];
        arguments.extend(paths.iter().map(String::as_str));
        let out = self.path("out");
        arguments.extend(["--model", "prospect", "-o", &out]);
        arguments.extend(more);
        let output = leafbrdf_with(&arguments, b"");
        assert!(output.stdout.is_empty());
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    }

    fn table_with(&self, name: &str) -> Points {
        Points::read(Path::new(&self.path(name))).unwrap()
    }

    fn summary(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap()
    }
}

#[test]
fn leaves_come_back_through_files() {
    let names = ["n_struct", "cab", "car", "cant", "cbrown", "cw", "cm"];
    let truth = columns(&Points::from_bytes("leaves", LEAVES.as_bytes()).unwrap(), &names);
    // both spectra on the tables' wavelengths and between them, and each alone
    for (wavelengths, measured) in [
        ("400:2500:1", &["reflectance", "transmittance"][..]),
        ("410.5:2400:3.7", &["transmittance", "reflectance"]),
        ("400:2500:1", &["reflectance"]),
        ("400:2500:1", &["transmittance"]),
    ] {
        let folder = Folder::new(&[("sphere.csv", &simulated(LEAVES, wavelengths, measured))]);
        let (status, message) = folder.fit(&["sphere.csv"], &[]);
        assert_eq!(status, Some(0), "{message}");
        let leaves = folder.table_with("out/leaves.csv");
        for (row, (found, truth)) in columns(&leaves, &names).iter().zip(&truth).enumerate() {
            assert_eq!(leaves.text(row, leaves.require("leaf").unwrap()), ["green", "thick", "pale"][row]);
            assert_eq!(leaves.text(row, leaves.require("status").unwrap()), "done");
            for ((found, truth), name) in found.iter().zip(truth).zip(names) {
                // shortest round trip loses no bit of the spectra: rounding of the model only
                assert!((found / truth - 1.0).abs() < 1e-8, "{name} {found} {truth} from {measured:?}");
            }
        }
        let spectrum = folder.table_with("out/green/spectrum.csv");
        let modelled = format!("{}_modelled", measured[0]);
        for pair in columns(&spectrum, &[measured[0], &modelled]) {
            assert!((pair[0] - pair[1]).abs() < 1e-10);
        }
        let summary = folder.summary("out/green/summary.json");
        assert_eq!((&summary["model"], &summary["prospect"]), (&"prospect".into(), &"D".into()));
        assert_eq!(summary["metadata"]["species"], "simulated");
        assert!(summary["parameters"]["cab"]["standard_error"].as_f64().unwrap() < 1e-6);
        assert_eq!(summary["search"]["starts_that_agree"], 4);
    }
}

#[test]
fn the_columns_of_the_files_are_those_of_the_contract() {
    let folder = Folder::new(&[("oak.csv", &simulated(LEAVES, "400:2500:20", &["reflectance", "transmittance"]))]);
    assert_eq!(folder.fit(&["oak.csv"], &[]).0, Some(0));
    let first = |name: &str| fs::read_to_string(folder.path(name)).unwrap().lines().next().unwrap().to_string();
    assert!(first("out/leaves.csv").starts_with(
        "leaf,status,model,normalization,n,sigma,tilt_in_plane_deg,tilt_lateral_deg,n_struct,cab,car,cant,cbrown,cw,cm,prot,cbc,rmse,r2,"
    ));
    assert_eq!(
        first("out/thick/spectrum.csv"),
        "wavelength_nm,reflectance,transmittance,reflectance_modelled,transmittance_modelled"
    );
    let leaves = folder.table_with("out/leaves.csv");
    for empty in ["normalization", "n", "sigma", "tilt_lateral_deg", "prot", "cbc"] {
        assert_eq!(leaves.text(0, leaves.require(empty).unwrap()), "", "{empty}");
    }
}

#[test]
fn held_tied_and_split_parameters_are_told_apart() {
    let one = "leaf,version,n_struct,cab,car,cw,prot,cbc\na,PRO,1.6,40,10,0.01,0.001,0.005\n";
    let folder = Folder::new(&[("a.csv", &simulated(one, "400:2500:5", &["reflectance", "transmittance"]))]);
    let more = ["--prospect", "pro", "--car-per-cab", "0.25", "--fix", "cant=0,cbrown=0"];
    let (status, message) = folder.fit(&["a.csv"], &more);
    assert_eq!(status, Some(0), "{message}");
    let leaves = folder.table_with("out/leaves.csv");
    let row = &columns(&leaves, &["n_struct", "cab", "car", "cant", "cm", "prot", "cbc"])[0];
    for (found, truth) in row.iter().zip([1.6, 40.0, 10.0, 0.0, 0.006, 0.001, 0.005]) {
        assert!((found - truth).abs() <= 1e-8 * truth, "{row:?}");
    }
    let summary = folder.summary("out/summary.json");
    assert_eq!(summary["parameters"]["car"]["how"], "tied to cab");
    assert_eq!(summary["parameters"]["cant"]["how"], "held");
    assert_eq!(summary["parameters"]["cm"]["how"], "prot + cbc");
    assert!(summary["parameters"]["cm"]["standard_error"].is_number());
}

#[test]
fn the_prior_of_n_is_held_where_there_is_no_transmittance() {
    let one = "leaf,n_struct,cab,car,cw,cm\na,1.8,40,10,0.012,0.0065\n";
    let folder = Folder::new(&[("a.csv", &simulated(one, "400:2500:5", &["reflectance"]))]);
    let (status, message) = folder.fit(&["a.csv"], &["--n-prior", "--fix", "cant=0,cbrown=0"]);
    assert_eq!(status, Some(0), "{message}");
    let summary = folder.summary("out/summary.json");
    assert_eq!(summary["parameters"]["n_struct"]["how"], "from the plateau, held");
    assert!(summary["n_prior"]["standard_deviation"].as_f64().unwrap() > 0.01);
    // the ordinary leaf of the prior: N to the precision of its bisection, and with it everything else
    let row = &columns(&folder.table_with("out/leaves.csv"), &["n_struct", "cab"])[0];
    assert!((row[0] - 1.8).abs() < 1e-6 && (row[1] - 40.0).abs() < 1e-3, "{row:?}");
}

/// Up to 1000 nm, R alone hardly tells scattering from dry matter.
#[test]
fn parameters_that_are_only_known_together_are_named_with_the_remedy() {
    let mut file = String::from("wavelength_nm,reflectance\n");
    let spectrum = simulated(LEAVES, "400:1000:1", &["reflectance"]);
    for (index, row) in spectrum.lines().filter_map(|line| line.strip_prefix("green,")).enumerate() {
        let (nm, value) = row.split_once(',').unwrap();
        // an error that is no leaf's: up and down from one wavelength to the next
        let error = if index % 2 == 0 { 0.003 } else { -0.003 };
        writeln!(file, "{nm},{}", value.parse::<f64>().unwrap() + error).unwrap();
    }
    let folder = Folder::new(&[("a.csv", &file)]);
    let (status, message) = folder.fit(&["a.csv"], &[]);
    assert_eq!(status, Some(0), "{message}");
    assert!(message.contains("n_struct and cm (") && message.contains("--n-prior"), "{message}");
    assert!(message.contains("known to half of its value at best: cm"), "{message}");
}

#[test]
fn missing_values_sd_and_wavelengths_outside_are_counted() {
    let file = "wavelength_nm,reflectance,transmittance,reflectance_sd,transmittance_sd,remark\n\
                350,0.05,0.01,0.01,0.01,x\n550,0.13,0.12,0.01,0.01,x\n670,-0.001,,0.01,,x\n700,0.13,0.12,0.01,0.01,\n\
                800,0.45,0.46,0.01,0.01,\n900,NaN,0.46,,0.01,\n1000,0.45,0.47,0.01,0.01,\n";
    let folder = Folder::new(&[("a.csv", file)]);
    let (status, message) = folder.fit(&["a.csv"], &["--free", "n_struct,cab,cm", "--fix", "car=8"]);
    assert_eq!(status, Some(0), "{message}");
    let summary = folder.summary("out/summary.json");
    assert_eq!(summary["weights"], "1/sd^2");
    let values = &summary["values"];
    assert_eq!((&values["used"], &values["negative_among_them"]), (&10.into(), &1.into()));
    assert_eq!(values["left_out"], serde_json::json!({"missing": 2, "other_wavelengths": 2}));
    assert_eq!(summary["wavelengths_nm"]["first"], 550.0);

    let ranged = ["--free", "n_struct,cab", "--wavelengths", "500:800", "--ignore-sd"];
    assert_eq!(folder.fit(&["a.csv"], &ranged).0, Some(0));
    let summary = folder.summary("out/summary.json");
    assert_eq!((&summary["weights"], &summary["wavelengths_nm"]["count"]), (&"equal".into(), &4.into()));
}

#[test]
fn every_rule_of_spectra_files_has_its_message() {
    let refused = |file: &str, parts: &[&str]| {
        let folder = Folder::new(&[("bad.csv", file)]);
        let (status, message) = folder.fit(&["bad.csv"], &[]);
        assert_eq!(status, Some(1), "{message}");
        for part in parts.iter().chain(&["bad.csv", "1 of 1 leaves failed"]) {
            assert!(message.contains(part), "no {part:?} in: {message}");
        }
        assert!(!Path::new(&folder.path("out/summary.json")).exists());
        let leaves = folder.table_with("out/leaves.csv");
        assert_eq!(leaves.text(0, leaves.require("status").unwrap()), "failed");
    };
    let head = "wavelength_nm,reflectance\n";
    refused("", &["has no data"]);
    refused(head, &["no row of values"]);
    refused("wavelength,reflectance\n550,0.1\n", &["line 1", "names are matched exactly"]);
    refused("wavelength_nm;reflectance\n550;0,1\n", &["semicolons"]);
    refused("wavelength_nm,rho\n550,0.1\n", &["no column reflectance or transmittance"]);
    refused("# quantity: brf\ntheta_s_deg,30\ntheta_v_deg,60\nphi_v_deg,180\n550,0.2\n", &["--model bands"]);
    refused("wavelength_nm,reflectance,reflectance\n550,0.1,0.1\n", &["second column reflectance"]);
    refused("wavelength_nm,reflectance,transmittance_sd\n550,0.1,0.1\n", &["without a column transmittance"]);
    refused(&format!("{head}550,45\n"), &["line 2, column 2 (reflectance)", "per cent? 45 % is 0.45"]);
    refused(&format!("{head}550,4500\n"), &["scaled by 10000"]);
    refused(&format!("{head}550,-9999\n"), &["Leave the cell empty"]);
    refused(&format!("{head}0.55,0.1\n"), &["line 2, column 1 (wavelength_nm)", "0.55 µm is 550 nm"]);
    refused(&format!("{head}550,0.1,3\n"), &["3 cells: expected 2"]);
    refused(&format!("{head}550,0.1\n560,0.2\n550,0.1\n"), &["line 4", "stands in line 2 already"]);
    refused(&format!("{head}550,\n560,NA\n"), &["every value is missing"]);
    refused(&format!("{head}550,n.d.\n"), &["missing value?"]);
    refused(&format!("{head}300,0.1\n310,0.2\n"), &["no wavelength is left"]);
    refused("wavelength_nm,reflectance,sample\n550,0.1,\n", &["name of a sample"]);
    refused(
        "wavelength_nm,reflectance,reflectance_sd\n550,0.1,0\n",
        &["no positive standard deviation", "--ignore-sd"],
    );
}

#[test]
fn one_leaf_that_fails_stops_no_other_and_no_name_is_used_twice() {
    let good = simulated(LEAVES, "400:2500:20", &["reflectance", "transmittance"]);
    let folder = Folder::new(&[("a.csv", &good), ("bad.csv", "wavelength_nm\n550\n"), ("again.csv", &good)]);
    let (status, message) = folder.fit(&["a.csv", "bad.csv", "again.csv"], &["--threads", "2"]);
    assert_eq!(status, Some(1));
    assert!(message.contains("4 of 7 leaves failed") && message.contains("would overwrite"), "{message}");
    let leaves = folder.table_with("out/leaves.csv");
    let status: Vec<&str> = (0..leaves.len()).map(|row| leaves.text(row, 1)).collect();
    assert_eq!(status, ["done", "done", "done", "failed", "failed", "failed", "failed"]);
}

#[test]
fn chlorophyll_in_milligrams_is_warned_of_and_computed_all_the_same() {
    let call = |cab: &str| leafbrdf_with(&["prospect", "--n-struct", "1.5", "--cab", cab, "--wavelengths", "680"], "");
    let output = call("0.04");
    let warning = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && warning.contains("0.04 mg cm⁻² = 40 µg cm⁻²"), "{warning}");
    assert!(call("0").stderr.is_empty() && call("40").stderr.is_empty());
}

#[test]
fn options_that_contradict_each_other_are_wrong_usage() {
    let folder = Folder::new(&[("a.csv", "wavelength_nm,reflectance\n550,0.1\n")]);
    for (more, part) in [
        (&["--fix", "cab=40", "--free", "cab,n_struct"][..], "cab is free and fixed"),
        (&["--fix", "cm=20"], "20 g m⁻² = 0.002 g cm⁻²"),
        (&["--fix", "cm"], "expected NAME=VALUE"),
        (&["--free", "chlorophyll"], "is no parameter: expected one of n_struct, cab"),
        (&["--free", "cab"], "n_struct is neither free nor held"),
        (&["--free", "n_struct,prot"], "no coefficients for prot"),
        (&["--prospect", "PRO", "--free", "n_struct,cm,prot"], "prot + cbc"),
        (&["--car-per-cab", "0.25", "--free", "n_struct,car"], "tied to cab"),
        (&["--bounds", "cab=0:1000"], "within 0:300"),
        (&["--bounds", "cab=0:80", "--fix", "cab=40"], "not free"),
        (&["--quantity", "brf"], "--quantity has no meaning for --model prospect"),
        (&["--robust"], "--robust has no meaning"),
    ] {
        let (status, message) = folder.fit(&["a.csv"], more);
        assert_eq!(status, Some(2), "{more:?}: {message}");
        assert!(message.contains(part), "{more:?}: no {part:?} in: {message}");
    }
    let (file, out) = (folder.path("a.csv"), folder.path("out"));
    let bands = leafbrdf_with(&["fit", &file, "--model", "bands", "-o", &out, "--n-prior"], b"");
    assert_eq!(bands.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&bands.stderr).contains("--n-prior is an option of --model prospect"));
}
