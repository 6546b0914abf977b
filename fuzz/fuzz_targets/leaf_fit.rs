//! See `leafbrdf_fuzz::leaf_fit`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| leafbrdf_fuzz::leaf_fit(data));
