//! The main job on data that the program makes itself: three leaves are simulated on the paper's goniometer, their
//! measurement files written, read back and inverted by every model of `fit`, and what comes out is set beside what went in
//! and beside the paper's numbers.
//!
//! | room | what |
//! |---|---|
//! | `study` | everything that comes out, as plain data: [`Study`] |
//! | `bands` | the part of it that the fit of every band gives |
//! | `paper` | what the paper prints and says, and how its statements stand |
//! | `text` | the study in words and columns |

mod bands;
mod paper;
mod study;
mod text;

pub use bands::{BandsReport, DHRF_SOURCES_DEG, Recovery};
pub use paper::{LAUREL_DHRF, PRINTED, Printed, Statement, Verdict, mirror_brdf, sensitivity};
pub use study::{Estimate, FiveParameters, Integrated, LeafStudy, Study, SurfaceStudy};

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use leafbrdf_core::Normalization;
use leafbrdf_fit::band::Weights;
use leafbrdf_fit::leaf::{LeafOptions, Method, Treatment, parameters};
use leafbrdf_fit::surface::SurfaceOptions;
use leafbrdf_fit::{BandBounds, BandOptions, LeafBandsOptions};
use leafbrdf_prospect::Parameter;

use crate::fit::{
    FitFailure, LeafOutcome, LeafValues, Selected, Selection, Summary, fit_bands, fit_leaf, fit_surface, write_bands,
    write_records,
};
use crate::measurement::{
    Measurement, Metadata, ReadError, ReadOptions, WriteError, WriteOptions, read_path, write_path,
};
use crate::simulate::{
    CoupledLeaf, Instrument, LeafModel, Noise, PresetLeaf, SimulationError, paper_directions, presets, write_truth,
};

/// Seed of the noise: the paper's year.
pub const SEED: u64 = 2005;

/// Folder of the simulated measurement files inside the demo's folder.
pub const MEASUREMENTS: &str = "measurements";
/// Folder of the true values behind them.
pub const TRUTH: &str = "truth";
/// Folder of the files of `fit --model bands`.
pub const FIT: &str = "fit";
/// Folder of the files of `fit --model surface`.
pub const FIT_SURFACE: &str = "fit-surface";
/// Folder of the five parameters' files, n and σ fitted first.
pub const FIT_TWO_STEP: &str = "fit-two-step";
/// Folder of the five parameters' files, all fitted at once.
pub const FIT_JOINT: &str = "fit-joint";

/// Why the demo did not come to its end.
#[derive(Debug)]
pub enum DemoError {
    /// A folder or file, and the system's reason.
    Io(String, io::Error),
    /// In the words that the user reads.
    Failed(String),
}

impl fmt::Display for DemoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DemoError::Io(place, error) => write!(f, "{place}: cannot be written: {error}"),
            DemoError::Failed(sentence) => f.write_str(sentence),
        }
    }
}

impl std::error::Error for DemoError {}

impl From<SimulationError> for DemoError {
    fn from(error: SimulationError) -> Self {
        DemoError::Failed(error.to_string())
    }
}
impl From<FitFailure> for DemoError {
    fn from(error: FitFailure) -> Self {
        DemoError::Failed(error.to_string())
    }
}
impl From<ReadError> for DemoError {
    fn from(error: ReadError) -> Self {
        DemoError::Failed(error.to_string())
    }
}
impl From<WriteError> for DemoError {
    fn from(error: WriteError) -> Self {
        DemoError::Failed(error.to_string())
    }
}

