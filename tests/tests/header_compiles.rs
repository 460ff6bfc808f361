//! `include/ofc.h` alone compiles without a warning in every dialect that users have.

use ofc_tests::shipped::{root, run};

const DIALECTS: [(&str, &str); 6] =
    [("gcc", "c99"), ("gcc", "c11"), ("gcc", "c17"), ("g++", "c++11"), ("g++", "c++17"), ("g++", "c++20")];

/// What the compiler says of a source text; empty when it is content.
fn complaints(compiler: &str, dialect: &str, text: &str) -> String {
    let folder = std::env::temp_dir().join(format!("ofc-header-{}-{dialect}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the source");
    let source = folder.join(if compiler == "gcc" { "use.c" } else { "use.cpp" });
    std::fs::write(&source, text).expect("the source");
    let include = root().join("include");
    let output = run(
        compiler,
        &[
            &format!("-std={dialect}"),
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            "-fsyntax-only",
            "-I",
            &include.to_string_lossy(),
            &source.to_string_lossy(),
        ],
    );
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.success(), said.is_empty(), "{said}");
    std::fs::remove_dir_all(&folder).expect("the folder goes");
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
