//! See `leafbrdf_fuzz::gradient`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::gradient(data));