/// Runs the demo in a folder, which is made where it does not exist.
///
/// Writes `measurements/LEAF.csv`, `truth/LEAF.csv` and the files of every model's fit under [`FIT`], [`FIT_SURFACE`],
/// [`FIT_TWO_STEP`] and [`FIT_JOINT`]. The same files and the same study every time.
///
/// # Errors
/// The system's, where the folder cannot be written.
pub fn run(folder: &Path) -> Result<Study, DemoError> {
    let [measurements, truth, fit, surface, two_step, joint] =
        [MEASUREMENTS, TRUTH, FIT, FIT_SURFACE, FIT_TWO_STEP, FIT_JOINT].map(|name| folder.join(name));
    for place in [&measurements, &truth, &fit, &surface, &two_step, &joint] {
        fs::create_dir_all(place).map_err(in_file(place))?;
    }
    let mut leaves = Vec::new();
    let mut rows = Vec::new();
    let mut records = [const { Vec::new() }; 3];
    for ((preset, paper), seed) in presets().iter().zip(PRINTED).zip(SEED..) {
        let leaf = true_leaf(preset)?;
        let path = measurements.join(format!("{}.csv", preset.name));
        let noise = Noise::new(Noise::RELATIVE, Noise::ABSOLUTE, seed);
        write_path(&path, &[simulated(preset, &leaf, noise, seed)?], &WriteOptions::default())?;
        let place = truth.join(format!("{}.csv", preset.name));
        write_truth(&place, &leaf).map_err(in_file(&place))?;

        // from here on nothing is known but the file
        let file = path.display().to_string();
        for measured in read_path(&path, &ReadOptions::default())? {
            let selected = Selected::new(&measured, &Selection::default())?;
            let outcome = fit_bands(selected.clone(), &fit_options(), &|_| ())?;
            let summary = Summary::of_bands(&measured, &file, &outcome);
            let place = made(&fit, preset.name)?;
            write_bands(&place, &outcome).and_then(|()| summary.write(&place)).map_err(in_file(&place))?;

            let options = SurfaceOptions::paper();
            let one_surface = fit_surface(&measured, selected.clone(), &options, BandBounds::table_3().k_lambert)?;
            let place = made(&surface, preset.name)?;
            let written = one_surface.write_tables(&place);
            written.and_then(|()| one_surface.write_summary(&place, &measured, &file)).map_err(in_file(&place))?;

            let mut five = Vec::new();
            for (method, place) in [(Method::TwoStep, &two_step), (Method::Joint, &joint)] {
                let outcome = fit_leaf(&measured, selected.clone(), &five_parameters(method))?;
                let place = made(place, preset.name)?;
                let written = outcome.write_tables(&place);
                written.and_then(|()| outcome.write_summary(&place, &measured, &file)).map_err(in_file(&place))?;
                five.push(outcome);
            }
            let values = [one_surface.values()].into_iter().chain(five.iter().map(LeafOutcome::values));
            for (records, values) in records.iter_mut().zip(values) {
                records.push((measured.name.clone(), file.clone(), Ok(values)));
            }
            leaves.push(LeafStudy {
                name: preset.name,
                species: preset.species,
                surface_truth: [preset.n, preset.sigma],
                interior_truth: LeafStudy::interior_of(preset),
                paper,
                bands: BandsReport::new(preset, &leaf, &measured, &outcome, &summary),
                surface: SurfaceStudy::new(&one_surface.fit, &leaf),
                two_step: FiveParameters::new(&five[0].fit),
                joint: FiveParameters::new(&five[1].fit),
                integrated: study::integrated(&measured, &leaf)?,
            });
            rows.push((measured.name, file.clone(), Ok(LeafValues::from(&summary))));
        }
    }
    let convention = Normalization::Bousquet2005.name();
    write_records(&fit, "bands", Some(convention), &rows).map_err(in_file(&fit.join("leaves.csv")))?;
    for ((place, model), records) in [(&surface, "surface"), (&two_step, "leaf"), (&joint, "leaf")].iter().zip(&records)
    {
        write_records(place, model, Some(convention), records).map_err(in_file(&place.join("leaves.csv")))?;
    }
    let in_words = |error: leafbrdf_core::DomainError| DemoError::Failed(error.to_string());
    Ok(Study {
        sensitivity: sensitivity().map_err(in_words)?,
        statements: study::statements(&leaves),
        mirror_brdf: [
            mirror_brdf(Normalization::Bousquet2005).map_err(in_words)?,
            mirror_brdf(Normalization::CookTorrance).map_err(in_words)?,
        ],
        leaves,
    })
}

/// The folder of a leaf inside that of a model.
fn made(folder: &Path, leaf: &str) -> Result<PathBuf, DemoError> {
    let place = folder.join(leaf);
    fs::create_dir_all(&place).map_err(in_file(&place))?;
    Ok(place)
}

/// The paper's five: n, σ, N, C_ab, C_m. Carotenoids follow the chlorophylls as they do in many leaves, and in the truth; water,
/// which nothing shows below 900 nm, has its usual value; other pigments are not there.
fn five_parameters(method: Method) -> LeafOptions {
    let held = [(Parameter::Cant, 0.0), (Parameter::Cbrown, 0.0), (Parameter::Cw, 0.01)];
    LeafOptions {
        car_per_cab: Some(0.25),
        treatments: held.map(|(parameter, value)| (parameters::place(parameter), Treatment::Held(value))).to_vec(),
        ..LeafOptions::new(method)
    }
}

fn in_file(place: &Path) -> impl Fn(io::Error) -> DemoError {
    let place = place.display().to_string();
    move |error| DemoError::Io(place.clone(), error)
}

/// n and σ of Table 4 over the preset's interior, 480–879 nm, K = 2π².
fn true_leaf(preset: &PresetLeaf) -> Result<CoupledLeaf, DemoError> {
    let wavelengths_nm: Vec<f64> = (480..=879).map(f64::from).collect();
    let leaf = LeafModel::of_preset(preset)?.at(&wavelengths_nm)?;
    match leaf.negative() {
        0 => Ok(leaf),
        negative => Err(DemoError::Failed(format!("{}: k_L is negative at {negative} wavelengths", preset.name))),
    }
}

fn simulated(preset: &PresetLeaf, leaf: &CoupledLeaf, mut noise: Noise, seed: u64) -> Result<Measurement, DemoError> {
    let instrument = Instrument::new(paper_directions());
    let mut metadata = Metadata::new();
    metadata.push("species", preset.species);
    metadata.push("source", "simulated by leafbrdf demo, not measured");
    leaf.model.describe(&mut metadata);
    instrument.describe(&mut metadata);
    noise.describe(seed, &mut metadata);
    Ok(instrument.measure(leaf, preset.name, metadata, &mut noise)?)
}

/// What `leafbrdf fit --model bands` does without further options.
fn fit_options() -> LeafBandsOptions {
    LeafBandsOptions {
        normalization: Normalization::Bousquet2005,
        band: BandOptions { weights: Weights::Relative, ..BandOptions::table_3() },
        ..LeafBandsOptions::default()
    }
}
