//! The shipped library holds no panic machinery and does not recurse; libraries that do are found out.
#![cfg(target_arch = "x86_64")]

use ofc_tests::call_graph::CallGraph;
use ofc_tests::shipped::{self, folder, panic_machinery, root};
use std::path::Path;

/// A library made of one of the files in `controls`, the way the shipped one is.
fn control(name: &str) -> String {
    let source = root().join("tests/controls").join(name).with_extension("rs");
    let library = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).with_extension("so");
    let (source, library) = (source.to_string_lossy().into_owned(), library.to_string_lossy().into_owned());
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let arguments = "--edition 2024 --crate-type cdylib -C opt-level=3 -C panic=abort -C lto=fat \
                     -C codegen-units=1 -C link-arg=-nostartfiles";
    let mut arguments: Vec<&str> = arguments.split_whitespace().collect();
    arguments.extend([source.as_str(), "-o", library.as_str()]);
    let _ = shipped::stdout(&rustc, &arguments);
    library
}

fn library() -> String {
    folder().join("libofc.so").to_string_lossy().into_owned()
}

#[test]
fn the_library_holds_no_panic_machinery() {
    let listing = shipped::stdout("nm", &["-C", &library()]);
    assert!(listing.contains("ofc_core::solve::solve"), "inner names have been stripped: {listing}");
    assert_eq!(panic_machinery(&listing), [""; 0]);
}

#[test]
fn the_library_does_not_recurse() {
    let graph = CallGraph::of(&library());
    assert!(graph.len() > 100, "{} functions", graph.len());
    assert_eq!(graph.unresolved, [""; 0]);
    assert_eq!(graph.recursive(), [""; 0]);
}

#[test]
fn a_library_that_can_panic_is_found_out() {
    let found = shipped::stdout("nm", &["-C", &control("panics")]);
    assert!(panic_machinery(&found).iter().any(|name| name.contains("panic_bounds_check")), "{found}");
}

#[test]
fn a_library_that_recurses_is_found_out() {
    let graph = CallGraph::of(&control("recursion"));
    let recursive = graph.recursive();
    for name in ["product", "is_even", "is_odd", "ofc_call_back"] {
        assert!(recursive.iter().any(|found| found.contains(name)), "{name} is not among {recursive:?}");
    }
    assert!(!recursive.contains(&"_init"), "{recursive:?}");
    let unresolved = |call: &String| call.starts_with("ofc_control: call");
    assert!(graph.unresolved.iter().any(unresolved), "{:?}", graph.unresolved);
}

#[test]
fn a_copied_address_is_known_only_while_its_register_holds_it() {
    let unresolved = |between: &str| {
        let code = format!(
            "0000000000001000 <f>:\n 1000:\tmov    0x100(%rip),%r15        # 2000 <memcpy>\n{between} 1030:\tmov    \
             %r15,%rbp\n 1040:\tcall   *%rbp\n"
        );
        CallGraph::read(&code, "2000 R_X86_64_GLOB_DAT  memcpy@GLIBC_2.14\n").unresolved
    };
    assert_eq!(unresolved(" 1010:\tmov    %r15d,%eax\n 1020:\tcall   1000 <f>\n"), [""; 0]);
    for written in [
        "mov    0x8(%rsp),%r15",
        "xor    %r15d,%r15d",
        "mov    0x8(%rip),%r15  # 3000 <x>",
        "pop    %r15",
        "jmp    1000 <f>",
    ] {
        assert_eq!(unresolved(&format!(" 1010:\t{written}\n")), ["f: call   *%rbp"], "{written}");
    }
}
