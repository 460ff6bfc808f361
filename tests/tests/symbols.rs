//! What the shared library exports and needs, and that the contract tests call all of it.

use std::collections::HashSet;

use ofc_tests::shipped::{self, folder, root};

/// What a shared library may need: memory moved by the C library, and the weak hooks of the compiler's start-up files.
const MAY_NEED: [&str; 9] = [
    "memcpy",
    "memmove",
    "memset",
    "memcmp",
    "bcmp",
    "__gmon_start__",
    "__cxa_finalize",
    "_ITM_deregisterTMCloneTable",
    "_ITM_registerTMCloneTable",
];

/// The names in the listing of `nm -D` whose type is one of `kinds`.
fn names<'a>(listing: &'a str, kinds: &[&str]) -> Vec<&'a str> {
    let of_line = |line: &'a str| {
        let mut words = line.split_whitespace().rev();
        let (name, kind) = (words.next()?, words.next()?);
        kinds.contains(&kind).then(|| name.split('@').next().unwrap_or(name))
    };
    listing.lines().filter_map(of_line).collect()
}

fn foreign_exports(listing: &str) -> Vec<&str> {
    let exports = names(listing, &["T", "D", "B", "R", "W", "V", "i"]);
    exports.into_iter().filter(|name| !name.starts_with("ofc_")).collect()
}

fn surprising_needs(listing: &str) -> Vec<&str> {
    names(listing, &["U", "w", "v"]).into_iter().filter(|name| !MAY_NEED.contains(name)).collect()
}

fn never_called<'a>(listing: &'a str, sources: &str) -> Vec<&'a str> {
    // A call, or an entry in a table of calls.
    let words: HashSet<&str> = sources.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    names(listing, &["T"]).into_iter().filter(|name| !words.contains(name)).collect()
}

fn listing() -> String {
    shipped::stdout("nm", &["-D", &folder().join("libofc.so").to_string_lossy()])
}

fn contract_tests() -> String {
    let files = std::fs::read_dir(root().join("tests/c")).expect("tests/c");
    files.map(|file| std::fs::read_to_string(file.expect("an entry").path()).expect("a source")).collect()
}

#[test]
fn exports_only_ofc_and_needs_no_allocator() {
    let listing = listing();
    assert!(names(&listing, &["T"]).len() > 20, "{listing}");
    assert_eq!(foreign_exports(&listing), [""; 0]);
    assert_eq!(surprising_needs(&listing), [""; 0]);
}

/// What belongs to the standard library or to an allocator.
fn of_std(listing: &str) -> Vec<&str> {
    const SIGNS: [&str; 4] = ["std::", "alloc::", "__rust", "__rg_"];
    listing.lines().filter(|line| SIGNS.iter().any(|sign| line.contains(sign))).collect()
}

#[test]
fn holds_nothing_of_the_standard_library() {
    let listing = shipped::stdout("nm", &["-C", &folder().join("libofc.so").to_string_lossy()]);
    assert!(listing.contains("ofc_core::solve::solve"), "inner names have been stripped: {listing}");
    assert_eq!(of_std(&listing), [""; 0]);
}

/// Whether a text says how to build the library, and says it as the tests do.
fn builds_what_is_tested(text: &str) -> bool {
    let mut commands =
        text.match_indices("cargo build").map(|(start, _)| text[start..].lines().next().unwrap_or_default());
    let shipped = format!("cargo {}", shipped::BUILD);
    let rest = |command: &str| command.strip_prefix(&shipped).map(|rest| rest.trim().to_owned());
    let same = |command: &str| matches!(rest(command).as_deref(), Some("" | "--quiet --target-dir target"));
    commands.clone().count() > 0 && commands.all(same)
}

#[test]
fn what_is_built_by_hand_is_what_is_tested() {
    for file in ["README.md", "tests/CMakeLists.txt", "c_examples/CMakeLists.txt"] {
        let text = std::fs::read_to_string(root().join(file)).expect("a file of the project");
        assert!(builds_what_is_tested(&text), "{file}");
    }
}

#[test]
fn every_export_has_a_contract_test() {
    assert_eq!(never_called(&listing(), &contract_tests()), [""; 0]);
}

#[test]
fn depends_on_no_library_and_says_its_version() {
    let headers = shipped::stdout("objdump", &["-p", &folder().join("libofc.so").to_string_lossy()]);
    assert!(!headers.contains("NEEDED"), "{headers}");
    let (major, minor) = (env!("CARGO_PKG_VERSION_MAJOR"), env!("CARGO_PKG_VERSION_MINOR"));
    let version = if major == "0" { format!("0.{minor}") } else { major.to_owned() };
    let soname = headers.lines().find(|line| line.contains("SONAME")).unwrap_or_default();
    assert!(soname.ends_with(&format!(" libofc.so.{version}")), "{soname}");
}

#[test]
fn the_checks_can_fail() {
    let listing =
        "                 U malloc@GLIBC_2.2.5\n00001000 T ofc_new\n00002000 T other\n  w __gmon_start__\n";
    assert_eq!(surprising_needs(listing), ["malloc"]);
    assert_eq!(foreign_exports(listing), ["other"]);
    assert_eq!(never_called(listing, "ofc_old(); ofc_new_and_better();"), ["ofc_new", "other"]);
    assert_eq!(of_std("1000 t std::io::Write\n2000 T __rustc::__rust_alloc\n3000 t core::cmp\n").len(), 2);
    assert!(!builds_what_is_tested("make"));
    assert!(!builds_what_is_tested("cargo build --release -p ofc-ffi\ncargo build -p ofc-ffi --features x"));
}
