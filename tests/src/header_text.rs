//! The text of `include/ofc.h`: what cbindgen makes of `ofc-ffi`, in the order of `ofc-ffi/header.txt`.
//!
//! cbindgen writes all constants, then all types, then all functions. The template has banners between lines that begin with
//! `@` and name what comes there, `OFC_STATUS_*` being all constants of that beginning in the order of the source.

use std::collections::BTreeMap;
use std::fmt::Write;

/// No line that is put together here is longer.
const WIDTH: usize = 120;

/// The comment of something and its code, a line each.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Entry {
    comment: Vec<String>,
    code: Vec<String>,
}

impl Entry {
    fn read(lines: &[&str]) -> Self {
        let (comment, code): (Vec<&str>, Vec<&str>) =
            lines.iter().partition(|line| line.trim_start().starts_with("///"));
        let owned = |lines: Vec<&str>| lines.into_iter().map(|line| line.trim_end().to_owned()).collect();
        Self { comment: owned(comment), code: owned(code) }
    }

    /// Whether the comment can stand behind the code, which then takes `width` characters.
    fn is_short(&self, width: usize) -> bool {
        self.comment.len() == 1 && self.code.len() == 1 && width + self.trailing().len() < WIDTH
    }

    fn trailing(&self) -> String {
        self.comment.concat().trim_start().replacen("///", "///<", 1)
    }

    /// The name that the code declares.
    fn name(&self) -> Option<&str> {
        let first = self.code.first()?;
        let word = |text: &str| text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
        if let Some(rest) = first.strip_prefix("#define ").or_else(|| first.strip_prefix("typedef struct ")) {
            return rest.get(..word(rest));
        }
        let before = match first.strip_prefix("typedef ") {
            // Of a pointer to a function the name is in the middle.
            Some(rest) => match rest.split_once("(*") {
                Some((_, name)) => name.split_once(')')?.0,
                None => rest.strip_suffix(';')?,
            },
            None => first.split_once('(')?.0,
        };
        before.rsplit([' ', '*']).next()
    }
}

/// Entries one below the other, short comments behind their code, in one column as far as neighbors have them there.
fn table(entries: &[Entry]) -> String {
    let mut text = String::new();
    let mut rest = entries;
    while let Some(first) = rest.first() {
        let longest = |run: &[Entry]| run.iter().map(|entry| entry.code.concat().len()).max().unwrap_or(0);
        let fits = |run: &[Entry]| run.iter().all(|entry| entry.is_short(longest(run)));
        let run = (1..=rest.len()).take_while(|&count| rest.get(..count).is_some_and(fits)).last();
        let (run, others) = rest.split_at(run.unwrap_or(0));
        for entry in run {
            let (code, width) = (entry.code.concat(), longest(run));
            let _ = writeln!(text, "{code:width$} {}", entry.trailing());
        }
        rest = others;
        if run.is_empty() {
            for line in first.comment.iter().chain(&first.code) {
                let _ = writeln!(text, "{line}");
            }
            rest = others.get(1..).unwrap_or_default();
        }
    }
    text
}

/// The declaration of a function on as few lines as it needs.
fn prototype(code: &[String]) -> String {
    let joined = code.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
    let Some((before, parameters)) = joined.split_once('(') else { return joined };
    let (mut text, indent) = (format!("{before}("), before.len() + 1);
    let mut column = indent;
    for (i, parameter) in parameters.split(", ").enumerate() {
        if i > 0 && column + parameter.len() + 3 > WIDTH {
            let _ = write!(text, ",\n{:indent$}", "");
            column = indent;
        } else if i > 0 {
            text.push_str(", ");
            column += 2;
        }
        text.push_str(parameter);
        column += parameter.len();
    }
    text
}

