//! `leafbrdf demo`: the main job on a data set that the program makes itself.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use leafbrdf::demo::{self, DemoError, FIT, MEASUREMENTS};
use leafbrdf::report;

use super::Failure;

/// Simulate three leaves, invert their measurements, and compare with the truth and the paper
///
/// Laurel, beech and hazel with n and σ of Table 4 over interiors by PROSPECT-D, on a goniometer like the paper's, with noise
/// from a fixed seed. The measurement files are written to DIR/measurements, the true values to DIR/truth, what
/// `fit --model bands` makes of the measurements to DIR/fit, and DIR/report.html collects it all, with figures, for a browser.
/// The same files every time.
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf demo
  leafbrdf demo -o study")]
pub struct Arguments {
    /// Folder for the files; made where it does not exist
    #[arg(short, long, value_name = "DIR", default_value = "leafbrdf-demo")]
    output: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let folder = &arguments.output;
    super::folder(folder)?;
    let study = demo::run(folder).map_err(|error: DemoError| Failure::Failed(error.to_string()))?;
    let mut out = io::stdout().lock();
    write!(out, "{study}").and_then(|()| out.flush()).map_err(|error| Failure::writing(None, &error))?;
    let page = report::write(folder, &study).map_err(|error| Failure::Failed(error.to_string()))?;
    let [data, fit] = [MEASUREMENTS, FIT].map(|name| folder.join(name));
    let (data, fit) = (data.display(), fit.display());
    // A courtesy: where standard error is closed, the files are there all the same.
    let _ = writeln!(
        io::stderr(),
        "files: {}\nwith figures, for a browser: {}\nthe fit by hand: leafbrdf fit {data}/*.csv --model bands --plots -o {fit}",
        folder.display(),
        page.display()
    );
    Ok(())
}
