//! Which layout a file has, and from there to its reader.

use std::path::Path;

use super::cell::{self, Cell, shown, trim};
use super::header::{self, Header};
use super::input::{Source, at, decode, display_name, read_all};
use super::{Azimuth, Layout, Measurement, Quantity, ReadError, long, wide};

/// What the user says about a file that it does not say itself.
///
/// Where the file does say it, and says something else, it is refused: one of the two is wrong.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// BRF or BRDF (`--quantity`).
    pub quantity: Option<Quantity>,
    /// The azimuth convention (`--azimuth`); without it and without a line in the file, `forward_180`.
    pub azimuth: Option<Azimuth>,
}

/// Reads a measurement file, wide or long, plain or gzip; `-` is standard input.
///
/// # Errors
///
/// The first violation of `docs/formats.md`, with file, line, column and remedy.
pub fn read_path(path: &Path, options: &ReadOptions) -> Result<Vec<Measurement>, ReadError> {
    let bytes = read_all(path)?;
    read_named(&display_name(path), &stem(path), &bytes, options)
}

/// Reads a measurement file from its bytes; `name` is for messages and, without folder and endings, the leaf's name.
///
/// ```
/// use leafbrdf::measurement::{ReadOptions, read_bytes};
/// let file = b"# quantity: brf\ntheta_s_deg,30\ntheta_v_deg,60\nphi_v_deg,180\n550,0.25\n";
/// let leaves = read_bytes("laurel.csv", file, &ReadOptions::default()).unwrap();
/// assert_eq!(leaves[0].name, "laurel");
/// assert_eq!(leaves[0].brdf(), [0.25 / std::f64::consts::PI]);
/// ```
///
/// # Errors
///
/// As [`read_path`].
pub fn read_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Vec<Measurement>, ReadError> {
    read_named(name, &stem(Path::new(name)), bytes, options)
}

fn read_named(name: &str, stem: &str, bytes: &[u8], options: &ReadOptions) -> Result<Vec<Measurement>, ReadError> {
    let text = decode(name, bytes)?;
    let source = Source { name, text: &text };
    let header = header::read(source)?;
    let context = Context { source, stem, options, azimuth: azimuth(source, &header, options)?, header };
    match layout(source)? {
        Layout::Wide => wide::read(context).map(|measurement| vec![measurement]),
        Layout::Long => long::read(context),
    }
}

/// What both layouts need to know.
pub(super) struct Context<'a> {
    pub source: Source<'a>,
    pub stem: &'a str,
    pub options: &'a ReadOptions,
    pub azimuth: Azimuth,
    pub header: Header,
}

impl Context<'_> {
    /// The sample's name, else the stem of the file's.
    pub fn leaf_name(&self) -> String {
        self.header.sample.as_deref().unwrap_or(self.stem).to_string()
    }
}

/// The file's name without folder and without the endings of data files: what a leaf is called that has no name of its own.
pub fn stem(path: &Path) -> String {
    if path == Path::new("-") {
        return "stdin".to_string();
    }
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut stem = name.as_str();
    for ending in [".gz", ".csv", ".txt"] {
        let cut = stem.len().saturating_sub(ending.len());
        if let (Some(front), Some(back)) = (stem.get(..cut), stem.get(cut..))
            && !front.is_empty()
            && back.eq_ignore_ascii_case(ending)
        {
            stem = front;
        }
    }
    stem.to_string()
}

pub(super) fn azimuth(source: Source<'_>, header: &Header, options: &ReadOptions) -> Result<Azimuth, ReadError> {
    match (header.azimuth, options.azimuth) {
        (Some((stated, line)), Some(asked)) if stated != asked => Err(ReadError {
            line: Some(line),
            ..ReadError::whole(
                source.name,
                format!(
                    "the file says azimuth {} and --azimuth says {}: leave the option out, or correct the file",
                    stated.name(),
                    asked.name()
                ),
            )
        }),
        (Some((stated, _)), _) => Ok(stated),
        (None, asked) => Ok(asked.unwrap_or(Azimuth::Forward180)),
    }
}

/// The names of the wide layout's first three rows.
pub(super) const ANGLES: [&str; 3] = ["theta_s_deg", "theta_v_deg", "phi_v_deg"];

/// The layout, from the first line that is neither blank nor a comment.
fn layout(source: Source<'_>) -> Result<Layout, ReadError> {
    let mut record = csv::ByteRecord::new();
    if !source.next(&mut source.records(), &mut record)? {
        let found = if source.text.is_empty() { "the file is empty" } else { "the file has no data, only remarks" };
        return Err(ReadError::whole(
            source.name,
            format!("{found}: expected a wide or long measurement file (see docs/formats.md)"),
        ));
    }
    let is_angle = |cell: &[u8]| ANGLES.iter().any(|angle| angle.as_bytes() == cell);
    let mut cells = record.iter().map(trim);
    let first = cells.next().unwrap_or(b"");
    let second = cells.next();
    let named = record.iter().map(trim).any(|cell| cell == b"wavelength_nm");
    if named {
        return Ok(Layout::Long);
    }
    match second {
        Some(second) if is_angle(first) && cell::parse(second) == Cell::Other => {
            // Names beside names: a long file without wavelengths, to be told so by the reader of long files.
            if second.first().is_some_and(u8::is_ascii_alphabetic) { Ok(Layout::Long) } else { Ok(Layout::Wide) }
        }
        _ if is_angle(first) => Ok(Layout::Wide),
        _ if record.iter().map(trim).any(is_angle) => Ok(Layout::Long),
        _ => Err(neither(source, &record)),
    }
}

/// The file is in neither layout: why, as far as its first row tells.
fn neither(source: Source<'_>, record: &csv::ByteRecord) -> ReadError {
    let line = record.iter().collect::<Vec<_>>().join(&b","[..]);
    let has = |byte: u8| line.contains(&byte);
    let hint = if has(b';') {
        ". The cells seem to be separated by semicolons: export the file with commas between the cells and decimal points"
    } else if has(b'\t') {
        ". The cells seem to be separated by tabs: export the file with commas between the cells"
    } else if line.to_ascii_lowercase().windows(5).any(|word| matches!(word, b"theta" | b"wavel" | b"phi_v")) {
        ". Names are matched exactly: wavelength_nm, theta_s_deg, theta_v_deg, phi_v_deg, brf or brdf"
    } else {
        ""
    };
    source.error(
        at(record),
        Some(1),
        format!(
            "found {}: expected theta_s_deg and one angle a column (wide layout), or a row of column names with \
             wavelength_nm (long layout); see docs/formats.md{hint}",
            shown(&line)
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leaf_without_sample_is_called_after_its_file() {
        for (path, name) in [
            ("data/laurel.csv", "laurel"),
            ("laurel.CSV.gz", "laurel"),
            ("a.b.csv", "a.b"),
            ("laurel.gz", "laurel"),
            (".csv", ".csv"),
            ("-", "stdin"),
        ] {
            assert_eq!(stem(Path::new(path)), name);
        }
    }
}
