//! `include/ofc.h` is what cbindgen makes of `ofc-ffi` today.

use ofc_tests::header_text::header;
use std::path::Path;

/// What says where each declaration goes, and the macros that cbindgen cannot make from Rust.
fn template() -> String {
    include_str!("../../ofc-ffi/header.txt")
        .replace("@MAJOR@", env!("CARGO_PKG_VERSION_MAJOR"))
        .replace("@MINOR@", env!("CARGO_PKG_VERSION_MINOR"))
        .replace("@PATCH@", env!("CARGO_PKG_VERSION_PATCH"))
}

fn generated() -> String {
    let ffi = Path::new(env!("CARGO_MANIFEST_DIR")).join("../ofc-ffi");
    let config = cbindgen::Config::from_file(ffi.join("cbindgen.toml")).expect("cbindgen.toml");
    let bindings = cbindgen::Builder::new()
        .with_crate(&ffi)
        .with_config(config)
        .generate()
        .expect("cbindgen reads the crate");
    let mut text = Vec::new();
    bindings.write(&mut text);
    header(&template(), &String::from_utf8(text).expect("the header is UTF-8"))
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

/// What cbindgen writes of two constants, a struct and a function.
const OUTPUT: &str = "/// One.\n#define OFC_ONE 1\n\n/// Minus two.\n#define OFC_TWO -2\n\n/// A pair.\ntypedef struct ofc_pair {\n    \
                      /// First.\n    int32_t a;\n    /// Second.\n    int32_t bcd;\n} ofc_pair;\n\n/// Adds.\nint32_t \
                      ofc_add(const struct ofc_pair *pair);\n";

#[test]
fn declarations_come_where_the_template_says() {
    let expected = "typedef struct ofc_pair ofc_pair;\n/// Adds.\nint32_t ofc_add(const ofc_pair *pair);\n---\n\
                    #define OFC_ONE 1    ///< One.\n#define OFC_TWO (-2) ///< Minus two.\n/// A pair.\nstruct ofc_pair {\n    \
                    int32_t a;   ///< First.\n    int32_t bcd; ///< Second.\n};\n";
    assert_eq!(
        header("typedef struct ofc_pair ofc_pair;\n@ ofc_add\n---\n@ OFC_*\n@ ofc_pair\n", OUTPUT),
        expected
    );
}

#[test]
#[should_panic(expected = "no place for")]
fn a_declaration_without_a_place_is_found() {
    let _ = header("@ OFC_*\n@ ofc_pair\n", OUTPUT);
}

#[test]
#[should_panic(expected = "two places")]
fn a_declaration_with_two_places_is_found() {
    let _ = header("@ OFC_* OFC_ONE\n@ ofc_pair ofc_add\n", OUTPUT);
}

#[test]
#[should_panic(expected = "is not declared")]
fn a_place_without_a_declaration_is_found() {
    let _ = header("@ OFC_* ofc_pair ofc_add ofc_subtract\n", OUTPUT);
}
