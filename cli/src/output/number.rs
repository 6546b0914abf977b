//! Numbers and words as cells.

/// Appends a number: the shortest decimal that reads back as the same double, whole numbers without a point.
///
/// ```
/// use leafbrdf::output::push_number;
/// let mut text = String::new();
/// for number in [30.0, 0.1 + 0.2, 1e-9, -0.0] {
///     push_number(&mut text, number);
///     text.push(' ');
/// }
/// assert_eq!(text, "30 0.30000000000000004 1e-9 -0 ");
/// ```
pub fn push_number(text: &mut String, number: f64) {
    let mut buffer = ryu::Buffer::new();
    let digits = buffer.format(number);
    text.push_str(digits.strip_suffix(".0").unwrap_or(digits));
}

/// Appends a word as a CSV cell, in quotes where it needs them.
pub fn push_text(text: &mut String, cell: &str) {
    if cell.contains(['"', ',', '\n', '\r']) || cell.starts_with('#') {
        text.push('"');
        text.push_str(&cell.replace('"', "\"\""));
        text.push('"');
    } else {
        text.push_str(cell);
    }
}
