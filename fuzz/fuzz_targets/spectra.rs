//! See `leafbrdf_fuzz::spectra`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::spectra(data));
