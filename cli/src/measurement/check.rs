//! What angles, wavelengths and values must satisfy, in either layout.

use std::collections::HashMap;

use super::Direction;
use super::cell::{self, Cell, remedy, shown};

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Wavelength,
    Zenith,
    Azimuth,
    Value,
    StandardDeviation,
}

/// The cell's number, NaN for a missing value where one may be missing; else what is wrong with it.
#[inline]
pub(super) fn number(kind: Kind, cell: &[u8]) -> Result<f64, String> {
    match cell::parse(cell) {
        Cell::Number(number) if kind.holds(number) => Ok(number),
        Cell::Missing if kind.may_be_missing() => Ok(f64::NAN),
        _ => Err(kind.complaint(cell)),
    }
}

/// The first direction that stands twice, and where it stands before.
pub(super) fn twice(directions: &[Direction]) -> Option<(usize, usize)> {
    let mut first = HashMap::with_capacity(directions.len());
    let again =
        |(index, direction): (usize, &Direction)| first.insert(direction.key(), index).map(|before| (index, before));
    directions.iter().enumerate().find_map(again)
}

/// The number at the beginning of a row's remaining cells, where it is written plainly, and how many bytes it takes up
/// to the comma or the end. `None`: [`number`] has to look at the cell.
#[inline]
pub(super) fn plain_number(kind: Kind, cells: &[u8]) -> Option<(f64, usize)> {
    cell::parse_short(cells).filter(|(number, _)| kind.holds(*number))
}

impl Kind {
    #[inline]
    fn holds(self, number: f64) -> bool {
        match self {
            Kind::Wavelength => (100.0..=100_000.0).contains(&number),
            Kind::Zenith => (0.0..90.0).contains(&number),
            Kind::Azimuth => (-360.0..=360.0).contains(&number),
            // Noise is kept, but −999 or −9999 is somebody's mark for "none".
            Kind::Value => (-99.0..=1e6).contains(&number),
            Kind::StandardDeviation => (0.0..=1e6).contains(&number),
        }
    }

    fn may_be_missing(self) -> bool {
        matches!(self, Kind::Value | Kind::StandardDeviation)
    }

    #[cold]
    fn complaint(self, cell: &[u8]) -> String {
        let found = shown(cell);
        let expected = match self {
            Kind::Wavelength => "a wavelength in nm, 100 to 100000",
            Kind::Zenith => "a zenith angle in degrees, 0 ≤ θ < 90",
            Kind::Azimuth => "an azimuth in degrees, −360 ≤ φ ≤ 360",
            Kind::Value => "a number, or an empty cell, NaN or NA where there is no value",
            Kind::StandardDeviation => "a standard deviation ≥ 0, or an empty cell, NaN or NA where there is none",
        };
        let hint = match (self, cell::parse(cell)) {
            (Kind::Wavelength, Cell::Number(number)) if number > 0.0 && number < 100.0 => {
                " (did you mean nm? 0.55 µm is 550 nm)"
            }
            (Kind::Value, Cell::Number(number)) if number < 0.0 => {
                " (no reflectance is below −99; a mark for a missing value? Leave the cell empty)"
            }
            (Kind::Value, Cell::Number(_)) => {
                " (no reflectance is above 1e6; leave the cell empty where there is none)"
            }
            (Kind::Zenith, Cell::Number(number)) if number < 0.0 => {
                " (a negative angle in the principal plane is the positive angle with φ_v turned by 180)"
            }
            (Kind::Zenith, Cell::Number(_)) => " (at 90° and beyond the leaf is seen edge-on or from below)",
            (_, Cell::Other) => remedy(cell),
            _ => "",
        };
        format!("found {found}: expected {expected}{hint}")
    }
}
