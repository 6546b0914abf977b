//! `leafbrdf dhrf`: directional-hemispherical reflectance of the surface, or of a measured leaf.

mod measured;

use std::path::PathBuf;

use clap::Args;
use leafbrdf::output::Cell;
use leafbrdf_core::{Angle, Beckmann, Grade, Illumination, Normalization, Surface, VCavity};

use super::inputs::{Input, Inputs};
use super::list::List;
use super::model::{AnyIndex, Output, tabulate};
use super::{Failure, NormalizationName};

/// Evaluate the hemispherical specular reflectance DHRF_spec (Eqs 12–14), or integrate a measured BRDF (Eq. 2)
///
/// The share of the light from θ_s that the surface reflects into the whole hemisphere; unitless. Relative error below
/// 2e-10 (real index, σ ≤ 1, θ_s ≤ 89°). A LIST is 10,20,30 or FIRST:LAST:STEP (LAST included).
///
/// With --measured, for every θ_s and wavelength of the file: DHRF from the scattered views by natural-neighbour interpolation,
/// with its error and the share that is extrapolated, and the specular peak's place, height and width.
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf dhrf --n 1.4 --sigma 0.1:0.5:0.1 --theta-s 0,30,60,80
  leafbrdf dhrf --points points.csv --normalization cook-torrance
  leafbrdf dhrf --measured laurel.csv --wavelengths 550:780:10 -o laurel-dhrf.csv
  leafbrdf dhrf --measured laurel.csv --subtract-lobe")]
pub struct Arguments {
    /// CSV file with the columns n, sigma, theta_s_deg, optionally kappa; - is standard input
    #[arg(long, value_name = "FILE", conflicts_with_all = ["n", "sigma", "kappa", "theta_s"])]
    points: Option<PathBuf>,
    /// Refractive index of the surface, n ≥ 1
    #[arg(long, value_name = "LIST", required_unless_present_any = ["points", "measured"], allow_hyphen_values = true)]
    n: Option<List>,
    /// Roughness σ of the surface, > 0
    #[arg(long, value_name = "LIST", required_unless_present_any = ["points", "measured"], allow_hyphen_values = true)]
    sigma: Option<List>,
    /// Imaginary part κ of the refractive index, ≥ 0 [default: 0]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    kappa: Option<List>,
    /// Illumination zenith angle θ_s in degrees, 0 ≤ θ_s < 90
    #[arg(long, value_name = "LIST", required_unless_present_any = ["points", "measured"], allow_hyphen_values = true)]
    theta_s: Option<List>,
    /// Constant K of the specular term
    #[arg(long, value_enum, default_value = "bousquet2005")]
    normalization: NormalizationName,
    #[command(flatten)]
    integrate: measured::Options,
    #[command(flatten)]
    output: Output,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(file) = &arguments.integrate.measured {
        return measured::run(file, &arguments.integrate, arguments.normalization.into(), &arguments.output);
    }
    arguments.integrate.refuse()?;
    let inputs = Inputs::new(
        arguments.points.as_deref(),
        vec![
            Input::new("n", "--n", "n", arguments.n.as_ref(), None),
            Input::new("sigma", "--sigma", "sigma", arguments.sigma.as_ref(), None),
            Input::new("kappa", "--kappa", "kappa", arguments.kappa.as_ref(), Some(0.0)),
            Input::new("theta_s_deg", "--theta-s", "theta_s", arguments.theta_s.as_ref(), None),
        ],
    )?;
    let normalization = Normalization::from(arguments.normalization);
    let columns = ["n", "sigma", "theta_s_deg", "dhrf_specular", "kappa", "normalization"];
    tabulate(&inputs, &arguments.output, columns, |row| {
        let [n, sigma, kappa, theta_s] = super::inputs::fixed(row);
        let surface = Surface::with_parts(AnyIndex::new(n, kappa)?, sigma, Beckmann, VCavity)?;
        let illumination = Illumination::new(Angle::from_degrees(theta_s))?;
        let dhrf = normalization.factor::<f64>() * illumination.dhrf(surface.index(), surface.sigma(), Grade::E10);
        Ok([
            Cell::Number(n),
            Cell::Number(sigma),
            Cell::Number(theta_s),
            Cell::Number(dhrf),
            Cell::Number(kappa),
            Cell::Text(normalization.name()),
        ])
    })
}
