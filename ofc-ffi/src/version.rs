//! The version, from Cargo.toml at compile time; the header's macros come from there too.

use core::ffi::{CStr, c_char};

const fn number(digits: &str) -> u32 {
    let mut value = 0;
    let mut rest = digits.as_bytes();
    while let [digit, tail @ ..] = rest {
        value = value * 10 + (*digit - b'0') as u32;
        rest = tail;
    }
    value
}

const VERSION: u32 = number(env!("CARGO_PKG_VERSION_MAJOR")) * 10_000
    + number(env!("CARGO_PKG_VERSION_MINOR")) * 100
    + number(env!("CARGO_PKG_VERSION_PATCH"));

/// Says the version of the library that is running, to be compared with OFC_VERSION.
/// @return major * 10000 + minor * 100 + patch.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_version() -> u32 {
    VERSION
}

/// Says the version of the library that is running as text.
/// @return The version in static storage, such as "0.2.0".
#[unsafe(no_mangle)]
pub extern "C" fn ofc_version_string() -> *const c_char {
    const TEXT: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(text) => text,
        Err(_) => c"",
    };
    TEXT.as_ptr()
}
