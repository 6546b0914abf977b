//! Measurements out again, in either layout, quantity and azimuth convention.

use std::collections::HashSet;
use std::path::Path;

use super::header::{self, Metadata};
use super::{Azimuth, Direction, Layout, Measurement, Quantity, WriteError, azimuth, check};
use crate::output::{AtomicFile, push_number};

/// The form to write; `None` leaves it as the measurement's own file had it.
#[derive(Clone, Copy, Debug, Default)]
pub struct WriteOptions {
    /// Wide or long.
    pub layout: Option<Layout>,
    /// BRF or BRDF.
    pub quantity: Option<Quantity>,
    /// The azimuth convention of the file.
    pub azimuth: Option<Azimuth>,
}

/// Writes a measurement file, whole or not at all; gzip where the name ends in `.gz`; `-` is standard output.
///
/// # Errors
///
/// [`WriteError::Unfit`] as [`render`]; [`WriteError::Io`] from the system.
pub fn write_path(path: &Path, measurements: &[Measurement], options: &WriteOptions) -> Result<(), WriteError> {
    let text = render(measurements, options)?;
    let io = |error| WriteError::Io { file: path.display().to_string(), error };
    let mut file = AtomicFile::create(path).map_err(io)?;
    std::io::Write::write_all(&mut file, text.as_bytes()).map_err(io)?;
    file.commit().map_err(io)
}

/// The text of a measurement file.
///
/// # Errors
///
/// [`WriteError::Unfit`] where the layout cannot hold the measurements: several leaves, or standard deviations, in the
/// wide one; leaves of different quantity or metadata, or without names of their own, in one long file; metadata that
/// would not be read back as they are.
pub fn render(measurements: &[Measurement], options: &WriteOptions) -> Result<String, WriteError> {
    let Some(first) = measurements.first() else {
        return Err(WriteError::Unfit("there is no measurement to write".to_string()));
    };
    let layout = options.layout.unwrap_or(first.layout);
    let quantity = options.quantity.unwrap_or(first.quantity);
    let azimuth = options.azimuth.unwrap_or(first.azimuth);
    let several = measurements.len() > 1;
    for measurement in measurements {
        writable(measurement, first, several).map_err(WriteError::Unfit)?;
    }
    let mut samples = HashSet::new();
    if let Some(twice) = measurements.iter().find(|one| several && !samples.insert(&one.sample)) {
        return Err(unfit(twice, "two leaves of the file have this sample name: each needs its own"));
    }

    let mut text = String::new();
    metadata(&mut text, &first.metadata);
    if let (false, Some(sample)) = (several, &first.sample) {
        line(&mut text, "sample", sample);
    }
    line(&mut text, "quantity", quantity.name());
    line(&mut text, "azimuth", azimuth.name());
    let converted: Vec<Measurement> = measurements.iter().map(|one| one.clone().into_quantity(quantity)).collect();
    match (layout, converted.as_slice()) {
        (Layout::Long, all) => long(&mut text, all, quantity, azimuth),
        (Layout::Wide, [one]) => {
            if one.sd.is_some() {
                return Err(unfit(one, "the wide layout has no place for standard deviations: write the long layout"));
            }
            wide(&mut text, one, azimuth);
        }
        (Layout::Wide, _) => {
            return Err(unfit(
                first,
                "the wide layout holds one leaf and the file has several: write the long layout, or choose a leaf",
            ));
        }
    }
    Ok(text)
}

fn unfit(measurement: &Measurement, why: &str) -> WriteError {
    WriteError::Unfit(format!("{}: {why}", measurement.name))
}

