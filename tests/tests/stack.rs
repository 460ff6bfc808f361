//! What `ofc.h` says of the stack is true of the shipped library, for every exported function and whatever its arguments are.
#![cfg(target_arch = "x86_64")]

use ofc_tests::shipped::{folder, root};
use ofc_tests::stack_depth;
use std::collections::BTreeMap;

/// "Stack: below 24 KiB.", of a call's own documentation: the number.
fn said(comment: &str) -> Option<u64> {
    let (_, rest) = comment.split_once("Stack: below ")?;
    rest.split_once(" KiB")?.0.parse().ok()
}

/// What the header says of all calls that say nothing else, and of those that take a stream.
fn general(header: &str) -> (u64, u64) {
    let (_, all) = header.split_once("/// - Stack: ").expect("a line on stack for all calls");
    let (_, streams) = header
        .split_once("every other one that takes a stream: below ")
        .expect("a line on stack for streams");
    let (_, joint) = streams.split_once("direct method, ").expect("a number for the joint method");
    let number = |text: &str| text.split_once(" KiB").and_then(|(number, _)| number.parse().ok());
    (said(&format!("Stack: {all}")).expect("a number"), number(joint).expect("a number"))
}

/// Each function and what it says of its stack, in KiB.
fn promises(header: &str) -> BTreeMap<String, Option<u64>> {
    let mut promises = BTreeMap::new();
    let mut comment = String::new();
    for line in header.lines() {
        if let Some(text) = line.strip_prefix("///") {
            comment.push_str(text);
            continue;
        }
        let name =
            line.split('(').next().and_then(|before| before.rsplit([' ', '*']).next()).unwrap_or_default();
        if !line.starts_with(['#', ' ', '/']) && line.contains('(') && name.starts_with("ofc_") {
            promises.insert(name.to_owned(), said(&comment));
        }
        comment.clear();
    }
    promises
}

#[test]
fn no_call_takes_more_than_the_header_says() {
    let header = std::fs::read_to_string(root().join("include/ofc.h")).expect("the header");
    let depths = stack_depth::of(&folder().join("libofc.so").to_string_lossy());
    let promises = promises(&header);
    assert!(promises.len() > 60, "{promises:?}");
    let (all, streams) = general(&header);
    let mut wrong = Vec::new();
    for (name, promise) in &promises {
        let depth = *depths.get(name).unwrap_or_else(|| panic!("{name} is not in the library"));
        println!("{depth:6} {name}");
        let limit = 1024 * promise.unwrap_or(if name.starts_with("ofc_stream_") { streams } else { all });
        // A number that is said of one call alone is near what it takes, not twice as much.
        let is_wrong = depth >= limit || (promise.is_some() && 2 * depth < limit);
        if is_wrong {
            wrong.push(format!("{name} takes {depth} bytes, and {limit} are said"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn promises_are_read() {
    let header = "/// One.\n///\n/// Stack: below 3 KiB.\nofc_status ofc_one(int32_t a,\n        int32_t b);\n\n/// Two.\nsize_t ofc_two(void);\n";
    let wanted = [("ofc_one".to_owned(), Some(3)), ("ofc_two".to_owned(), None)];
    assert_eq!(promises(header), BTreeMap::from(wanted));
}
