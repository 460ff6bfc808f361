//! `include/ofc.h` alone compiles without a warning in every dialect that users have.

use ofc_tests::shipped::root;
use std::io::Write;
use std::process::{Command, Stdio};

const DIALECTS: [(&str, &str); 6] =
    [("gcc", "c99"), ("gcc", "c11"), ("gcc", "c17"), ("g++", "c++11"), ("g++", "c++17"), ("g++", "c++20")];

/// What the compiler says of a source text; empty when it is content.
fn complaints(compiler: &str, dialect: &str, text: &str) -> String {
    let language = if compiler == "gcc" { "c" } else { "c++" };
    let include = root().join("include");
    let mut process = Command::new(compiler)
        .args([&format!("-std={dialect}"), "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"])
        .args(["-x", language, "-I"])
        .arg(include)
        .arg("-")
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("{compiler}: {error}"));
    process.stdin.take().expect("a pipe").write_all(text.as_bytes()).expect("the compiler reads");
    let output = process.wait_with_output().expect("the compiler ends");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.success(), said.is_empty(), "{said}");
    said
}

#[test]
fn alone_in_every_dialect() {
    let text = "#include <ofc.h>\n#include <ofc.h>\n\
                static size_t room[OFC_SOLVE_WORKSPACE_SIZE(64, 48) / sizeof(size_t)];\n\
                size_t use(void);\n\
                size_t use(void) { ofc_solve_params p; return sizeof room + (size_t)ofc_solve_params_default(&p); }\n";
    for (compiler, dialect) in DIALECTS {
        assert_eq!(complaints(compiler, dialect, text), "", "{compiler} -std={dialect}");
    }
}

#[test]
fn the_check_can_fail() {
    for (compiler, dialect) in DIALECTS {
        assert_ne!(
            complaints(compiler, dialect, "#include <ofc.h>\nint use(int unused) { return ofc_nothing; }\n"),
            ""
        );
    }
}
