//! See `leafbrdf_fuzz::dhrf`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::dhrf(data));
