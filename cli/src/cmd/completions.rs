//! `leafbrdf completions`: a completion script for a shell.

use std::io::{self, Write};

use clap::{Args, CommandFactory};
use clap_complete::Shell;

use super::Failure;

/// Print a completion script for a shell
#[derive(Args)]
#[command(after_help = "Example:
  leafbrdf completions bash > ~/.local/share/bash-completion/completions/leafbrdf")]
pub struct Arguments {
    /// The shell
    shell: Shell,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut crate::Arguments::command(), "leafbrdf", &mut script);
    let mut output = io::stdout().lock();
    output.write_all(&script).and_then(|()| output.flush()).map_err(|error| Failure::writing(None, &error))
}
