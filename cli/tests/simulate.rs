//! `leafbrdf simulate` as a user meets it, and the laws of what it writes.

use std::f64::consts::PI;
use std::path::Path;
use std::process::{Command, Output};

use leafbrdf::measurement::{Direction, Measurement, Metadata, Quantity, ReadOptions, read_bytes};
use leafbrdf::points::Points;
use leafbrdf::simulate::{AnyDiffuse, AnySurface, FacetKind, Instrument, LeafModel, Noise, paper_directions, presets};
use leafbrdf_core::{Normalization, P1, Surface};
use leafbrdf_prospect::{Coupling, LeafParams, Parameter};

fn simulate(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leafbrdf")).arg("simulate").args(arguments).output().unwrap()
}

/// The text of a measurement file.
#[track_caller]
fn text(arguments: &[&str]) -> String {
    let output = simulate(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[track_caller]
fn leaf(arguments: &[&str]) -> Measurement {
    let [leaf] =
        <[_; 1]>::try_from(read_bytes("simulated.csv", text(arguments).as_bytes(), &ReadOptions::default()).unwrap())
            .unwrap();
    leaf
}

#[track_caller]
fn refused(arguments: &[&str], parts: &[&str]) {
    let output = simulate(arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}: no file is written");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: no {part:?} in: {message}");
    }
}

fn noiseless(model: &LeafModel, wavelengths_nm: &[f64], instrument: &Instrument) -> Measurement {
    let leaf = model.at(wavelengths_nm).unwrap();
    instrument.measure(&leaf, "leaf", Metadata::new(), &mut Noise::new(0.0, 0.0, 0)).unwrap()
}

fn direction(theta_s_deg: f64, theta_v_deg: f64, phi_v_deg: f64) -> Direction {
    Direction { theta_s_deg, theta_v_deg, phi_v_deg }
}

#[test]
fn a_preset_is_the_papers_campaign() {
    let beech = leaf(&["--leaf", "beech", "--seed", "1"]);
    assert_eq!((beech.name.as_str(), beech.quantity), ("beech", Quantity::Brdf));
    assert_eq!((beech.wavelengths_nm.first(), beech.wavelengths_nm.last()), (Some(&480.0), Some(&879.0)));
    assert_eq!((beech.wavelengths_nm.len(), beech.directions.len(), beech.counts().missing), (400, 4 * 98, 0));
    assert_eq!(beech.directions, paper_directions());
    for (key, part) in [
        ("species", "Fagus sylvatica"),
        ("source", "simulated"),
        ("surface", "n 1.56, sigma 0.29, beckmann facets, normalization bousquet2005"),
        ("interior", "PROSPECT-D, n_struct 1.6, cab 18 µg cm⁻²"),
        ("coupling", "bousquet"),
        ("noise", "0.01 of the value"),
        ("noise", "seed 1"),
    ] {
        assert!(beech.metadata.get(key).unwrap().contains(part), "{key}: {:?}", beech.metadata.get(key));
    }
}

#[test]
fn equal_seeds_give_equal_bytes_and_others_other_ones() {
    let with_seed = |seed: &str| text(&["--leaf", "hazel", "--seed", seed, "--wavelengths", "500:600:10"]);
    assert_eq!(with_seed("7"), with_seed("7"));
    assert_ne!(with_seed("7"), with_seed("8"));
    assert_eq!(text(&["--leaf", "hazel"]), text(&["--leaf", "hazel"]));
}

#[test]
fn the_directions_of_a_simulated_file_give_the_same_file_again() {
    let folder = tempfile::tempdir().unwrap();
    for layout in ["wide", "long"] {
        let path = folder.path().join(format!("{layout}.csv"));
        let path = path.to_str().unwrap();
        let usual = ["--leaf", "laurel", "--seed", "5", "--wavelengths", "550,670", "--layout", layout];
        let first = text(&usual);
        std::fs::write(path, &first).unwrap();
        assert_eq!(text(&[&usual[..], &["--geometry", path]].concat()), first, "{layout}");
    }
    let turned = folder.path().join("turned.csv");
    std::fs::write(&turned, "# azimuth: forward_0\ntheta_s_deg,theta_v_deg,phi_v_deg\n40,30,0\n").unwrap();
    let by_file = leaf(&["--leaf", "beech", "--wavelengths", "550", "--geometry", turned.to_str().unwrap()]);
    let by_lists =
        leaf(&["--leaf", "beech", "--wavelengths", "550", "--theta-s", "40", "--theta-v", "30", "--phi-v", "180"]);
    assert_eq!((by_file.directions, by_file.values), (by_lists.directions, by_lists.values));
}

