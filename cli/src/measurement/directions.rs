//! The directions alone: of a geometry file, or of a measurement file of either layout.

use std::collections::HashSet;
use std::path::Path;

use csv::ByteRecord;

use super::cell::{self, Cell, shown, trim};
use super::check::{Kind, number};
use super::input::{Source, at, decode, display_name, read_all};
use super::read::{ANGLES, ReadOptions, azimuth as convention};
use super::{Azimuth, Direction, ReadError, azimuth, header, wide};

/// Reads directions: a table with the columns `theta_s_deg`, `theta_v_deg`, `phi_v_deg` (others are ignored), or a
/// measurement file, wide or long, whose values do not matter; plain or gzip, `-` is standard input.
///
/// A line `# azimuth: forward_0` is obeyed. Where there is a column `wavelength_nm` the directions repeat and each is taken
/// once; elsewhere a direction that stands twice is an error.
///
/// # Errors
///
/// No such columns, an angle out of its range, a direction that stands twice, no direction: with file, line and column.
pub fn read_directions(path: &Path) -> Result<Vec<Direction>, ReadError> {
    directions_from_bytes(&display_name(path), &read_all(path)?)
}

/// The same from a file's bytes; `name` is for messages.
///
/// ```
/// use leafbrdf::measurement::directions_from_bytes;
/// let file = b"theta_v_deg,theta_s_deg,phi_v_deg\n60,30,180\n0,30,0\n";
/// let directions = directions_from_bytes("angles.csv", file).unwrap();
/// assert_eq!((directions.len(), directions[0].theta_v_deg), (2, 60.0));
/// ```
///
/// # Errors
///
/// As [`read_directions`].
pub fn directions_from_bytes(name: &str, bytes: &[u8]) -> Result<Vec<Direction>, ReadError> {
    let text = decode(name, bytes)?;
    let source = Source { name, text: &text };
    let header = header::read(source)?;
    let turned = convention(source, &header, &ReadOptions::default())? == Azimuth::Forward0;
    let (mut records, mut record) = (source.records(), ByteRecord::new());
    if !source.next(&mut records, &mut record)? {
        return Err(ReadError::whole(name, "has no row: expected the columns theta_s_deg, theta_v_deg, phi_v_deg"));
    }
    let is_angle = |cell: &[u8]| ANGLES.iter().any(|angle| angle.as_bytes() == trim(cell));
    let is_number = record.get(1).is_some_and(|cell| matches!(cell::parse(cell), Cell::Number(_)));
    let mut directions = if record.get(0).is_some_and(is_angle) && is_number {
        let (mut again, mut first) = (source.records(), ByteRecord::new());
        wide::directions(source, &mut again, &mut first)?.0
    } else {
        table(source, &mut records, &record)?
    };
    if turned {
        azimuth::turn(source, &mut directions)?;
    }
    Ok(directions)
}

/// The distinct directions of a table whose first row are the names of its columns.
fn table(
    source: Source<'_>,
    records: &mut csv::Reader<&[u8]>,
    names: &ByteRecord,
) -> Result<Vec<Direction>, ReadError> {
    let mut places = [0; 3];
    for (place, angle) in places.iter_mut().zip(ANGLES) {
        let mut found = names.iter().enumerate().filter(|(_, name)| trim(name) == angle.as_bytes());
        *place = found.next().map(|(index, _)| index).ok_or_else(|| {
            let row = names.iter().collect::<Vec<_>>().join(&b", "[..]);
            let message = format!("no column {angle} (names are matched exactly): found {}", shown(&row));
            source.error(at(names), None, message)
        })?;
        if let Some((again, _)) = found.next() {
            let message = format!("a second column {angle}: expected each name once");
            return Err(source.error(at(names), Some(again + 1), message));
        }
    }
    let repeats = names.iter().any(|name| trim(name) == b"wavelength_nm");
    let (mut seen, mut directions, mut record) = (HashSet::new(), Vec::new(), ByteRecord::new());
    while source.next(records, &mut record)? {
        if record.len() != names.len() {
            let message = format!("{} cells: expected {}, as there are column names", record.len(), names.len());
            return Err(source.error(at(&record), None, message));
        }
        let angle = |which: usize, kind| {
            let place = places.get(which).copied().unwrap_or(0);
            number(kind, record.get(place).unwrap_or(b""))
                .map_err(|why| source.error(at(&record), Some(place + 1), why))
        };
        let direction = Direction {
            theta_s_deg: angle(0, Kind::Zenith)?,
            theta_v_deg: angle(1, Kind::Zenith)?,
            phi_v_deg: angle(2, Kind::Azimuth)?,
        };
        if seen.insert(direction.key()) {
            directions.push(direction);
        } else if !repeats {
            let Direction { theta_s_deg, theta_v_deg, phi_v_deg } = direction;
            let message = format!(
                "the direction θ_s {theta_s_deg}°, θ_v {theta_v_deg}°, φ_v {phi_v_deg}° stands above already: expected each once"
            );
            return Err(source.error(at(&record), None, message));
        }
    }
    if directions.is_empty() {
        return Err(ReadError::whole(
            source.name,
            "has column names and no row below them: expected one row a direction",
        ));
    }
    Ok(directions)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<Direction>, String> {
        directions_from_bytes("angles.csv", text.as_bytes()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_table_and_both_layouts_of_a_measurement_give_the_same_directions() {
        let table = read("phi_v_deg,theta_s_deg,theta_v_deg\n180,30,60\n0,30,20\n").unwrap();
        let wide = read("theta_s_deg,30,30\ntheta_v_deg,60,20\nphi_v_deg,180,0\n550,0.1,0.2\n").unwrap();
        let long = read(
            "wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,brf\n550,30,60,180,1\n550,30,20,0,1\n551,30,60,180,1\n",
        );
        let turned = read("# azimuth: forward_0\ntheta_s_deg,theta_v_deg,phi_v_deg\n30,60,0\n30,20,180\n").unwrap();
        assert_eq!((&table, &table, &table), (&wide, &long.unwrap(), &turned));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        assert!(read("theta_s_deg,theta_v_deg\n30,60\n").unwrap_err().contains("no column phi_v_deg"));
        let names = "theta_s_deg,theta_v_deg,phi_v_deg\n";
        assert!(read(&format!("{names}30,95,0\n")).unwrap_err().contains("line 2, column 2"));
        assert!(read(&format!("{names}30,9,0\n30,9,360\n")).unwrap_err().contains("line 3"));
        assert!(read(&format!("{names}30,,0\n")).unwrap_err().contains("line 2, column 2"));
        assert!(read(names).unwrap_err().contains("no row below"));
        assert!(read("").unwrap_err().contains("has no row"));
        assert!(read(&format!("theta_s_deg,{names}1,1,1,1\n")).unwrap_err().contains("second column"));
    }
}
