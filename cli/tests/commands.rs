//! The commands as a user meets them: values, columns, messages, exit codes.
//!
//! The golden files are those of model-core; what made them is said at their top.

mod common;

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use common::{fails, leafbrdf, leafbrdf_with, table_with};
use leafbrdf::points::Points;

/// The table that a successful run prints.
#[track_caller]
fn table(arguments: &[&str]) -> Points {
    table_with(arguments, b"")
}

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../model-core/tests/golden").join(name)
}

fn number(table: &Points, row: usize, column: &str) -> f64 {
    table.number(row, table.require(column).unwrap()).unwrap()
}

/// The largest relative difference between a printed column and a golden one, where the golden one is above `floor`.
fn worst(printed: &Points, column: &str, golden: &Points, reference: &str, floor: f64) -> f64 {
    assert_eq!(printed.len(), golden.len());
    let (column, reference) = (printed.require(column).unwrap(), golden.require(reference).unwrap());
    let pairs =
        (0..golden.len()).map(|row| (printed.number(row, column).unwrap(), golden.number(row, reference).unwrap()));
    pairs
        .filter(|(_, expected)| expected.abs() > floor)
        .map(|(found, expected)| (found / expected - 1.0).abs())
        .fold(0.0, f64::max)
}

// Values.

#[test]
fn brdf_agrees_with_forty_digit_arithmetic() {
    let file = golden("brdf_reference.csv");
    let points = Points::read(&file).unwrap();
    for (normalization, reference) in [("bousquet2005", "f_2pi2"), ("cook-torrance", "f_4pi")] {
        let printed = table(&["brdf", "--points", file.to_str().unwrap(), "--normalization", normalization]);
        // Demanded: 1e-12 wherever BRDF > 1e-200. The density underflows with it.
        for (column, reference, floor) in [
            ("brdf_specular", reference, 1e-200),
            ("brdf", reference, 1e-200),
            ("fresnel", "F", 0.0),
            ("masking", "G", 0.0),
            ("density", "D_beckmann", 1e-200),
            ("theta_a_deg", "theta_a_deg", 1e-9),
            ("alpha_deg", "alpha_deg", 1e-9),
        ] {
            let worst = worst(&printed, column, &points, reference, floor);
            assert!(worst < 1e-12, "{column}: {worst:e}");
        }
        assert_eq!(printed.text(0, printed.require("normalization").unwrap()), normalization);
    }
}

#[test]
fn fresnel_agrees_with_forty_digit_arithmetic() {
    let file = golden("fresnel_reference.csv");
    let points = Points::read(&file).unwrap();
    let printed = table(&["fresnel", "--points", file.to_str().unwrap()]);
    for row in 0..points.len() {
        for (column, reference) in [("f", "F"), ("r_s", "R_s"), ("r_p", "R_p")] {
            // Demanded: 1e-12 absolute for the polarisations.
            let difference = number(&printed, row, column) - number(&points, row, reference);
            assert!(difference.abs() < 1e-12, "{column}: {difference:e}");
        }
    }
    assert!(worst(&printed, "f", &points, "F", 0.0) < 1e-12);
}

#[test]
fn dhrf_agrees_with_adaptive_quadrature() {
    // The reference is good to 4e-13; demanded: 2e-10.
    let file = golden("dhrf_reference.csv");
    let points = Points::read(&file).unwrap();
    let printed = table(&["dhrf", "--points", file.to_str().unwrap(), "--normalization", "cook-torrance"]);
    let worst = worst(&printed, "dhrf_specular", &points, "dhrf_4pi", 0.0);
    assert!(worst < 2e-10, "{worst:e}");
}

#[test]
fn dhrf_of_a_smooth_absorbing_surface_is_its_fresnel_factor() {
    // At normal incidence F varies by θ⁴ only, and σ = 0.001: far below 1e-9.
    let smooth = ["dhrf", "--n=1.5", "--kappa=0.5", "--sigma=0.001", "--theta-s=0", "--normalization=cook-torrance"];
    assert!((number(&table(&smooth), 0, "dhrf_specular") - 0.5 / 6.5).abs() < 1e-9);
}