#[test]
fn noise_has_the_stated_standard_deviation_at_every_level() {
    let usual = ["--leaf", "laurel", "--layout", "long"];
    let clean = leaf(&usual);
    let noisy = leaf(
        &[&usual[..], &["--seed", "3", "--noise-relative", "0.02", "--noise-absolute", "0.001", "--with-sd"]].concat(),
    );
    let stated = noisy.sd.clone().unwrap();
    let mut levels = [const { Vec::new() }; 3];
    for ((clean, noisy), sd) in clean.values.iter().zip(&noisy.values).zip(&stated) {
        // both rounded to 10⁻⁶: the sd is known to 2·10⁻⁸
        assert!((sd - (0.02 * clean).hypot(0.001)).abs() < 2e-8, "{clean}: {sd}");
        let level = if *clean < 0.05 {
            0
        } else if *clean < 0.2 {
            1
        } else {
            2
        };
        levels[level].push((noisy - clean) / sd);
    }
    for scores in levels {
        let count = scores.len() as f64;
        let mean = scores.iter().sum::<f64>() / count;
        let variance = scores.iter().map(|score| score * score).sum::<f64>() / count;
        assert!(count > 1000.0);
        // standard errors of mean and variance of standard normal numbers: four of them
        assert!(mean.abs() < 4.0 / count.sqrt(), "{mean} of {count}");
        assert!((variance - 1.0).abs() < 4.0 * (2.0 / count).sqrt(), "{variance} of {count}");
    }
}

#[test]
fn without_a_surface_every_view_sees_the_lambert_coefficient() {
    let surface = Surface::new(1.0, 0.3).unwrap();
    let interior = LeafParams { cab: 40.0, cm: 0.005, ..LeafParams::with_n_struct(1.5) };
    let model = LeafModel::new(surface, interior);
    let measured = noiseless(&model, &[550.0, 800.0], &Instrument::new(paper_directions()));
    let leaf = model.at(&[550.0, 800.0]).unwrap();
    for (band, k_l) in leaf.k_lambert.iter().enumerate() {
        // 10⁻⁶ sr⁻¹ is the instrument's step
        assert!(measured.band(band).iter().all(|brdf| (PI * brdf - k_l).abs() < PI * 0.5001e-6));
    }
}

