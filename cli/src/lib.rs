#![doc = include_str!("../README.md")]

pub mod demo;
pub mod fit;
pub mod measurement;
pub mod output;
pub mod points;
pub mod simulate;
