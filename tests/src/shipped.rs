//! The library as it is shipped: built once for all tests that look at it from outside.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// The project's root.
#[must_use]
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize().expect("the tests lie in the project")
}

/// What cargo is told to build the library: README's command.
pub const BUILD: &str = "build --release -p ofc-ffi";

/// The folder of `libofc.so`, and of the `libofc.a` that [`archive`] is made from.
///
/// # Panics
/// When they cannot be built.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let mut build = Command::new(cargo);
        // The folder is the default one, whatever the environment says.
        build.args(BUILD.split_whitespace()).args(["--quiet", "--target-dir", "target"]).current_dir(root());
        assert!(build.status().expect("cargo runs").success(), "cargo {BUILD}");
        root().join("target/release")
    })
}

/// The archive as it is installed: nothing but `ofc_*` is defined in it.
///
/// # Panics
/// When it cannot be made.
pub fn archive() -> &'static str {
    static ARCHIVE: OnceLock<String> = OnceLock::new();
    ARCHIVE.get_or_init(|| {
        let script = root().join("ofc-ffi/package/archive.sh").to_string_lossy().into_owned();
        let raw = folder().join("libofc.a").to_string_lossy().into_owned();
        let archive = root().join("target/shipped/libofc.a").to_string_lossy().into_owned();
        let _ = stdout(&script, &[&raw, &archive]);
        archive
    })
}

/// Runs a program and returns what it wrote, whatever its exit status.
///
/// # Panics
/// When it cannot be started.
pub fn run(program: &str, arguments: &[&str]) -> Output {
    Command::new(program).args(arguments).output().unwrap_or_else(|error| panic!("{program}: {error}"))
}

/// What a program that must succeed wrote to its standard output.
///
/// # Panics
/// When it fails.
#[must_use]
pub fn stdout(program: &str, arguments: &[&str]) -> String {
    let output = run(program, arguments);
    assert!(output.status.success(), "{program} {arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("text")
}

/// The names in the listing of `nm -C` that belong to panics, their messages or an unwinder.
///
#[must_use]
pub fn panic_machinery(listing: &str) -> Vec<&str> {
    const SIGNS: [&str; 8] = [
        "panic",
        "core::fmt",
        "unwrap_failed",
        "expect_failed",
        "_fail",
        "_Unwind_",
        "eh_personality",
        "unwind",
    ];
    listing.lines().filter(|line| SIGNS.iter().any(|sign| line.contains(sign))).collect()
}

/// The exported functions of ofc in the listing of `nm`.
#[must_use]
pub fn exports(listing: &str) -> Vec<&str> {
    listing
        .lines()
        .filter_map(|line| line.split_once(" T "))
        .map(|(_, name)| name)
        .filter(|name| name.starts_with("ofc_"))
        .collect()
}
