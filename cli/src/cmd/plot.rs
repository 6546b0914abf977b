//! `leafbrdf plot`: the figures of a fit.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use leafbrdf::measurement::{Azimuth, Quantity, ReadOptions};
use leafbrdf::plot::{Kind, PlotOptions, plot};

use super::Failure;
use super::list::List;

/// Draw the figures of a fit: those of the paper and more, as SVG and PNG
///
/// Reads what `leafbrdf fit` wrote into DIR (one leaf, or a folder for each) and the measurement that summary.json names, and
/// writes DIR/figures (DIR/LEAF/figures): hemisphere maps measured and modelled (Figs 1, 2, 5), k_L, n and sigma against
/// wavelength and the density of measured against modelled values (Fig. 4), DHRF and the share of it that never entered the
/// leaf (Fig. 6), cuts through the plane of incidence with residuals, and χ² over n and sigma. The same input gives the same
/// bytes.
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf plot laurel-fit
  leafbrdf plot out --wavelengths 500,680,850 --svg
  leafbrdf plot out/leaf3 --measurement leaves/leaf3.csv.gz --png")]
pub struct Arguments {
    /// Folder of a fit
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Wavelengths of the maps in nm; the nearest that were fitted are taken
    #[arg(long, value_name = "LIST", default_value = "550,670,780")]
    wavelengths: List,
    /// The measurement, where it is not where summary.json says
    #[arg(long, value_name = "FILE")]
    measurement: Option<PathBuf>,
    /// Quantity of the measurement, where it does not say
    #[arg(long, value_enum)]
    quantity: Option<Quantity>,
    /// Azimuth convention of the measurement, where it does not say
    #[arg(long, value_enum)]
    azimuth: Option<Azimuth>,
    /// Write SVG only
    #[arg(long, conflicts_with = "png")]
    svg: bool,
    /// Write PNG only
    #[arg(long)]
    png: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let kinds = match (arguments.svg, arguments.png) {
        (true, _) => vec![Kind::Svg],
        (_, true) => vec![Kind::Png],
        _ => PlotOptions::all_kinds(),
    };
    let List(wavelengths) = &arguments.wavelengths;
    if let Some(nm) = wavelengths.iter().find(|nm| !(**nm >= 100.0)) {
        return Err(Failure::Usage(format!("--wavelengths {nm}: expected wavelengths in nm, such as 550,670,780")));
    }
    let options = PlotOptions {
        wavelengths_nm: arguments.wavelengths.0.clone(),
        kinds,
        measurement: arguments.measurement.clone(),
        read: ReadOptions { quantity: arguments.quantity, azimuth: arguments.azimuth },
        only: Vec::new(),
    };
    let mut out = io::stdout().lock();
    for file in draw(&arguments.folder, &options)? {
        writeln!(out, "{}", file.display()).map_err(|error| Failure::writing(None, &error))?;
    }
    Ok(())
}

/// Draws the figures of a folder; what is left out is told on standard error.
pub fn draw(folder: &Path, options: &PlotOptions) -> Result<Vec<PathBuf>, Failure> {
    let plotted = plot(folder, options).map_err(|error| Failure::Failed(error.to_string()))?;
    let mut errors = io::stderr().lock();
    for sentence in &plotted.left_out {
        // A courtesy: where standard error is closed, the figures are there all the same.
        let _ = writeln!(errors, "warning: {sentence}");
    }
    Ok(plotted.files)
}
