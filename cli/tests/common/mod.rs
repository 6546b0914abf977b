//! The program as tests run it, and what they read of it.

// each test binary takes what it needs
#![allow(dead_code)]

use std::collections::HashMap;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use leafbrdf::points::Points;

/// The program, run to its end.
pub fn leafbrdf(arguments: &[&str]) -> Output {
    leafbrdf_with(arguments, "")
}

/// The same with something on standard input.
pub fn leafbrdf_with(arguments: &[&str], input: impl AsRef<[u8]>) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_leafbrdf"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.as_ref().to_vec();
    let writer = std::thread::spawn(move || stdin.write_all(&input));
    let output = child.wait_with_output().unwrap();
    // A command that does not read its input closes it early.
    let _ = writer.join();
    output
}

/// The same in a folder.
pub fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_leafbrdf")).current_dir(folder).args(arguments).output().unwrap()
}

/// What was said on standard error.
pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// The table that a successful run prints.
#[track_caller]
pub fn table_with(arguments: &[&str], input: impl AsRef<[u8]>) -> Points {
    let output = leafbrdf_with(arguments, input);
    assert!(output.status.success(), "{arguments:?}: {}", stderr(&output));
    Points::from_bytes("output", &output.stdout).unwrap()
}

/// The run ends with this status and a message on standard error that has these parts.
#[track_caller]
pub fn fails(arguments: &[&str], input: impl AsRef<[u8]>, status: i32, parts: &[&str]) {
    let output = leafbrdf_with(arguments, input);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(status), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?}: no results are printed on failure");
    for part in parts {
        assert!(message.contains(part), "{arguments:?}: no {part:?} in: {message}");
    }
}

/// The rows of a CSV file as maps from column to cell.
pub fn rows(path: &Path) -> Vec<HashMap<String, String>> {
    csv::Reader::from_path(path).unwrap().deserialize().collect::<Result<_, _>>().unwrap()
}

/// A cell that holds a number.
#[track_caller]
pub fn number(row: &HashMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column}: {:?}", row[column]))
}
