//! A program without a C library links the archive, and computes the bits that every target must compute.
//!
//! The program is that of `determinism/`, which calls every exported function; `determinism/run.sh` runs it elsewhere.
#![cfg(all(target_os = "linux", any(target_arch = "x86_64", target_arch = "aarch64")))]

use ofc_tests::shipped::{self, exports, folder, panic_machinery, root};
use std::path::Path;

/// The linked program.
fn program(name: &str, definitions: &[&str]) -> String {
    let root = root();
    let path = |relative: &str| root.join(relative).to_string_lossy().into_owned();
    let mut sources: Vec<String> = std::fs::read_dir(root.join("tests/determinism"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path().to_string_lossy().into_owned())
        .filter(|file| Path::new(file).extension().is_some_and(|extension| extension == "c"))
        .collect();
    sources.sort();
    sources.push(path("c_examples/firmware/board/memory.c"));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).to_string_lossy().into_owned();
    let include = format!("-I{}", path("include"));
    let board = format!("-I{}", path("c_examples/firmware/board"));
    let mut arguments =
        vec!["-std=c99", "-O2", "-ffreestanding", "-fno-stack-protector", "-ffp-contract=off"];
    arguments.extend(["-fno-tree-loop-distribute-patterns", "-nostdlib", "-static", "-no-pie"]);
    arguments.extend(["-Wl,--gc-sections", &include, &board]);
    arguments.extend(definitions);
    arguments.extend(sources.iter().map(String::as_str));
    arguments.extend([shipped::archive(), "-o", &program]);
    let _ = shipped::stdout("gcc", &arguments);
    program
}

fn digests() -> String {
    std::fs::read_to_string(root().join("tests/determinism/digests.txt")).expect("the digests")
}

#[test]
fn holds_every_function_and_no_panic_machinery() {
    let listing = shipped::stdout("nm", &["-C", &program("digests-linked", &[])]);
    let library = folder().join("libofc.so");
    let exported = shipped::stdout("nm", &["-D", &library.to_string_lossy()]);
    let linked = exports(&listing);
    let missing: Vec<_> = exports(&exported).into_iter().filter(|name| !linked.contains(name)).collect();
    assert!(linked.len() > 20, "{listing}");
    assert_eq!(missing, [""; 0]);
    assert_eq!(panic_machinery(&listing), [""; 0]);
    let undefined: Vec<_> = listing.lines().filter(|line| line.contains(" U ")).collect();
    assert_eq!(undefined, [""; 0]);
}

#[test]
fn computes_the_bits_that_every_target_computes() {
    assert_eq!(shipped::stdout(&program("digests-run", &[]), &[]), digests());
}

#[test]
fn a_digest_notices_one_bit() {
    let (flipped, expected) =
        (shipped::stdout(&program("digests-flipped", &["-DCONTROL=7"]), &[]), digests());
    assert_eq!(flipped.lines().count(), expected.lines().count());
    let equal: Vec<_> = flipped.lines().zip(expected.lines()).filter(|(a, b)| a == b).collect();
    assert_eq!(equal, [("done", "done")]);
}
