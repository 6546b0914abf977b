//! The wide layout: one column a direction, one row a wavelength.

use csv::ByteRecord;

use super::cell::{shown, trim};
use super::check::{self, Kind, number, plain_number};
use super::input::{Source, at};
use super::read::{ANGLES, Context};
use super::{Azimuth, Direction, Layout, Measurement, Quantity, ReadError, azimuth};

pub(super) fn read(context: Context<'_>) -> Result<Measurement, ReadError> {
    let source = context.source;
    let quantity = quantity(&context)?;
    let mut records = source.records();
    let mut record = ByteRecord::new();

    let (mut directions, width) = directions(source, &mut records, &mut record)?;
    let bands = memchr::memchr_iter(b'\n', source.text.as_bytes()).count();
    let mut wavelengths: Vec<(f64, u64)> = Vec::with_capacity(bands);
    // Room for every line of a regular file; a ragged one stops at its first short line, and asks for no more than
    // there are cells.
    let mut values = Vec::with_capacity((bands * directions.len()).min(source.text.len()));

    if memchr::memchr(b'"', source.text.as_bytes()).is_some() {
        while source.next(&mut records, &mut record)? {
            wavelengths.push((row(source, &record, width, &mut values)?, at(&record)));
        }
    } else {
        // Without quotes a line is a row and a comma ends a cell: no need for a copy of either.
        let mut start = usize::try_from(records.position().byte()).unwrap_or(usize::MAX);
        while let Some(rest) = source.text.as_bytes().get(start..).filter(|rest| !rest.is_empty()) {
            let end = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
            let line = rest.get(..end).unwrap_or(rest);
            if !matches!(line, [] | [b'#', ..]) {
                let whole_rows = values.len();
                let wavelength = match plain_row(line, width, &mut values) {
                    Some(wavelength) => wavelength,
                    None => {
                        // Once more, at leisure, for the cells that are no plain numbers and for the errors.
                        values.truncate(whole_rows);
                        let mut record: ByteRecord = line.split(|byte| *byte == b',').collect();
                        let mut position = csv::Position::new();
                        position.set_byte(start as u64);
                        record.set_position(Some(position));
                        row(source, &record, width, &mut values)?
                    }
                };
                wavelengths.push((wavelength, start as u64));
            }
            start += end + 1;
        }
    }
    let (wavelengths_nm, values) = ascending(source, &wavelengths, values, directions.len())?;
    if !values.iter().any(|value| !value.is_nan()) {
        let found = if wavelengths_nm.is_empty() { "no row of values" } else { "every value is missing" };
        return Err(ReadError::whole(
            source.name,
            format!("{found}: expected at least one number below the three rows of angles"),
        ));
    }
    if context.azimuth == Azimuth::Forward0 {
        azimuth::turn(source, &mut directions)?;
    }
    Ok(Measurement {
        name: context.leaf_name(),
        sample: context.header.sample,
        metadata: context.header.metadata,
        quantity,
        layout: Layout::Wide,
        azimuth: context.azimuth,
        wavelengths_nm,
        directions,
        values,
        sd: None,
    })
}

/// Appends the values of a row to `values`; its wavelength.
fn row(source: Source<'_>, record: &ByteRecord, width: usize, values: &mut Vec<f64>) -> Result<f64, ReadError> {
    same_width(source, record, width)?;
    let mut cells = record.iter().enumerate();
    let wavelength = cells.next().map_or(&b""[..], |(_, cell)| cell);
    let wavelength =
        number(Kind::Wavelength, wavelength).map_err(|why| in_first_cell(source, record, wavelength, why))?;
    for (index, cell) in cells {
        match number(Kind::Value, cell) {
            Ok(value) => values.push(value),
            Err(why) => return Err(source.error(at(record), Some(index + 1), why)),
        }
    }
    Ok(wavelength)
}

/// The same in one pass over the bytes, for a row of `width` plain numbers; `None` for any other, `values` being undone
/// by the caller.
#[inline]
fn plain_row(line: &[u8], width: usize, values: &mut Vec<f64>) -> Option<f64> {
    let (wavelength, mut end) = plain_number(Kind::Wavelength, line)?;
    for _ in 1..width {
        let cells = line.get(end + 1..)?;
        let (value, length) = plain_number(Kind::Value, cells)?;
        values.push(value);
        end += 1 + length;
    }
    (end == line.len()).then_some(wavelength)
}

fn quantity(context: &Context<'_>) -> Result<Quantity, ReadError> {
    match (context.header.quantity, context.options.quantity) {
        (Some((stated, line)), Some(asked)) if stated != asked => {
            let message = format!(
                "the file says quantity {} and --quantity says {}: leave the option out, or correct the file",
                stated.name(),
                asked.name()
            );
            Err(ReadError { line: Some(line), ..ReadError::whole(context.source.name, message) })
        }
        (Some((stated, _)), _) => Ok(stated),
        (None, Some(asked)) => Ok(asked),
        (None, None) => Err(ReadError::whole(
            context.source.name,
            "does not say whether its values are BRF or BRDF, which differ by a factor of π: \
             add the line '# quantity: brf' (π·BRDF, unitless) or '# quantity: brdf' (sr⁻¹), or say --quantity brf or brdf",
        )),
    }
}