// Values of the coupled leaf that other code computed (tests/golden/leaf_reference.csv of leafbrdf-prospect).
#[test]
fn values_are_those_of_the_golden_coupled_leaf() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../prospect/tests/golden/leaf_reference.csv");
    let points = Points::read(&path).unwrap();
    let column = |name: &str| points.require(name).unwrap();
    let mut compared = 0;
    for row in (0..points.len()).step_by(7) {
        let number = |name: &str| points.number(row, column(name)).unwrap();
        let normalization = match points.text(row, column("normalization")) {
            "cook-torrance" => Normalization::CookTorrance,
            _ => Normalization::Bousquet2005,
        };
        let mut interior = LeafParams::with_n_struct(number("n_struct"));
        for parameter in
            [Parameter::Cab, Parameter::Car, Parameter::Cant, Parameter::Cbrown, Parameter::Cw, Parameter::Cm]
        {
            interior.set(parameter, number(parameter.name()));
        }
        let surface = Surface::new(number("n"), number("sigma")).unwrap().with_normalization(normalization);
        let coupling = Coupling::from_name(points.text(row, column("coupling"))).unwrap();
        let model = LeafModel { coupling, ..LeafModel::new(surface, interior) };
        let view = direction(number("theta_s_deg"), number("theta_v_deg"), number("phi_v_deg"));
        let measured = noiseless(&model, &[number("wavelength_nm")], &Instrument::new(vec![view]));
        // half a step of 10⁻⁶ sr⁻¹, and what rounding adds to a tie
        assert!((measured.values[0] - number("brdf")).abs() < 0.5001e-6, "row {row}");
        compared += 1;
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn a_tilted_leaf_is_a_level_one_seen_from_its_own_normal() {
    let model = LeafModel::of_preset(&presets()[1]).unwrap();
    let instrument = Instrument {
        tilt_deg: [5.0, 0.0],
        ..Instrument::new(vec![direction(40.0, 30.0, 180.0), direction(40.0, 88.0, 180.0)])
    };
    let tilted = noiseless(&model, &[550.0], &instrument);
    // leaning towards the source: it sees the light at 35° and the view at 35°, and receives more than the level panel
    let level = noiseless(&model, &[550.0], &Instrument::new(vec![direction(35.0, 35.0, 180.0)]));
    let factor = 35_f64.to_radians().cos() / 40_f64.to_radians().cos();
    assert!((tilted.values[0] - factor * level.values[0]).abs() < 1.1e-6);
    assert!(tilted.values[1].is_nan(), "93° from the leaf's normal: below its horizon");

    let message =
        simulate(&["--leaf", "beech", "--theta-s", "40", "--theta-v", "30,88", "--phi-v", "180", "--tilt", "5,0"]);
    assert!(String::from_utf8_lossy(&message.stderr).contains("400 values are missing"));
    refused(
        &["--leaf", "beech", "--theta-s", "40", "--theta-v", "88", "--phi-v", "180", "--tilt", "5,0"],
        &["below the leaf's horizon"],
    );
}

#[test]
fn beyond_the_limit_signal_is_lost_in_proportion_to_the_cosine_and_nowhere_else() {
    let usual = ["--leaf", "hazel", "--wavelengths", "780"];
    let (whole, lossy) = (leaf(&usual), leaf(&[&usual[..], &["--loss-beyond"]].concat()));
    assert!(lossy.metadata.get("loss").unwrap().contains("70 deg"));
    let mut beyond = 0;
    for ((d, whole), lossy) in whole.directions.iter().zip(&whole.values).zip(&lossy.values) {
        let kept = (d.theta_v_deg.to_radians().cos() / 70_f64.to_radians().cos()).min(1.0);
        assert!((lossy - kept * whole).abs() < 1.1e-6, "{d:?}");
        beyond += usize::from(kept < 1.0);
    }
    assert_eq!(beyond, 4 * 33);
}

#[test]
fn what_is_given_replaces_the_presets_value_and_quantities_differ_by_pi() {
    let usual = ["--leaf", "beech", "--wavelengths", "670"];
    let preset = leaf(&usual);
    let greener = leaf(&[&usual[..], &["--cab", "60"]].concat());
    assert!(greener.metadata.get("interior").unwrap().contains("cab 60"));
    assert!(greener.values.iter().zip(&preset.values).all(|(green, usual)| green < usual));
    let brf = leaf(&[&usual[..], &["--quantity", "brf"]].concat());
    assert_eq!(brf.quantity, Quantity::Brf);
    assert!(brf.values.iter().zip(&preset.values).all(|(brf, brdf)| (brf / (PI * brdf) - 1.0).abs() < 1e-12));
    let turned = leaf(&[&usual[..], &["--azimuth", "forward_0"]].concat());
    assert_eq!((&turned.directions, &turned.values), (&preset.directions, &preset.values), "the reader turns it back");
}

#[test]
fn a_bowl_darkens_views_near_the_normal_and_keeps_the_flux_at_normal_incidence() {
    let plain = LeafModel::of_preset(&presets()[2]).unwrap();
    let bowl = LeafModel { diffuse: AnyDiffuse::P1(P1::new(0.15, 0.0).unwrap()), ..plain };
    let views = Instrument::new(vec![direction(8.0, 6.0, 0.0), direction(60.0, 69.0, 90.0)]);
    let (flat, curved) = (noiseless(&plain, &[800.0], &views), noiseless(&bowl, &[800.0], &views));
    assert!(curved.values[0] < flat.values[0] && curved.values[1] > flat.values[1]);
    let at_normal = |model: &LeafModel| model.at(&[800.0]).unwrap().dhrf_parts(0.0).unwrap();
    assert_eq!(at_normal(&plain), at_normal(&bowl));
}

#[test]
fn facets_have_their_own_convention_unless_another_is_asked_for() {
    assert_eq!(FacetKind::Beckmann.usual_normalization(), Normalization::Bousquet2005);
    let surface = |arguments: &[&str]| {
        leaf(&[&["--leaf", "beech", "--wavelengths", "670"], arguments].concat())
            .metadata
            .get("surface")
            .unwrap()
            .to_string()
    };
    assert!(surface(&[]).ends_with("beckmann facets, normalization bousquet2005"));
    assert!(surface(&["--normalization", "cook-torrance"]).ends_with("normalization cook-torrance"));
    assert!(surface(&["--facets", "ggx"]).ends_with("ggx facets, normalization cook-torrance"));
    assert!(surface(&["--facets", "ggx", "--normalization", "bousquet2005"]).ends_with("normalization bousquet2005"));
}

// F D/(2W) at nadir is F(0)/(4π σ²), and k_L is PROSPECT's reflectance less what GGX facets reflect at normal incidence
#[test]
fn a_ggx_leaf_has_a_ggx_lobe_over_its_own_diffuse_part() {
    let preset = LeafModel::of_preset(&presets()[1]).unwrap();
    let surface = AnySurface::new(FacetKind::Ggx, 1.5, 0.2, Normalization::CookTorrance).unwrap();
    let leaf = LeafModel { surface, ..preset };
    let nadir = Instrument::new(vec![direction(0.0, 0.0, 0.0)]);
    let at = |model: &LeafModel| model.at(&[670.0]).unwrap();
    let lobe = noiseless(&leaf, &[670.0], &nadir).values[0] - at(&leaf).k_lambert[0] / PI;
    assert!((lobe - 0.04 / (4.0 * PI * 0.04)).abs() < 1e-6, "{lobe}");
    let whole = |model: &LeafModel| at(model).k_lambert[0] + at(model).dhrf_specular;
    assert!((whole(&leaf) - whole(&preset)).abs() < 1e-14, "the interior is the same");
}

#[test]
fn the_truth_is_written_for_comparison() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("truth.csv");
    text(&["--leaf", "laurel", "--wavelengths", "500,780", "--truth", path.to_str().unwrap()]);
    let points = Points::read(&path).unwrap();
    let number = |row, name| points.number(row, points.require(name).unwrap()).unwrap();
    assert_eq!((number(0, "n"), number(1, "sigma"), number(1, "wavelength_nm")), (1.22, 0.078, 780.0));
    let truth = LeafModel::of_preset(&presets()[0]).unwrap().at(&[500.0, 780.0]).unwrap();
    assert_eq!([number(0, "k_l"), number(1, "k_l")], truth.k_lambert[..]);
}

