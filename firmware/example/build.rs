//! The measurement as a table in flash, and where a device's memory is.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    println!("cargo::rerun-if-changed=data/beech.csv");
    fs::write(out.join("measurement.rs"), table(Path::new("data/beech.csv"))).expect("OUT_DIR can be written");

    let target = env::var("TARGET").expect("cargo sets TARGET");
    let bare = env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    if bare {
        // thumbv8m.main-none-eabihf → memory/thumbv8m.main.x
        let map = format!("memory/{}.x", target.split('-').next().unwrap_or_default());
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

/// A wide measurement file (docs/formats.md) as Rust constants.
fn table(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let mut angles: [Vec<f32>; 3] = Default::default();
    let (mut wavelengths, mut values) = (Vec::<f32>::new(), Vec::<Vec<f32>>::new());
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let (name, cells) = line.split_once(',').expect("cells");
        let cells = cells.split(',').map(|cell| cell.parse().expect("a number")).collect();
        match name {
            "theta_s_deg" => angles[0] = cells,
            "theta_v_deg" => angles[1] = cells,
            "phi_v_deg" => angles[2] = cells,
            nm => {
                wavelengths.push(nm.parse().expect("a wavelength"));
                values.push(cells);
            }
        }
    }
    let [theta_s, theta_v, phi_v] = angles;
    let directions: Vec<[f32; 3]> = theta_s.iter().zip(&theta_v).zip(&phi_v).map(|((s, v), p)| [*s, *v, *p]).collect();
    let mut rust = String::new();
    let write = &mut rust;
    writeln!(write, "/// Number of directions.\npub const DIRECTIONS: usize = {};", directions.len()).unwrap();
    writeln!(write, "/// Number of wavelengths.\npub const BANDS: usize = {};", wavelengths.len()).unwrap();
    writeln!(write, "/// θ_s, θ_v, φ_v, degrees.\npub static DIRECTIONS_DEG: [[f32; 3]; DIRECTIONS] = {directions:?};")
        .unwrap();
    writeln!(write, "/// Wavelengths, nm.\npub static WAVELENGTHS_NM: [f32; BANDS] = {wavelengths:?};").unwrap();
    writeln!(write, "/// BRDF, sr⁻¹, band after band.\npub static BRDF: [[F32; DIRECTIONS]; BANDS] = [").unwrap();
    for band in values {
        let cells: Vec<String> = band.iter().map(|value| format!("F32({value:?})")).collect();
        writeln!(write, "[{}],", cells.join(", ")).unwrap();
    }
    writeln!(write, "];").unwrap();
    rust
}
