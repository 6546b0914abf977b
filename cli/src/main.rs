//! The command `leafbrdf`: prints the error and sets the exit status; everything else is in `cmd`.

mod cmd;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;

use cmd::{Command, Failure};

/// Leaf BRDF: the model of Bousquet et al. (2005), measurement files, inversion.
///
/// Angles are in degrees, wavelengths in nm. φ_v = 180° is the forward, specular side. Results go to standard output,
/// everything else to standard error. Exit status: 0 done; 1 a run failed or some inputs failed; 2 wrong usage.
#[derive(Parser)]
#[command(name = "leafbrdf", version, arg_required_else_help = true, after_help = cmd::EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Threads; as many as the machine has cores without it. The results do not depend on it
    #[arg(long, global = true, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Arguments {
    fn run(self) -> Result<(), Failure> {
        if let Some(threads) = self.threads {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads));
            pool.build_global().map_err(|error| Failure::Failed(format!("--threads: {error}")))?;
        }
        self.command.run()
    }
}

fn main() -> ExitCode {
    let failure = match Arguments::parse().run() {
        Ok(()) => return ExitCode::SUCCESS,
        Err(failure) => failure,
    };
    let (message, status) = match failure {
        // The reader of our output (`| head`) has seen enough.
        Failure::PipeClosed => return ExitCode::SUCCESS,
        Failure::Failed(message) => (message, 1),
        Failure::Usage(message) => (message, 2),
    };
    // Nothing is left to do where standard error is closed as well.
    let _ = writeln!(io::stderr(), "error: {message}");
    ExitCode::from(status)
}
