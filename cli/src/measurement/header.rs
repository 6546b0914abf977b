//! `# key: value` lines.

use super::input::Source;
use super::{Azimuth, Quantity, ReadError};

/// The `# key: value` lines of a file, in its order.
///
/// Lines that are not `key: value` are kept as well, with an empty key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Metadata {
    entries: Vec<(String, String)>,
}

impl Metadata {
    /// No lines.
    pub fn new() -> Self {
        Metadata::default()
    }

    /// The value of the first line with this key, whatever its case; `None` where there is none or it is empty.
    pub fn get(&self, key: &str) -> Option<&str> {
        let found = self.entries.iter().find(|(k, _)| k.eq_ignore_ascii_case(key));
        found.map(|(_, value)| value.as_str()).filter(|value| !value.is_empty())
    }

    /// One more line. An empty key makes it a plain remark.
    pub fn push(&mut self, key: impl Into<String>, value: impl Into<String>) {
        self.entries.push((key.into(), value.into()));
    }

    /// All lines in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|(key, value)| (key.as_str(), value.as_str()))
    }
}

/// What the `#` lines say.
pub(super) struct Header {
    pub metadata: Metadata,
    /// The quantity and the line that names it.
    pub quantity: Option<(Quantity, u64)>,
    pub azimuth: Option<(Azimuth, u64)>,
    pub sample: Option<String>,
}

/// Keys of which a file may have only one.
const SINGLE: [&str; 3] = ["quantity", "azimuth", "sample"];

/// All `#` lines of the file, wherever they stand.
pub(super) fn read(source: Source<'_>) -> Result<Header, ReadError> {
    let bytes = source.text.as_bytes();
    let mut header = Header { metadata: Metadata::new(), quantity: None, azimuth: None, sample: None };
    let mut seen: [Option<(String, u64)>; SINGLE.len()] = Default::default();

    let first = bytes.first().filter(|byte| **byte == b'#').map(|_| 0);
    for start in first.into_iter().chain(memchr::memmem::find_iter(bytes, b"\n#").map(|end| end + 1)) {
        let rest = source.text.get(start + 1..).unwrap_or("");
        let (key, value) = split(rest.split('\n').next().unwrap_or("").trim());
        let line = || 1 + memchr::memchr_iter(b'\n', bytes.get(..start).unwrap_or(&[])).count() as u64;
        let wrong = |message: String| Err(ReadError { line: Some(line()), ..ReadError::whole(source.name, message) });

        if let Some(place) = SINGLE.iter().position(|single| key.eq_ignore_ascii_case(single))
            && let Some(before) = seen.get_mut(place)
        {
            match before {
                Some((other, first_line)) if !value.eq_ignore_ascii_case(other) => {
                    return wrong(format!(
                        "{key} is {value:?} here but {other:?} in line {first_line}: expected one {key} for the file"
                    ));
                }
                Some(_) => continue,
                None => *before = Some((value.to_string(), line())),
            }
        }
        if key.eq_ignore_ascii_case("quantity") {
            match Quantity::from_name(value) {
                Some(quantity) => header.quantity = Some((quantity, line())),
                None => return wrong(format!("quantity is {value:?}: expected brf (π·BRDF, unitless) or brdf (sr⁻¹)")),
            }
        } else if key.eq_ignore_ascii_case("azimuth") {
            match Azimuth::from_name(value) {
                Some(azimuth) => header.azimuth = Some((azimuth, line())),
                None => {
                    return wrong(format!(
                        "azimuth is {value:?}: expected forward_180 (φ_v = 180° is the specular side) or forward_0"
                    ));
                }
            }
        } else if key.eq_ignore_ascii_case("sample") {
            if !is_sample(value) {
                return wrong(format!(
                    "sample is {value:?}: expected the name of a sample, without control characters"
                ));
            }
            header.sample = Some(value.to_string());
        } else if !(key.is_empty() && value.is_empty()) {
            header.metadata.push(key, value);
        }
    }
    Ok(header)
}

/// `key: value`, or an empty key and the whole remark.
///
/// A key is a word or a few; the colon of `https://…` makes none.
pub(crate) fn split(remark: &str) -> (&str, &str) {
    match remark.split_once(':') {
        Some((key, value)) if is_key(key.trim_end()) && !value.starts_with("//") => (key.trim_end(), value.trim()),
        _ => ("", remark),
    }
}

/// What a leaf may be called.
pub(super) fn is_sample(name: &str) -> bool {
    !name.is_empty() && name.trim() == name && !name.contains(char::is_control)
}

/// Letters, digits, `_`, `-`, `.` and single spaces, beginning with a letter, at most 40 characters.
pub(super) fn is_key(key: &str) -> bool {
    key.chars().count() <= 40
        && key.starts_with(char::is_alphabetic)
        && key.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ' '))
        && !key.ends_with(' ')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_colon_makes_a_key_only_after_words() {
        assert_eq!(split("species: Prunus laurocerasus"), ("species", "Prunus laurocerasus"));
        assert_eq!(split("leaf age:3 weeks: about"), ("leaf age", "3 weeks: about"));
        assert_eq!(split("https://example.org/data"), ("", "https://example.org/data"));
        assert_eq!(split("measured at 10:30"), ("measured at 10", "30"));
        assert_eq!(split("no colon"), ("", "no colon"));
        assert_eq!(split("12: not a word"), ("", "12: not a word"));
        assert_eq!(split("face:"), ("face", ""));
    }
}
