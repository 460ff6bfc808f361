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
}
