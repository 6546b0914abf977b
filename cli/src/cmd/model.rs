//! What the commands of the surface model share: options, the index, and the way from inputs to a table.

use std::path::PathBuf;

use clap::Args;
use leafbrdf::output::{Cell, Format, TableWriter};
use leafbrdf_core::{Absorbing, Dielectric, DomainError, Index, Polarized};

use super::Failure;
use super::inputs::{Inputs, RowError};

/// Where a table goes.
#[derive(Args)]
pub struct Output {
    /// Form of the results [default: table on a terminal, csv otherwise]
    #[arg(long, value_enum)]
    pub format: Option<Format>,
    /// File for the results; written whole or not at all, compressed where its name ends in .gz [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// A refractive index that the user chose: real where κ is 0.
#[derive(Clone, Copy)]
pub enum AnyIndex {
    Real(Dielectric<f64>),
    Complex(Absorbing<f64>),
}

impl AnyIndex {
    pub fn new(n: f64, kappa: f64) -> Result<Self, DomainError> {
        Ok(if kappa == 0.0 {
            AnyIndex::Real(Dielectric::new(n)?)
        } else {
            AnyIndex::Complex(Absorbing::new(n, kappa)?)
        })
    }

    pub fn polarized(self, cos_theta_a: f64) -> Polarized<f64> {
        match self {
            AnyIndex::Real(index) => index.polarized(cos_theta_a),
            AnyIndex::Complex(index) => index.polarized(cos_theta_a),
        }
    }
}

impl Index<f64> for AnyIndex {
    fn fresnel(self, cos_theta_a: f64) -> f64 {
        match self {
            AnyIndex::Real(index) => index.fresnel(cos_theta_a),
            AnyIndex::Complex(index) => index.fresnel(cos_theta_a),
        }
    }

    fn fresnel_with_slope(self, cos_theta_a: f64) -> (f64, f64) {
        match self {
            AnyIndex::Real(index) => index.fresnel_with_slope(cos_theta_a),
            AnyIndex::Complex(index) => index.fresnel_with_slope(cos_theta_a),
        }
    }
}

/// Evaluates every row and prints the table.
///
/// All rows are checked before the first is printed: a bad last row leaves no table that looks whole.
pub fn tabulate<const WIDTH: usize>(
    inputs: &Inputs<'_>,
    output: &Output,
    columns: [&str; WIDTH],
    evaluate: impl for<'a> Fn(&'a [f64]) -> Result<[Cell<'a>; WIDTH], DomainError>,
) -> Result<(), Failure> {
    inputs.for_each(|row| evaluate(row).map(|_| ()))?;
    let path = output.output.as_deref();
    let writing = |error: std::io::Error| Failure::writing(path, &error);
    let mut table = TableWriter::create(path, output.format, &columns).map_err(writing)?;
    inputs.for_each(|row| {
        let cells = evaluate(row).map_err(RowError::Domain)?;
        table.row(&cells).map_err(|error| RowError::Failure(writing(error)))
    })?;
    table.finish().map_err(writing)
}
