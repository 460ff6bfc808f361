//! `include/ofc.hpp`: clean in every dialect and compiler that users have, the bits of the calls of C, and views of `OpenCV`.

use ofc_tests::shipped::{self, root};
use std::path::Path;
use std::process::Output;

const STRICT: [&str; 10] = [
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wold-style-cast",
    "-Wconversion",
    "-Wsign-conversion",
    "-Wshadow",
    "-Wcast-qual",
    "-Wnon-virtual-dtor",
    "-Werror",
];

/// Compiles a source of `tests/cpp`, or any other.
fn compile(compiler: &str, dialect: &str, source: &Path, more: &[&str]) -> Output {
    let (dialect, include) = (format!("-std={dialect}"), format!("-I{}", root().join("include").display()));
    let source = source.to_string_lossy();
    let mut arguments =
        vec![dialect.as_str(), "-O1", &include, "-isystem", "/usr/include/opencv4", "-x", "c++", &source];
    arguments.extend(STRICT);
    arguments.extend(["-x", "none"]);
    arguments.extend(more);
    shipped::run(compiler, &arguments)
}

fn source(name: &str) -> std::path::PathBuf {
    root().join("tests/cpp").join(name)
}

/// Whether the program, linked as a user would link it, ends well.
fn passes(name: &str, more: &[&str]) {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name.replace('.', "-"));
    let program = program.to_string_lossy();
    let mut options = vec![shipped::archive(), "-Wl,--gc-sections", "-o", &program];
    options.extend(more);
    let output = compile("g++", "c++17", &source(name), &options);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = shipped::run(&program, &[]);
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn gives_the_bits_of_c_and_throws_its_errors() {
    passes("calls.cpp", &[]);
}

#[test]
fn sees_regions_masks_and_types_of_opencv() {
    passes("opencv.cpp", &["-lopencv_core"]);
}

#[test]
fn compiles_without_a_warning_in_every_dialect() {
    let header = root().join("include/ofc.hpp");
    for compiler in ["g++", "clang++"] {
        for dialect in ["c++17", "c++20"] {
            for (file, more) in [
                (&header, "-Wno-pragma-once-outside-header"),
                (&source("calls.cpp"), "-g0"),
                (&source("opencv.cpp"), "-g0"),
            ] {
                let output = compile(compiler, dialect, file, &["-fsyntax-only", more]);
                let said = String::from_utf8_lossy(&output.stderr);
                assert!(output.status.success() && said.is_empty(), "{compiler} {dialect}: {said}");
            }
        }
    }
}

#[test]
fn the_checks_can_fail() {
    let wrong = Path::new(env!("CARGO_TARGET_TMPDIR")).join("wrong.cpp");
    std::fs::write(&wrong, "#include <ofc.hpp>\nint main() { return (int)ofc::Workspace().bytes(); }\n")
        .expect("a file");
    for compiler in ["g++", "clang++"] {
        assert!(!compile(compiler, "c++17", &wrong, &["-fsyntax-only"]).status.success(), "{compiler}");
    }
}
