//! `leafbrdf prospect`: reflectance and transmittance of leaves from their structure and contents.

use std::collections::HashSet;
use std::io;
use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, ValueEnum};
use leafbrdf::output::{Cell, TableWriter};
use leafbrdf::points::Points;
use leafbrdf::spectra::Grid;
use leafbrdf_prospect::{Error, LeafParams, Parameter, Prospect, Version, sensor, table};

use super::Failure;
use super::list::List;
use super::model::Output;
use super::version::VersionName;

/// Leaf reflectance and transmittance by PROSPECT, at any wavelengths from 400 to 2500 nm
///
/// Fractions of the light that falls on the upper face; R + T + absorptance = 1. An omitted constituent is 0. Values that are
/// impossible, or probably in another unit, are refused.
#[derive(Args)]
#[command(after_help = "Examples:
  leafbrdf prospect --model D --n-struct 1.5 --cab 40 --car 8 --cw 0.01 --cm 0.009
  leafbrdf prospect --model PRO --n-struct 1.4 --cab 50 --prot 0.001 --cbc 0.004 --bands 560:20,665:30,705:15,842:115
  leafbrdf prospect --points leaves.csv --wavelengths 400:2500:10 -o spectra.csv")]
pub struct Arguments {
    /// CSV file with the columns n_struct, optionally version, cab, car, cant, cbrown, cw, cm, prot, cbc; one spectrum a distinct
    /// row; - is standard input
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["n_struct", "cab", "car", "cant", "cbrown", "cw", "cm", "prot", "cbc"])]
    points: Option<PathBuf>,
    /// Version; with --points, that of rows without a column version
    #[arg(long, value_enum, ignore_case = true, default_value = "D")]
    model: VersionName,
    /// N, number of plates, 1 to 10
    #[arg(long, value_name = "N", required_unless_present = "points", allow_negative_numbers = true)]
    n_struct: Option<f64>,
    /// C_ab, chlorophylls a + b, µg cm⁻² [default: 0]
    #[arg(long, value_name = "CAB", allow_negative_numbers = true)]
    cab: Option<f64>,
    /// C_car, carotenoids, µg cm⁻² [default: 0]
    #[arg(long, value_name = "CAR", allow_negative_numbers = true)]
    car: Option<f64>,
    /// C_ant, anthocyanins, µg cm⁻² (D, PRO) [default: 0]
    #[arg(long, value_name = "CANT", allow_negative_numbers = true)]
    cant: Option<f64>,
    /// C_brown, brown pigments, arbitrary units [default: 0]
    #[arg(long, value_name = "CBROWN", allow_negative_numbers = true)]
    cbrown: Option<f64>,
    /// C_w, equivalent water thickness, cm [default: 0]
    #[arg(long, value_name = "CW", allow_negative_numbers = true)]
    cw: Option<f64>,
    /// C_m, dry matter, g cm⁻² [default: 0]
    #[arg(long, value_name = "CM", allow_negative_numbers = true)]
    cm: Option<f64>,
    /// C_prot, proteins, g cm⁻² (PRO) [default: 0]
    #[arg(long, value_name = "PROT", allow_negative_numbers = true)]
    prot: Option<f64>,
    /// C_cbc, carbon-based constituents other than proteins, g cm⁻² (PRO) [default: 0]
    #[arg(long, value_name = "CBC", allow_negative_numbers = true)]
    cbc: Option<f64>,
    /// Tie carotenoids to chlorophyll: C_car = RATIO · C_ab (0.25 is usual), with car omitted
    #[arg(long, value_name = "RATIO", allow_negative_numbers = true)]
    car_per_cab: Option<f64>,
    /// Let PROSPECT-PRO take cm together with prot or cbc, which otherwise is refused: the same matter would absorb twice
    #[arg(long)]
    allow_cm_with_prot_cbc: bool,
    /// Wavelengths in nm, in the order printed; those between the 1 nm of the tables are interpolated
    #[arg(long, value_name = "LIST", default_value = "400:2500:1", conflicts_with = "bands")]
    wavelengths: List,
    /// Bands of a sensor instead: centre and full width at half maximum in nm, Gaussian
    #[arg(long, value_name = "CENTRE:FWHM,…")]
    bands: Option<Bands>,
    #[command(flatten)]
    output: Output,
}

/// CENTRE:FWHM, separated by commas.
#[derive(Clone, Debug)]
struct Bands(Vec<(f64, f64)>);

impl FromStr for Bands {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let band = |part: &str| {
            let (centre, fwhm) = part.split_once(':')?;
            Some((centre.trim().parse::<f64>().ok()?, fwhm.trim().parse::<f64>().ok()?))
        };
        let bands = text.split(',').map(|part| {
            band(part).ok_or_else(|| format!("{part:?}: expected CENTRE:FWHM in nm, such as 560:20,665:30"))
        });
        bands.collect::<Result<_, _>>().map(Bands)
    }
}

