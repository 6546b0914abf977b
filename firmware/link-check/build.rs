//! Tells the linker where flash and RAM are, on the device only.

fn main() {
    println!("cargo::rerun-if-changed=mps2-an386.ld");
    let for_device = std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    if for_device {
        let here = std::env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
        println!("cargo::rustc-link-arg-bins=-T{here}/mps2-an386.ld");
    }
}
