//! See `leafbrdf_fuzz::bands`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::bands(data));
