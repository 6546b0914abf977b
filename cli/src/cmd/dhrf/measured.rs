//! `dhrf --measured FILE`: hemispherical quantities of a measured BRDF.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use leafbrdf::fit::WavelengthRange;
use leafbrdf::hemisphere::{HemisphereOptions, MeasuredDhrf, NotMeasured, hemispheres};
use leafbrdf::measurement::{Azimuth, Quantity, ReadOptions, read_path};
use leafbrdf::output::{Cell, TableWriter};
use leafbrdf_core::Normalization;
use leafbrdf_fit::{BandOptions, LeafBandsOptions, band::Weights};

use super::super::Failure;
use super::super::model::Output;

#[derive(Args)]
pub struct Options {
    /// Measurement file, wide or long, to integrate over its views; - is standard input
    #[arg(long, value_name = "FILE", help_heading = "Measured BRDF",
          conflicts_with_all = ["points", "n", "sigma", "kappa", "theta_s"])]
    pub measured: Option<PathBuf>,
    /// Wavelengths in nm, FIRST:LAST[:STEP], both ends included [default: all in the file]
    #[arg(long, value_name = "RANGE", help_heading = "Measured BRDF")]
    wavelengths: Option<WavelengthRange>,
    /// Leave views beyond this θ_v out, and extrapolate over them [default: 90]
    #[arg(long, value_name = "DEG", help_heading = "Measured BRDF")]
    max_theta_v: Option<f64>,
    /// Do not take views for their mirror images in the principal plane as well
    #[arg(long, help_heading = "Measured BRDF")]
    no_mirror: bool,
    /// Fit k_L, n and sigma in each band, subtract the lobe from the views, integrate what is left, and add the lobe's own
    /// integral: for peaks narrower than the views are apart
    #[arg(long, help_heading = "Measured BRDF")]
    subtract_lobe: bool,
    /// Quantity of the file, where it does not say: π·BRDF (brf) or sr⁻¹ (brdf)
    #[arg(long, value_enum, help_heading = "Measured BRDF")]
    quantity: Option<Quantity>,
    /// Azimuth convention of the file, where it does not say
    #[arg(long, value_enum, help_heading = "Measured BRDF")]
    azimuth: Option<Azimuth>,
}

