//! Tables of named columns, row by row.

use std::io::{self, IsTerminal, Write};
use std::path::Path;

use super::{AtomicFile, push_number, push_text};

/// How a table is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Comma-separated, one row of names first.
    Csv,
    /// An array of objects, one a row.
    Json,
    /// Aligned columns, for people.
    Table,
}

impl Format {
    /// The format asked for, else a table on a terminal and CSV everywhere else.
    pub fn or_default(asked: Option<Format>, output: Option<&Path>) -> Format {
        let on_terminal = output.is_none_or(|path| path == Path::new("-")) && io::stdout().is_terminal();
        asked.unwrap_or(if on_terminal { Format::Table } else { Format::Csv })
    }
}

/// One cell of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// A number; NaN and infinities become empty cells (`null`).
    Number(f64),
    /// A whole number.
    Count(u64),
    /// A word.
    Text(&'a str),
    /// No value.
    Empty,
}

impl Cell<'_> {
    /// A number, or an empty cell where there is none.
    pub fn or_empty(number: Option<f64>) -> Self {
        number.map_or(Cell::Empty, Cell::Number)
    }

    fn push_plain(self, text: &mut String) {
        match self {
            Cell::Number(number) if number.is_finite() => push_number(text, number),
            Cell::Count(count) => text.push_str(&count.to_string()),
            Cell::Text(word) => text.push_str(word),
            _ => {}
        }
    }

    fn push_csv(self, text: &mut String) {
        match self {
            Cell::Text(word) => push_text(text, word),
            other => other.push_plain(text),
        }
    }

    fn push_json(self, text: &mut String) {
        match self {
            Cell::Number(number) if !number.is_finite() => text.push_str("null"),
            Cell::Empty => text.push_str("null"),
            Cell::Text(word) => push_json_string(text, word),
            other => other.push_plain(text),
        }
    }
}

/// Writes a table row by row to a file (`-o`) or to standard output.
///
/// Rows of CSV and JSON leave as they come; an aligned table waits for its last row, to know its widths.
pub struct TableWriter {
    format: Format,
    columns: Vec<String>,
    sink: AtomicFile,
    line: String,
    rows: u64,
    waiting: Vec<Vec<String>>,
}

impl TableWriter {
    /// Begins a table; without `output` on standard output.
    ///
    /// # Errors
    ///
    /// The system's.
    pub fn create(output: Option<&Path>, format: Option<Format>, columns: &[&str]) -> io::Result<Self> {
        let format = Format::or_default(format, output);
        let mut sink = AtomicFile::create(output.unwrap_or(Path::new("-")))?;
        let mut line = String::new();
        match format {
            Format::Csv => {
                for (index, column) in columns.iter().enumerate() {
                    line.push_str(if index > 0 { "," } else { "" });
                    push_text(&mut line, column);
                }
                line.push('\n');
            }
            Format::Json => line.push('['),
            Format::Table => {}
        }
        sink.write_all(line.as_bytes())?;
        let columns = columns.iter().map(|column| (*column).to_string()).collect();
        Ok(TableWriter { format, columns, sink, line, rows: 0, waiting: Vec::new() })
    }

    /// One row, a cell for every column.
    ///
    /// # Errors
    ///
    /// The system's; `InvalidInput` where there are more or fewer cells than columns.
    pub fn row(&mut self, cells: &[Cell<'_>]) -> io::Result<()> {
        if cells.len() != self.columns.len() {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, "a row needs a cell for every column"));
        }
        self.line.clear();
        match self.format {
            Format::Csv => {
                for (index, cell) in cells.iter().enumerate() {
                    self.line.push_str(if index > 0 { "," } else { "" });
                    cell.push_csv(&mut self.line);
                }
                self.line.push('\n');
            }
            Format::Json => {
                self.line.push_str(if self.rows > 0 { ",\n " } else { "\n " });
                for (index, (column, cell)) in self.columns.iter().zip(cells).enumerate() {
                    self.line.push_str(if index > 0 { ", " } else { "{" });
                    push_json_string(&mut self.line, column);
                    self.line.push_str(": ");
                    cell.push_json(&mut self.line);
                }
                self.line.push('}');
            }
            Format::Table => {
                let cells = cells.iter().map(|cell| {
                    let mut text = String::new();
                    cell.push_plain(&mut text);
                    text
                });
                self.waiting.push(cells.collect());
            }
        }
        self.rows += 1;
        self.sink.write_all(self.line.as_bytes())
    }

    /// Ends the table.
    ///
    /// # Errors
    ///
    /// The system's.
    pub fn finish(mut self) -> io::Result<()> {
        match self.format {
            Format::Csv => {}
            Format::Json => self.sink.write_all(b"\n]\n")?,
            Format::Table => {
                self.waiting.insert(0, std::mem::take(&mut self.columns));
                let mut widths = vec![0; self.waiting.first().map_or(0, Vec::len)];
                for row in &self.waiting {
                    for (width, cell) in widths.iter_mut().zip(row) {
                        *width = cell.chars().count().max(*width);
                    }
                }
                for row in &self.waiting {
                    let cells: Vec<String> =
                        row.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
                    writeln!(self.sink, "{}", cells.join("  "))?;
                }
            }
        }
        self.sink.commit()
    }
}

/// A JSON string (RFC 8259 §7).
fn push_json_string(text: &mut String, word: &str) {
    text.push('"');
    for c in word.chars() {
        match c {
            '"' => text.push_str("\\\""),
            '\\' => text.push_str("\\\\"),
            '\n' => text.push_str("\\n"),
            '\t' => text.push_str("\\t"),
            c if u32::from(c) < 0x20 => text.push_str(&format!("\\u{:04x}", u32::from(c))),
            c => text.push(c),
        }
    }
    text.push('"');
}