#[test]
fn an_option_that_would_be_ignored_or_is_in_another_unit_is_refused() {
    for (options, parts) in [
        (&["--p1", "0.2,0"][..], "--diffuse p1"),
        (&["--noise-relative", "-1"], "standard deviations ≥ 0"),
        (&["--wavelengths", "0.5:0.9:0.1"], "did you mean nm"),
        (&["--cw", "10"], "did you mean 10 mg cm⁻²"),
    ] {
        refused(&[&["--leaf", "beech"][..], options].concat(), &[parts]);
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_name_and_what_is_doubtful_is_said() {
    refused(&["--n", "1.5"], &["--sigma", "--n-struct"]);
    refused(&["--leaf", "beech", "--n", "0.5"], &["n"]);
    refused(&["--leaf", "beech", "--cm", "50"], &["cm", "g m⁻²"]);
    refused(&["--leaf", "beech", "--wavelengths", "380:400"], &["380"]);
    refused(&["--leaf", "beech", "--wavelengths", "600,500"], &["--wavelengths", "rising"]);
    refused(&["--leaf", "beech", "--with-sd"], &["without noise"]);
    refused(&["--leaf", "beech", "--noise-absolute=-1"], &["--noise-absolute"]);
    refused(&["--leaf", "beech", "--loss-beyond", "95"], &["--loss-beyond"]);
    refused(&["--leaf", "beech", "--tilt", "5"], &["two numbers"]);
    refused(&["--leaf", "beech", "--gain", "1.1"], &["--gain", "bousquet"]);
    refused(&["--leaf", "beech", "--diffuse", "p1", "--p1", "1.2,0"], &["--p1", "a"]);
    refused(&["--leaf", "beech", "--theta-s", "30", "--theta-v", "90", "--phi-v", "0"], &["theta_v"]);
    let output = simulate(&["--n", "3", "--sigma", "0.1", "--n-struct", "1.5", "--cab", "40"]);
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stderr).contains("k_L is negative at"));
}
