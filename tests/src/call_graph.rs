//! Who calls whom in a linked x86-64 library, read from its disassembly.
//!
//! Position-independent code calls other libraries through slots of the global offset table, also by way of a register,
//! and could call its own functions so. A function counts as called where its address is read, so the graph has every
//! edge that the program can take, and perhaps more. Calls of which that is not certain are listed.

use crate::shipped;
use std::collections::{BTreeMap, BTreeSet};

/// Functions by address, and whom each may call.
#[derive(Debug, Default)]
pub struct CallGraph {
    pub(crate) names: BTreeMap<u64, String>,
    pub(crate) calls: BTreeMap<u64, BTreeSet<u64>>,
    /// Calls and pointers to functions whose target this reading cannot tell.
    pub unresolved: Vec<String>,
}

/// The function behind each relocated word; `None` for what another library or nobody provides.
type Slots = BTreeMap<u64, Option<u64>>;

/// The function that calls those of the library's callers, which are on nobody's list: how much stack they take is theirs to know.
const CALLS_ITS_CALLER: &str = "call_the_callers_function";

/// What it hands over, which by its name is known to come back to the function that reads its address, and counts as called there.
const IS_CALLED_BACK: &str = "part_of_work";

impl CallGraph {
    /// Reads a shared library or a position-independent program.
    ///
    /// # Panics
    /// When the disassembler fails.
    #[must_use]
    pub fn of(library: &str) -> Self {
        let relocations = shipped::stdout("objdump", &["-R", library]);
        let code = shipped::stdout("objdump", &["-d", "--no-show-raw-insn", library]);
        Self::read(&code, &relocations)
    }

    /// Reads the text of `objdump -d --no-show-raw-insn` and `objdump -R`.
    #[must_use]
    pub fn read(code: &str, relocations: &str) -> Self {
        let mut graph = Self { names: code.lines().filter_map(header).collect(), ..Self::default() };
        let addresses = graph.names.iter().map(|(address, name)| (name.as_str(), *address)).collect();
        let slots: Slots = relocations.lines().filter_map(|line| relocation(line, &addresses)).collect();
        let mut function = Function::default();
        for line in code.lines() {
            if let Some((address, _)) = header(line) {
                graph.finish(&function);
                function = Function { address, ..Function::default() };
            } else if let Some((_, instruction)) = line.split_once(":\t") {
                graph.instruction(&mut function, instruction.trim(), &slots);
            }
        }
        graph.finish(&function);
        graph
    }

    /// How many functions there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.names.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Functions that can be on the stack twice: each that stays when those without callees are taken away, again and
    /// again.
    #[must_use]
    pub fn recursive(&self) -> Vec<&str> {
        let mut left = self.calls.clone();
        loop {
            let leaves: BTreeSet<u64> =
                left.iter().filter(|(_, callees)| callees.is_empty()).map(|(caller, _)| *caller).collect();
            if leaves.is_empty() {
                return left
                    .keys()
                    .filter_map(|address| self.names.get(address))
                    .map(String::as_str)
                    .collect();
            }
            left.retain(|caller, _| !leaves.contains(caller));
            for callees in left.values_mut() {
                callees.retain(|callee| !leaves.contains(callee));
            }
        }
    }

    fn finish(&mut self, function: &Function) {
        if function.address != 0 {
            self.calls.entry(function.address).or_default();
        }
    }

    fn instruction(&mut self, function: &mut Function, text: &str, slots: &Slots) {
        let (operation, operands) = text.split_once(' ').unwrap_or((text, ""));
        let operands = operands.trim();
        let is_jump = operation.starts_with('j');
        let is_call = operation == "call";
        if is_call || is_jump {
            if let Some(register) = operands.strip_prefix("*%") {
                let is_table = is_jump && function.table_registers.contains(register);
                if !is_table && !function.pointer_registers.contains(register) {
                    self.refuse(function, text);
                }
            } else if let Some(slot) = operands.strip_prefix('*') {
                match comment(slot).and_then(|address| slots.get(&address)) {
                    Some(target) => self.edge(function, *target, true),
                    None => self.refuse(function, text),
                }
            } else if let Some(target) = hexadecimal(operands) {
                self.edge(function, Some(target), is_call);
            }
            // Behind a call only what it must preserve holds what it held; behind a jump the next line comes from elsewhere.
            function.holding.retain(|register| is_call && PRESERVED.contains(register));
            return;
        }
        // `movslq (table,index,4), register; add table, register; jmp *register` is a `match`.
        if operation == "movslq" && operands.contains(",4)") {
            function.table_registers.insert(destination(operands).to_owned());
        }
        function.copy(operation, operands);
        let Some(address) = comment(operands) else { return };
        let target = match operation {
            "mov" => slots.get(&address).copied(),
            "lea" => Some(Some(address)),
            _ => None,
        };
        match target {
            Some(Some(target)) if self.names.contains_key(&target) => {
                self.edge(function, Some(target), true);
                let is_called_back =
                    self.names.get(&target).is_some_and(|name| name.contains(IS_CALLED_BACK));
                if ARGUMENTS.contains(&destination(operands)) && !is_called_back {
                    self.refuse(function, text);
                }
            }
            Some(None) => {}
            _ => return,
        }
        function.pointer_registers.insert(destination(operands).to_owned());
        function.holding.extend(whole(destination(operands)));
    }