impl Options {
    /// Without a file, none of the other options means anything.
    pub fn refuse(&self) -> Result<(), Failure> {
        let given = [
            ("--wavelengths", self.wavelengths.is_some()),
            ("--max-theta-v", self.max_theta_v.is_some()),
            ("--no-mirror", self.no_mirror),
            ("--subtract-lobe", self.subtract_lobe),
            ("--quantity", self.quantity.is_some()),
            ("--azimuth", self.azimuth.is_some()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => {
                Err(Failure::Usage(format!("{option} is for a measured BRDF: it needs --measured FILE")))
            }
            None => Ok(()),
        }
    }
}

const COLUMNS: [&str; 25] = [
    "leaf",
    "wavelength_nm",
    "theta_s_deg",
    "dhrf",
    "dhrf_error",
    "extrapolated_share",
    "interpolation_error",
    "extrapolation_error",
    "noise_sd",
    "directions",
    "enclosed_share",
    "mirrored",
    "lobe_n",
    "lobe_sigma",
    "lobe_dhrf",
    "lobe_dhrf_se",
    "peak_theta_v_deg",
    "peak_phi_v_deg",
    "peak_height",
    "background",
    "peak_width_deg",
    "peak_centre_theta_v_deg",
    "peak_centre_phi_v_deg",
    "peak_cut",
    "normalization",
];

pub fn run(file: &Path, options: &Options, normalization: Normalization, output: &Output) -> Result<(), Failure> {
    let max_theta_v_deg = options.max_theta_v.unwrap_or(90.0);
    if !(max_theta_v_deg > 0.0) {
        return Err(Failure::Usage(format!("--max-theta-v {max_theta_v_deg}: expected an angle above 0 degrees")));
    }
    let leaves = read_path(file, &ReadOptions { quantity: options.quantity, azimuth: options.azimuth })?;
    let asked = HemisphereOptions {
        wavelengths: options.wavelengths,
        theta_s_deg: None,
        max_theta_v_deg,
        mirrored: !options.no_mirror,
        subtract: options.subtract_lobe.then(|| LeafBandsOptions {
            normalization,
            // as `fit --model bands`
            band: BandOptions { weights: Weights::Relative, ..BandOptions::table_3() },
            ..LeafBandsOptions::default()
        }),
    };
    let path = output.output.as_deref();
    let writing = |error: io::Error| Failure::writing(path, &error);
    let mut failures: Vec<String> = Vec::new();
    let mut done = Vec::new();
    for leaf in &leaves {
        let named = |message: String| format!("{}: {}: {message}", file.display(), leaf.name);
        if let Some(warning) = leaf.azimuth_warning() {
            // where standard error is closed, the results are there all the same
            let _ = writeln!(io::stderr(), "warning: {warning}");
        }
        match hemispheres(leaf, &asked) {
            Err(failure) => failures.push(named(failure.to_string())),
            Ok(rows) => {
                let mut refused: Vec<(f64, NotMeasured, usize)> = Vec::new();
                for (theta_s, _, result) in rows {
                    match result {
                        Ok(row) => done.push((leaf.name.as_str(), row)),
                        Err(why) => match refused.iter_mut().find(|(at, other, _)| *at == theta_s && *other == why) {
                            Some((_, _, count)) => *count += 1,
                            None => refused.push((theta_s, why, 1)),
                        },
                    }
                }
                let sentence = |(theta_s, why, count): (f64, NotMeasured, usize)| {
                    let bands = if count == 1 { "band" } else { "bands" };
                    named(format!("theta_s {theta_s}°, {count} {bands}: {why}"))
                };
                failures.extend(refused.into_iter().map(sentence));
            }
        }
    }
    if !done.is_empty() {
        let mut table = TableWriter::create(path, output.format, &COLUMNS).map_err(writing)?;
        for (name, row) in &done {
            table.row(&cells(name, row, &asked, normalization)).map_err(writing)?;
        }
        table.finish().map_err(writing)?;
    }
    if failures.is_empty() { Ok(()) } else { Err(Failure::Failed(failures.join("\nerror: "))) }
}

fn cells<'a>(
    name: &'a str,
    row: &MeasuredDhrf,
    asked: &HemisphereOptions,
    normalization: Normalization,
) -> [Cell<'a>; COLUMNS.len()] {
    let lobe = |of: fn(&leafbrdf::hemisphere::SubtractedLobe) -> f64| {
        row.lobe.as_ref().map_or(Cell::Empty, |lobe| Cell::Number(of(lobe)))
    };
    let peak = |of: fn(&leafbrdf::hemisphere::Peak) -> f64| {
        row.peak.as_ref().map_or(Cell::Empty, |peak| Cell::Number(of(peak)))
    };
    let yes = |yes: bool| Cell::Text(if yes { "yes" } else { "no" });
    [
        Cell::Text(name),
        Cell::Number(row.wavelength_nm),
        Cell::Number(row.theta_s_deg),
        Cell::Number(row.dhrf()),
        Cell::Number(row.error()),
        Cell::Number(row.extrapolated_share()),
        Cell::Number(row.integral.interpolation_error),
        Cell::Number(row.integral.extrapolation_error),
        Cell::Number(row.integral.noise_sd),
        Cell::Count(row.directions as u64),
        Cell::Number(row.enclosed),
        yes(asked.mirrored),
        lobe(|lobe| lobe.n),
        lobe(|lobe| lobe.sigma),
        lobe(|lobe| lobe.dhrf),
        lobe(|lobe| lobe.se),
        peak(|peak| peak.brightest_deg[0]),
        peak(|peak| peak.brightest_deg[1]),
        peak(|peak| peak.height),
        peak(|peak| peak.background),
        peak(|peak| peak.width_deg),
        peak(|peak| peak.centre_deg[0]),
        peak(|peak| peak.centre_deg[1]),
        row.peak.map_or(Cell::Empty, |peak| yes(peak.cut)),
        // which convention lobe_n and lobe_sigma belong to; a DHRF has none
        row.lobe.map_or(Cell::Empty, |_| Cell::Text(normalization.name())),
    ]
}
