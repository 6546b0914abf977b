//! The subcommands: one file each, with help text, arguments and `run`.

mod brdf;
mod completions;
mod convert;
mod demo;
mod dhrf;
mod fit;
mod fresnel;
mod inputs;
mod leaf;
mod list;
mod model;
mod normalization;
mod plot;
mod prospect;
mod simulate;
mod version;

use std::io::{self, Write};

use clap::Subcommand;
use leafbrdf::measurement::{ReadError, WriteError};

pub use normalization::NormalizationName;

pub const EXAMPLES: &str = "Examples:
  leafbrdf demo
  leafbrdf fit laurel.csv --model bands -o laurel-fit
  leafbrdf brdf --n 1.56 --sigma 0.29 --theta-s 60 --theta-v 0:70:10 --phi-v 180
  leafbrdf convert laurel.csv laurel-long.csv.gz --layout long
  leafbrdf completions bash > ~/.local/share/bash-completion/completions/leafbrdf";

#[derive(Subcommand)]
pub enum Command {
    Brdf(brdf::Arguments),
    Fresnel(fresnel::Arguments),
    Dhrf(dhrf::Arguments),
    Prospect(Box<prospect::Arguments>),
    Leaf(leaf::Arguments),
    Simulate(Box<simulate::Arguments>),
    Fit(fit::Arguments),
    Plot(plot::Arguments),
    Convert(convert::Arguments),
    Demo(demo::Arguments),
    Completions(completions::Arguments),
}

impl Command {
    pub fn run(self) -> Result<(), Failure> {
        match self {
            Command::Brdf(arguments) => brdf::run(&arguments),
            Command::Fresnel(arguments) => fresnel::run(&arguments),
            Command::Dhrf(arguments) => dhrf::run(&arguments),
            Command::Prospect(arguments) => prospect::run(&arguments),
            Command::Leaf(arguments) => leaf::run(&arguments),
            Command::Simulate(arguments) => simulate::run(&arguments),
            Command::Fit(arguments) => fit::run(&arguments),
            Command::Plot(arguments) => plot::run(&arguments),
            Command::Convert(arguments) => convert::run(&arguments),
            Command::Demo(arguments) => demo::run(&arguments),
            Command::Completions(arguments) => completions::run(&arguments),
        }
    }
}

/// Why a command ended before its end.
#[derive(Debug)]
pub enum Failure {
    /// Exit status 1: a run failed, or some inputs failed.
    Failed(String),
    /// Exit status 2: the command line asks for what cannot be.
    Usage(String),
    /// The reader of standard output has gone: no failure.
    PipeClosed,
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        Failure::Failed(error.to_string())
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::Io { error, .. } if error.kind() == io::ErrorKind::BrokenPipe => Failure::PipeClosed,
            error => Failure::Failed(error.to_string()),
        }
    }
}

/// The remedy for a wavelength that was probably given in µm; nothing for others.
fn micrometres(nm: f64) -> &'static str {
    if nm > 0.0 && nm < 100.0 { " (did you mean nm? 0.55 µm is 550 nm)" } else { "" }
}

/// Warns of chlorophyll that was probably given in mg cm⁻²: what is possible is not refused.
fn warn_of_milligrams(cab: f64) {
    if cab > 0.0 && cab < 0.2 {
        let likely = (1e9 * cab).round() / 1e6;
        // A courtesy: where standard error is closed, the results are there all the same.
        let _ = writeln!(
            io::stderr(),
            "warning: cab = {cab} µg cm⁻² is hardly any chlorophyll: did you mean {cab} mg cm⁻² = {likely} µg cm⁻²?"
        );
    }
}

/// Refuses `-` as a folder: standard output holds one file, and a folder of that name helps nobody.
fn folder(path: &std::path::Path) -> Result<(), Failure> {
    if path == std::path::Path::new("-") {
        return Err(Failure::Usage("--output -: several files are written, expected the name of a folder".to_string()));
    }
    Ok(())
}

impl Failure {
    /// A table or file that could not be written.
    pub fn writing(output: Option<&std::path::Path>, error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Failure::PipeClosed;
        }
        let name = output
            .filter(|path| *path != std::path::Path::new("-"))
            .map_or_else(|| "standard output".to_string(), |path| path.display().to_string());
        Failure::Failed(format!("{name}: cannot be written: {error}"))
    }
}
