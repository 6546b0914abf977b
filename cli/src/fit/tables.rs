//! The tables that more than one model writes: `dhrf.csv` of each of them, and `bands.csv` of those with one surface for the leaf.

use std::io;
use std::path::Path;

use leafbrdf_core::{DhrfGradient, Normalization};
use leafbrdf_fit::AtBound;

use crate::output::{Cell, Format, TableWriter};

/// DHRF at one θ_s: the diffuse term's, the surface's, and the latter's standard error; NaN where there is none.
#[derive(Clone, Copy, Debug)]
pub(super) struct Budget {
    pub theta_s_deg: f64,
    pub diffuse: f64,
    pub specular: f64,
    pub specular_se: f64,
}

impl Budget {
    /// First-order propagation to DHRF_spec of the variances and the covariance of n and σ.
    pub fn specular_se(gradient: &DhrfGradient<f64>, [n, covariance, sigma]: [f64; 3]) -> f64 {
        let variance = gradient.d_n * (gradient.d_n * n + 2.0 * gradient.d_sigma * covariance)
            + gradient.d_sigma * gradient.d_sigma * sigma;
        variance.max(0.0).sqrt()
    }

    /// The budget of a wavelength from that of a leaf whose diffuse part is for k_L = 1.
    pub fn with_k_lambert(self, k_l: f64) -> Self {
        Budget { diffuse: k_l * self.diffuse, ..self }
    }
}

/// Writes `dhrf.csv` into a folder, whole or not at all; each row with its wavelength, nm.
pub(super) fn write_budgets(
    folder: &Path,
    normalization: Normalization,
    rows: impl Iterator<Item = (f64, Budget)>,
) -> io::Result<()> {
    let columns = [
        "wavelength_nm",
        "theta_s_deg",
        "dhrf_diffuse",
        "dhrf_specular",
        "dhrf",
        "dhrf_specular_se",
        "specular_share",
        "normalization",
    ];
    let mut table = TableWriter::create(Some(&folder.join("dhrf.csv")), Some(Format::Csv), &columns)?;
    for (nm, Budget { theta_s_deg, diffuse, specular, specular_se }) in rows {
        let total = diffuse + specular;
        let numbers = [nm, theta_s_deg, diffuse, specular, total, specular_se, specular / total];
        let mut cells: Vec<Cell<'_>> = numbers.map(Cell::Number).to_vec();
        cells.push(Cell::Text(normalization.name()));
        table.row(&cells)?;
    }
    table.finish()
}

/// The columns with which every `bands.csv` begins.
pub(super) const BAND_COLUMNS: [&str; 11] =
    ["wavelength_nm", "k_l", "n", "sigma", "rmse", "n_obs", "status", "at_bound", "k_l_se", "n_se", "sigma_se"];

/// What all rows of `bands.csv` say alike, where one surface serves the whole leaf.
pub(super) struct OneSurface<'a> {
    /// Which parameters sit at a bound.
    pub at_bound: &'a str,
    /// a and b of the diffuse term, its e, and both tilts in degrees.
    pub shape: [Option<f64>; 5],
    pub facets: &'a str,
    pub diffuse: &'a str,
    pub normalization: Normalization,
}

/// One wavelength of it.
pub(super) struct Band<'a> {
    pub wavelength_nm: f64,
    pub k_l: Option<f64>,
    /// n and σ.
    pub surface: [Option<f64>; 2],
    pub rmse: Option<f64>,
    pub n_obs: usize,
    pub status: &'a str,
    pub k_l_se: Option<f64>,
    pub surface_se: [Option<f64>; 2],
    pub note: &'a str,
}

/// Writes `bands.csv` of a leaf with one surface into a folder, whole or not at all.
pub(super) fn write_bands<'a>(
    folder: &Path,
    leaf: &OneSurface<'_>,
    bands: impl Iterator<Item = Band<'a>>,
) -> io::Result<()> {
    let others =
        ["p1_a", "p1_b", "p2_e", "tilt_in_plane_deg", "tilt_lateral_deg", "facets", "diffuse", "note", "normalization"];
    let columns = [&BAND_COLUMNS[..], &others].concat();
    let mut table = TableWriter::create(Some(&folder.join("bands.csv")), Some(Format::Csv), &columns)?;
    for band in bands {
        let mut row = vec![Cell::Number(band.wavelength_nm), Cell::or_empty(band.k_l)];
        row.extend(band.surface.map(Cell::or_empty));
        row.extend([Cell::or_empty(band.rmse), Cell::Count(band.n_obs as u64)]);
        row.extend([band.status, leaf.at_bound].map(Cell::Text));
        row.push(Cell::or_empty(band.k_l_se));
        row.extend(band.surface_se.iter().chain(&leaf.shape).copied().map(Cell::or_empty));
        row.extend([leaf.facets, leaf.diffuse, band.note, leaf.normalization.name()].map(Cell::Text));
        table.row(&row)?;
    }
    table.finish()
}

/// `sigma=upper;k_l=lower`, or nothing.
pub(super) fn at_bound<'a>(parameters: impl Iterator<Item = (&'a str, AtBound)>) -> String {
    let places = parameters.filter_map(|(name, at)| match at {
        AtBound::Free => None,
        AtBound::Lower => Some(format!("{name}=lower")),
        AtBound::Upper => Some(format!("{name}=upper")),
    });
    places.collect::<Vec<_>>().join(";")
}
