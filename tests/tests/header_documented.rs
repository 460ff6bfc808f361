//! Everything in `include/ofc.h` and `include/ofc.hpp` is documented, as Doxygen sees it, and no comment names what is not
//! there.

use ofc_tests::shipped::root;
use std::collections::HashSet;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

/// For C: parameters and return values are documented too.
const OF_C: &str = "INPUT=ofc.h\nOPTIMIZE_OUTPUT_FOR_C=YES\nWARN_NO_PARAMDOC=YES\n";

/// For C++, where they are those of C.
const OF_CPP: &str = "INPUT=ofc.hpp\nPREDEFINED=OPENCV_CORE_HPP\nEXCLUDE_SYMBOLS=*detail*\n";

/// What Doxygen says of a header; empty when every macro, type, field and function is documented, and what the options ask for.
fn complaints(name: &str, header: &str, options: &str) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("doxygen").join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    let input = options.lines().next().and_then(|line| line.strip_prefix("INPUT=")).expect("a file first");
    std::fs::write(folder.join(input), header).expect("a file");
    let config = "QUIET=YES\nWARN_IF_UNDOCUMENTED=YES\nGENERATE_LATEX=NO\nSEARCHENGINE=NO\nHAVE_DOT=NO\n"
        .to_owned()
        + options;
    let mut process = Command::new("doxygen")
        .arg("-")
        .current_dir(&folder)
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap_or_else(|error| panic!("doxygen: {error}"));
    process.stdin.take().expect("a pipe").write_all(config.as_bytes()).expect("doxygen reads");
    let output = process.wait_with_output().expect("doxygen ends");
    assert!(output.status.success());
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn header() -> String {
    std::fs::read_to_string(root().join("include/ofc.h")).expect("the header")
}

fn header_of_cpp() -> String {
    std::fs::read_to_string(root().join("include/ofc.hpp")).expect("the header")
}

/// The names of this library in a text, `OFC_STATUS_*` among them.
fn names(text: &str) -> impl Iterator<Item = &str> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '*');
    // A pointer's star is none of its function's name.
    let words = words.map(|word| word.trim_start_matches('*'));
    words.filter(|word| word.starts_with("ofc_") || word.starts_with("OFC_"))
}

/// Names in comments that the code does not have.
fn strangers(header: &str) -> Vec<&str> {
    let comment = |line: &str| line.find("///").unwrap_or(line.len());
    let code: HashSet<&str> = header.lines().flat_map(|line| names(line.split_at(comment(line)).0)).collect();
    let comments = header.lines().flat_map(|line| names(line.split_at(comment(line)).1));
    let known = |name: &str| match name.strip_suffix('*') {
        Some(start) => code.iter().any(|word| word.starts_with(start)),
        None => code.contains(name),
    };
    comments.filter(|name| !known(name)).collect()
}

#[test]
fn doxygen_finds_everything_documented() {
    assert_eq!(complaints("header", &header(), OF_C), "");
    let cpp = header_of_cpp();
    assert_eq!(complaints("cpp", &cpp, OF_CPP), "");
    for piece in [
        "    /// A view to write through.\n",
        "/// The normals as CV_32FC3 in the order x, y, z; zero where there is none.\n",
    ] {
        assert_ne!(complaints("cpp-without", &cpp.replacen(piece, "", 1), OF_CPP), "", "{piece}");
    }
}

#[test]
fn comments_name_what_is_there() {
    assert_eq!(strangers(&header()), [""; 0]);
    // What the comments of the header for C++ name is in either of them.
    assert_eq!(strangers(&(header() + &header_of_cpp())), [""; 0]);
}

#[test]
fn what_is_not_documented_is_found() {
    let whole = "/// @file\n/// A header.\n\n/// A macro.\n#define OFC_MACRO 1\n\n/// A struct.\ntypedef struct ofc_struct {\n    \
                 int field; ///< A field.\n} ofc_struct;\n\n/// A type.\ntypedef int ofc_type;\n\n/// A function.\n/// @param \
                 first  One.\n/// @param second,third  Two.\n/// @return A number.\nint ofc_function(int first, int second, \
                 ofc_type third);\n";
    assert_eq!(complaints("whole", whole, OF_C), "");
    let pieces = [
        "/// A macro.\n",
        "/// A struct.\n",
        " ///< A field.",
        "/// A type.\n",
        "/// @param first  One.\n",
        ",third",
    ];
    for (i, piece) in pieces.into_iter().chain(["/// @return A number.\n"]).enumerate() {
        let without = whole.replacen(piece, "", 1);
        assert_ne!(complaints(&format!("without-{i}"), &without, OF_C), "", "{piece}");
    }
}

#[test]
fn names_that_are_not_there_are_found() {
    let text = "/// One of OFC_A_*, or ofc_gone(), or OFC_B_*.\n#define OFC_A_ONE 1 ///< Not OFC_A_TWO.\n";
    assert_eq!(strangers(text), ["ofc_gone", "OFC_B_*", "OFC_A_TWO"]);
}