#[test]
fn the_convention_as_printed_is_smaller_by_two_over_pi() {
    let as_printed = table(&["dhrf", "--n", "1.4", "--sigma", "0.3", "--theta-s", "0,60"]);
    let derived =
        table(&["dhrf", "--n", "1.4", "--sigma", "0.3", "--theta-s", "0,60", "--normalization", "cook-torrance"]);
    for row in 0..2 {
        let ratio = number(&as_printed, row, "dhrf_specular") / number(&derived, row, "dhrf_specular");
        assert!((ratio - std::f64::consts::FRAC_2_PI).abs() < 1e-15);
    }
}

#[test]
fn the_diffuse_part_is_k_l_over_pi() {
    let printed = table(&["brdf", "--n=1.5", "--sigma=0.3", "--k-l=0.4", "--theta-s=30", "--theta-v=0", "--phi-v=0"]);
    assert_eq!(number(&printed, 0, "brdf_diffuse"), 0.4 / std::f64::consts::PI);
    let sum = number(&printed, 0, "brdf_specular") + number(&printed, 0, "brdf_diffuse");
    assert!((number(&printed, 0, "brdf") - sum).abs() < 1e-15);
}

#[test]
fn absorption_adds_to_the_fresnel_factor_of_the_surface() {
    let at = |kappa: &str| {
        let list = ["brdf", "--n=1.5", "--kappa", kappa, "--sigma=0.3", "--theta-s=0", "--theta-v=0", "--phi-v=0"];
        number(&table(&list), 0, "fresnel")
    };
    assert!((at("0") - 0.04).abs() < 1e-15);
    // ((n − 1)² + κ²)/((n + 1)² + κ²)
    assert!((at("0.5") - 0.5 / 6.5).abs() < 1e-15);
}

// Columns, rows, formats.

#[test]
fn the_columns_are_those_of_the_contract() {
    let first_line = |arguments: &[&str]| {
        let output = leafbrdf(arguments);
        String::from_utf8(output.stdout).unwrap().lines().next().unwrap().to_string()
    };
    let brdf = first_line(&["brdf", "--n=1.5", "--sigma=0.3", "--theta-s=0", "--theta-v=0", "--phi-v=0"]);
    assert!(brdf.starts_with(
        "n,sigma,theta_s_deg,theta_v_deg,phi_v_deg,alpha_deg,theta_a_deg,fresnel,density,masking,brdf_specular,brdf_diffuse,brdf,"
    ));
    assert_eq!(first_line(&["fresnel", "--n=1.5", "--theta=0"]), "n,k,theta_deg,f,r_s,r_p");
    assert!(
        first_line(&["dhrf", "--n=1.5", "--sigma=0.3", "--theta-s=0"]).starts_with("n,sigma,theta_s_deg,dhrf_specular")
    );
}

#[test]
fn rows_are_the_product_of_the_lists_and_the_last_runs_fastest() {
    let list =
        ["brdf", "--n", "1.2,1.5", "--sigma", "0.3", "--theta-s", "30", "--theta-v", "0:60:30", "--phi-v", "-90,180"];
    let printed = table(&list);
    assert_eq!(printed.len(), 12);
    let row = |row| ["n", "theta_v_deg", "phi_v_deg"].map(|column| number(&printed, row, column));
    assert_eq!(row(0), [1.2, 0.0, -90.0]);
    assert_eq!(row(1), [1.2, 0.0, 180.0]);
    assert_eq!(row(2), [1.2, 30.0, -90.0]);
    assert_eq!(row(11), [1.5, 60.0, 180.0]);
}

#[test]
fn points_come_in_any_column_order_from_standard_input() {
    let points = b"\xef\xbb\xbfphi_v_deg,leaf,theta_v_deg,theta_s_deg,k_l,sigma,n\r\n180,a,60,60,0.1,0.078,1.22\r\n0,b,0,0,0.2,0.3,1.4\r\n";
    let printed = table_with(&["brdf", "--points", "-"], points);
    assert_eq!(printed.len(), 2);
    // The paper's laurel in the mirror direction: 1.25 sr⁻¹ (physics of Table 4).
    assert!((number(&printed, 0, "brdf_specular") - 1.25).abs() < 0.01);
    assert_eq!(number(&printed, 1, "k_l"), 0.2);
}

