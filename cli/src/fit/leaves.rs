//! `leaves.csv`: one row a leaf, failed ones included.

use std::io;
use std::path::Path;

use super::Summary;
use crate::output::{Cell, Format, TableWriter};

/// The columns that the contract names, in its order; cells of parameters that a model does not have are empty.
const COLUMNS: [&str; 49] = [
    "leaf",
    "status",
    "model",
    "normalization",
    "n",
    "sigma",
    "tilt_in_plane_deg",
    "tilt_lateral_deg",
    "n_struct",
    "cab",
    "car",
    "cant",
    "cbrown",
    "cw",
    "cm",
    "prot",
    "cbc",
    "rmse",
    "r2",
    "bands",
    "warnings",
    "file",
    "message",
    "n_struct_se",
    "cab_se",
    "car_se",
    "cant_se",
    "cbrown_se",
    "cw_se",
    "cm_se",
    "prot_se",
    "cbc_se",
    "n_se",
    "sigma_se",
    "tilt_in_plane_deg_se",
    "tilt_lateral_deg_se",
    "p1_a",
    "p1_b",
    "p1_a_se",
    "p1_b_se",
    "facets",
    "diffuse",
    "method",
    "gain",
    "offset",
    "gain_se",
    "offset_se",
    "p2_e",
    "p2_e_se",
];

/// What a row says of a leaf that was fitted; `None` where a model has no such parameter.
#[derive(Clone, Debug, Default)]
pub struct LeafValues {
    /// The convention for K that n and σ belong to.
    pub normalization: Option<String>,
    /// Refractive index of the surface.
    pub n: Option<f64>,
    /// Roughness of the surface.
    pub sigma: Option<f64>,
    /// Tilt of the leaf in the principal plane and across it, degrees.
    pub tilt_deg: [Option<f64>; 2],
    /// N, C_ab, C_car, C_ant, C_brown, C_w, C_m, C_prot, C_cbc.
    pub prospect: [Option<f64>; 9],
    /// Their standard errors.
    pub prospect_se: [Option<f64>; 9],
    /// Standard errors of n, σ and both tilts (degrees).
    pub surface_se: [Option<f64>; 4],
    /// a and b of the diffuse terms P1 and P2.
    pub p1: [Option<f64>; 2],
    /// Their standard errors.
    pub p1_se: [Option<f64>; 2],
    /// e of the diffuse term P2, and its standard error.
    pub p2_e: [Option<f64>; 2],
    /// Distribution of facets, and shape of the diffuse term.
    pub kinds: Option<[&'static str; 2]>,
    /// How a whole leaf was inverted.
    pub method: Option<&'static str>,
    /// Gain and flat offset of the diffuse term.
    pub gain_and_offset: [Option<f64>; 2],
    /// Their standard errors.
    pub gain_and_offset_se: [Option<f64>; 2],
    /// √(Σ residual²/values): sr⁻¹ of BRDF, or for `prospect` a fraction (reflectance, transmittance).
    pub rmse: f64,
    /// 1 − Σ residual²/Σ (value − mean)².
    pub r2: f64,
    /// Wavelengths fitted.
    pub bands: usize,
    /// What the user should know before using the numbers.
    pub warnings: Vec<String>,
}

impl From<&Summary> for LeafValues {
    fn from(summary: &Summary) -> Self {
        LeafValues {
            normalization: Some(summary.normalization.name().to_string()),
            n: Some(summary.n),
            sigma: Some(summary.sigma),
            surface_se: [summary.surface_se[0], summary.surface_se[1], None, None],
            rmse: summary.rmse,
            r2: summary.r2,
            bands: summary.fitted,
            warnings: summary.warnings.clone(),
            kinds: Some(["beckmann", "lambert"]),
            ..LeafValues::default()
        }
    }
}

/// One row of `leaves.csv`: the leaf's name, its file, and what was found or the sentence that says why nothing was.
pub type LeafRecord = (String, String, Result<LeafValues, String>);

/// Writes `leaves.csv` into a folder, whole or not at all; `normalization` is what failed leaves would have had, where the model has one.
///
/// # Errors
/// The system's.
pub fn write_records(
    folder: &Path,
    model: &str,
    normalization: Option<&str>,
    records: &[LeafRecord],
) -> io::Result<()> {
    let mut table = TableWriter::create(Some(&folder.join("leaves.csv")), Some(Format::Csv), &COLUMNS)?;
    for (leaf, file, result) in records {
        let status = if result.is_ok() { "done" } else { "failed" };
        let message;
        let mut row = vec![Cell::Text(leaf), Cell::Text(status), Cell::Text(model)];
        match result {
            Ok(values) => {
                row.push(values.normalization.as_deref().map_or(Cell::Empty, Cell::Text));
                row.extend([number(&values.n), number(&values.sigma)]);
                row.extend(values.tilt_deg.iter().chain(&values.prospect).map(number));
                row.extend([Cell::Number(values.rmse), Cell::Number(values.r2)]);
                row.extend([Cell::Count(values.bands as u64), Cell::Count(values.warnings.len() as u64)]);
                message = values.warnings.join(" | ");
                row.extend([Cell::Text(file), Cell::Text(&message)]);
                let errors = values.prospect_se.iter().chain(&values.surface_se);
                row.extend(errors.chain(&values.p1).chain(&values.p1_se).map(number));
                row.extend(values.kinds.map_or([Cell::Empty; 2], |kinds| kinds.map(Cell::Text)));
                row.push(values.method.map_or(Cell::Empty, Cell::Text));
                let coupling = values.gain_and_offset.iter().chain(&values.gain_and_offset_se);
                row.extend(coupling.chain(&values.p2_e).map(number));
            }
            Err(sentence) => {
                row.push(normalization.map_or(Cell::Empty, Cell::Text));
                row.extend([Cell::Empty; 17]);
                row.extend([Cell::Text(file), Cell::Text(sentence)]);
                row.extend([Cell::Empty; 26]);
            }
        }
        table.row(&row)?;
    }
    table.finish()
}

fn number<'a>(number: &Option<f64>) -> Cell<'a> {
    Cell::or_empty(*number)
}
