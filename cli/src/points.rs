//! Tables of inputs (`--points FILE`): named columns in any order, one evaluation a row.

use std::path::Path;

use csv::ByteRecord;

use crate::measurement::ReadError;
use crate::measurement::cell::{self, Cell, remedy, shown, trim};
use crate::measurement::input::{Source, at, decode, display_name, read_all};

/// A table of inputs, rows in the order of the file.
///
/// Columns are found by their exact names; others are there and do not disturb. `#` lines and blank lines are left
/// out. Plain or gzip, comma-separated.
///
/// ```
/// use leafbrdf::points::Points;
/// let points = Points::from_bytes("points.csv", b"n,comment,theta_deg\n1.5,a,0\n1.4,b,60\n")?;
/// let theta = points.require("theta_deg")?;
/// assert_eq!(points.number(1, theta)?, 60.0);
/// # Ok::<(), leafbrdf::measurement::ReadError>(())
/// ```
pub struct Points {
    file: String,
    text: String,
    names: Vec<String>,
    rows: Vec<ByteRecord>,
}

impl Points {
    /// Reads a table; `-` is standard input.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or is no text, a ragged row, a name that stands twice, no row.
    pub fn read(path: &Path) -> Result<Self, ReadError> {
        Points::from_bytes(&display_name(path), &read_all(path)?)
    }

    /// The same from a file's bytes; `file` is its name in messages.
    ///
    /// # Errors
    ///
    /// As [`Points::read`].
    pub fn from_bytes(file: &str, bytes: &[u8]) -> Result<Self, ReadError> {
        let text = decode(file, bytes)?.into_owned();
        let source = Source { name: file, text: &text };
        let mut records = source.records();
        let mut record = ByteRecord::new();
        if !source.next(&mut records, &mut record)? {
            return Err(ReadError::whole(file, "has no row: expected a row of column names, then one row a point"));
        }
        let names: Vec<String> = record.iter().map(|name| String::from_utf8_lossy(trim(name)).into_owned()).collect();
        if let [only] = names.as_slice()
            && let Some(separator) = only.chars().find(|c| matches!(c, ';' | '\t'))
        {
            let separator = if separator == ';' { "semicolons" } else { "tabs" };
            let message = format!(
                "found {}, separated by {separator}: export the file with commas between the cells and decimal points",
                shown(only.as_bytes())
            );
            return Err(source.error(at(&record), Some(1), message));
        }
        let mut rows = Vec::new();
        while source.next(&mut records, &mut record)? {
            let (found, width) = (record.len(), names.len());
            if found != width {
                let column = Some(found.min(width) + usize::from(found > width));
                let message = format!("{found} cells: expected {width}, as there are column names");
                return Err(source.error(at(&record), column, message));
            }
            rows.push(record.clone());
        }
        if rows.is_empty() {
            return Err(ReadError::whole(file, "has column names and no row below them: expected one row a point"));
        }
        Ok(Points { file: file.to_string(), text, names, rows })
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there is no row: never, a table without rows is refused.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Where the column is; `None` where there is none of this name.
    ///
    /// # Errors
    ///
    /// Two columns of this name.
    pub fn find(&self, name: &str) -> Result<Option<usize>, ReadError> {
        let mut places = self.names.iter().enumerate().filter(|(_, found)| *found == name);
        let first = places.next().map(|(index, _)| index);
        match places.next() {
            Some((again, _)) => Err(ReadError {
                line: Some(self.source().line(0)),
                column: Some(again + 1),
                ..ReadError::whole(&self.file, format!("a second column {name}: expected each name once"))
            }),
            None => Ok(first),
        }
    }

    /// Where the column is.
    ///
    /// # Errors
    ///
    /// No column, or two columns, of this name.
    pub fn require(&self, name: &str) -> Result<usize, ReadError> {
        self.find(name)?.ok_or_else(|| {
            let found = shown(self.names.join(", ").as_bytes());
            let message = format!("no column {name} (names are matched exactly): found {found}");
            ReadError { line: Some(self.source().line(0)), ..ReadError::whole(&self.file, message) }
        })
    }

    /// The number in a cell.
    ///
    /// # Errors
    ///
    /// Anything that is no finite number, an empty cell included.
    pub fn number(&self, row: usize, column: usize) -> Result<f64, ReadError> {
        let cell = self.cell(row, column);
        match cell::parse(cell) {
            Cell::Number(number) => Ok(number),
            _ => Err(self.error(row, column, &format!("expected a number{}", remedy(cell)))),
        }
    }

    /// The word in a cell, without blanks around it.
    pub fn text(&self, row: usize, column: usize) -> &str {
        std::str::from_utf8(trim(self.cell(row, column))).unwrap_or("")
    }

    /// What is wrong with a cell: file, line, column, what was found, and what was expected.
    pub fn error(&self, row: usize, column: usize, expected: &str) -> ReadError {
        let start = self.rows.get(row).map_or(0, at);
        ReadError {
            column_name: self.names.get(column).cloned(),
            ..self.source().error(
                start,
                Some(column + 1),
                format!("found {}: {expected}", shown(self.cell(row, column))),
            )
        }
    }

    fn cell(&self, row: usize, column: usize) -> &[u8] {
        self.rows.get(row).and_then(|record| record.get(column)).unwrap_or(b"")
    }

    fn source(&self) -> Source<'_> {
        Source { name: &self.file, text: &self.text }
    }
}
