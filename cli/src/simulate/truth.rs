//! The true values behind a simulated measurement.

use std::io;
use std::path::Path;

use super::CoupledLeaf;
use crate::output::{Cell, Format, TableWriter};

/// Writes `wavelength_nm,k_l,n,sigma`, whole or not at all: what `bands.csv` of a fit is to be compared with.
///
/// # Errors
/// The system's.
pub fn write_truth(path: &Path, leaf: &CoupledLeaf) -> io::Result<()> {
    let mut table = TableWriter::create(Some(path), Some(Format::Csv), &["wavelength_nm", "k_l", "n", "sigma"])?;
    let surface = &leaf.model.surface;
    for (nm, k_l) in leaf.wavelengths_nm.iter().zip(&leaf.k_lambert) {
        table.row(&[*nm, *k_l, surface.n(), surface.sigma()].map(Cell::Number))?;
    }
    table.finish()
}
