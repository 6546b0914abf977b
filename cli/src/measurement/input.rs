//! From a path to text: standard input, gzip, byte order marks, line ends, and what is not text at all.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::ReadError;

/// Files above this size, as text, are refused: they are no leaf measurement, and a gzip file of a megabyte can hold
/// a gigabyte.
const LARGEST: u64 = 1 << 30;

/// The file's name as messages show it.
pub(crate) fn display_name(path: &Path) -> String {
    if path == Path::new("-") { "standard input".to_string() } else { path.display().to_string() }
}

/// All bytes of the file, `-` being standard input.
pub(crate) fn read_all(path: &Path) -> Result<Vec<u8>, ReadError> {
    let name = display_name(path);
    let bytes = if path == Path::new("-") {
        limited(io::stdin().lock(), 0)
    } else {
        File::open(path).and_then(|file| {
            let size = file.metadata().map_or(0, |metadata| metadata.len());
            limited(file, size)
        })
    };
    bytes.map_err(|error| ReadError::whole(&name, format!("cannot be read: {error}")))
}

/// Reads to the end, or one byte past the largest size, so that [`decode`] can tell.
fn limited(reader: impl Read, expected: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(usize::try_from(expected.min(LARGEST)).unwrap_or(0) + 1);
    reader.take(LARGEST + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of a file: decompressed where it is gzip (known by its first bytes, whatever its name), without byte order
/// mark, lines ended by `\n`.
pub(crate) fn decode<'a>(name: &str, bytes: &'a [u8]) -> Result<Cow<'a, str>, ReadError> {
    let wrong = |message: String| Err(ReadError::whole(name, message));
    let plain = match bytes {
        [0x1f, 0x8b, ..] => match limited(MultiGzDecoder::new(bytes), 4 * bytes.len() as u64) {
            Ok(plain) => Cow::Owned(plain),
            Err(error) => {
                return wrong(format!("the gzip file is truncated or damaged ({error}): get it again from its source"));
            }
        },
        _ => Cow::Borrowed(bytes),
    };
    if plain.len() as u64 > LARGEST {
        return wrong("holds more than 1 GiB of text: split it, one file a leaf".to_string());
    }
    if let Some(kind) = other_kind(&plain) {
        return wrong(format!("is {kind}: expected text (UTF-8), comma-separated, plain or gzip-compressed"));
    }
    if let Some(at) = memchr::memchr(0, &plain) {
        let line = 1 + memchr::memchr_iter(b'\n', plain.get(..at).unwrap_or(&[])).count();
        let message = "binary data (a zero byte): expected text (UTF-8), comma-separated, plain or gzip-compressed";
        return Err(ReadError { line: Some(line as u64), ..ReadError::whole(name, message) });
    }
    let text = match plain {
        Cow::Borrowed(plain) => {
            std::str::from_utf8(plain).map(Cow::Borrowed).map_err(|error| (error, Cow::Borrowed(plain)))
        }
        Cow::Owned(plain) => String::from_utf8(plain)
            .map(Cow::Owned)
            .map_err(|error| (error.utf8_error(), Cow::Owned(error.into_bytes()))),
    };
    let text = match text {
        Ok(text) => text,
        Err((error, plain)) => {
            let before = plain.get(..error.valid_up_to()).unwrap_or(&[]);
            let line = 1 + line_ends(before);
            let byte = plain.get(error.valid_up_to()).copied().unwrap_or(0);
            let message = format!("the byte 0x{byte:02x} is not UTF-8 text: save the file with encoding UTF-8");
            return Err(ReadError { line: Some(line), ..ReadError::whole(name, message) });
        }
    };
    let text = without_mark(text);
    let text = if text.is_empty() || text.ends_with(['\n', '\r']) {
        text
    } else {
        // A remark in the last line, unended, would come out of the `csv` reader as a row.
        let mut text = text.into_owned();
        text.push('\n');
        Cow::Owned(text)
    };
    Ok(if memchr::memchr(b'\r', text.as_bytes()).is_some() {
        // Windows, and Macs of the last century.
        Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n"))
    } else {
        text
    })
}

