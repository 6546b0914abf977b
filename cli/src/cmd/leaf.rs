//! `leafbrdf leaf`: the coupled leaf, PROSPECT's interior under a rough surface.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};
use leafbrdf::measurement::ReadError;
use leafbrdf::output::{Cell, TableWriter};
use leafbrdf::points::Points;
use leafbrdf_core::{Angle, DomainError, Geometry, Normalization, Surface};
use leafbrdf_prospect::{CoupledLeaf, Coupling, Error, LeafParams, Parameter, Prospect, Version, table};

use super::model::Output;
use super::version::VersionName;
use super::{Failure, NormalizationName};

/// Evaluate the coupled leaf (Eq. 18): BRDF of PROSPECT's interior under a rough surface
///
/// One value a row of the file. The diffuse part is k_L = R − DHRF_spec(n, σ, 0°) (bousquet, Eq. 17), PROSPECT's reflectance less its
/// first-surface reflection 1 − t_av(40°) (prospecular), R plus a constant (offset), or gain times prospecular's plus a constant
/// (gain-offset). A k_L that comes out negative is printed as it is, marked in the column k_l_sign, and counted on standard error.
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf leaf --points leaves.csv
  leafbrdf leaf --points leaves.csv --coupling prospecular --normalization cook-torrance -o brdf.csv")]
pub struct Arguments {
    /// CSV file with the columns n, sigma, n_struct, wavelength_nm, theta_s_deg, theta_v_deg, phi_v_deg; optionally cab, car,
    /// cant, cbrown, cw, cm, prot, cbc (0 without), gain (1), offset (0), and version, normalization, coupling in the place of the
    /// options; - is standard input
    #[arg(long, value_name = "FILE", required = true)]
    points: PathBuf,
    /// Version of PROSPECT of rows without a column version
    #[arg(long = "prospect", value_enum, ignore_case = true, default_value = "D")]
    version: VersionName,
    /// Constant K of the specular term, of rows without a column normalization
    #[arg(long, value_enum, default_value = "bousquet2005")]
    normalization: NormalizationName,
    /// From the interior to k_L, of rows without a column coupling
    #[arg(long, value_enum, default_value = "bousquet")]
    coupling: CouplingName,
    /// n is a coefficient on the tabulated index of leaf material (PROSPECULAR), not the surface's index itself
    #[arg(long)]
    scaled_index: bool,
    #[command(flatten)]
    output: Output,
}

/// A coupling by the name that users write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CouplingName(pub Coupling);

impl ValueEnum for CouplingName {
    fn value_variants<'a>() -> &'a [Self] {
        &[
            CouplingName(Coupling::Bousquet),
            CouplingName(Coupling::Prospecular),
            CouplingName(Coupling::Offset),
            CouplingName(Coupling::GainOffset),
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        let help = match self.0 {
            Coupling::Bousquet => "k_L = R − DHRF_spec(n, σ, 0°) (Eq. 17)",
            Coupling::Prospecular => "k_L = R − (1 − t_av(40°, n(λ)))",
            Coupling::Offset => "k_L = R + offset",
            Coupling::GainOffset => "k_L = gain · (R − (1 − t_av(40°, n(λ)))) + offset",
        };
        Some(PossibleValue::new(self.0.name()).help(help))
    }
}

/// The columns of numbers, in the order of the output, and what a missing one means.
const NUMBERS: [(&str, Option<f64>); 17] = [
    ("n", None),
    ("sigma", None),
    ("n_struct", None),
    ("cab", Some(0.0)),
    ("car", Some(0.0)),
    ("cant", Some(0.0)),
    ("cbrown", Some(0.0)),
    ("cw", Some(0.0)),
    ("cm", Some(0.0)),
    ("prot", Some(0.0)),
    ("cbc", Some(0.0)),
    ("wavelength_nm", None),
    ("theta_s_deg", None),
    ("theta_v_deg", None),
    ("phi_v_deg", None),
    ("gain", Some(1.0)),
    ("offset", Some(0.0)),
];

/// The columns of words.
const WORDS: [&str; 3] = ["version", "normalization", "coupling"];

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let points = Rows::new(arguments)?;
    // all rows are checked before the first is printed: a bad last row leaves no table that looks whole
    let mut negative = 0;
    let mut results = Vec::with_capacity(points.points.len());
    for row in 0..points.points.len() {
        let result = points.evaluate(row)?;
        negative += usize::from(result.k_l < 0.0);
        results.push(result);
    }
    let path = arguments.output.output.as_deref();
    print(&results, arguments).map_err(|error| Failure::writing(path, &error))?;
    if negative > 0 {
        // a courtesy: the column says it too
        let _ = writeln!(
            io::stderr(),
            "warning: k_l is negative in {negative} of {} rows: there the surface alone reflects more than the whole leaf, so \
             interior and surface do not go together",
            results.len()
        );
    }
    Ok(())
}

