//! Where a device's memory is: the maps of the example firmware.

use std::path::PathBuf;
use std::{env, fs};

fn main() {
    let target = env::var("TARGET").expect("cargo sets TARGET");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
        // thumbv8m.main-none-eabihf → thumbv8m.main.x
        let map = format!("../example/memory/{}.x", target.split('-').next().unwrap_or_default());
        println!("cargo::rerun-if-changed={map}");
        fs::copy(&map, out.join("memory.x")).unwrap_or_else(|error| panic!("{map}: {error}"));
        println!("cargo::rustc-link-search={}", out.display());
        // cortex-m-rt's script includes it, riscv-rt's does not
        if target.starts_with("riscv") {
            println!("cargo::rustc-link-arg-bins=-Tmemory.x");
        }
        println!("cargo::rustc-link-arg-bins=-Tlink.x");
    }
}
