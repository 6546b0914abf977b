//! What is wrong with a file, where, and what to do about it.

use std::fmt;

/// A file that cannot be read: its name, the place where there is one, what was found, what was expected.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError {
    /// The file's name as the user gave it; `standard input` for `-`.
    pub file: String,
    /// Line, counted from 1.
    pub line: Option<u64>,
    /// Cell in the line, counted from 1.
    pub column: Option<usize>,
    /// The column's name, where it has one.
    pub column_name: Option<String>,
    /// What was found, what was expected, and the remedy.
    pub message: String,
}

impl ReadError {
    pub(crate) fn whole(file: &str, message: impl Into<String>) -> Self {
        ReadError { file: file.to_string(), line: None, column: None, column_name: None, message: message.into() }
    }
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file)?;
        if let Some(line) = self.line {
            write!(f, ", line {line}")?;
        }
        if let Some(column) = self.column {
            write!(f, ", column {column}")?;
        }
        if let Some(name) = &self.column_name {
            write!(f, " ({name})")?;
        }
        write!(f, ": {}", self.message)
    }
}

impl std::error::Error for ReadError {}

/// A measurement that cannot be written in the form that was asked for, or a file that cannot be written.
#[derive(Debug)]
#[non_exhaustive]
pub enum WriteError {
    /// The form asked for cannot hold the measurement; says why and what to do.
    Unfit(String),
    /// The system's own error, with the file's name.
    Io {
        /// The file.
        file: String,
        /// What the system says.
        error: std::io::Error,
    },
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            WriteError::Unfit(why) => f.write_str(why),
            WriteError::Io { file, error } if file == "-" => write!(f, "standard output: cannot be written: {error}"),
            WriteError::Io { file, error } => write!(f, "{file}: cannot be written: {error}"),
        }
    }
}

impl std::error::Error for WriteError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            WriteError::Unfit(_) => None,
            WriteError::Io { error, .. } => Some(error),
        }
    }
}
