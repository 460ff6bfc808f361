//! How much stack the functions of a linked x86-64 library can take at most, read from its disassembly.
//!
//! A frame is what a function pushes and takes off the stack pointer, all of it at once; how deep a function reaches is its
//! frame and the deepest of the functions that it may call. Whatever the arguments are, a call takes no more, but for what
//! functions of other libraries take, which for this one are those that copy and clear memory.

use crate::call_graph::{CallGraph, header, hexadecimal};
use crate::shipped;
use std::collections::BTreeMap;

/// The bytes of stack that each exported function reaches down to, without the address that its own call pushes.
///
/// # Panics
/// When the disassembler fails, and of a library that recurses or makes calls whose target is not known.
#[must_use]
pub fn of(library: &str) -> BTreeMap<String, u64> {
    let graph = CallGraph::of(library);
    assert!(graph.recursive().is_empty() && graph.unresolved.is_empty(), "stack without a bound: {graph:?}");
    let frames = frames(&shipped::stdout("objdump", &["-d", "--no-show-raw-insn", library]));
    let mut depths = BTreeMap::new();
    while depths.len() < graph.names.len() {
        for address in
            graph.names.keys().filter(|address| !depths.contains_key(*address)).copied().collect::<Vec<_>>()
        {
            let callees = graph
                .calls
                .get(&address)
                .into_iter()
                .flatten()
                .filter(|callee| graph.names.contains_key(callee));
            if let Some(below) = callees.map(|callee| depths.get(callee)).collect::<Option<Vec<&u64>>>() {
                let deepest = below.into_iter().map(|depth| depth + RETURN_ADDRESS).max().unwrap_or(0);
                depths.insert(address, frames.get(&address).unwrap_or(&0) + deepest);
            }
        }
    }
    // Functions of the same code have one address and several names, of which the disassembler prints one.
    let listing = shipped::stdout("nm", &["-D", "--defined-only", library]);
    let exported = listing.lines().filter_map(|line| {
        let (address, name) = line.split_once(" T ")?;
        Some((name.split('@').next()?.to_owned(), *depths.get(&hexadecimal(address)?)?))
    });
    exported.collect()
}

/// What a call pushes.
const RETURN_ADDRESS: u64 = 8;

/// What is touched at once where a large frame is taken page by page.
const PAGE: u64 = 4096;

/// The frame of each function in the text of `objdump -d --no-show-raw-insn`.
fn frames(code: &str) -> BTreeMap<u64, u64> {
    let mut frames = BTreeMap::new();
    let mut function = 0;
    for line in code.lines() {
        if let Some((address, _)) = header(line) {
            function = address;
        } else if let Some((_, instruction)) = line.split_once(":\t") {
            *frames.entry(function).or_default() += taken(instruction.trim());
        }
    }
    frames
}

/// What one instruction takes from the stack.
fn taken(instruction: &str) -> u64 {
    let (operation, operands) = instruction.split_once(' ').unwrap_or((instruction, ""));
    let operands = operands.trim();
    let constant =
        || operands.strip_prefix("$0x").and_then(|rest| rest.strip_suffix(",%rsp")).and_then(hexadecimal);
    match operation {
        "push" => 8,
        "sub" => constant().unwrap_or(0),
        // 128 is subtracted so: it is shorter.
        "add" => constant().map_or(0, |number| (number as i64).min(0).unsigned_abs()),
        // Where a loop is to end that takes page by page; the page that it subtracts is counted as well.
        "lea" => operands
            .strip_prefix("-0x")
            .and_then(|rest| rest.strip_suffix("(%rsp),%r11"))
            .and_then(hexadecimal)
            // An address below the stack pointer that is less than a page away is no such end.
            .map_or(0, |number| number.saturating_sub(PAGE)),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_every_kind() {
        let code = "0000000000001000 <f>:\n    1000:\tpush   %rbp\n    1001:\tsub    $0x28,%rsp\n    1002:\tret\n\
                    0000000000001010 <g>:\n    1010:\tadd    $0xffffffffffffff80,%rsp\n    1011:\tadd    $0x80,%rsp\n\
                    0000000000001020 <h>:\n    1020:\tlea    -0x3000(%rsp),%r11\n    1021:\tsub    $0x1000,%rsp\n\
                    \u{20}   1022:\tcmp    %r11,%rsp\n    1023:\tjne    1021 <h+0x1>\n    1024:\tsub    $0x10,%rsp\n";
        let wanted = [(0x1000, 0x30), (0x1010, 0x80), (0x1020, 0x3010)];
        assert_eq!(frames(code), BTreeMap::from(wanted));
    }
}
