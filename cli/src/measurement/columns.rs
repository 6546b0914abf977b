//! Columns by name, in any order: the rules of the first row, and of the rows under it.

use csv::ByteRecord;

use super::ReadError;
use super::cell::trim;
use super::input::{Source, at};

/// The row of names.
pub(crate) struct Names<'a> {
    source: Source<'a>,
    record: &'a ByteRecord,
    /// Without the blanks around them.
    pub names: Vec<&'a [u8]>,
}

impl<'a> Names<'a> {
    pub fn new(source: Source<'a>, record: &'a ByteRecord) -> Self {
        Names { source, record, names: record.iter().map(trim).collect() }
    }

    /// The column of exactly this name, if there is one.
    pub fn find(&self, name: &str) -> Result<Option<usize>, ReadError> {
        let mut places = self.names.iter().enumerate().filter(|(_, found)| **found == name.as_bytes());
        let first = places.next().map(|(index, _)| index);
        match places.next() {
            Some((again, _)) => {
                let message = format!("a second column {name}: expected each name once");
                Err(self.source.error(at(self.record), Some(again + 1), message))
            }
            None => Ok(first),
        }
    }

    /// What is wrong with the row as a whole.
    pub fn error(&self, message: String) -> ReadError {
        self.source.error(at(self.record), None, message)
    }
}

/// A row under the names has as many cells as they are.
pub(crate) fn same_width(source: Source<'_>, record: &ByteRecord, width: usize) -> Result<(), ReadError> {
    let found = record.len();
    if found == width {
        return Ok(());
    }
    let message = format!("{found} cells: expected {width}, as there are column names");
    Err(source.error(at(record), Some(found.min(width) + usize::from(found > width)), message))
}

/// What is wrong with one cell (columns are counted from 0 here).
pub(crate) fn wrong_cell(source: Source<'_>, record: &ByteRecord, column: usize, name: &str, why: String) -> ReadError {
    ReadError { column_name: Some(name.to_string()), ..source.error(at(record), Some(column + 1), why) }
}
