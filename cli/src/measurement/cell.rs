//! One cell → one number, the same double as the standard library's, whatever the locale.

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cell {
    /// A finite number.
    Number(f64),
    /// Empty, `NaN` (in any case) or `NA`.
    Missing,
    /// Anything else: infinities, numbers too large for a double, words.
    Other,
}

/// 10⁰ … 10²², all of them exact.
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// The cell without the spaces and tabs around it.
#[inline]
pub(crate) fn trim(cell: &[u8]) -> &[u8] {
    match cell {
        [first, .., last] if !is_blank(*first) && !is_blank(*last) => cell,
        _ => trim_slowly(cell),
    }
}

fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t'
}

#[inline(never)]
fn trim_slowly(mut cell: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = cell
        && is_blank(*first)
    {
        cell = rest;
    }
    while let [rest @ .., last] = cell
        && is_blank(*last)
    {
        cell = rest;
    }
    cell
}

/// The cell's number. Spaces and tabs around it do not matter.
#[inline]
pub(crate) fn parse(cell: &[u8]) -> Cell {
    match parse_short(cell) {
        Some((number, length)) if length == cell.len() => Cell::Number(number),
        _ => parse_any(trim(cell)),
    }
}

/// `[-]digits[.digits]` up to a comma or the end, and how many bytes that is; `None` for anything else, for more than 18
/// digits and for mantissas above 2⁵³.
///
/// Mantissa and power of ten are exact then, so their quotient is the correctly rounded value (Clinger 1990): the bits
/// are those of the general algorithm.
#[inline]
pub(crate) fn parse_short(cells: &[u8]) -> Option<(f64, usize)> {
    let negative = cells.first() == Some(&b'-');
    let first = usize::from(negative);
    let mut mantissa = 0_u64;
    let mut after_point = None;
    let mut end = first;
    while let Some(&byte) = cells.get(end) {
        let digit = byte.wrapping_sub(b'0');
        if digit <= 9 {
            mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        } else if byte == b',' {
            break;
        } else if byte == b'.' && after_point.is_none() {
            after_point = Some(end + 1);
        } else {
            return None;
        }
        end += 1;
    }
    // Nothing or a point alone, and nineteen digits or more, which may have run over.
    let digits = end - first - usize::from(after_point.is_some());
    if digits == 0 || digits > 18 || mantissa > 1 << 53 {
        return None;
    }
    let decimals = after_point.map_or(0, |point| end - point);
    let magnitude = mantissa as f64 / POWERS_OF_TEN.get(decimals)?;
    Some((if negative { -magnitude } else { magnitude }, end))
}

#[inline(never)]
fn parse_any(cell: &[u8]) -> Cell {
    if cell.is_empty() || cell == b"NA" || cell.eq_ignore_ascii_case(b"nan") {
        return Cell::Missing;
    }
    // The standard library also reads "inf", "infinity" and "+nan": words, not numbers.
    let numeric = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'+' | b'-' | b'e' | b'E');
    if !cell.iter().all(numeric) {
        return Cell::Other;
    }
    match std::str::from_utf8(cell).ok().and_then(|text| text.parse::<f64>().ok()) {
        Some(number) if number.is_finite() => Cell::Number(number),
        _ => Cell::Other,
    }
}

/// The cell as an error message shows it: in quotes, and not longer than a glance.
pub(crate) fn shown(cell: &[u8]) -> String {
    let text = String::from_utf8_lossy(trim(cell));
    if text.is_empty() {
        return "an empty cell".to_string();
    }
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push('…');
    }
    // `{:?}` escapes what a terminal would obey.
    format!("{short:?}")
}

