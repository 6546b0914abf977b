#![doc = include_str!("../README.md")]

pub mod fit;
pub mod measurement;
pub mod output;
pub mod points;
