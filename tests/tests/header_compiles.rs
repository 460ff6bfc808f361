//! `include/ofc.h` alone compiles without a warning in every dialect that users have.

use ofc_tests::shipped::root;
use std::io::Write;
use std::process::{Command, Stdio};

const DIALECTS: [(&str, &str); 6] =
    [("gcc", "c99"), ("gcc", "c11"), ("gcc", "c17"), ("g++", "c++11"), ("g++", "c++17"), ("g++", "c++20")];

/// What users' builds are strict about; in C++ also casts of C, which the header's macros must do without.
const STRICT: [&str; 7] =
    ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Werror", "-fsyntax-only"];

/// What the compiler says of a source text; empty when it is content.
fn complaints(compiler: &str, dialect: &str, text: &str) -> String {
    let (language, more) = if compiler == "gcc" { ("c", "-Wcast-qual") } else { ("c++", "-Wold-style-cast") };
    let include = root().join("include");
    let mut process = Command::new(compiler)
        .args([&format!("-std={dialect}"), more, "-x", language])
        .args(STRICT)
        .arg("-I")
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
                static size_t buffer[OFC_SOLVE_WORKSPACE_SIZE(64, 48) / sizeof(size_t)];\n\
                ofc_status use(void);\n\
                ofc_status use(void) { buffer[0] = 1; ofc_solve_params p; return ofc_solve_params_default(&p); }\n";
    for (compiler, dialect) in DIALECTS {
        assert_eq!(complaints(compiler, dialect, text), "", "{compiler} -std={dialect}");
    }
}

/// The macros of the header, with how many parameters each has, if it has a list of them.
fn macros(header: &str) -> Vec<(&str, Option<usize>)> {
    let of_line = |line| {
        let rest = str::strip_prefix(line, "#define ")?;
        let name = rest.get(..rest.find(|c: char| !c.is_alphanumeric() && c != '_')?)?;
        let parameters = rest.strip_prefix(name)?.strip_prefix('(').and_then(|list| list.split_once(')'));
        Some((name, parameters.map(|(list, _)| list.split(',').count())))
    };
    header.lines().filter_map(of_line).collect()
}

/// A function that uses every macro: with numbers that the compiler knows, with sizes and with counts of 32 bits.
fn uses(macros: &[(&str, Option<usize>)]) -> String {
    let mut text = "#include <ofc.h>\nsize_t use(size_t size, int32_t count);\nsize_t use(size_t size, int32_t count) {\n\
                    size_t sum = size;\nsum += count > 0;\n"
        .to_owned();
    for (name, parameters) in macros {
        let mut with = |argument: &str| match parameters {
            None => text.extend(["{ const int32_t constant = ", name, "; sum += constant == count; }\n"]),
            Some(n) => text.extend(["sum += ", name, "(", &vec![argument; *n].join(", "), ");\n"]),
        };
        with("size");
        // These compare sizes, which is what a count becomes by OFC_SIZE.
        if !["OFC_LARGER", "OFC_SMALLER"].contains(name) {
            with("count");
            with("64");
        }
    }
    text + "return sum; }\n"
}

#[test]
fn every_macro_is_clean_in_strict_c_and_cpp() {
    let header = std::fs::read_to_string(root().join("include/ofc.h")).expect("the header");
    let macros = macros(&header);
    assert!(macros.iter().filter(|(_, parameters)| parameters.is_some()).count() > 15, "{macros:?}");
    for (compiler, dialect) in DIALECTS {
        assert_eq!(complaints(compiler, dialect, &uses(&macros)), "", "{compiler} -std={dialect}");
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
    let cast = "#include <ofc.h>\n#define OFC_CAST(x) ((size_t)(x))\n";
    assert_ne!(complaints("g++", "c++17", &(cast.to_owned() + &uses(&[("OFC_CAST", Some(1))]))), "");
    let sign = "#define OFC_SIGN(x) ((x) * sizeof(int))\n";
    assert_ne!(complaints("gcc", "c99", &(sign.to_owned() + &uses(&[("OFC_SIGN", Some(1))]))), "");
}
