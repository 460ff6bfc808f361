//! What the shared library exports and needs, and that the contract tests and the fuzz targets call all of it.

use std::collections::HashSet;
use std::path::Path;

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

/// The C sources of a folder of the tests.
fn sources(folder: &str) -> String {
    let files = std::fs::read_dir(root().join("tests").join(folder)).expect("a folder");
    let paths = files.map(|file| file.expect("an entry").path());
    let sources = paths.filter(|path| path.extension().is_some_and(|extension| extension == "c"));
    sources.map(|path| std::fs::read_to_string(path).expect("a source")).collect()
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
    commands.clone().count() > 0 && commands.all(|command| rest(command).as_deref() == Some(""))
}

#[test]
fn what_is_built_by_hand_is_what_is_tested() {
    let text = |file: &str| std::fs::read_to_string(root().join(file)).expect("a file of the project");
    assert!(builds_what_is_tested(&text("README.md")));
    // CMake says the same in its own words, and no other file of it calls cargo.
    let cmake = text("CMakeLists.txt");
    assert!(cmake.contains(
        "build --profile \"${OFC_CARGO_PROFILE}\" -p ofc-ffi --quiet --target-dir target ${ofc_cargo_options}"
    ));
    assert!(
        cmake.contains("set(OFC_CARGO_PROFILE release CACHE")
            && cmake.contains("set(OFC_CARGO_OPTIONS \"\" CACHE")
    );
    for file in ["tests/CMakeLists.txt", "c_examples/CMakeLists.txt"] {
        assert!(!text(file).contains("cargo"), "{file}");
    }
}

/// The archive as cargo makes it.
fn raw_archive() -> String {
    folder().join("libofc.a").to_string_lossy().into_owned()
}

#[test]
fn the_archive_defines_only_ofc_and_all_of_it() {
    let listing = shipped::stdout("nm", &["-g", shipped::archive()]);
    assert_eq!(foreign_exports(&listing), [""; 0]);
    assert_eq!(surprising_needs(&listing), [""; 0]);
    let (mut archived, exported) = (names(&listing, &["T"]), self::listing());
    archived.sort_unstable();
    assert_eq!(archived, names(&exported, &["T"]));
    // What cargo makes is another thing.
    assert_ne!(foreign_exports(&shipped::stdout("nm", &["-g", &raw_archive()])), [""; 0]);
}

/// The listing of a program of these sources, linked with these archives and options in this order.
fn linked(name: &str, source: &str, with: &[&str]) -> Result<String, String> {
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (file, program) = (scratch.join(name).with_extension("c"), scratch.join(name));
    std::fs::write(&file, source).expect("a source");
    let (file, program) = (file.to_string_lossy().into_owned(), program.to_string_lossy().into_owned());
    let include = format!("-I{}", root().join("include").display());
    let mut arguments = vec!["-O0", "-fno-builtin", "-rdynamic", &include, &file];
    arguments.extend(with);
    arguments.extend(["-o", &program]);
    let output = shipped::run("gcc", &arguments);
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    Ok(shipped::stdout("nm", &[&program]))
}

#[test]
fn the_programs_own_mathematics_stays_that_of_the_c_library() {
    const FUNCTIONS: [&str; 4] = ["cbrt", "fma", "fmod", "rintf"];
    let source = "#include <math.h>\n#include <ofc.h>\nint main(int count, char **arguments) {\n\
                  (void)arguments;\ndouble x = count;\n\
                  return (int)(cbrt(x) + fma(x, x, x) + fmod(x, 3) + rintf((float)x)) + (int)ofc_version();\n}\n";
    let own = |listing: &str| {
        let needed = names(listing, &["U"]);
        FUNCTIONS.iter().filter(|function| !needed.contains(function)).count()
    };
    assert_eq!(own(&linked("mathematics", source, &[shipped::archive(), "-lm"]).expect("a program")), 0);
    let raw = linked("mathematics-raw", source, &[&raw_archive(), "-lm"]).expect("a program");
    assert_eq!(own(&raw), FUNCTIONS.len(), "{raw}");
}

/// A Rust library of somebody else that has the standard library, as an archive.
fn other_library() -> String {
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (source, archive) = (scratch.join("other.rs"), scratch.join("libother.a"));
    std::fs::write(
        &source,
        "#[unsafe(no_mangle)]\npub extern \"C\" fn other_sum(n: u32) -> u64 {\n\
         let all: Vec<u64> = (0..u64::from(n)).collect();\nprintln!(\"{}\", all.len());\nall.iter().sum()\n}\n",
    )
    .expect("a source");
    let (source, archive) = (source.to_string_lossy().into_owned(), archive.to_string_lossy().into_owned());
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let options = ["--edition", "2024", "--crate-type", "staticlib", "-O", &source, "-o", &archive];
    let _ = shipped::stdout(&rustc, &options);
    archive
}

#[test]
fn the_whole_archive_links_beside_another_rust_library() {
    let source = "#include <ofc.h>\nunsigned long long other_sum(unsigned n);\n\
                  int main(void) { return (int)other_sum(10) + (int)ofc_version(); }\n";
    let other = other_library();
    let both = |name: &str, archive: &str| {
        linked(name, source, &["-Wl,--whole-archive", archive, &other, "-Wl,--no-whole-archive", "-lm"])
    };
    let listing = both("both", shipped::archive()).expect("a program");
    assert!(names(&listing, &["T"]).contains(&"ofc_solve") && names(&listing, &["T"]).contains(&"other_sum"));
    let raw = both("both-raw", &raw_archive()).expect_err("twice the same runtime");
    assert!(raw.contains("multiple definition"), "{raw}");
}

#[test]
fn a_program_takes_from_the_archive_only_what_it_calls() {
    let source = "#include <ofc.h>\nint main(void) { return (int)ofc_version(); }\n";
    let gc = "-Wl,--gc-sections";
    let one =
        linked("version", source, &[shipped::archive(), gc, "-Wl,--no-export-dynamic"]).expect("a program");
    assert_eq!(one.lines().filter(|line| line.contains("ofc")).count(), 1, "{one}");
    let all = linked("version-all", source, &[shipped::archive()]).expect("a program");
    assert!(all.lines().filter(|line| line.contains("ofc")).count() > 100, "{all}");
}

#[test]
fn every_export_has_a_contract_test_and_is_fuzzed() {
    for folder in ["c", "fuzz"] {
        assert_eq!(never_called(&listing(), &sources(folder)), [""; 0], "tests/{folder}");
    }
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
