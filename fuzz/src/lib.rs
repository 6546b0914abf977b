//! The laws that must hold on whatever input: one public function a fuzz target, taking any bytes and panicking where a
//! law is broken.
//!
//! `cargo fuzz run --features libfuzzer TARGET` (or `just fuzz`) looks for new input; `cargo test -p leafbrdf-fuzz`
//! replays the files in `corpus/`, the regressions among them, on stable Rust. Both call these functions.

mod bands;
mod dhrf;
mod extended;
mod gradient;
mod input;
mod mirror;
mod readers;
mod spectra;
mod surface;
mod whole;

pub use bands::bands;
pub use dhrf::dhrf;
pub use extended::extended;
pub use gradient::gradient;
pub use input::Input;
pub(crate) use mirror::{Counting, Mirror};
pub use readers::readers;
pub use spectra::spectra;
pub use surface::{surface_complex, surface_f32, surface_f64};
pub use whole::{leaf_fit, surface_fit};

/// A function that panics where its laws are broken on the bytes given.
pub type Target = fn(&[u8]);

/// Every target by its name, for the replay.
pub const TARGETS: &[(&str, Target)] = &[
    ("surface_f64", surface_f64),
    ("surface_f32", surface_f32),
    ("surface_complex", surface_complex),
    ("gradient", gradient),
    ("dhrf", dhrf),
    ("extended", extended),
    ("bands", bands),
    ("readers", readers),
    ("spectra", spectra),
    ("surface_fit", surface_fit),
    ("leaf_fit", leaf_fit),
];