/// Whether the measurement can be read back as it is.
fn writable(one: &Measurement, first: &Measurement, several: bool) -> Result<(), String> {
    let wrong = |why: &str| Err(format!("{}: {why}", one.name));
    let cells = one.wavelengths_nm.len() * one.directions.len();
    if one.values.len() != cells || one.sd.as_ref().is_some_and(|sd| sd.len() != cells) {
        return wrong("there must be one value (and standard deviation) a wavelength and direction");
    }
    if check::twice(&one.directions).is_some() || !one.wavelengths_nm.is_sorted_by(|a, b| a < b) {
        return wrong("wavelengths must ascend, and directions must differ");
    }
    if one.metadata != first.metadata {
        return wrong("the leaves' '# key: value' lines differ: write a file for each");
    }
    for (key, value) in one.metadata.iter() {
        let as_read = if key.is_empty() { header::split(value) == ("", value) } else { header::is_key(key) };
        let reserved = ["quantity", "azimuth", "sample"].iter().any(|other| key.eq_ignore_ascii_case(other));
        let empty = key.is_empty() && value.is_empty();
        if !as_read || reserved || empty || value.trim() != value || value.contains(['\n', '\r']) {
            return wrong(&format!("the metadata line {key:?}: {value:?} would not be read back as it is"));
        }
    }
    match &one.sample {
        None if several => wrong("several leaves in one file need a sample name each"),
        Some(sample) if !header::is_sample(sample) => {
            wrong("a sample name must not be empty, and has no blanks around it and no control characters")
        }
        _ => Ok(()),
    }
}

fn metadata(text: &mut String, metadata: &Metadata) {
    for (key, value) in metadata.iter() {
        line(text, key, value);
    }
}

fn line(text: &mut String, key: &str, value: &str) {
    text.push_str("# ");
    if !key.is_empty() {
        text.push_str(key);
        text.push_str(": ");
    }
    text.push_str(value);
    text.push('\n');
}

fn in_convention(directions: &[Direction], azimuth: Azimuth) -> Vec<Direction> {
    let mut directions = directions.to_vec();
    if azimuth == Azimuth::Forward0 {
        azimuth::turned(&mut directions);
    }
    directions
}

/// A value, or an empty cell.
fn push_value(text: &mut String, value: f64) {
    text.push(',');
    if !value.is_nan() {
        push_number(text, value);
    }
}

fn wide(text: &mut String, one: &Measurement, azimuth: Azimuth) {
    let directions = in_convention(&one.directions, azimuth);
    let mut row = |name: &str, angle: fn(&Direction) -> f64| {
        text.push_str(name);
        directions.iter().for_each(|direction| push_value(text, angle(direction)));
        text.push('\n');
    };
    row("theta_s_deg", |direction| direction.theta_s_deg);
    row("theta_v_deg", |direction| direction.theta_v_deg);
    row("phi_v_deg", |direction| direction.phi_v_deg);
    for (band, wavelength) in one.wavelengths_nm.iter().enumerate() {
        push_number(text, *wavelength);
        one.band(band).iter().for_each(|value| push_value(text, *value));
        text.push('\n');
    }
}

fn long(text: &mut String, all: &[Measurement], quantity: Quantity, azimuth: Azimuth) {
    let has_sd = all.iter().any(|one| one.sd.is_some());
    text.push_str("wavelength_nm,theta_s_deg,theta_v_deg,phi_v_deg,");
    text.push_str(quantity.name());
    if has_sd {
        text.push_str(",sd");
    }
    if all.len() > 1 {
        text.push_str(",sample");
    }
    text.push('\n');
    for one in all {
        let directions: Vec<String> = in_convention(&one.directions, azimuth)
            .iter()
            .map(|direction| {
                let mut angles = String::new();
                [direction.theta_s_deg, direction.theta_v_deg, direction.phi_v_deg]
                    .iter()
                    .for_each(|a| push_value(&mut angles, *a));
                angles
            })
            .collect();
        let sample = one.sample.as_deref().filter(|_| all.len() > 1).map(quoted);
        for (band, wavelength) in one.wavelengths_nm.iter().enumerate() {
            let mut nanometres = String::new();
            push_number(&mut nanometres, *wavelength);
            let start = band * directions.len();
            for (index, (direction, value)) in directions.iter().zip(one.band(band)).enumerate() {
                text.push_str(&nanometres);
                text.push_str(direction);
                push_value(text, *value);
                if has_sd {
                    let sd = one.sd.as_ref().and_then(|sd| sd.get(start + index));
                    push_value(text, sd.copied().unwrap_or(f64::NAN));
                }
                if let Some(sample) = &sample {
                    text.push(',');
                    text.push_str(sample);
                }
                text.push('\n');
            }
        }
    }
}

fn quoted(cell: &str) -> String {
    let mut text = String::new();
    crate::output::push_text(&mut text, cell);
    text
}