#[test]
fn json_and_table_hold_the_same_numbers_as_csv() {
    let list = ["fresnel", "--n", "1.3", "--theta", "10,55.5", "--format"];
    let run = |format: &str| String::from_utf8(leafbrdf(&[&list[..], &[format]].concat()).stdout).unwrap();
    let csv = run("csv");
    let rows: Vec<Vec<&str>> = csv.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let json = run("json");
    let table = run("table");
    for (row, line) in rows.iter().zip(table.lines().skip(1)) {
        assert_eq!(line.split_whitespace().collect::<Vec<_>>(), *row);
        for (name, cell) in ["n", "k", "theta_deg", "f", "r_s", "r_p"].iter().zip(row) {
            assert!(json.contains(&format!("\"{name}\": {cell}")), "{json}");
        }
    }
    assert!(json.starts_with("[\n {") && json.ends_with("}\n]\n"), "{json}");
}

// Wrong usage and bad inputs.

#[test]
fn an_option_out_of_range_is_wrong_usage() {
    let brdf = |change: &str| {
        let mut list = vec!["brdf", "--n=1.5", "--sigma=0.3", "--theta-s=30", "--theta-v=0", "--phi-v=0"];
        let flag = change.split('=').next().unwrap().to_string();
        list.retain(|argument| !argument.starts_with(&flag));
        [list, vec![change]].concat().into_iter().map(str::to_string).collect::<Vec<_>>()
    };
    for (change, parts) in [
        ("--n=0.9", ["--n: found 0.9", "1 ≤ n"]),
        ("--sigma=0", ["--sigma: found 0", "sigma"]),
        ("--sigma=-0.1", ["--sigma: found -0.1", "sigma"]),
        ("--kappa=-1", ["--kappa: found -1", "kappa"]),
        ("--k-l=1.5", ["--k-l: found 1.5", "k_L ≤ 1"]),
        ("--theta-s=90", ["--theta-s: found 90", "< 90°"]),
        ("--theta-v=0,95", ["--theta-v: found 95", "< 90°"]),
        ("--phi-v=400", ["--phi-v: found 400", "360°"]),
        ("--phi-v=nan", ["--phi-v", "is no number"]),
        ("--theta-v=0:10:-1", ["--theta-v", "never arrives"]),
        ("--theta-v=a", ["--theta-v", "is no number"]),
    ] {
        let arguments = brdf(change);
        fails(&arguments.iter().map(String::as_str).collect::<Vec<_>>(), b"", 2, &parts);
    }
    fails(&["brdf", "--n", "1.5"], b"", 2, &["--sigma"]);
    fails(&["brdf", "--points", "-", "--n", "1.5"], b"", 2, &["--n"]);
    fails(&["dhrf", "--n=1.5", "--sigma=0.3", "--theta-s=90"], b"", 2, &["--theta-s: found 90"]);
    fails(&["fresnel", "--n=1.5", "--theta=-1"], b"", 2, &["--theta: found -1"]);
    fails(&["no-such-command"], b"", 2, &["no-such-command"]);
    fails(&["brdf", "--normalization", "other"], b"", 2, &["bousquet2005", "cook-torrance"]);
}

