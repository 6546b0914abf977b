//! Numbers as text, digit by digit.

use crate::board::write;

/// A string.
pub fn print(text: &str) {
    for byte in text.bytes() {
        write(byte);
    }
}

/// A whole number.
pub fn print_whole(value: u64) {
    let mut rest = value;
    let mut unit = 1_u64;
    while rest >= 10 {
        rest /= 10;
        unit *= 10;
    }
    while unit > 0 {
        write(b'0' + ((value / unit) % 10) as u8);
        unit /= 10;
    }
}

/// A number with four decimals; `-` where there is none.
pub fn print_decimal(value: f32) {
    if value.is_nan() {
        return print("-");
    }
    if value < 0.0 {
        write(b'-');
    }
    let magnitude = if value < 0.0 { -value } else { value };
    if magnitude >= 1e9 {
        return print("inf");
    }
    // to the nearest ten-thousandth, in integers
    let scaled = (magnitude * 10_000.0 + 0.5) as u64;
    print_whole(scaled / 10_000);
    write(b'.');
    let mut unit = 1_000;
    while unit > 0 {
        write(b'0' + ((scaled / unit) % 10) as u8);
        unit /= 10;
    }
}

/// Eight hexadecimal digits.
pub fn print_bits(bits: u32) {
    for nibble in (0..8).rev() {
        let digit = ((bits >> (4 * nibble)) & 0xF) as u8;
        write(if digit < 10 { b'0' + digit } else { b'a' + digit - 10 });
    }
}
