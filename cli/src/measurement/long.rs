//! The long layout: one row a value, columns by name and in any order.

use std::collections::HashMap;

use csv::ByteRecord;

use super::cell::{shown, trim};
use super::check::{Kind, number};
use super::columns::{Names, same_width, wrong_cell};
use super::input::{Source, at};
use super::read::Context;
use super::{Azimuth, Direction, Layout, Measurement, Quantity, ReadError, azimuth, header};

/// A sparse file (every row its own wavelength and direction) would need the square of its rows in memory. A grid
/// may be this many times larger than the rows that are there.
const SPARSEST: usize = 100;

pub(super) fn read(context: Context<'_>) -> Result<Vec<Measurement>, ReadError> {
    let source = context.source;
    let mut records = source.records();
    let mut record = ByteRecord::new();
    source.next(&mut records, &mut record)?;
    let columns = Columns::find(&context, &record)?;

    let mut leaves = Leaves::default();
    while source.next(&mut records, &mut record)? {
        same_width(source, &record, columns.width)?;
        let row = columns.row(source, &record)?;
        let leaf = match columns.sample {
            None => leaves.only(),
            Some(sample) => leaves.named(source, &record, sample)?,
        };
        leaf.push(row);
    }
    if leaves.leaves.is_empty() {
        return Err(ReadError::whole(
            source.name,
            "no row of values: expected at least one number below the column names",
        ));
    }
    let several = leaves.leaves.len() > 1;
    leaves.leaves.into_iter().map(|leaf| leaf.finish(&context, columns.quantity, several)).collect()
}

/// Where the columns are.
struct Columns {
    wavelength: usize,
    theta_s: usize,
    theta_v: usize,
    phi_v: usize,
    value: usize,
    quantity: Quantity,
    sd: Option<usize>,
    sample: Option<usize>,
    width: usize,
}

/// One row of the file.
struct Row {
    wavelength: f64,
    direction: Direction,
    value: f64,
    sd: f64,
    /// Where the row begins, in bytes.
    at: u64,
}

impl Columns {
    fn find(context: &Context<'_>, record: &ByteRecord) -> Result<Self, ReadError> {
        let source = context.source;
        let names = Names::new(source, record);
        let required = |name: &str| {
            names.find(name)?.ok_or_else(|| {
                let like = names.names.iter().find(|found| similar(found, name));
                let like = like.map_or(String::new(), |found| format!("; is it {}?", shown(found)));
                let list = names.names.iter().map(|name| String::from_utf8_lossy(name)).collect::<Vec<_>>().join(", ");
                let mut short: String = list.chars().take(200).collect();
                if short.len() < list.len() {
                    short.push('…');
                }
                let message = format!("no column {name} (names are matched exactly{like}): found {short:?}");
                names.error(message)
            })
        };
        let (quantity, value) = Columns::quantity(context, record, names.find("brf")?, names.find("brdf")?)?;
        Ok(Columns {
            wavelength: required("wavelength_nm")?,
            theta_s: required("theta_s_deg")?,
            theta_v: required("theta_v_deg")?,
            phi_v: required("phi_v_deg")?,
            value,
            quantity,
            sd: names.find("sd")?,
            sample: names.find("sample")?,
            width: names.names.len(),
        })
    }