    /// A jump within a function is a loop; a call of the function by itself is recursion.
    fn edge(&mut self, function: &Function, target: Option<u64>, is_call: bool) {
        let callees = self.calls.entry(function.address).or_default();
        let Some(target) = target else { return };
        let start = self.names.range(..=target).next_back().map(|(start, _)| *start);
        callees.extend(start.filter(|start| is_call || *start != function.address));
    }

    fn refuse(&mut self, function: &Function, text: &str) {
        let name = self.names.get(&function.address).map_or("", String::as_str);
        // The linker's own way to functions of other libraries.
        if !name.contains("@plt") && !name.contains(CALLS_ITS_CALLER) {
            self.unresolved.push(format!("{name}: {text}"));
        }
    }
}

/// What is known of a function while its instructions are read.
#[derive(Default)]
struct Function {
    address: u64,
    /// Registers that have held the address of a function, read from its slot or copied from a register that held it.
    pointer_registers: BTreeSet<String>,
    /// Registers that have held the offset of a branch of a `match`.
    table_registers: BTreeSet<String>,
    /// Registers that hold the address of a function at this line, which the one above it leads to.
    holding: BTreeSet<&'static str>,
}

impl Function {
    /// A register takes a value: what another one holds, or something else.
    fn copy(&mut self, operation: &str, operands: &str) {
        let operands = operands.split('#').next().unwrap_or_default().trim();
        let (source, target) = operands.rsplit_once(',').unwrap_or(("", operands));
        let Some(target) = target.strip_prefix('%').and_then(whole) else { return };
        let source = source.strip_prefix('%').and_then(whole);
        if operation == "mov" && source.is_some_and(|source| self.holding.contains(source)) {
            self.holding.insert(target);
            self.pointer_registers.insert(target.to_owned());
        } else {
            self.holding.remove(target);
        }
        if ["mul", "imul", "div", "idiv", "cltq", "cqto", "xchg", "cpuid"].contains(&operation) {
            self.holding.clear();
        }
    }
}

/// The registers that a called function leaves as they were.
const PRESERVED: [&str; 6] = ["rbx", "rbp", "r12", "r13", "r14", "r15"];

/// The register of 64 bits that this one is, or is a part of.
fn whole(register: &str) -> Option<&'static str> {
    const NAMES: [(&str, &[&str]); 15] = [
        ("rax", &["eax", "ax", "al", "ah"]),
        ("rbx", &["ebx", "bx", "bl", "bh"]),
        ("rcx", &["ecx", "cx", "cl", "ch"]),
        ("rdx", &["edx", "dx", "dl", "dh"]),
        ("rsi", &["esi", "si", "sil"]),
        ("rdi", &["edi", "di", "dil"]),
        ("rbp", &["ebp", "bp", "bpl"]),
        ("r8", &["r8d", "r8w", "r8b"]),
        ("r9", &["r9d", "r9w", "r9b"]),
        ("r10", &["r10d", "r10w", "r10b"]),
        ("r11", &["r11d", "r11w", "r11b"]),
        ("r12", &["r12d", "r12w", "r12b"]),
        ("r13", &["r13d", "r13w", "r13b"]),
        ("r14", &["r14d", "r14w", "r14b"]),
        ("r15", &["r15d", "r15w", "r15b"]),
    ];
    NAMES.iter().find(|(name, parts)| *name == register || parts.contains(&register)).map(|(name, _)| *name)
}

/// Where an address of a function would be handed to another function.
const ARGUMENTS: [&str; 6] = ["rdi", "rsi", "rdx", "rcx", "r8", "r9"];

fn destination(operands: &str) -> &str {
    let operands = operands.split('#').next().unwrap_or_default().trim();
    operands.rsplit_once(",%").map_or("", |(_, register)| register)
}

/// `8548 <name>...`: the number.
pub(crate) fn hexadecimal(text: &str) -> Option<u64> {
    u64::from_str_radix(text.split_whitespace().next()?, 16).ok()
}

/// `0x5d7e(%rip)  # 71948 <name>`: the address that the disassembler worked out.
fn comment(operands: &str) -> Option<u64> {
    operands.split_once('#').and_then(|(_, address)| hexadecimal(address))
}

/// `0000000000008548 <name>:`: address and name.
pub(crate) fn header(line: &str) -> Option<(u64, String)> {
    let (address, name) = line.strip_suffix(">:")?.split_once(" <")?;
    Some((hexadecimal(address)?, name.to_owned()))
}

/// `71600 R_X86_64_RELATIVE  *ABS*+0x8630` or `71608 R_X86_64_GLOB_DAT  name@Base`: the slot and what it holds.
fn relocation(line: &str, addresses: &BTreeMap<&str, u64>) -> Option<(u64, Option<u64>)> {
    let mut words = line.split_whitespace();
    let (slot, kind, value) = (hexadecimal(words.next()?)?, words.next()?, words.next()?);
    let target = match value.strip_prefix("*ABS*+0x") {
        Some(address) => hexadecimal(address),
        None => value.split('@').next().and_then(|name| addresses.get(name)).copied(),
    };
    kind.starts_with("R_X86_64").then_some((slot, target))
}
