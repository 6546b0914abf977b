//! Hemispherical spectra of leaves: reflectance and transmittance by wavelength, as integrating spheres give them.
//!
//! CSV, plain or gzip: columns `wavelength_nm` and `reflectance`, `transmittance` or both (fractions), optionally `reflectance_sd`,
//! `transmittance_sd`, and `sample` for several leaves in one file. Columns in any order, others ignored, names matched exactly.

use std::collections::HashMap;
use std::path::Path;

use csv::ByteRecord;
use leafbrdf_prospect::table::{self, View, columns_of};
use leafbrdf_prospect::{Error, Version};

use crate::measurement::cell::{self, Cell, remedy, shown, trim};
use crate::measurement::columns::{Names, same_width, wrong_cell};
use crate::measurement::input::{Source, at, decode, display_name, read_all};
use crate::measurement::{Metadata, ReadError, header, read::stem};

/// One leaf's spectra.
#[derive(Clone, Debug, PartialEq)]
pub struct LeafSpectra {
    /// What to call the leaf: its `sample`, else the stem of the file's name.
    pub name: String,
    /// The file's `# key: value` lines.
    pub metadata: Metadata,
    /// Wavelengths in nm, ascending, each once.
    pub wavelengths_nm: Vec<f64>,
    /// Reflectance, a fraction, one a wavelength; NaN where missing. `None`: not measured.
    pub reflectance: Option<Vec<f64>>,
    /// Transmittance, likewise.
    pub transmittance: Option<Vec<f64>>,
    /// Standard deviations of the reflectance, where the file has them; NaN where missing.
    pub reflectance_sd: Option<Vec<f64>>,
    /// Standard deviations of the transmittance.
    pub transmittance_sd: Option<Vec<f64>>,
}

impl LeafSpectra {
    /// Numbers, missing values, and numbers below zero (noise, kept), over both spectra.
    pub fn counts(&self) -> [usize; 3] {
        let mut counts = [0; 3];
        for value in [&self.reflectance, &self.transmittance].into_iter().flatten().flatten() {
            counts[usize::from(value.is_nan())] += 1;
            counts[2] += usize::from(*value < 0.0);
        }
        counts
    }
}

/// Reads a file of spectra; `-` is standard input. One element a leaf, in order of their first rows.
///
/// # Errors
///
/// A file that cannot be read, is no text, or breaks a rule of the format: file, line, column, what was expected.
pub fn read_spectra(path: &Path) -> Result<Vec<LeafSpectra>, ReadError> {
    read_named(&display_name(path), &stem(path), &read_all(path)?)
}

/// The same from a file's bytes; `name` is for messages and, without folder and endings, the leaf's name.
///
/// ```
/// use leafbrdf::spectra::spectra_from_bytes;
/// let file = b"wavelength_nm,reflectance,transmittance\n550,0.12,0.10\n800,0.48,0.47\n";
/// let leaves = spectra_from_bytes("oak.csv", file)?;
/// assert_eq!((leaves[0].name.as_str(), leaves[0].wavelengths_nm.len()), ("oak", 2));
/// # Ok::<(), leafbrdf::measurement::ReadError>(())
/// ```
///
/// # Errors
///
/// As [`read_spectra`].
pub fn spectra_from_bytes(name: &str, bytes: &[u8]) -> Result<Vec<LeafSpectra>, ReadError> {
    read_named(name, &stem(Path::new(name)), bytes)
}

fn read_named(name: &str, stem: &str, bytes: &[u8]) -> Result<Vec<LeafSpectra>, ReadError> {
    let text = decode(name, bytes)?;
    let source = Source { name, text: &text };
    let (metadata, sample) = remarks(&text);
    let mut records = source.records();
    let mut record = ByteRecord::new();
    if !source.next(&mut records, &mut record)? {
        return Err(ReadError::whole(name, "has no data: expected a row of column names with wavelength_nm"));
    }
    let columns = Columns::find(source, &record)?;

    let mut leaves: Vec<(Option<String>, Vec<Row>)> = Vec::new();
    let mut by_name: HashMap<Option<String>, usize> = HashMap::new();
    while source.next(&mut records, &mut record)? {
        same_width(source, &record, columns.width)?;
        let row = columns.row(source, &record)?;
        let key = columns.sample(source, &record)?;
        let place = *by_name.entry(key.clone()).or_insert_with(|| {
            leaves.push((key, Vec::new()));
            leaves.len() - 1
        });
        if let Some((_, rows)) = leaves.get_mut(place) {
            rows.push(row);
        }
    }
    if leaves.is_empty() {
        return Err(ReadError::whole(name, "no row of values: expected at least one below the column names"));
    }
    let default = sample.unwrap_or_else(|| stem.to_string());
    let finish = |(sample, rows): (Option<String>, Vec<Row>)| {
        let of = sample.as_ref().map_or(String::new(), |sample| format!(" of sample {sample:?}"));
        let leaf = sorted(source, rows, &of)?;
        Ok(LeafSpectra { name: sample.unwrap_or_else(|| default.clone()), metadata: metadata.clone(), ..leaf })
    };
    leaves.into_iter().map(finish).collect()
}

