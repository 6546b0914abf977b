//! `leafbrdf plot` and `fit --plots` as their user runs them: figures out of a fit's folder.

mod common;

use std::fs;
use std::path::{Path, PathBuf};

use common::leafbrdf;
use leafbrdf::measurement::{ReadOptions, read_path};

fn succeed(arguments: &[&str]) -> String {
    let output = leafbrdf(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// A simulated beech of a few bands and its fit, in a folder of its own.
struct Study {
    folder: tempfile::TempDir,
}

impl Study {
    fn new(leaves: &[&str], fit: &[&str]) -> Self {
        let study = Study { folder: tempfile::tempdir().unwrap() };
        let mut arguments = vec!["fit".to_string()];
        if leaves.is_empty() {
            return study;
        }
        for leaf in leaves {
            let file = study.measurement(leaf);
            succeed(&["simulate", "--leaf", leaf, "--seed", "1", "--wavelengths", "480:880:50", "-o", &file]);
            arguments.push(file);
        }
        arguments.extend(fit.iter().map(|word| (*word).to_string()));
        arguments.extend(["-o".to_string(), study.fit()]);
        succeed(&arguments.iter().map(String::as_str).collect::<Vec<_>>());
        study
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn measurement(&self, leaf: &str) -> String {
        self.at(&format!("{leaf}.csv")).display().to_string()
    }

    fn fit(&self) -> String {
        self.at("fit").display().to_string()
    }
}

fn svgs(folder: &Path) -> Vec<(String, String)> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "svg"));
    files.sort();
    let name = |path: &Path| path.file_stem().unwrap().to_string_lossy().into_owned();
    files.iter().map(|path| (name(path), fs::read_to_string(path).unwrap())).collect()
}

const FIGURES: [&str; 7] =
    ["density", "dhrf", "hemisphere-sources", "hemisphere-wavelengths", "parameters", "principal-plane", "valley"];

#[test]
fn every_figure_is_well_formed_and_every_axis_has_a_unit() {
    let study = Study::new(&["beech"], &["--model", "bands"]);
    succeed(&["plot", &study.fit(), "--svg"]);
    let figures = svgs(&study.at("fit/figures"));
    assert_eq!(figures.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), FIGURES);
    for (name, svg) in figures {
        let document = roxmltree::Document::parse(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
        let text_of = |node: roxmltree::Node<'_, '_>| -> String {
            node.descendants().filter(roxmltree::Node::is_text).filter_map(|text| text.text()).collect()
        };
        let of_axes: Vec<String> = document
            .descendants()
            .filter(|node| node.attribute("class").is_some_and(|class| class.contains("axis-label")))
            .map(text_of)
            .collect();
        assert!(!of_axes.is_empty(), "{name} has axes");
        for label in of_axes {
            let unit = label.rsplit_once('(').map(|(_, unit)| unit);
            let known = ["nm)", "°)", "sr⁻¹)", "unitless)", "%)", "count)"];
            assert!(unit.is_some_and(|unit| known.contains(&unit)), "{name}: {label}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name} has a place that is no number");
        let ids: Vec<&str> = document.descendants().filter_map(|node| node.attribute("id")).collect();
        let mut once = ids.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), ids.len(), "{name}: an id stands twice");
    }
}

#[test]
fn each_map_has_a_dot_for_every_direction() {
    let study = Study::new(&["beech"], &["--model", "bands"]);
    succeed(&["plot", &study.fit(), "--svg", "--wavelengths", "480,680"]);
    let figures = svgs(&study.at("fit/figures"));
    let dots = |name: &str| {
        let (_, svg) = figures.iter().find(|(other, _)| other == name).unwrap();
        svg.matches("class=\"direction\"").count()
    };
    // two wavelengths × measured and modelled × 98; four sources × the same
    assert_eq!(dots("hemisphere-wavelengths"), 2 * 2 * 98);
    assert_eq!(dots("hemisphere-sources"), 4 * 2 * 98);
}