/// One leaf to compute, and its row where it comes from a file.
struct Leaf {
    version: Version,
    leaf: LeafParams<f64>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let leaves = match &arguments.points {
        Some(path) => from_points(&Points::read(path)?, arguments)?,
        None => vec![from_flags(arguments)?],
    };
    let columns = Columns::new(arguments)?;
    print(arguments, &leaves, &columns).map_err(|error| Failure::writing(arguments.output.output.as_deref(), &error))
}

/// The rules of the model that the options set.
fn ruled<'a>(arguments: &Arguments, model: Prospect<'a, f64>) -> Result<Prospect<'a, f64>, Error> {
    let model = if arguments.allow_cm_with_prot_cbc { model.allow_cm_with_prot_cbc() } else { model };
    match arguments.car_per_cab {
        Some(ratio) => model.with_car_per_cab(ratio),
        None => Ok(model),
    }
}

/// Does the model accept this leaf?
fn check(arguments: &Arguments, version: Version, leaf: &LeafParams<f64>) -> Result<(), Error> {
    ruled(arguments, Prospect::new(table::full(version)))?.band(leaf, 0).map(|_| ())
}

fn from_flags(arguments: &Arguments) -> Result<Leaf, Failure> {
    let values = [
        arguments.n_struct,
        arguments.cab,
        arguments.car,
        arguments.cant,
        arguments.cbrown,
        arguments.cw,
        arguments.cm,
        arguments.prot,
        arguments.cbc,
    ];
    let mut leaf = LeafParams::with_n_struct(0.0);
    for (parameter, value) in Parameter::ALL.into_iter().zip(values) {
        leaf.set(parameter, value.unwrap_or(0.0));
    }
    let version = arguments.model.0;
    check(arguments, version, &leaf).map_err(|error| Failure::Usage(format!("{}: {error}", flag(error))))?;
    super::warn_of_milligrams(leaf.cab);
    Ok(Leaf { version, leaf })
}

/// The option that an error of the model speaks of.
fn flag(error: Error) -> String {
    match error {
        Error::Outside { parameter, .. } | Error::NotInVersion { parameter, .. } => {
            format!("--{}", parameter.name().replace('_', "-"))
        }
        Error::CarPerCab { .. } | Error::CarGivenAndTied => "--car-per-cab".to_string(),
        Error::DryMatterTwice => "--cm".to_string(),
        Error::Response => "--bands".to_string(),
        Error::Wavelength { .. } => "--wavelengths".to_string(),
        _ => "prospect".to_string(),
    }
}

/// The distinct leaves of a file, in order of their first rows; all rows are checked.
fn from_points(points: &Points, arguments: &Arguments) -> Result<Vec<Leaf>, Failure> {
    let version_column = points.find("version")?;
    let mut columns = Vec::new();
    for parameter in Parameter::ALL {
        let name = parameter.name();
        let column = if parameter == Parameter::NStruct { Some(points.require(name)?) } else { points.find(name)? };
        columns.push((parameter, column));
    }
    let mut seen = HashSet::new();
    let mut leaves = Vec::new();
    for row in 0..points.len() {
        let version = match version_column {
            Some(column) => VersionName::from_str(points.text(row, column), true)
                .map_err(|_| points.error(row, column, "expected 5B, D or PRO"))?,
            None => arguments.model,
        };
        let mut leaf = LeafParams::with_n_struct(0.0);
        for (parameter, column) in &columns {
            if let Some(column) = column {
                leaf.set(*parameter, points.number(row, *column)?);
            }
        }
        // + 0: a negative zero is the same leaf
        let key = Parameter::ALL.map(|parameter| (leaf.get(parameter) + 0.0).to_bits());
        if !seen.insert((version.0, key)) {
            continue;
        }
        check(arguments, version.0, &leaf).map_err(|error| {
            let of = match error {
                Error::Outside { parameter, .. } | Error::NotInVersion { parameter, .. } => parameter,
                Error::DryMatterTwice => Parameter::Cm,
                Error::CarGivenAndTied => Parameter::Car,
                other => return Failure::Usage(format!("{}: {other}", flag(other))),
            };
            match columns.iter().find_map(|(parameter, column)| column.filter(|_| *parameter == of)) {
                Some(column) => points.error(row, column, &error.to_string()).into(),
                None => Failure::Failed(error.to_string()),
            }
        })?;
        leaves.push(Leaf { version: version.0, leaf });
    }
    Ok(leaves)
}

/// What each row of a spectrum stands for.
enum Columns {
    /// Rising wavelengths without repetition, and for each row printed its place among them.
    Wavelengths { grid: Grid, order: Vec<usize> },
    /// Sensor bands with their weights at the table's wavelengths.
    Bands(Vec<(f64, f64, Vec<f64>)>),
}

