//! What every model does with the leaves of its files: read under names of their own, fitted on all threads, told and written.

use std::collections::HashMap;
use std::fs;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use leafbrdf::fit::{LeafRecord, LeafValues, Selected, Selection, write_records};
use leafbrdf::measurement::{Measurement, ReadError, ReadOptions, read_path, stem};
use leafbrdf::output::file_name;
use rayon::prelude::*;

use super::super::Failure;
use super::Arguments;

/// One leaf of the input, or why there is none.
pub struct Input<D> {
    pub name: String,
    pub file: String,
    pub data: Result<D, String>,
}

/// What is kept of a leaf once its files are written: its row of `leaves.csv`, and a line for people.
pub type Told = (LeafValues, String);

/// What a model is called in `leaves.csv`, the convention for K where it has one, and how its progress is counted.
pub struct Model<D> {
    pub name: &'static str,
    pub normalization: Option<&'static str>,
    /// The bands of a leaf, which `fit` counts; `None`: a leaf is one step.
    pub bands: Option<fn(&D) -> usize>,
}

/// The folder of a leaf among several: its name, but for those of what stands beside the folders.
fn folder_of(name: &str) -> String {
    let folder = file_name(name);
    if ["leaves.csv", "figures"].contains(&folder.to_ascii_lowercase().as_str()) {
        format!("_{folder}")
    } else {
        folder
    }
}

/// All leaves of all files, each under a name of its own; a file that cannot be read is one failed leaf.
pub fn read<D>(
    arguments: &Arguments,
    reader: impl Fn(&Path) -> Result<Vec<D>, ReadError>,
    name_of: impl Fn(&D) -> &str,
) -> Vec<Input<D>> {
    let mut inputs = Vec::new();
    let mut places: HashMap<String, String> = HashMap::new();
    for path in &arguments.files {
        let file = path.display().to_string();
        match reader(path) {
            Ok(leaves) => inputs.extend(leaves.into_iter().map(|leaf| {
                let name = name_of(&leaf).to_string();
                let folder = folder_of(&name);
                let data = match places.get(&folder) {
                    Some(other) => Err(format!(
                        "{file}: leaf {name} has the name of one in {other}, whose results it would overwrite: give one of them \
                         another file name or `# sample:`"
                    )),
                    None => Ok(leaf),
                };
                places.entry(folder).or_insert_with(|| file.clone());
                Input { name, file: file.clone(), data }
            })),
            Err(error) => {
                inputs.push(Input { name: stem(path), file, data: Err(error.to_string()) });
            }
        }
    }
    inputs
}

/// The same for files of directional measurements.
pub fn measurements(arguments: &Arguments) -> Vec<Input<Measurement>> {
    let options = ReadOptions { quantity: arguments.quantity, azimuth: arguments.azimuth };
    read(arguments, |path| read_path(path, &options), |leaf| &leaf.name)
}

/// The part of a measurement that the options ask for.
pub fn selected(data: &Measurement, arguments: &Arguments) -> Result<Selected, String> {
    let selection = Selection {
        wavelengths: arguments.wavelengths,
        max_theta_v_deg: arguments.max_theta_v,
        use_sd: !arguments.ignore_sd,
    };
    Selected::new(data, &selection).map_err(|failure| failure.to_string())
}

/// Fits and writes all leaves, each in a folder of its own where there are several, then `leaves.csv`. Results, warnings and failures
/// go to standard error, and the command fails where a leaf has failed.
///
/// `fit` says why a leaf has no result; `write` puts one into its folder.
pub fn each<D: Sync + Send, O>(
    arguments: &Arguments,
    model: &Model<D>,
    read: impl FnOnce() -> Vec<Input<D>>,
    fit: impl Fn(&D, &ProgressBar) -> Result<O, String> + Sync,
    write: impl Fn(O, &Path, &D, &str) -> io::Result<Told> + Sync,
) -> Result<(), Failure> {
    super::super::folder(&arguments.output)?;
    fs::create_dir_all(&arguments.output).map_err(|error| Failure::writing(Some(&arguments.output), &error))?;
    let bar = progress_bar(if model.bands.is_some() { "bands" } else { "leaves" });
    let leaves = read();
    let several = leaves.len() > 1;
    let steps = |leaf: &Input<D>| match model.bands {
        Some(bands) => leaf.data.as_ref().map_or(0, bands),
        None => 1,
    };
    bar.set_length(leaves.iter().map(|leaf| steps(leaf) as u64).sum());

    let one = |leaf: &Input<D>| -> Result<Told, String> {
        let data = leaf.data.as_ref().map_err(Clone::clone)?;
        let outcome = fit(data, &bar).map_err(|why| format!("{}: leaf {}: {why}", leaf.file, leaf.name))?;
        let folder = if several { arguments.output.join(folder_of(&leaf.name)) } else { arguments.output.clone() };
        fs::create_dir_all(&folder)
            .and_then(|()| write(outcome, &folder, data, &leaf.file))
            .map_err(|error| format!("{}: cannot be written: {error}", folder.display()))
    };
    let done: Vec<Result<Told, String>> = leaves
        .par_iter()
        .map(|leaf| {
            let result = one(leaf);
            bar.inc(u64::from(model.bands.is_none()));
            result
        })
        .collect();
    bar.finish_and_clear();

    let mut errors = io::stderr().lock();
    let mut failed = 0;
    let mut records = Vec::<LeafRecord>::new();
    for (leaf, result) in leaves.into_iter().zip(done) {
        // Messages are a courtesy: where standard error is closed, the files are what was asked for.
        let _ = match &result {
            Ok((values, line)) => {
                let _ = writeln!(errors, "{}: {line}", leaf.name);
                let mut warnings = values.warnings.iter();
                warnings.try_for_each(|warning| writeln!(errors, "warning: {}: {warning}", leaf.name))
            }
            Err(sentence) => {
                failed += 1;
                writeln!(errors, "error: {sentence}")
            }
        };
        records.push((leaf.name, leaf.file, result.map(|(values, _)| values)));
    }
    write_records(&arguments.output, model.name, model.normalization, &records)
        .map_err(|error| Failure::writing(Some(&arguments.output.join("leaves.csv")), &error))?;
    match failed {
        0 => Ok(()),
        _ => Err(Failure::Failed(format!("{failed} of {} leaves failed, the others are done", records.len()))),
    }
}

/// On standard error, and only on a terminal.
fn progress_bar(of: &str) -> ProgressBar {
    if !io::stderr().is_terminal() {
        return ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
    }
    let style = ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {of} {{eta}}"))
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(0).with_style(style)
}
