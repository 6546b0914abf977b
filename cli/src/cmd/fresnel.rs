//! `leafbrdf fresnel`: the Fresnel factor of a facet.

use std::path::PathBuf;

use clap::Args;
use leafbrdf::output::Cell;
use leafbrdf_core::{Angle, Index};

use super::Failure;
use super::inputs::{Input, Inputs};
use super::list::List;
use super::model::{AnyIndex, Output, tabulate};

/// Evaluate the Fresnel factor (Eq. 8), and its two polarisations, for a real or complex refractive index
///
/// f = (r_s + r_p)/2 for unpolarised light. A LIST is 10,20,30 or FIRST:LAST:STEP (LAST included).
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf fresnel --n 1.5 --theta 0:85:5
  leafbrdf fresnel --n 1.45 --kappa 0.05 --theta 0,55.4
  leafbrdf fresnel --points points.csv --format json")]
pub struct Arguments {
    /// CSV file with the columns n, k, theta_deg; - is standard input
    #[arg(long, value_name = "FILE", conflicts_with_all = ["n", "kappa", "theta"])]
    points: Option<PathBuf>,
    /// Refractive index, n ≥ 1
    #[arg(long, value_name = "LIST", required_unless_present = "points", allow_hyphen_values = true)]
    n: Option<List>,
    /// Imaginary part κ of the refractive index, ≥ 0 [default: 0]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    kappa: Option<List>,
    /// Incidence angle on the facet in degrees, 0 ≤ θ ≤ 90
    #[arg(long, value_name = "LIST", required_unless_present = "points", allow_hyphen_values = true)]
    theta: Option<List>,
    #[command(flatten)]
    output: Output,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let inputs = Inputs::new(
        arguments.points.as_deref(),
        vec![
            Input::new("n", "--n", "n", arguments.n.as_ref(), None),
            Input::new("k", "--kappa", "kappa", arguments.kappa.as_ref(), Some(0.0)),
            Input::new("theta_deg", "--theta", "theta_a", arguments.theta.as_ref(), None),
        ],
    )?;
    tabulate(&inputs, &arguments.output, ["n", "k", "theta_deg", "f", "r_s", "r_p"], |row| {
        let [n, kappa, theta] = super::inputs::fixed(row);
        let index = AnyIndex::new(n, kappa)?;
        let cos_theta_a = Angle::from_degrees(theta).incidence_cosine()?;
        let polarized = index.polarized(cos_theta_a);
        Ok([n, kappa, theta, index.fresnel(cos_theta_a), polarized.r_s, polarized.r_p].map(Cell::Number))
    })
}
