//! leafbrdf.h says what src/ says.

use std::path::Path;

/// The checked-in header is what cbindgen makes of the source. `LEAFBRDF_BLESS=1` writes it instead.
#[test]
fn the_header_is_generated_from_the_source() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("cbindgen.toml reads");
    let mut header = Vec::new();
    cbindgen::Builder::new()
        .with_crate(root)
        .with_config(config)
        .generate()
        .expect("the source reads")
        .write(&mut header);
    let header = String::from_utf8(header).expect("UTF-8");
    let path = root.join("include/leafbrdf.h");
    if std::env::var_os("LEAFBRDF_BLESS").is_some() {
        std::fs::write(&path, header).expect("the header can be written");
        return;
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == header, "include/leafbrdf.h is not what src/ says: LEAFBRDF_BLESS=1 cargo test -p leafbrdf-c");
}
