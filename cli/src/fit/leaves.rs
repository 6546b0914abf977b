//! `leaves.csv`: one row a leaf, failed ones included.

use std::io;
use std::path::Path;

use super::Summary;
use crate::output::{Cell, Format, TableWriter};

/// One leaf's row.
#[derive(Clone, Debug)]
pub struct LeafRow {
    /// The leaf's name.
    pub leaf: String,
    /// The file it came from.
    pub file: String,
    /// What was found, or the sentence that says why nothing was.
    pub result: Result<Summary, String>,
}

/// The columns that the contract names, in its order; cells of parameters that a model does not have are empty.
const COLUMNS: [&str; 23] = [
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
];

/// Writes `leaves.csv` into a folder, whole or not at all.
///
/// # Errors
/// The system's.
pub fn write_leaves(folder: &Path, model: &str, normalization: &str, rows: &[LeafRow]) -> io::Result<()> {
    let mut table = TableWriter::create(Some(&folder.join("leaves.csv")), Some(Format::Csv), &COLUMNS)?;
    for LeafRow { leaf, file, result } in rows {
        let status = if result.is_ok() { "done" } else { "failed" };
        let mut row = vec![leaf.as_str(), status, model, normalization].into_iter().map(Cell::Text).collect::<Vec<_>>();
        let message = match result {
            Ok(summary) => {
                row.extend([Cell::Number(summary.n), Cell::Number(summary.sigma)]);
                row.extend([Cell::Empty; 11]);
                row.extend([Cell::Number(summary.rmse), Cell::Number(summary.r2)]);
                row.extend([Cell::Count(summary.fitted as u64), Cell::Count(summary.warnings.len() as u64)]);
                summary.warnings.join(" | ")
            }
            Err(sentence) => {
                row.extend([Cell::Empty; 17]);
                sentence.clone()
            }
        };
        row.extend([Cell::Text(file), Cell::Text(&message)]);
        table.row(&row)?;
    }
    table.finish()
}