#[test]
fn a_bad_row_of_points_is_named_by_line_and_column() {
    let names = "n,sigma,theta_s_deg,theta_v_deg,phi_v_deg\n";
    let with = |row: &str| format!("# a remark\n{names}1.5,0.3,30,0,0\n\n{row}\n");
    for (row, parts) in [
        ("0.9,0.3,30,0,0", ["standard input, line 5, column 1 (n): found \"0.9\"", "1 ≤ n"]),
        ("1.5,0.3,30,90,0", ["line 5, column 4 (theta_v_deg): found \"90\"", "< 90°"]),
        ("1.5,,30,0,0", ["line 5, column 2 (sigma)", "an empty cell: expected a number"]),
        ("1.5,0.3,x,0,0", ["line 5, column 3 (theta_s_deg)", "found \"x\": expected a number"]),
        ("1.5,0.3,30,0", ["line 5, column 4", "4 cells: expected 5"]),
    ] {
        fails(&["brdf", "--points", "-"], with(row).as_bytes(), 1, &parts);
    }
    fails(&["brdf", "--points", "-"], b"n,theta_s_deg\n1,2\n", 1, &["line 1", "no column sigma", "\"n, theta_s_deg\""]);
    fails(
        &["brdf", "--points", "-"],
        format!("n,{names}1,1,1,1,1,1\n").as_bytes(),
        1,
        &["line 1, column 2", "a second column n"],
    );
    fails(&["brdf", "--points", "-"], names.as_bytes(), 1, &["no row below"]);
    fails(&["brdf", "--points", "-"], b"", 1, &["standard input", "no row"]);
    fails(&["brdf", "--points", "no-such-file.csv"], b"", 1, &["no-such-file.csv: cannot be read"]);
    fails(&["fresnel", "--points", "-"], b"n;k;theta_deg\n1,5;0;0\n", 1, &["line 1", "semicolons"]);
}

// Files and pipes.