    fn quantity(
        context: &Context<'_>,
        record: &ByteRecord,
        brf: Option<usize>,
        brdf: Option<usize>,
    ) -> Result<(Quantity, usize), ReadError> {
        let source = context.source;
        let stated = context.header.quantity;
        let wrong =
            |column: Option<usize>, message: &str| Err(source.error(at(record), column.map(|i| i + 1), message));
        if let (Some((stated, line)), Some(asked)) = (stated, context.options.quantity)
            && stated != asked
        {
            let message = format!(
                "the file says quantity {} and --quantity says {}: leave the option out, or correct the file",
                stated.name(),
                asked.name()
            );
            return Err(ReadError { line: Some(line), ..ReadError::whole(source.name, message) });
        }
        let wanted = context.options.quantity.or(stated.map(|(quantity, _)| quantity));
        match (brf, brdf, wanted) {
            (Some(brf), Some(_), Some(Quantity::Brf)) => Ok((Quantity::Brf, brf)),
            (Some(_), Some(brdf), Some(Quantity::Brdf)) => Ok((Quantity::Brdf, brdf)),
            (Some(_), Some(brdf), None) => wrong(
                Some(brdf),
                "both a column brf and a column brdf: say which one to read, and sd belongs to, with --quantity brf or brdf",
            ),
            (Some(brf), None, Some(Quantity::Brdf)) => wrong(
                Some(brf),
                "the column is brf and the quantity asked for is brdf: rename the column, or leave out the other",
            ),
            (None, Some(brdf), Some(Quantity::Brf)) => wrong(
                Some(brdf),
                "the column is brdf and the quantity asked for is brf: rename the column, or leave out the other",
            ),
            (Some(brf), None, _) => Ok((Quantity::Brf, brf)),
            (None, Some(brdf), _) => Ok((Quantity::Brdf, brdf)),
            (None, None, _) => wrong(
                None,
                "no column of values: expected brf (π·BRDF, unitless) or brdf (sr⁻¹), which differ by a factor of π; \
                 names are matched exactly",
            ),
        }
    }

    fn row(&self, source: Source<'_>, record: &ByteRecord) -> Result<Row, ReadError> {
        let read = |kind: Kind, column: usize, name: &str| {
            let cell = record.get(column).unwrap_or(b"");
            number(kind, cell).map_err(|why| wrong_cell(source, record, column, name, why))
        };
        Ok(Row {
            wavelength: read(Kind::Wavelength, self.wavelength, "wavelength_nm")?,
            direction: Direction {
                theta_s_deg: read(Kind::Zenith, self.theta_s, "theta_s_deg")?,
                theta_v_deg: read(Kind::Zenith, self.theta_v, "theta_v_deg")?,
                phi_v_deg: read(Kind::Azimuth, self.phi_v, "phi_v_deg")?,
            },
            value: read(Kind::Value, self.value, self.quantity.name())?,
            sd: self.sd.map_or(Ok(f64::NAN), |sd| read(Kind::StandardDeviation, sd, "sd"))?,
            at: at(record),
        })
    }
}

/// The same name but for case, unit and punctuation.
fn similar(found: &[u8], name: &str) -> bool {
    let bare = |text: &str| {
        let letters: String = text.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
        let without_unit =
            ["nm", "degrees", "deg"].iter().find_map(|unit| letters.strip_suffix(unit)).map(str::to_string);
        without_unit.unwrap_or(letters)
    };
    bare(&String::from_utf8_lossy(found)) == bare(name)
}

/// The leaves of a file, in order of their first rows.
#[derive(Default)]
struct Leaves {
    leaves: Vec<Leaf>,
    by_name: HashMap<Vec<u8>, usize>,
    last: usize,
}

impl Leaves {
    /// The one leaf of a file without samples.
    fn only(&mut self) -> &mut Leaf {
        self.at(0, None)
    }

    fn named(&mut self, source: Source<'_>, record: &ByteRecord, sample: usize) -> Result<&mut Leaf, ReadError> {
        let cell = trim(record.get(sample).unwrap_or(b""));
        let is_last =
            self.leaves.get(self.last).is_some_and(|leaf| leaf.sample.as_deref().map(str::as_bytes) == Some(cell));
        if !is_last {
            if !std::str::from_utf8(cell).is_ok_and(header::is_sample) {
                let message =
                    format!("found {}: expected the name of a sample, without control characters", shown(cell));
                return Err(wrong_cell(source, record, sample, "sample", message));
            }
            let next = self.leaves.len();
            self.last = *self.by_name.entry(cell.to_vec()).or_insert(next);
        }
        Ok(self.at(self.last, Some(cell)))
    }

    fn at(&mut self, index: usize, sample: Option<&[u8]>) -> &mut Leaf {
        if index >= self.leaves.len() {
            let sample = sample.map(|sample| String::from_utf8_lossy(sample).into_owned());
            self.leaves.push(Leaf { sample, ..Leaf::default() });
        }
        &mut self.leaves[index]
    }
}

/// The rows of one leaf, wavelengths and directions numbered as they come.
#[derive(Default)]
struct Leaf {
    sample: Option<String>,
    wavelengths: Vec<f64>,
    bands: HashMap<u64, u32>,
    directions: Vec<Direction>,
    places: HashMap<[u64; 3], u32>,
    rows: Vec<Value>,
}

