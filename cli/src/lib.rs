#![doc = include_str!("../README.md")]

pub mod demo;
pub mod fit;
pub mod hemisphere;
pub mod measurement;
pub mod output;
pub mod plot;
pub mod points;
pub mod recovery;
pub mod report;
pub mod simulate;
pub mod spectra;

/// The examples of the repository's README, as tests; the file is not part of the package.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct RepositoryReadme;