#[test]
fn directions_of_one_plane_show_their_values_and_what_lies_below_a_tilted_leafs_horizon_stays_empty() {
    let study = Study::new(&[], &[]);
    let plane = study.measurement("plane");
    let views = ["--theta-s", "40", "--theta-v", "0:60:10", "--phi-v", "180", "--wavelengths", "500:800:50"];
    succeed(&[&["simulate", "--leaf", "beech", "--seed", "1", "--tilt", "6,0", "-o", &plane][..], &views].concat());
    succeed(&["fit", &plane, "--model", "surface", "--tilt", "-o", &study.fit()]);
    succeed(&["plot", &study.fit(), "--svg", "--wavelengths", "500,700"]);
    let figures = svgs(&study.at("fit/figures"));
    let (_, svg) = figures.iter().find(|(name, _)| name == "hemisphere-wavelengths").unwrap();
    let dots: Vec<&str> = svg.split('<').filter(|tag| tag.contains("class=\"direction\"")).collect();
    assert_eq!(dots.len(), 2 * 2 * 7);
    let coloured = |tag: &&&str| tag.contains("r=\"5.5\"") && !tag.contains("#ffffff");
    assert_eq!(dots.iter().filter(coloured).count(), 2 * 7, "the measured values of both wavelengths");
    assert!(svg.contains("coloured dots"));
    // the leaf leans towards the source: the modelled maps end before the rim on the far side, in the colour of no value
    let empty = svg.split('<').filter(|tag| tag.starts_with("path") && tag.contains("fill=\"#eceef1\""));
    assert_eq!(empty.count(), 2);
    let level = Study::new(&["beech"], &["--model", "surface"]);
    succeed(&["plot", &level.fit(), "--svg"]);
    let (_, svg) = &svgs(&level.at("fit/figures"))[0];
    assert!(!svg.split('<').any(|tag| tag.starts_with("path") && tag.contains("fill=\"#eceef1\"")));
}

#[test]
fn the_same_fit_gives_the_same_bytes_in_svg_and_png() {
    let study = Study::new(&["beech"], &["--model", "bands", "--plots"]);
    let read = || -> Vec<(PathBuf, Vec<u8>)> {
        let mut files: Vec<PathBuf> =
            fs::read_dir(study.at("fit/figures")).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect()
    };
    let with_fit = read();
    succeed(&["plot", &study.fit()]);
    assert!(with_fit == read());
    let png = with_fit.iter().filter(|(path, _)| path.extension().is_some_and(|e| e == "png"));
    let signatures: Vec<bool> = png.map(|(_, bytes)| bytes.starts_with(b"\x89PNG\r\n\x1a\n")).collect();
    let expected = if cfg!(feature = "png") { vec![true; FIGURES.len()] } else { Vec::new() };
    assert_eq!(signatures, expected);
}

#[test]
fn several_leaves_have_figures_of_their_own_and_one_together() {
    let study = Study::new(&["beech", "laurel"], &["--model", "bands"]);
    let printed = succeed(&["plot", &study.fit(), "--svg"]);
    assert_eq!(svgs(&study.at("fit/beech/figures")).len(), FIGURES.len());
    let together = svgs(&study.at("fit/figures"));
    assert_eq!(together.len(), 2);
    assert!(together[0].1.contains("beech") && together[0].1.contains("laurel"));
    assert_eq!(printed.lines().count(), 2 * FIGURES.len() + 2);
}

#[test]
fn a_surface_with_other_facets_and_a_tilt_is_drawn_as_it_was_fitted() {
    let options = ["--model", "surface", "--facets", "ggx", "--diffuse", "p1", "--tilt"];
    let study = Study::new(&["beech"], &options);
    succeed(&["plot", &study.fit(), "--svg"]);
    let figures = svgs(&study.at("fit/figures"));
    let (_, density) = figures.iter().find(|(name, _)| name == "density").unwrap();
    // the figure's RMSE is that of the fit: the model at every direction is the one that was fitted
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(study.at("fit/summary.json")).unwrap()).unwrap();
    let rmse = format!("RMSE {:.2e} sr⁻¹", summary["rmse"].as_f64().unwrap()).replace('-', "−");
    assert!(density.contains(&rmse), "{rmse}");
}

