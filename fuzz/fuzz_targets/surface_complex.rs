//! See `leafbrdf_fuzz::surface_complex`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::surface_complex(data));
