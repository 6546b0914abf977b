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

/// What firmware/README.md shows is what c-example/run compiles and runs.
#[test]
fn the_readme_shows_the_quick_start_that_is_built() {
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("firmware");
    let read = |file: &str| std::fs::read_to_string(firmware.join(file)).expect("the file is there");
    assert!(read("README.md").contains(&format!("```c\n{}```", read("c-example/quick_start.c"))));
}

/// Every status and every function of the header is explained in firmware/README.md.
#[test]
fn the_readme_names_every_status_and_every_function() {
    let firmware = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("firmware");
    let read = |file: &str| std::fs::read_to_string(firmware.join(file)).expect("the file is there");
    let (header, readme) = (read("leafbrdf-c/include/leafbrdf.h"), read("README.md"));
    let words = header.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '(')).filter(|word| {
        word.starts_with("LB_ERR_") || *word == "LB_OK" || (word.starts_with("lb_") && word.contains('('))
    });
    let mut count = 0;
    for word in words {
        let name = word.split('(').next().unwrap_or_default();
        assert!(readme.contains(&format!("`{name}`")), "firmware/README.md does not name {name}");
        count += 1;
    }
    assert!(count > 25, "{count}");
}
