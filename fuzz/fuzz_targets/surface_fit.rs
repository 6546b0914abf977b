//! See `leafbrdf_fuzz::surface_fit`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::surface_fit(data));