#[test]
fn a_result_file_is_whole_or_absent() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("f.csv");
    let name = path.to_str().unwrap();
    let good = ["fresnel", "--n=1.5", "--theta=0:80:10", "-o", name];
    assert!(leafbrdf(&good).status.success());
    let whole = std::fs::read(&path).unwrap();
    assert!(whole.starts_with(b"n,k,theta_deg") && whole.ends_with(b"\n"));
    // A failing run leaves the earlier file alone.
    fails(&["fresnel", "--n=1.5", "--theta=0,95", "--output", name], b"", 2, &["--theta"]);
    assert_eq!(std::fs::read(&path).unwrap(), whole);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no temporary file is left");
    let nowhere = folder.path().join("missing").join("f.csv");
    fails(
        &["fresnel", "--n=1.5", "--theta=0", "-o", nowhere.to_str().unwrap()],
        b"",
        1,
        &["f.csv", "cannot be written"],
    );
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    // More than any pipe holds.
    let mut child = Command::new(env!("CARGO_BIN_EXE_leafbrdf"))
        .args(["brdf", "--n=1.5", "--sigma=0.3", "--theta-s=0:80", "--theta-v=0:80", "--phi-v=0:360:30"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = [0; 100];
    child.stdout.take().unwrap().read_exact(&mut first).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

const WIDE: &str = "# species: Corylus avellana\n# quantity: brf\ntheta_s_deg,30,30\ntheta_v_deg,60,0\nphi_v_deg,180,0\n\
                    400,0.116,\n401,0.117,-0.002\n";

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_standard_output_is_named_so() {
    let brdf = ["brdf", "--n", "1.5", "--sigma", "0.3", "--theta-s", "10", "--theta-v", "20", "--phi-v", "180"];
    for call in [&["simulate", "--leaf", "beech"][..], &[&brdf[..], &["-o", "-"]].concat(), &brdf] {
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = Command::new(env!("CARGO_BIN_EXE_leafbrdf")).args(call).stdout(full).output().unwrap();
        assert_eq!(output.status.code(), Some(1), "{call:?}");
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(message.starts_with("error: standard output: cannot be written"), "{call:?}: {message}");
    }
}

#[test]
fn convert_goes_there_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    std::fs::write(path("a.csv"), WIDE).unwrap();
    let run = |arguments: &[&str]| {
        let output = leafbrdf(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let told = run(&[
        "convert",
        &path("a.csv"),
        &path("b.csv.gz"),
        "--layout=long",
        "--to-quantity=brdf",
        "--to-azimuth=forward_0",
    ]);
    assert!(told.contains("2 bands, 2 directions, 3 values, 1 missing, 1 negative"), "{told}");
    assert!(std::fs::read(path("b.csv.gz")).unwrap().starts_with(&[0x1f, 0x8b]));
    run(&[
        "convert",
        &path("b.csv.gz"),
        &path("c.csv"),
        "--layout=wide",
        "--to-quantity=brf",
        "--to-azimuth=forward_180",
    ]);
    let expected = WIDE.replace("# quantity: brf\n", "# quantity: brf\n# azimuth: forward_180\n");
    assert_eq!(std::fs::read_to_string(path("c.csv")).unwrap(), expected);
    // Through pipes as well.
    let output = leafbrdf_with(&["convert", "-", "-"], WIDE.as_bytes());
    assert_eq!(String::from_utf8(output.stdout).unwrap(), expected);
}

#[test]
fn convert_refuses_what_the_reader_refuses() {
    let no_quantity = WIDE.replace("# quantity: brf\n", "");
    fails(&["convert", "-", "-"], no_quantity.as_bytes(), 1, &["standard input", "--quantity"]);
    assert!(leafbrdf_with(&["convert", "-", "-", "--quantity", "brf"], no_quantity.as_bytes()).status.success());
    fails(&["convert", "-", "-", "--quantity", "brdf"], WIDE.as_bytes(), 1, &["line 2", "says brdf"]);
    fails(&["convert", "-"], WIDE.as_bytes(), 2, &["OUT"]);
    let several =
        "sample,wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf\na,400,30,60,180,0.2\nb,400,30,60,180,0.3\n";
    fails(&["convert", "-", "-", "--layout=wide"], several.as_bytes(), 1, &["one leaf"]);
    fails(&["convert", "-", "-", "--sample=c"], several.as_bytes(), 1, &["no sample \"c\"", "a, b"]);
    let chosen = leafbrdf_with(&["convert", "-", "-", "--layout=wide", "--sample=b"], several.as_bytes());
    assert!(String::from_utf8(chosen.stdout).unwrap().ends_with(
        "# sample: b\n# quantity: brf\n# azimuth: forward_180\ntheta_s_deg,30\ntheta_v_deg,60\nphi_v_deg,180\n400,0.3\n"
    ));
}

// Help.

#[test]
fn every_help_text_has_an_example() {
    let help = String::from_utf8(leafbrdf(&["--help"]).stdout).unwrap();
    let commands = help.split_once("Commands:").unwrap().1.split_once("Options:").unwrap().0;
    let names: Vec<&str> = commands
        .lines()
        .filter(|line| line.starts_with("  ") && !line.starts_with("   "))
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    for expected in ["brdf", "fresnel", "dhrf", "convert", "completions"] {
        assert!(names.contains(&expected), "no {expected} in {names:?}");
    }
    for name in names {
        let output = leafbrdf(&[name, "--help"]);
        assert!(output.status.success());
        let help = String::from_utf8(output.stdout).unwrap();
        assert!(help.contains("Example") && help.contains(&format!("leafbrdf {name}")), "{name}: {help}");
    }
}

#[test]
fn every_command_takes_a_number_of_threads() {
    let one = ["brdf", "--n", "1.5", "--sigma", "0.3", "--theta-s", "10,40", "--theta-v", "20", "--phi-v", "180"];
    let alone = leafbrdf(&one).stdout;
    for threads in ["1", "2"] {
        assert_eq!(leafbrdf(&[&one[..], &["--threads", threads]].concat()).stdout, alone);
        assert_eq!(leafbrdf(&[&["--threads", threads][..], &one[..]].concat()).stdout, alone);
    }
    fails(&[&one[..], &["--threads", "0"]].concat(), "", 2, &["1..=1024"]);
}

#[test]
fn version_and_completions_are_printed() {
    let version = String::from_utf8(leafbrdf(&["--version"]).stdout).unwrap();
    assert_eq!(version.trim(), format!("leafbrdf {}", env!("CARGO_PKG_VERSION")));
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = leafbrdf(&["completions", shell]);
        assert!(output.status.success() && String::from_utf8(output.stdout).unwrap().contains("theta-s"), "{shell}");
    }
    fails(&["completions", "no-such-shell"], b"", 2, &["bash"]);
}