fn print(results: &[Evaluated], arguments: &Arguments) -> io::Result<()> {
    let columns: Vec<&str> =
        NUMBERS.iter().map(|(name, _)| *name).chain(WORDS).chain(["k_l", "brdf", "k_l_sign"]).collect();
    let mut table = TableWriter::create(arguments.output.output.as_deref(), arguments.output.format, &columns)?;
    for Evaluated { numbers, version, normalization, coupling, k_l, brdf } in results {
        let mut cells: Vec<Cell<'_>> = numbers.map(Cell::Number).to_vec();
        cells.extend([version.name(), normalization.name(), coupling.name()].map(Cell::Text));
        let sign = if *k_l < 0.0 { "negative" } else { "" };
        cells.extend([Cell::Number(*k_l), Cell::Number(*brdf), Cell::Text(sign)]);
        table.row(&cells)?;
    }
    table.finish()
}

/// The file, with the places of its columns.
struct Rows<'a> {
    arguments: &'a Arguments,
    points: Points,
    numbers: [Option<usize>; NUMBERS.len()],
    words: [Option<usize>; WORDS.len()],
}

/// One row, computed.
struct Evaluated {
    numbers: [f64; NUMBERS.len()],
    version: Version,
    normalization: Normalization,
    coupling: Coupling,
    k_l: f64,
    brdf: f64,
}

impl<'a> Rows<'a> {
    fn new(arguments: &'a Arguments) -> Result<Self, ReadError> {
        let points = Points::read(&arguments.points)?;
        let mut numbers = [None; NUMBERS.len()];
        for (place, (name, default)) in numbers.iter_mut().zip(NUMBERS) {
            *place = if default.is_some() { points.find(name)? } else { Some(points.require(name)?) };
        }
        let mut words = [None; WORDS.len()];
        for (place, name) in words.iter_mut().zip(WORDS) {
            *place = points.find(name)?;
        }
        Ok(Rows { arguments, points, numbers, words })
    }

    /// The word of a column, or what the options say.
    fn word<W: ValueEnum>(&self, row: usize, column: usize, default: W) -> Result<W, Failure> {
        let Some(place) = self.words[column] else { return Ok(default) };
        W::from_str(self.points.text(row, place), true).map_err(|_| {
            let names: Vec<String> = W::value_variants()
                .iter()
                .filter_map(|value| Some(value.to_possible_value()?.get_name().to_string()))
                .collect();
            self.points.error(row, place, &format!("expected {}", names.join(", "))).into()
        })
    }

    fn evaluate(&self, row: usize) -> Result<Evaluated, Failure> {
        let mut numbers = [0.0; NUMBERS.len()];
        for ((number, place), (_, default)) in numbers.iter_mut().zip(self.numbers).zip(NUMBERS) {
            *number = match place {
                Some(place) => self.points.number(row, place)?,
                None => default.unwrap_or(f64::NAN),
            };
        }
        let VersionName(version) = self.word(row, 0, self.arguments.version)?;
        let normalization = Normalization::from(self.word(row, 1, self.arguments.normalization)?);
        let CouplingName(coupling) = self.word(row, 2, self.arguments.coupling)?;

        // an error of the model speaks of one column
        let at = |name: &str, message: String| -> Failure {
            let column = NUMBERS.iter().position(|(other, _)| *other == name).and_then(|column| self.numbers[column]);
            match column {
                Some(column) => self.points.error(row, column, &message).into(),
                None => Failure::Failed(message),
            }
        };
        let domain = |error: DomainError| {
            let name = match error.parameter {
                "theta_s" => "theta_s_deg",
                "theta_v" => "theta_v_deg",
                "phi_v" => "phi_v_deg",
                other => other,
            };
            at(name, format!("expected {}", error.expected))
        };
        let inside = |error: Error| {
            let name = match error {
                Error::Outside { parameter, .. } | Error::NotInVersion { parameter, .. } => parameter.name(),
                Error::DryMatterTwice => "cm",
                Error::Wavelength { .. } => "wavelength_nm",
                _ => "n",
            };
            let hint = if let Error::Wavelength { value, .. } = error { super::micrometres(value) } else { "" };
            at(name, format!("{error}{hint}"))
        };

        let [n, sigma, interior @ .., wavelength_nm, theta_s, theta_v, phi_v, gain, offset] = numbers;
        let interior: [f64; Parameter::ALL.len()] = interior;
        let mut leaf = LeafParams::with_n_struct(1.0);
        for (parameter, value) in Parameter::ALL.into_iter().zip(interior) {
            leaf.set(parameter, value);
        }
        let deg = Angle::from_degrees;
        let geometry = Geometry::from_angles(deg(theta_s), deg(theta_v), deg(phi_v)).map_err(domain)?;
        // a coefficient may be below 1; the index that it makes is checked by the leaf
        let surface = Surface::new(if self.arguments.scaled_index { 1.0 } else { n }, sigma).map_err(domain)?;
        let mut room = [0.0; 11];
        let columns = table::columns_of(version);
        let wavelength = [wavelength_nm];
        let room = room.get_mut(..columns).unwrap_or_default();
        let view = table::full(version).at_wavelengths(&wavelength, room).map_err(inside)?;
        let surface = surface.with_normalization(normalization);
        let coupled = CoupledLeaf::new(Prospect::new(view), leaf, coupling, surface).with_gain_and_offset(gain, offset);
        let coupled = if self.arguments.scaled_index { coupled.with_scaled_index(n) } else { coupled };
        let band = coupled.band(0, &geometry).map_err(inside)?;
        Ok(Evaluated { numbers, version, normalization, coupling, k_l: band.diffuse.k_lambert, brdf: band.brdf })
    }
}