/// The `# key: value` lines, and the sample among them.
fn remarks(text: &str) -> (Metadata, Option<String>) {
    let (mut metadata, mut sample) = (Metadata::new(), None);
    for line in text.lines().filter_map(|line| line.strip_prefix('#')) {
        match header::split(line.trim()) {
            ("", "") => {}
            (key, value) if key.eq_ignore_ascii_case("sample") && !value.is_empty() && sample.is_none() => {
                sample = Some(value.to_string());
            }
            (key, value) => metadata.push(key, value),
        }
    }
    (metadata, sample)
}

/// The four columns of numbers, in the order of [`Row::values`].
const VALUES: [&str; 4] = ["reflectance", "transmittance", "reflectance_sd", "transmittance_sd"];

/// Where the columns are.
struct Columns {
    wavelength: usize,
    values: [Option<usize>; 4],
    sample: Option<usize>,
    width: usize,
}

/// One row of the file.
struct Row {
    wavelength_nm: f64,
    values: [f64; 4],
    at: u64,
}

impl Columns {
    fn find(source: Source<'_>, record: &ByteRecord) -> Result<Self, ReadError> {
        let row = Names::new(source, record);
        let names = &row.names;
        let found = shown(&names.join(&b", "[..]));
        let Some(wavelength) = row.find("wavelength_nm")? else {
            return Err(row.error(Columns::hint(names, &found)));
        };
        let mut values = [None; 4];
        for (place, name) in values.iter_mut().zip(VALUES) {
            *place = row.find(name)?;
        }
        if let [None, None, ..] = values {
            let brdf = names.iter().any(|name| name.ends_with(b"_deg") || *name == b"brf" || *name == b"brdf");
            let hint = if brdf { "; a file of BRF or BRDF is fitted with --model bands" } else { "" };
            let message =
                format!("no column reflectance or transmittance (names are matched exactly): found {found}{hint}");
            return Err(row.error(message));
        }
        for (sd, of) in [(2, 0), (3, 1)] {
            if let ([Some(column), None], [name, missing]) = ([values[sd], values[of]], [VALUES[sd], VALUES[of]]) {
                let message = format!("a column {name} without a column {missing}");
                return Err(source.error(at(record), Some(column + 1), message));
            }
        }
        Ok(Columns { wavelength, values, sample: row.find("sample")?, width: names.len() })
    }

    /// Why there is no column of wavelengths, as far as the first row tells.
    fn hint(names: &[&[u8]], found: &str) -> String {
        let any = |test: &dyn Fn(&str) -> bool| names.iter().any(|name| test(&String::from_utf8_lossy(name)));
        let hint = if any(&|name| name.contains(';')) {
            ". The cells seem to be separated by semicolons: export the file with commas between the cells and decimal points"
        } else if any(&|name| name.contains('\t')) {
            ". The cells seem to be separated by tabs: export the file with commas between the cells"
        } else if any(&|name| name == "theta_s_deg") {
            ". A file of BRF or BRDF is fitted with --model bands"
        } else if any(&|name| name.to_lowercase().starts_with("wavel") || name.to_lowercase().starts_with("lambda")) {
            "; names are matched exactly, and wavelengths are in nm"
        } else {
            ""
        };
        format!(
            "found {found}: expected column names, wavelength_nm and reflectance, transmittance or both among them{hint}"
        )
    }

    fn row(&self, source: Source<'_>, record: &ByteRecord) -> Result<Row, ReadError> {
        let number = |column: usize, name: &str, kind: Kind| {
            let cell = record.get(column).unwrap_or(b"");
            kind.number(cell)
                .map_err(|why| wrong_cell(source, record, column, name, format!("found {}: {why}", shown(cell))))
        };
        let mut values = [f64::NAN; 4];
        for (index, ((value, column), name)) in values.iter_mut().zip(self.values).zip(VALUES).enumerate() {
            if let Some(column) = column {
                *value = number(column, name, if index < 2 { Kind::Fraction } else { Kind::Deviation })?;
            }
        }
        Ok(Row { wavelength_nm: number(self.wavelength, "wavelength_nm", Kind::Wavelength)?, values, at: at(record) })
    }

    /// The name in the column `sample`; `None` without such a column.
    fn sample(&self, source: Source<'_>, record: &ByteRecord) -> Result<Option<String>, ReadError> {
        let Some(column) = self.sample else { return Ok(None) };
        let cell = trim(record.get(column).unwrap_or(b""));
        if cell.is_empty() || cell.iter().any(u8::is_ascii_control) {
            let message = format!("found {}: expected the name of a sample", shown(cell));
            return Err(wrong_cell(source, record, column, "sample", message));
        }
        Ok(Some(String::from_utf8_lossy(cell).into_owned()))
    }
}