/// A line of code as it is best in C: negative numbers in parentheses.
fn in_c(line: &str) -> String {
    match line.strip_prefix("#define ").and_then(|rest| rest.split_once(' ')) {
        Some((name, value)) if value.starts_with('-') => format!("#define {name} ({value})"),
        _ => line.to_owned(),
    }
}

/// The declarations in cbindgen's output, by name in the order of the source.
///
/// # Panics
/// When a piece of the output declares nothing.
fn declarations(output: &str) -> (Vec<String>, BTreeMap<String, Entry>) {
    let pieces = output.split("\n\n").map(|piece| piece.trim_matches('\n')).filter(|piece| !piece.is_empty());
    let mut names = Vec::new();
    let mut entries = BTreeMap::new();
    for piece in pieces {
        let code = piece.replace("struct ofc_", "ofc_").replace("typedef ofc_", "typedef struct ofc_");
        let lines: Vec<&str> = code.lines().collect();
        let start = lines.iter().position(|line| !line.starts_with("///")).unwrap_or(0);
        let (comment, body) = lines.split_at(start);
        let mut entry = Entry::read(comment);
        entry.code = body.iter().map(|line| in_c(line)).collect();
        let name = entry.name().unwrap_or_else(|| panic!("no declaration: {piece}")).to_owned();
        names.push(name.clone());
        entries.insert(name, entry);
    }
    (names, entries)
}

/// A declaration as the header has it; a struct that the template has declared already is only defined.
fn declaration(entry: &Entry, name: &str, template: &str) -> String {
    let mut text = entry.comment.iter().fold(String::new(), |text, line| text + line + "\n");
    let first = entry.code.first().map_or("", String::as_str);
    if entry.code.len() > 2 && first.ends_with('{') {
        let declared = template.contains(&format!("typedef struct {name} {name};"));
        let (open, close) = if declared {
            (format!("struct {name} {{"), "};".to_owned())
        } else {
            (first.to_owned(), format!("}} {name};"))
        };
        let fields = entry.code.get(1..entry.code.len() - 1).unwrap_or_default();
        let mut start = 0;
        let mut entries = Vec::new();
        for (i, line) in fields.iter().enumerate() {
            if !line.trim_start().starts_with("///") {
                let lines: Vec<&str> =
                    fields.get(start..=i).unwrap_or_default().iter().map(String::as_str).collect();
                entries.push(Entry::read(&lines));
                start = i + 1;
            }
        }
        let _ = write!(text, "{open}\n{}{close}\n", table(&entries));
    } else if first.starts_with("typedef") {
        let _ = writeln!(text, "{first}");
    } else {
        let _ = writeln!(text, "{}", prototype(&entry.code));
    }
    text
}

/// The header: the template with cbindgen's declarations in their places.
///
/// # Panics
/// When a declaration has no place or several, or a place no declaration.
#[must_use]
pub fn header(template: &str, output: &str) -> String {
    let (names, mut entries) = declarations(output);
    let mut text = String::new();
    for line in template.lines() {
        let Some(places) = line.strip_prefix("@ ") else {
            text.push_str(line);
            text.push('\n');
            continue;
        };
        let mut constants = Vec::new();
        let mut pieces = Vec::new();
        for place in places.split_whitespace() {
            let matching = |name: &&String| {
                place.strip_suffix('*').map_or(*name == place, |start| name.starts_with(start))
            };
            let matching: Vec<&String> = names.iter().filter(matching).collect();
            assert!(!matching.is_empty(), "{place} is not declared");
            for name in matching {
                let entry = entries.remove(name).unwrap_or_else(|| panic!("{name} has two places"));
                if entry.code.first().is_some_and(|code| code.starts_with("#define")) {
                    constants.push(entry);
                } else {
                    pieces.push(declaration(&entry, name, template));
                }
            }
        }
        if !constants.is_empty() {
            pieces.push(table(&constants));
        }
        text.push_str(&pieces.join("\n"));
    }
    assert!(entries.is_empty(), "no place for {:?}", entries.keys());
    text
}
