//! See `leafbrdf_fuzz::extended`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::extended(data));
