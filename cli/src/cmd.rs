//! The subcommands: one file each, with help text, arguments and `run`.

mod completions;
mod convert;

use std::io;

use clap::Subcommand;
use leafbrdf::measurement::{ReadError, WriteError};

pub const EXAMPLES: &str = "Examples:
  leafbrdf brdf --n 1.56 --sigma 0.29 --theta-s 60 --theta-v 0:70:10 --phi-v 180
  leafbrdf convert laurel.csv laurel-long.csv.gz --layout long
  leafbrdf completions bash > ~/.local/share/bash-completion/completions/leafbrdf";

#[derive(Subcommand)]
pub enum Command {
    Convert(convert::Arguments),
    Completions(completions::Arguments),
}

impl Command {
    pub fn run(self) -> Result<(), Failure> {
        match self {
            Command::Convert(arguments) => convert::run(&arguments),
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

impl Failure {
    /// A table or file that could not be written.
    pub fn writing(output: Option<&std::path::Path>, error: &io::Error) -> Self {
        if error.kind() == io::ErrorKind::BrokenPipe {
            return Failure::PipeClosed;
        }
        let name = output.map_or_else(|| "standard output".to_string(), |path| path.display().to_string());
        Failure::Failed(format!("{name}: cannot be written: {error}"))
    }
}
