//! `leafbrdf fit`: the main job, inversion of measured leaf BRDF; and of hemispherical spectra.

mod leaf;
mod leaves;
mod prospect;
mod surface;

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use indicatif::ProgressBar;
use leafbrdf::fit::{LeafValues, Summary, WavelengthRange, fit_bands, write_bands};
use leafbrdf::measurement::{Azimuth, Measurement, Quantity, ReadOptions};
use leafbrdf::plot::PlotOptions;
use leafbrdf_core::Normalization;
use leafbrdf_fit::{BandBounds, BandOptions, Interval, LeafBandsOptions, Start, band::Weights};

use super::{Failure, NormalizationName};

/// What is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Model {
    /// k_L, n and σ at each wavelength (§4.2)
    Bands,
    /// One n and σ for the leaf, k_L at each wavelength; with options a tilt of the leaf, other facets, another diffuse term
    Surface,
    /// n and σ of the surface and PROSPECT's parameters of the interior, from directional reflectance (§4.6)
    Leaf,
    /// PROSPECT's parameters, from hemispherical reflectance, transmittance or both
    Prospect,
}

/// Invert measured leaf BRDF: parameters with standard errors, from measurement files
///
/// Writes DIR/bands.csv, DIR/dhrf.csv and DIR/summary.json, into a folder DIR/LEAF for each leaf where there are several, and
/// DIR/leaves.csv with one row a leaf. A leaf that fails is named, and the others are still done.
///
/// With --model prospect the files are hemispherical spectra (columns wavelength_nm, reflectance and/or transmittance as
/// fractions, optionally sample, reflectance_sd, transmittance_sd), and DIR/spectrum.csv holds them beside the modelled ones.
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf fit laurel.csv --model bands -o laurel-fit
  leafbrdf fit leaves/*.csv --model bands --wavelengths 480:879 --normalization cook-torrance -o out
  leafbrdf fit laurel.csv --model surface -o laurel-surface
  leafbrdf fit leaves/*.csv --model surface --tilt --facets ggx --diffuse p1 -o out
  leafbrdf fit leaves/*.csv --model leaf -o out
  leafbrdf fit leaf.csv --model leaf --method joint --coupling bousquet --fix cant=0 --car-per-cab 0.25 -o out
  leafbrdf fit sphere.csv --model prospect --prospect D --fix cbrown=0 -o sphere-fit")]
pub struct Arguments {
    /// Measurement files, wide or long (for prospect: spectra), plain or gzip; - is standard input
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,
    /// What is fitted
    #[arg(long, value_enum)]
    model: Model,
    /// Folder for the results; made where it does not exist
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// The constant K of Eq. 10 that n and sigma belong to: 2π² as printed, or 4π [default: bousquet2005; with --facets ggx
    /// cook-torrance]
    #[arg(long, value_enum)]
    normalization: Option<NormalizationName>,
    /// Wavelengths in nm, both ends included; all in the file without it
    #[arg(long, value_name = "FIRST:LAST[:STEP]")]
    wavelengths: Option<WavelengthRange>,
    /// Directions with a larger viewing zenith angle, in degrees, are left out (§2.3)
    #[arg(long, value_name = "DEG", default_value_t = 70.0, value_parser = angle)]
    max_theta_v: f64,
    /// Bounds of the Lambert coefficient (Table 3). With --model surface k_l is not held within them: those outside are counted
    #[arg(long, value_name = "LOWER:UPPER", default_value = "0.01:0.99", allow_hyphen_values = true)]
    k_l_bounds: Range,
    /// Bounds of the refractive index (Table 3)
    #[arg(long, value_name = "LOWER:UPPER", default_value = "1.1:5")]
    n_bounds: Range,
    /// Bounds of the roughness (Table 3)
    #[arg(long, value_name = "LOWER:UPPER", default_value = "0.01:1")]
    sigma_bounds: Range,
    /// A start of your own for n, tried beside those of the scan (with --start-sigma; Table 3: 1.47). k_L needs none: it
    /// follows from n and sigma
    #[arg(long, value_name = "N")]
    start_n: Option<f64>,
    /// A start of your own for sigma (with --start-n; Table 3: 0.3)
    #[arg(long, value_name = "SIGMA")]
    start_sigma: Option<f64>,
    /// The most valleys of χ² that are searched; a scan of the whole box finds them [default: 4 in each band (1 to 4), 8 for a
    /// surface (1 to 12)]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=12))]
    starts: Option<u8>,
    /// Huber's loss: values far from the model count less
    #[arg(long)]
    robust: bool,
    /// Leave the file's standard deviations out: every value counts the same
    #[arg(long)]
    ignore_sd: bool,
    /// Quantity of the files that do not say: π·BRDF (brf) or sr⁻¹ (brdf)
    #[arg(long, value_enum)]
    quantity: Option<Quantity>,
    /// Azimuth convention of the files that do not say
    #[arg(long, value_enum)]
    azimuth: Option<Azimuth>,
    /// Draw the figures too, as `leafbrdf plot` does, into the folder figures beside each leaf's files
    #[arg(long)]
    plots: bool,
    #[command(flatten)]
    surface: surface::Options,
    #[command(flatten)]
    leaf: leaf::Options,
    #[command(flatten)]
    prospect: prospect::Options,
}

/// LOWER:UPPER.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Range(f64, f64);

impl FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected LOWER:UPPER with LOWER < UPPER, such as 1.1:5, not {text}");
        let (lower, upper) = text.split_once(':').ok_or_else(wrong)?;
        match (lower.trim().parse::<f64>(), upper.trim().parse::<f64>()) {
            (Ok(lower), Ok(upper)) if lower < upper && upper.is_finite() && lower.is_finite() => {
                Ok(Range(lower, upper))
            }
            _ => Err(wrong()),
        }
    }
}

fn angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if (0.0..=90.0).contains(&degrees) => Ok(degrees),
        _ => Err("expected an angle from 0 to 90 degrees".to_string()),
    }
}

impl Arguments {
    /// The user's own start must lie inside the bounds.
    fn check_starts(&self) -> Result<(), Failure> {
        for (option, value, within) in
            [("--start-n", self.start_n, self.n_bounds), ("--start-sigma", self.start_sigma, self.sigma_bounds)]
        {
            if let Some(value) = value
                && !(value >= within.0 && value <= within.1)
            {
                let message = format!("{option} {value} lies outside its bounds {}:{}", within.0, within.1);
                return Err(Failure::Usage(message));
            }
        }
        Ok(())
    }

    /// The convention for K where the facets are the paper's.
    fn normalization(&self) -> Normalization {
        self.normalization.map_or(Normalization::Bousquet2005, Normalization::from)
    }

    fn options(&self) -> Result<LeafBandsOptions, Failure> {
        let interval = |Range(lower, upper)| Interval::new(lower, upper);
        let bounds = BandBounds {
            k_lambert: interval(self.k_l_bounds),
            n: interval(self.n_bounds),
            sigma: interval(self.sigma_bounds),
        };
        let start = match (self.start_n, self.start_sigma) {
            (None, None) => None,
            (n, sigma) => Some(Start { n: n.unwrap_or(1.47), sigma: sigma.unwrap_or(0.3) }),
        };
        self.check_starts()?;
        if self.starts.is_some_and(|starts| starts > 4) {
            return Err(Failure::Usage("--starts: expected 1 to 4 for --model bands".to_string()));
        }
        bounds.check().map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(LeafBandsOptions {
            normalization: self.normalization(),
            band: BandOptions {
                bounds,
                starts: usize::from(self.starts.unwrap_or(4)),
                weights: Weights::Relative,
                ..BandOptions::table_3()
            },
            starts: start.into_iter().collect(),
            robust: self.robust,
            ..LeafBandsOptions::default()
        })
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let fitted = match arguments.model {
        Model::Bands => bands(arguments),
        Model::Surface => surface::run(arguments),
        Model::Leaf => leaf::run(arguments),
        Model::Prospect => prospect::run(arguments),
    };
    // where some leaves have failed the others still have figures
    if arguments.plots && !matches!(fitted, Err(Failure::Usage(_))) {
        let read = ReadOptions { quantity: arguments.quantity, azimuth: arguments.azimuth };
        let drawn = super::plot::draw(&arguments.output, &PlotOptions { read, ..PlotOptions::default() });
        return fitted.and(drawn.map(|_| ()));
    }
    fitted
}

fn bands(arguments: &Arguments) -> Result<(), Failure> {
    let options = arguments.options()?;
    arguments.prospect.refuse()?;
    arguments.surface.refuse("bands")?;
    arguments.leaf.refuse("bands")?;
    let model = leaves::Model {
        name: "bands",
        normalization: Some(arguments.normalization().name()),
        bands: Some(|leaf: &Measurement| leaf.wavelengths_nm.len()),
    };
    let fit = |data: &Measurement, bar: &ProgressBar| {
        let selected = leaves::selected(data, arguments)?;
        let mut options = options.clone();
        if selected.sd.is_some() {
            options.band.weights = Weights::Absolute;
        }
        fit_bands(selected, &options, &|bands| bar.inc(bands as u64)).map_err(|failure| failure.to_string())
    };
    leaves::each(
        arguments,
        &model,
        || leaves::measurements(arguments),
        fit,
        |outcome, folder, data, file| {
            let summary = Summary::of_bands(data, file, &outcome);
            write_bands(folder, &outcome)?;
            summary.write(folder)?;
            Ok((LeafValues::from(&summary), summary.line()))
        },
    )
}