fn without_mark(text: Cow<'_, str>) -> Cow<'_, str> {
    const MARK: char = '\u{feff}';
    if !text.starts_with(MARK) {
        return text;
    }
    match text {
        Cow::Borrowed(text) => Cow::Borrowed(text.strip_prefix(MARK).unwrap_or(text)),
        Cow::Owned(text) => Cow::Owned(text.strip_prefix(MARK).unwrap_or(&text).to_string()),
    }
}

/// Line ends of any of the three kinds.
fn line_ends(bytes: &[u8]) -> u64 {
    let carriage_only = bytes.windows(2).filter(|pair| matches!(pair, [b'\r', next] if *next != b'\n')).count();
    (memchr::memchr_iter(b'\n', bytes).count() + carriage_only) as u64
}

/// What a file is that is not text, as far as its first bytes tell.
fn other_kind(bytes: &[u8]) -> Option<&'static str> {
    Some(match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "UTF-16 text (save it as UTF-8)",
        [b'P', b'K', 3, 4, ..] => "a ZIP archive or an Excel workbook (export the sheet as CSV)",
        [0xd0, 0xcf, 0x11, 0xe0, ..] => "an old Excel workbook (export the sheet as CSV)",
        [0x1f, 0x8b, ..] => "a gzip file within a gzip file (decompress it once)",
        [0x28, 0xb5, 0x2f, 0xfd, ..] => "zstd-compressed (decompress it, or use gzip)",
        [0xfd, b'7', b'z', b'X', b'Z', ..] => "xz-compressed (decompress it, or use gzip)",
        [b'B', b'Z', b'h', b'1'..=b'9', 0x31, 0x41, 0x59, ..] => "bzip2-compressed (decompress it, or use gzip)",
        [0x89, b'H', b'D', b'F', ..] => "an HDF5 file",
        [b'%', b'P', b'D', b'F', ..] => "a PDF file",
        _ => return None,
    })
}

/// A decoded file: finds the line of a place in it, for messages.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub name: &'a str,
    pub text: &'a str,
}

impl Source<'_> {
    /// An error somewhere in the record that the `csv` reader found at byte `record`.
    ///
    /// The reader counts a record from the end of the one before; blank lines and comments in between are skipped here.
    pub fn error(&self, record: u64, column: Option<usize>, message: impl Into<String>) -> ReadError {
        ReadError { line: Some(self.line(record)), column, ..ReadError::whole(self.name, message) }
    }

    /// The line, counted from 1, of the record at byte `record`.
    pub fn line(&self, record: u64) -> u64 {
        let mut start = usize::try_from(record).unwrap_or(usize::MAX).min(self.text.len());
        let bytes = self.text.as_bytes();
        loop {
            let rest = bytes.get(start..).unwrap_or(&[]);
            let skipped = matches!(rest, [b'\n' | b'#', ..]);
            match memchr::memchr(b'\n', rest) {
                Some(end) if skipped => start += end + 1,
                _ => break,
            }
        }
        1 + memchr::memchr_iter(b'\n', bytes.get(..start).unwrap_or(&[])).count() as u64
    }

    /// The records of the file: cells between commas, quotes as usual, blank lines and `#` lines left out.
    pub fn records(&self) -> csv::Reader<&[u8]> {
        csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .buffer_capacity(1 << 16)
            .from_reader(self.text.as_bytes())
    }

    /// The next record, `None` at the end. A cell that runs over a line end is refused: its quote is not closed.
    #[inline]
    pub fn next(&self, records: &mut csv::Reader<&[u8]>, record: &mut csv::ByteRecord) -> Result<bool, ReadError> {
        match records.read_byte_record(record) {
            Ok(false) => Ok(false),
            Ok(true) => {
                if memchr::memchr(b'\n', record.as_slice()).is_some() {
                    let column = record.iter().position(|cell| cell.contains(&b'\n')).map(|index| index + 1);
                    return Err(self.error(
                        at(record),
                        column,
                        "a quoted cell runs over the end of the line: close its quote",
                    ));
                }
                Ok(true)
            }
            Err(error) => Err(ReadError::whole(self.name, format!("cannot be read: {error}"))),
        }
    }
}

/// Where the `csv` reader found the record, in bytes.
pub(crate) fn at(record: &csv::ByteRecord) -> u64 {
    record.position().map_or(0, csv::Position::byte)
}
