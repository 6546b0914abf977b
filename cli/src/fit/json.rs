//! What every `summary.json` says in the same words.

use std::io::{self, Write};
use std::path::Path;

use leafbrdf_core::Normalization;
use leafbrdf_fit::AtBound;
use serde_json::{Map, Value, json};

use super::Selected;
use crate::measurement::Metadata;
use crate::output::AtomicFile;

/// Writes `summary.json` into a folder, whole or not at all.
pub(super) fn write(folder: &Path, summary: &Value) -> io::Result<()> {
    let mut file = AtomicFile::create(&folder.join("summary.json"))?;
    serde_json::to_writer_pretty(&mut file, summary)?;
    file.write_all(b"\n")?;
    file.commit()
}

/// A number, or `null` where there is none.
pub(super) fn finite(number: f64) -> Value {
    if number.is_finite() { json!(number) } else { Value::Null }
}

/// A number that may be missing.
pub(super) fn optional(number: Option<f64>) -> Value {
    number.map_or(Value::Null, finite)
}

/// This program.
pub(super) fn program() -> Value {
    json!({"name": "leafbrdf", "version": env!("CARGO_PKG_VERSION")})
}

/// The file's `# key: value` lines.
pub(super) fn metadata(metadata: &Metadata) -> Map<String, Value> {
    metadata.iter().map(|(key, value)| (key.to_string(), json!(value))).collect()
}

/// What theta_s is in `dhrf.csv`, where a leaf may be tilted.
pub(super) const DHRF_ANGLE: &str = "dhrf.csv: theta_s_deg is counted from the leaf's own normal, as if the leaf lay level; a tilt in the \
                                     holder has no part in it";

/// How K is written out.
pub(super) fn constant(normalization: Normalization) -> &'static str {
    match normalization {
        Normalization::Bousquet2005 => "2 pi^2 (Eq. 10 as printed)",
        Normalization::CookTorrance => "4 pi (as derived from Eqs 5, 6, 9)",
    }
}

/// The first, the last, and how many.
pub(super) fn wavelengths(nm: &[f64]) -> Value {
    json!({"first": nm.first(), "last": nm.last(), "count": nm.len()})
}

/// The bound that a parameter sits at.
pub(super) fn at_bound(at: AtBound) -> Value {
    match at {
        AtBound::Free => Value::Null,
        AtBound::Lower => json!("lower"),
        AtBound::Upper => json!("upper"),
    }
}

/// Directions that take part, and those that do not.
pub(super) fn directions(selected: &Selected) -> Value {
    json!({"used": selected.vectors.len(), "left_out_beyond_max_theta_v": selected.directions_left_out})
}

/// Values that take part, and why others do not.
pub(super) fn values(selected: &Selected, used: usize) -> Value {
    json!({
        "used": used,
        "negative_among_them": selected.negative,
        "left_out": {
            "missing": selected.missing, "beyond_max_theta_v": selected.beyond_theta_v,
            "other_wavelengths": selected.other_wavelengths,
        },
    })
}