/// What a column holds.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Wavelength,
    Fraction,
    Deviation,
}

impl Kind {
    fn number(self, cell: &[u8]) -> Result<f64, String> {
        let parsed = cell::parse(cell);
        let (range, expected) = match self {
            Kind::Wavelength => (100.0..=100_000.0, "expected a wavelength in nm, 100 to 100000"),
            // noise goes below 0, and a badly calibrated sphere a little above 1
            Kind::Fraction => (-0.5..=1.5, "expected a fraction, or an empty cell, NaN or NA where there is no value"),
            Kind::Deviation => (0.0..=1.0, "expected a standard deviation ≥ 0, a fraction, or an empty cell"),
        };
        match parsed {
            Cell::Number(number) if range.contains(&number) => return Ok(number),
            Cell::Missing if self != Kind::Wavelength => return Ok(f64::NAN),
            _ => {}
        }
        let hint = match (self, parsed) {
            (Kind::Wavelength, Cell::Number(number)) if number > 0.0 && number < 100.0 => {
                " (did you mean nm? 0.55 µm is 550 nm)".to_string()
            }
            (Kind::Fraction | Kind::Deviation, Cell::Number(number)) if number > 1.0 && number <= 150.0 => {
                format!(" (per cent? {number} % is {})", number / 100.0)
            }
            (Kind::Fraction, Cell::Number(number)) if number < 0.0 => {
                " (a mark for a missing value? Leave the cell empty)".to_string()
            }
            (Kind::Fraction, Cell::Number(_)) => " (counts, or scaled by 10000? Divide them first)".to_string(),
            (_, Cell::Other) => remedy(cell).to_string(),
            _ => String::new(),
        };
        Err(format!("{expected}{hint}"))
    }
}

/// Rows in order of wavelength, as columns; the name is the caller's to fill in.
fn sorted(source: Source<'_>, mut rows: Vec<Row>, of: &str) -> Result<LeafSpectra, ReadError> {
    rows.sort_by(|a, b| a.wavelength_nm.total_cmp(&b.wavelength_nm));
    for pair in rows.windows(2) {
        if let [a, b] = pair
            && a.wavelength_nm == b.wavelength_nm
        {
            let (first, again) = (a.at.min(b.at), a.at.max(b.at));
            let message = format!(
                "{} nm{of} stands in line {} already: expected each wavelength once (several leaves in one file need a \
                 column sample)",
                a.wavelength_nm,
                source.line(first)
            );
            return Err(source.error(again, None, message));
        }
    }
    let column = |index: usize| -> Option<Vec<f64>> {
        let values: Vec<f64> = rows.iter().map(|row| row.values.get(index).copied().unwrap_or(f64::NAN)).collect();
        values.iter().any(|value| !value.is_nan()).then_some(values)
    };
    let leaf = LeafSpectra {
        name: String::new(),
        metadata: Metadata::new(),
        wavelengths_nm: rows.iter().map(|row| row.wavelength_nm).collect(),
        reflectance: column(0),
        transmittance: column(1),
        reflectance_sd: column(2),
        transmittance_sd: column(3),
    };
    if leaf.reflectance.is_none() && leaf.transmittance.is_none() {
        let message = format!("every value{of} is missing: expected at least one number");
        return Err(ReadError::whole(source.name, message));
    }
    Ok(leaf)
}

/// Wavelengths at which the coefficient tables of PROSPECT are wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    wavelengths_nm: Vec<f64>,
}

impl Grid {
    /// These wavelengths, nm, rising.
    pub fn new(wavelengths_nm: Vec<f64>) -> Self {
        Grid { wavelengths_nm }
    }

    /// The wavelengths, nm.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// Are they inside the tables, 400–2500 nm, and rising?
    ///
    /// # Errors
    /// The model's own.
    pub fn check(&self) -> Result<(), Error> {
        let mut room = self.room(Version::P5B);
        self.view(Version::P5B, &mut room).map(|_| ())
    }

    /// Room for the tables of a version.
    pub fn room(&self, version: Version) -> Vec<f64> {
        vec![0.0; columns_of(version) * self.wavelengths_nm.len()]
    }

    /// The tables of a version at these wavelengths, interpolated between the 1 nm of the published ones.
    ///
    /// # Errors
    /// Wavelengths outside 400–2500 nm or not rising; room of another size.
    pub fn view<'a>(&'a self, version: Version, room: &'a mut [f64]) -> Result<View<'a, f64>, Error> {
        table::full(version).at_wavelengths(&self.wavelengths_nm, room)
    }
}