struct Value {
    band: u32,
    place: u32,
    value: f64,
    sd: f64,
    at: u64,
}

impl Leaf {
    fn push(&mut self, row: Row) {
        // Mostly a row has the wavelength or direction of the one before, or the next one, or the first again: no look-up
        // for those.
        let near = |last: Option<u32>| last.into_iter().flat_map(|last| [last, last.saturating_add(1), 0]);
        let band = near(self.rows.last().map(|last| last.band))
            .find(|band| self.wavelengths.get(*band as usize) == Some(&row.wavelength));
        let band = band.unwrap_or_else(|| {
            let next = self.wavelengths.len() as u32;
            *self.bands.entry(row.wavelength.to_bits()).or_insert_with(|| {
                self.wavelengths.push(row.wavelength);
                next
            })
        });
        let place = near(self.rows.last().map(|last| last.place))
            .find(|place| self.directions.get(*place as usize) == Some(&row.direction));
        let place = place.unwrap_or_else(|| {
            let next = self.directions.len() as u32;
            *self.places.entry(row.direction.key()).or_insert_with(|| {
                self.directions.push(row.direction);
                next
            })
        });
        self.rows.push(Value { band, place, value: row.value, sd: row.sd, at: row.at });
    }

    fn finish(self, context: &Context<'_>, quantity: Quantity, several: bool) -> Result<Measurement, ReadError> {
        let source = context.source;
        let of_sample =
            self.sample.as_ref().filter(|_| several).map_or(String::new(), |sample| format!(" of sample {sample:?}"));
        let (bands, width) = (self.wavelengths.len(), self.directions.len());
        let size = bands.saturating_mul(width);
        if size > 1_000_000 && size / SPARSEST > self.rows.len() {
            let message = format!(
                "the {} rows{of_sample} have {bands} wavelengths and {width} directions, so that hardly any direction has a \
                 spectrum: expected the same directions at every wavelength (several leaves in one file need a column sample)",
                self.rows.len()
            );
            return Err(ReadError::whole(source.name, message));
        }
        if !self.rows.iter().any(|row| !row.value.is_nan()) {
            let message = format!("every value{of_sample} is missing: expected at least one number");
            return Err(ReadError::whole(source.name, message));
        }

        let mut order: Vec<usize> = (0..bands).collect();
        order.sort_by(|a, b| self.wavelengths[*a].total_cmp(&self.wavelengths[*b]));
        let mut rank = vec![0; bands];
        for (new, old) in order.iter().enumerate() {
            rank[*old] = new;
        }
        let mut values = vec![f64::NAN; size];
        let mut sd = vec![f64::NAN; size];
        let mut first = vec![u64::MAX; size];
        for row in &self.rows {
            let cell = rank[row.band as usize] * width + row.place as usize;
            if first[cell] != u64::MAX {
                let Direction { theta_s_deg, theta_v_deg, phi_v_deg } = self.directions[row.place as usize];
                let message = format!(
                    "{} nm, θ_s {theta_s_deg}°, θ_v {theta_v_deg}°, φ_v {phi_v_deg}°{of_sample} stands in line {} already: \
                     expected each wavelength and direction once (several leaves in one file need a column sample)",
                    self.wavelengths[row.band as usize],
                    source.line(first[cell])
                );
                return Err(source.error(row.at, None, message));
            }
            first[cell] = row.at;
            values[cell] = row.value;
            sd[cell] = row.sd;
        }

        let mut directions = self.directions;
        if context.azimuth == Azimuth::Forward0 {
            azimuth::turn(source, &mut directions)?;
        }
        let has_sd = sd.iter().any(|sd| !sd.is_nan());
        Ok(Measurement {
            name: self.sample.clone().unwrap_or_else(|| context.leaf_name()),
            sample: self.sample.or_else(|| context.header.sample.clone()),
            metadata: context.header.metadata.clone(),
            quantity,
            layout: Layout::Long,
            azimuth: context.azimuth,
            wavelengths_nm: order.iter().map(|index| self.wavelengths[*index]).collect(),
            directions,
            values,
            sd: has_sd.then_some(sd),
        })
    }
}
