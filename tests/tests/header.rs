//! `include/ofc.h` is what cbindgen makes of `ofc-ffi` today.

use std::path::Path;

/// What the header says before its first declaration: the manual's first page, and the macros that cbindgen cannot
/// make from Rust.
fn preamble() -> String {
    include_str!("../../ofc-ffi/header.txt")
        .replace("@MAJOR@", env!("CARGO_PKG_VERSION_MAJOR"))
        .replace("@MINOR@", env!("CARGO_PKG_VERSION_MINOR"))
        .replace("@PATCH@", env!("CARGO_PKG_VERSION_PATCH"))
}

fn generated() -> String {
    let ffi = Path::new(env!("CARGO_MANIFEST_DIR")).join("../ofc-ffi");
    let mut config = cbindgen::Config::from_file(ffi.join("cbindgen.toml")).expect("cbindgen.toml");
    config.after_includes = Some(preamble());
    let bindings = cbindgen::Builder::new()
        .with_crate(&ffi)
        .with_config(config)
        .generate()
        .expect("cbindgen reads the crate");
    let mut text = Vec::new();
    bindings.write(&mut text);
    String::from_utf8(text).expect("the header is UTF-8")
}

#[test]
fn the_header_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../include/ofc.h");
    let generated = generated();
    if std::env::var_os("OFC_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&path, &generated).expect("the header can be written");
        return;
    }
    let checked_in = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        checked_in == generated,
        "include/ofc.h has drifted from ofc-ffi: OFC_BLESS=1 cargo test -p ofc-tests --test header"
    );
}