impl Columns {
    fn new(arguments: &Arguments) -> Result<Self, Failure> {
        let usage = |error: Error| {
            let hint = if let Error::Wavelength { value, .. } = error { super::micrometres(value) } else { "" };
            let option = if arguments.bands.is_some() { "--bands" } else { "--wavelengths" };
            Failure::Usage(format!("{option}: {error}{hint}"))
        };
        if let Some(Bands(bands)) = &arguments.bands {
            let wavelengths = table::full(Version::D).wavelengths();
            let weighted = bands.iter().map(|&(centre, fwhm)| {
                let mut weights = vec![0.0; table::BANDS];
                sensor::weights(&sensor::Response::Gaussian { centre, fwhm }, wavelengths, &mut weights)?;
                Ok((centre, fwhm, weights))
            });
            return Ok(Columns::Bands(weighted.collect::<Result<_, Error>>().map_err(usage)?));
        }
        let List(asked) = &arguments.wavelengths;
        let mut rising = asked.clone();
        rising.sort_by(f64::total_cmp);
        rising.dedup();
        let order = asked.iter().map(|nm| rising.partition_point(|other| other < nm)).collect();
        let grid = Grid::new(rising);
        grid.check().map_err(usage)?;
        Ok(Columns::Wavelengths { grid, order })
    }
}

fn print(arguments: &Arguments, leaves: &[Leaf], columns: &Columns) -> io::Result<()> {
    let mut names = Vec::new();
    if arguments.points.is_some() {
        names.push("version");
        names.extend(Parameter::ALL.map(Parameter::name));
    }
    names.extend(["wavelength_nm", "reflectance", "transmittance", "absorptance"]);
    if matches!(columns, Columns::Bands(_)) {
        names.push("fwhm_nm");
    }
    let mut table = TableWriter::create(arguments.output.output.as_deref(), arguments.output.format, &names)?;
    let refused = |error: Error| io::Error::new(io::ErrorKind::InvalidInput, error.to_string());
    // the tables at the wavelengths asked for, once a version
    let versions = [Version::P5B, Version::D, Version::Pro];
    let mut rooms = versions.map(|version| match columns {
        Columns::Wavelengths { grid, .. } if leaves.iter().any(|leaf| leaf.version == version) => grid.room(version),
        _ => Vec::new(),
    });
    let mut views = Vec::new();
    if let Columns::Wavelengths { grid, .. } = columns {
        for (version, room) in versions.into_iter().zip(&mut rooms).filter(|(_, room)| !room.is_empty()) {
            views.push(grid.view(version, room).map_err(refused)?);
        }
    }
    for Leaf { version, leaf } in leaves {
        let mut inputs = Vec::new();
        if arguments.points.is_some() {
            inputs.push(Cell::Text(version.name()));
            inputs.extend(Parameter::ALL.map(|parameter| Cell::Number(leaf.get(parameter))));
        }
        let mut row = |values: &[f64]| {
            let mut cells = inputs.clone();
            cells.extend(values.iter().map(|value| Cell::Number(*value)));
            table.row(&cells)
        };
        match columns {
            Columns::Wavelengths { grid, order } => {
                let mut room = grid.room(*version);
                let view = grid.view(*version, &mut room).map_err(refused)?;
                let spectra =
                    spectra(&ruled(arguments, Prospect::new(view)).map_err(refused)?, leaf).map_err(refused)?;
                for &place in order {
                    let at = |values: &[f64]| values.get(place).copied().unwrap_or(f64::NAN);
                    row(&[at(grid.wavelengths_nm()), at(&spectra[0]), at(&spectra[1]), at(&spectra[2])])?;
                }
            }
            Columns::Bands(bands) => {
                let model = ruled(arguments, Prospect::new(table::full(*version))).map_err(refused)?;
                let spectra = spectra(&model, leaf).map_err(refused)?;
                for (centre, fwhm, weights) in bands {
                    let seen = |values: &[f64]| sensor::weighted(values, weights).map_err(refused);
                    row(&[*centre, seen(&spectra[0])?, seen(&spectra[1])?, seen(&spectra[2])?, *fwhm])?;
                }
            }
        }
    }
    table.finish()
}

/// Reflectance, transmittance, absorptance.
fn spectra(model: &Prospect<'_, f64>, leaf: &LeafParams<f64>) -> Result<[Vec<f64>; 3], Error> {
    let bands = model.view().len();
    let mut spectra = [const { Vec::new() }; 3];
    spectra.iter_mut().for_each(|values| values.resize(bands, 0.0));
    let [reflectance, transmittance, absorptance] = &mut spectra;
    model.spectrum(leaf, reflectance, transmittance)?;
    model.absorptance(leaf, absorptance)?;
    Ok(spectra)
}
