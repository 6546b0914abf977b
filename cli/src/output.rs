//! Results: tables of named columns as CSV, JSON or aligned text, and files that are written whole or not at all.

mod atomic;
mod number;
mod table;

pub use atomic::{AtomicFile, file_name};
pub use number::{push_number, push_text};
pub use table::{Cell, Format, TableWriter};
