#![doc = include_str!("../README.md")]

pub mod measurement;
pub mod output;