/// The three rows of angles, in any order, and how many cells a row has.
pub(super) fn directions(
    source: Source<'_>,
    records: &mut csv::Reader<&[u8]>,
    record: &mut ByteRecord,
) -> Result<(Vec<Direction>, usize), ReadError> {
    let mut angles: [Option<(Vec<f64>, u64)>; 3] = Default::default();
    let mut width = None;
    for _ in ANGLES {
        if !source.next(records, record)? {
            break;
        }
        let name = trim(record.get(0).unwrap_or(b""));
        let Some(which) = ANGLES.iter().position(|angle| angle.as_bytes() == name) else {
            let missing: Vec<&str> =
                ANGLES.iter().zip(&angles).filter(|(_, row)| row.is_none()).map(|(n, _)| *n).collect();
            let message = format!(
                "found {}: expected the row {}; the wide layout begins with the rows theta_s_deg, theta_v_deg and phi_v_deg",
                shown(name),
                missing.join(" or ")
            );
            return Err(source.error(at(record), Some(1), message));
        };
        same_width(source, record, *width.get_or_insert(record.len()))?;
        if record.len() < 2 {
            return Err(source.error(
                at(record),
                None,
                format!("{} has no angle: expected one a direction", shown(name)),
            ));
        }
        let kind = if which == 2 { Kind::Azimuth } else { Kind::Zenith };
        let row = record.iter().enumerate().skip(1).map(|(index, cell)| {
            number(kind, cell)
                .map_err(|why| source.error(at(record), Some(index + 1), why + trailing_comma(cell, index, record)))
        });
        let row = row.collect::<Result<Vec<f64>, ReadError>>()?;
        if let Some(place) = angles.get_mut(which)
            && let Some((_, before)) = place.replace((row, at(record)))
        {
            let message = format!("the row {} stands in line {} already", shown(name), source.line(before));
            return Err(source.error(at(record), Some(1), message));
        }
    }
    let [Some((theta_s, _)), Some((theta_v, _)), Some((phi_v, last))] = angles else {
        let message = "ends before its three rows of angles: expected theta_s_deg, theta_v_deg and phi_v_deg";
        return Err(ReadError::whole(source.name, message));
    };
    let zenith = theta_s.into_iter().zip(theta_v);
    let directions: Vec<Direction> = zenith
        .zip(phi_v)
        .map(|((theta_s_deg, theta_v_deg), phi_v_deg)| Direction { theta_s_deg, theta_v_deg, phi_v_deg })
        .collect();
    if let Some((index, before)) = check::twice(&directions)
        && let Some(Direction { theta_s_deg, theta_v_deg, phi_v_deg }) = directions.get(index)
    {
        let message = format!(
            "the direction θ_s {theta_s_deg}°, θ_v {theta_v_deg}°, φ_v {phi_v_deg}° stands in column {} already: \
             expected each direction once (average repeated measurements, or give each a file)",
            before + 2
        );
        return Err(source.error(last, Some(index + 2), message));
    }
    Ok((directions, width.unwrap_or(0)))
}

fn trailing_comma(cell: &[u8], index: usize, record: &ByteRecord) -> &'static str {
    if trim(cell).is_empty() && index + 1 == record.len() { " (a comma at the end of the line?)" } else { "" }
}

/// A ragged row is an error: no telling which of its cells is missing.
#[inline]
fn same_width(source: Source<'_>, record: &ByteRecord, width: usize) -> Result<(), ReadError> {
    if record.len() == width {
        return Ok(());
    }
    let found = record.len();
    let hint = if width > 1 && found == 2 * width - 1 {
        " (decimal commas? Write decimal points)"
    } else if found == 1 && record.iter().any(|cell| cell.contains(&b';')) {
        " (separated by semicolons? Export the file with commas between the cells)"
    } else {
        ""
    };
    let message = format!("{found} cells: expected {width}, as in the first row of angles{hint}");
    Err(source.error(at(record), Some(found.min(width) + usize::from(found > width)), message))
}

fn in_first_cell(source: Source<'_>, record: &ByteRecord, cell: &[u8], why: String) -> ReadError {
    let name = trim(cell);
    if ANGLES.iter().any(|angle| angle.as_bytes() == name) {
        return source.error(
            at(record),
            Some(1),
            format!("the row {} stands above already: expected a wavelength", shown(name)),
        );
    }
    source.error(at(record), Some(1), why)
}

/// Rows by ascending wavelength, each wavelength once.
fn ascending(
    source: Source<'_>,
    wavelengths: &[(f64, u64)],
    values: Vec<f64>,
    width: usize,
) -> Result<(Vec<f64>, Vec<f64>), ReadError> {
    if wavelengths.is_sorted_by(|(a, _), (b, _)| a < b) {
        return Ok((wavelengths.iter().map(|(wavelength, _)| *wavelength).collect(), values));
    }
    let mut order: Vec<(f64, u64, usize)> =
        wavelengths.iter().enumerate().map(|(index, &(wavelength, record))| (wavelength, record, index)).collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    // Of several duplicates, the one that a reader of the file meets first.
    let pairs = order.windows(2).filter_map(|pair| match pair {
        [first, second] if first.0 == second.0 => Some((first.1, second.1, first.0)),
        _ => None,
    });
    if let Some((first, second, wavelength)) = pairs.min_by_key(|(_, second, _)| *second) {
        let message = format!(
            "the wavelength {wavelength} nm stands in line {} already: expected each wavelength once",
            source.line(first)
        );
        return Err(source.error(second, Some(1), message));
    }
    let row = |index: usize| values.get(index * width..(index + 1) * width).unwrap_or(&[]);
    let sorted = order.iter().flat_map(|(_, _, index)| row(*index)).copied().collect();
    Ok((order.iter().map(|(wavelength, _, _)| *wavelength).collect(), sorted))
}
