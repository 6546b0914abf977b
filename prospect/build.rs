//! Turns the coefficient files of `data/` into constant tables, with the interface transmissivities worked out by the
//! same function that users call (`src/interface.rs`).

use std::fmt::Write as _;
use std::path::Path;
use std::{env, fs};

use leafbrdf_core::Portable;

#[path = "src/both.rs"]
mod both;
#[allow(dead_code, missing_docs)]
#[path = "src/interface.rs"]
mod interface;

/// Sine and cosine of 40°, the cone above the leaf.
const SIN_40: f64 = 0.642_787_609_686_539_4;
const COS_40: f64 = 0.766_044_443_118_978;

/// Bands of a complete table: 400–2500 nm at 1 nm.
const BANDS: usize = 2101;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/both.rs");
    println!("cargo::rerun-if-changed=src/interface.rs");
    let mut code = String::new();
    for (name, file, header) in [
        ("P5B", "data/prospect_5b.csv", "wavelength_nm,n,k_ab,k_car,k_brown,k_w,k_m"),
        ("PRO", "data/prospect_pro.csv", "wavelength_nm,n,k_ab,k_car,k_ant,k_brown,k_w,k_m,k_prot,k_cbc"),
    ] {
        println!("cargo::rerun-if-changed={file}");
        let text = fs::read_to_string(file).unwrap_or_else(|error| panic!("{file}: {error}"));
        table(&mut code, name, file, header, &text);
    }
    let out = env::var_os("OUT_DIR").expect("cargo sets OUT_DIR");
    fs::write(Path::new(&out).join("tables.rs"), code).expect("the table file is written");
}

/// Appends one constant: columns t_av(40°), t_av(90°), t_av(90°)/n², then the absorption coefficients.
fn table(code: &mut String, name: &str, file: &str, header: &str, text: &str) {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(lines.next(), Some(header), "{file}: unexpected columns");
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); header.split(',').count() + 1];
    for (row, line) in lines.enumerate() {
        let values: Vec<f64> =
            line.split(',').map(|cell| cell.parse().unwrap_or_else(|_| panic!("{file}, row {row}: {cell}"))).collect();
        let [wavelength, n, k @ ..] = values.as_slice() else { panic!("{file}, row {row}: too short") };
        assert_eq!(*wavelength, (400 + row) as f64, "{file}: wavelengths must be 400, 401, …");
        // plain arithmetic: the same tables wherever they are built
        let Portable(t_40) = interface::t_av_within(Portable(SIN_40), Portable(COS_40), Portable(*n));
        let Portable(t_90) = interface::t_av_within(Portable(1.0), Portable(0.0), Portable(*n));
        let computed = [t_40, t_90, t_90 / (n * n)];
        assert_eq!(computed.len() + k.len(), columns.len(), "{file}, row {row}: ragged");
        for (column, value) in columns.iter_mut().zip(computed.iter().chain(k)) {
            column.push(*value);
        }
    }
    let count = columns.len();
    writeln!(code, "pub(super) const {name}: &[[f64; {BANDS}]; {count}] = &[").expect("writing to a string");
    for column in &columns {
        assert_eq!(column.len(), BANDS, "{file}: number of rows");
        writeln!(code, "{column:?},").expect("writing to a string");
    }
    code.push_str("];\n");
}
