//! The main job on data that the program makes itself: three leaves are simulated on the paper's goniometer, their
//! measurement files written, read back and inverted as `fit --model bands` does, and what comes out is set beside what
//! went in and beside the paper's numbers.

mod report;

pub use report::{DHRF_SOURCES_DEG, DemoReport, LeafReport, Recovery};

use std::fmt;
use std::fs;
use std::io;
use std::path::Path;

use leafbrdf_core::Normalization;
use leafbrdf_fit::{BandOptions, LeafBandsOptions, band::Weights};

use crate::fit::{FitFailure, LeafRow, Selected, Selection, Summary, fit_bands, write_bands, write_leaves};
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
/// Folder of the fit's files.
pub const FIT: &str = "fit";

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
/// Writes `measurements/LEAF.csv`, `truth/LEAF.csv` and the files of `fit --model bands` under `fit/`. The same files and
/// the same report every time.
///
/// # Errors
/// The system's, where the folder cannot be written.
pub fn run(folder: &Path) -> Result<DemoReport, DemoError> {
    let [measurements, truth, fit] = [MEASUREMENTS, TRUTH, FIT].map(|name| folder.join(name));
    for place in [&measurements, &truth, &fit] {
        fs::create_dir_all(place).map_err(in_file(place))?;
    }
    let mut leaves = Vec::new();
    let mut rows = Vec::new();
    for (preset, seed) in presets().iter().zip(SEED..) {
        let leaf = true_leaf(preset)?;
        let path = measurements.join(format!("{}.csv", preset.name));
        let noise = Noise::new(Noise::RELATIVE, Noise::ABSOLUTE, seed);
        write_path(&path, &[simulated(preset, &leaf, noise, seed)?], &WriteOptions::default())?;
        let file = truth.join(format!("{}.csv", preset.name));
        write_truth(&file, &leaf).map_err(in_file(&file))?;

        // from here on nothing is known but the file
        for measured in read_path(&path, &ReadOptions::default())? {
            let outcome = fit_bands(Selected::new(&measured, &Selection::default())?, &fit_options(), &|_| ())?;
            let place = fit.join(preset.name);
            let file = path.display().to_string();
            let summary = Summary::of_bands(&measured, &file, &outcome);
            fs::create_dir_all(&place)
                .and_then(|()| write_bands(&place, &outcome))
                .and_then(|()| summary.write(&place))
                .map_err(in_file(&place))?;
            leaves.push(LeafReport::new(preset, &leaf, &measured, &outcome, &summary));
            rows.push(LeafRow { leaf: measured.name, file, result: Ok(summary) });
        }
    }
    let convention = Normalization::Bousquet2005.name();
    write_leaves(&fit, "bands", convention, &rows).map_err(in_file(&fit.join("leaves.csv")))?;
    Ok(DemoReport { leaves })
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
