//! `leafbrdf brdf`: the leaf's BRDF, and every factor of it.

use std::path::PathBuf;

use clap::Args;
use leafbrdf::output::Cell;
use leafbrdf_core::{Angle, Beckmann, Geometry, Index, Leaf, Normalization, Surface, VCavity, facet, masking};

use super::inputs::{Input, Inputs};
use super::list::List;
use super::model::{AnyIndex, Output, tabulate};
use super::{Failure, NormalizationName};

/// Evaluate the leaf BRDF (Eqs 3–10) at the product of lists, or at the rows of a file
///
/// A LIST is 10,20,30 or FIRST:LAST:STEP (LAST included) or both, separated by commas. BRDF in sr⁻¹, α and θ_a in degrees,
/// density in sr⁻¹, normalised: exp(−tan²α/σ²)/(π σ² cos⁴α).
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf brdf --n 1.56 --sigma 0.29 --theta-s 60 --theta-v 0:70:10 --phi-v 180
  leafbrdf brdf --points points.csv --normalization cook-torrance -o brdf.csv")]
pub struct Arguments {
    /// CSV file with the columns n, sigma, theta_s_deg, theta_v_deg, phi_v_deg, optionally kappa, k_l; - is standard input
    #[arg(long, value_name = "FILE", conflicts_with_all = ["n", "sigma", "kappa", "k_l", "theta_s", "theta_v", "phi_v"])]
    points: Option<PathBuf>,
    /// Refractive index of the surface, n ≥ 1
    #[arg(long, value_name = "LIST", required_unless_present = "points", allow_hyphen_values = true)]
    n: Option<List>,
    /// Roughness σ of the surface, > 0
    #[arg(long, value_name = "LIST", required_unless_present = "points", allow_hyphen_values = true)]
    sigma: Option<List>,
    /// Imaginary part κ of the refractive index, ≥ 0 [default: 0]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    kappa: Option<List>,
    /// Lambert coefficient k_L of the diffuse part, 0 to 1 [default: 0]
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    k_l: Option<List>,
    /// Illumination zenith angle θ_s in degrees, 0 ≤ θ_s < 90
    #[arg(long, value_name = "LIST", required_unless_present = "points", allow_hyphen_values = true)]
    theta_s: Option<List>,
    /// Viewing zenith angle θ_v in degrees, 0 ≤ θ_v < 90
    #[arg(long, value_name = "LIST", required_unless_present = "points", allow_hyphen_values = true)]
    theta_v: Option<List>,
    /// Viewing azimuth φ_v in degrees; 180 is the forward, specular side
    #[arg(long, value_name = "LIST", required_unless_present = "points", allow_hyphen_values = true)]
    phi_v: Option<List>,
    /// Constant K of the specular term
    #[arg(long, value_enum, default_value = "bousquet2005")]
    normalization: NormalizationName,
    #[command(flatten)]
    output: Output,
}

const COLUMNS: [&str; 16] = [
    "n",
    "sigma",
    "theta_s_deg",
    "theta_v_deg",
    "phi_v_deg",
    "alpha_deg",
    "theta_a_deg",
    "fresnel",
    "density",
    "masking",
    "brdf_specular",
    "brdf_diffuse",
    "brdf",
    "kappa",
    "k_l",
    "normalization",
];

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let inputs = Inputs::new(
        arguments.points.as_deref(),
        vec![
            Input::new("n", "--n", "n", arguments.n.as_ref(), None),
            Input::new("sigma", "--sigma", "sigma", arguments.sigma.as_ref(), None),
            Input::new("kappa", "--kappa", "kappa", arguments.kappa.as_ref(), Some(0.0)),
            Input::new("k_l", "--k-l", "k_lambert", arguments.k_l.as_ref(), Some(0.0)),
            Input::new("theta_s_deg", "--theta-s", "theta_s", arguments.theta_s.as_ref(), None),
            Input::new("theta_v_deg", "--theta-v", "theta_v", arguments.theta_v.as_ref(), None),
            Input::new("phi_v_deg", "--phi-v", "phi_v", arguments.phi_v.as_ref(), None),
        ],
    )?;
    let normalization = Normalization::from(arguments.normalization);

    tabulate(&inputs, &arguments.output, COLUMNS, |row| {
        let [n, sigma, kappa, k_l, theta_s, theta_v, phi_v] = super::inputs::fixed(row);
        let index = AnyIndex::new(n, kappa)?;
        let surface = Surface::with_parts(index, sigma, Beckmann, VCavity)?.with_normalization(normalization);
        let leaf = Leaf::new(k_l, surface)?;
        let deg = Angle::from_degrees;
        let geometry = Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v))?;
        Ok([
            Cell::Number(n),
            Cell::Number(sigma),
            Cell::Number(theta_s),
            Cell::Number(theta_v),
            Cell::Number(phi_v),
            Cell::Number(geometry.alpha().to_degrees()),
            Cell::Number(geometry.theta_a().to_degrees()),
            Cell::Number(index.fresnel(geometry.cos_theta_a())),
            Cell::Number(facet::beckmann(geometry.tan2_alpha(), sigma)),
            Cell::Number(masking::v_cavity(&geometry)),
            Cell::Number(surface.brdf(&geometry)),
            Cell::Number(leaf.brdf_diffuse(&geometry)),
            Cell::Number(leaf.brdf(&geometry)),
            Cell::Number(kappa),
            Cell::Number(k_l),
            Cell::Text(normalization.name()),
        ])
    })
}