#[test]
fn another_leafs_measurement_is_noticed() {
    let study = Study::new(&["beech"], &["--model", "surface"]);
    let other = study.measurement("hazel");
    succeed(&["simulate", "--leaf", "hazel", "--seed", "1", "--wavelengths", "480:880:50", "-o", &other]);
    let message = |arguments: &[&str]| String::from_utf8(leafbrdf(arguments).stderr).unwrap();
    assert_eq!(message(&["plot", &study.fit(), "--svg"]), "");
    let wrong = message(&["plot", &study.fit(), "--svg", "--measurement", &other]);
    assert!(wrong.contains("another leaf's") && wrong.contains("beech"), "{wrong}");
}

#[test]
fn without_the_measurement_the_rest_is_drawn_and_the_remedy_told() {
    let study = Study::new(&["beech"], &["--model", "bands"]);
    let moved = study.at("elsewhere.csv");
    fs::rename(study.measurement("beech"), &moved).unwrap();
    let output = leafbrdf(&["plot", &study.fit(), "--svg"]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && message.contains("--measurement FILE") && message.contains("maps"), "{message}");
    assert_eq!(svgs(&study.at("fit/figures")).len(), 2);
    succeed(&["plot", &study.fit(), "--svg", "--measurement", moved.to_str().unwrap()]);
    assert_eq!(svgs(&study.at("fit/figures")).len(), FIGURES.len());
    assert_eq!(read_path(&moved, &ReadOptions::default()).unwrap().len(), 1);
}

#[test]
fn a_folder_without_a_fit_is_refused_with_what_was_expected() {
    let folder = tempfile::tempdir().unwrap();
    let output = leafbrdf(&["plot", folder.path().to_str().unwrap()]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(message.contains("summary.json") && message.contains("leafbrdf fit"), "{message}");
    let output = leafbrdf(&["plot", folder.path().join("nowhere").to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn hemispherical_spectra_are_drawn_with_the_prospect_fit() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).display().to_string();
    let spectrum = ["prospect", "--model", "D", "--n-struct", "1.5", "--cab", "40", "--cm", "0.006", "--cw", "0.01"];
    succeed(&[&spectrum[..], &["--wavelengths", "400:2500:20", "-o", &at("leaf.csv")]].concat());
    succeed(&["fit", &at("leaf.csv"), "--model", "prospect", "-o", &at("fit"), "--plots"]);
    let figures = svgs(&folder.path().join("fit/figures"));
    assert_eq!(figures.len(), 1);
    assert!(figures[0].1.contains("transmittance, measured"));
}

#[test]
fn the_demo_collects_itself_in_one_page_without_a_network() {
    let folder = tempfile::tempdir().unwrap();
    let printed = succeed(&["demo", "-o", folder.path().to_str().unwrap()]);
    let page = fs::read_to_string(folder.path().join("report.html")).unwrap();
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..roxmltree::ParsingOptions::default() };
    let document = roxmltree::Document::parse_with_options(&page, options).unwrap();
    let count = |name: &str| document.descendants().filter(|node| node.has_tag_name(name)).count();
    let svgs = document.descendants().filter(|node| node.tag_name().name() == "svg").count();
    assert_eq!(count("figure"), svgs);
    assert!(svgs >= 3 * 5 && count("table") >= 9, "{svgs} figures, {} tables", count("table"));
    for outside in ["<script", "<link", "@import", "src=", "https:"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(printed.contains("Table 4"));
    assert!(folder.path().join("fit/laurel/figures/hemisphere-wavelengths.svg").is_file());
}
