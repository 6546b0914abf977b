//! See `leafbrdf_fuzz::readers`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::readers(data));