/// What to do about a cell that is no number.
pub(crate) fn remedy(cell: &[u8]) -> &'static str {
    let cell = trim(cell);
    let only = |allowed: &[u8]| !cell.is_empty() && cell.iter().all(|b| b.is_ascii_digit() || allowed.contains(b));
    let has_digit = cell.iter().any(u8::is_ascii_digit);
    let lower = cell.to_ascii_lowercase();
    if has_digit && cell.contains(&b',') && only(b"+-,eE") {
        " (a decimal comma? Write a decimal point)"
    } else if has_digit && cell.contains(&b';') && only(b"+-,.;eE ") {
        " (a semicolon-separated file? Export it with commas between the cells and decimal points)"
    } else if std::str::from_utf8(cell).is_ok_and(|text| text.parse().is_ok_and(f64::is_infinite)) {
        " (infinite, or too large to be held; leave the cell empty where there is no value)"
    } else if matches!(lower.as_slice(), b"na" | b"n/a" | b"#n/a" | b"null" | b"none" | b"-" | b"--" | b"nd" | b"n.d.")
    {
        " (a missing value? Leave the cell empty, or write NaN or NA)"
    } else if cell.last() == Some(&b'%') {
        " (a per cent sign? Write the fraction)"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn number(text: &str) -> f64 {
        match parse(text.as_bytes()) {
            Cell::Number(number) => number,
            other => panic!("{text:?} is {other:?}"),
        }
    }

    #[test]
    fn missing_values_are_the_three_that_the_format_names() {
        for text in ["", "  ", "\t", "NaN", "nan", "NAN", "NA", " NA "] {
            assert_eq!(parse(text.as_bytes()), Cell::Missing, "{text:?}");
        }
        for text in ["na", "n/a", "-", ".", "-.", "+", "null", "+nan", "1 2", "0x10", "1_000", "1e", "e5", "1.2.3", "٣"]
        {
            assert_eq!(parse(text.as_bytes()), Cell::Other, "{text:?}");
        }
    }

    #[test]
    fn infinities_and_numbers_beyond_a_double_are_no_numbers() {
        for text in ["inf", "-inf", "Infinity", "1e999", "-1e400"] {
            assert_eq!(parse(text.as_bytes()), Cell::Other, "{text:?}");
        }
        let digits = "9".repeat(400);
        assert_eq!(parse(digits.as_bytes()), Cell::Other);
    }

    #[test]
    fn numbers_are_read_in_every_usual_spelling() {
        for (text, value) in
            [("0.116", 0.116), ("-0.002", -0.002), (".5", 0.5), ("5.", 5.0), ("+1", 1.0), ("1E-3", 1e-3)]
        {
            assert_eq!(number(text), value);
        }
        assert!(number("-0").is_sign_negative());
        assert_eq!(number(" 42 "), 42.0);
    }

    #[test]
    fn the_last_digits_are_those_of_the_standard_library() {
        for text in [
            "9007199254740992",
            "9007199254740993",
            "9007199254740993.0",
            "18446744073709551616",
            "1844674407370955161",
            "9999999999999999999",
            "0.1844674407370955161",
            "0.000000000000000001",
            "0.30000000000000004",
            "123456789.123456789",
            "1.7976931348623157e308",
            "5e-324",
        ] {
            assert_eq!(number(text).to_bits(), text.parse::<f64>().unwrap().to_bits(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn every_decimal_is_the_double_of_the_standard_library(text in "-?[0-9]{1,12}(\\.[0-9]{0,12})?") {
            prop_assert_eq!(number(&text).to_bits(), text.parse::<f64>().unwrap().to_bits());
        }

        #[test]
        fn every_printed_double_is_read_back(bits: u64) {
            let value = f64::from_bits(bits);
            prop_assume!(value.is_finite());
            prop_assert_eq!(number(&format!("{value:?}")).to_bits(), bits);
            prop_assert_eq!(number(&format!("{value}")).to_bits(), bits);
        }

        #[test]
        fn no_cell_makes_it_panic(cell: Vec<u8>) {
            if let Cell::Number(number) = parse(&cell) {
                prop_assert!(number.is_finite());
            }
            shown(&cell);
            remedy(&cell);
        }
    }
}
