//! A simulated measurement of a beech leaf: 41 directions, 8 wavelengths, noise of an instrument.
//!
//! `data/beech.csv`, written by the project's own `leafbrdf simulate` (its header says with what) and turned into tables by `build.rs`.

use leafbrdf_core::real::device::F32;

include!(concat!(env!("OUT_DIR"), "/measurement.rs"));
