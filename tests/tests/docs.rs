//! What the documents say of the code: links lead to files and headings that exist, and constants have the values given.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the workspace").to_path_buf()
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The targets of links and pictures, `](target)`.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target)
}

/// A heading as GitHub links to it: lower case, spaces as hyphens, no punctuation.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().to_lowercase().replace(' ', "-");
    kept.chars().filter(|c| c.is_alphanumeric() || *c == '-' || *c == '_').collect()
}

fn has_heading(text: &str, wanted: &str) -> bool {
    text.lines()
        .filter(|line| line.starts_with('#'))
        .any(|line| anchor(line.trim_start_matches('#')) == wanted)
}

/// The value of a constant in Rust: what stands between `=` and `;` after `const NAME:`.
fn value_of<'t>(source: &'t str, name: &str) -> Option<&'t str> {
    let (_, rest) = source.split_once(&format!("const {name}: "))?;
    let (_, rest) = rest.split_once(" = ")?;
    rest.split_once(';').map(|(value, _)| value)
}

/// What is wrong in a Markdown document that lies in `folder`.
fn mistakes(text: &str, folder: &Path) -> Vec<String> {
    let mut mistakes = Vec::new();
    for target in targets(text).filter(|target| !target.contains("://")) {
        let (file, heading) = target.split_once('#').unwrap_or((target, ""));
        let path = folder.join(file);
        if !path.exists() {
            mistakes.push(format!("{target}: there is no such file"));
        } else if !heading.is_empty() {
            let document = if file.is_empty() { text.to_owned() } else { read(&path) };
            if !has_heading(&document, heading) {
                mistakes.push(format!("{target}: there is no such heading"));
            }
        }
    }
    // Rows of tables of constants: | `NAME` and what it is | value | [file](path) |.
    for line in text.lines().filter_map(|line| line.strip_prefix("| `")) {
        let cells: Vec<&str> = line.trim_end_matches(" |").split(" | ").collect();
        let [name, value, file] = cells[..] else { continue };
        let (Some((name, _)), Some(path)) = (name.split_once('`'), targets(file).next()) else { continue };
        let source = std::fs::read_to_string(folder.join(path)).unwrap_or_default();
        if value_of(&source, name) != Some(value) {
            mistakes.push(format!("{name} is not {value} in {path}"));
        }
    }
    mistakes
}

#[test]
fn documents_agree_with_the_code() {
    let root = root();
    let mut documents: Vec<_> = [
        "README.md",
        "CONTRIBUTING.md",
        "SECURITY.md",
        "bindings/python/README.md",
        "bindings/web/README.md",
        "c_examples/README.md",
    ]
    .map(|file| root.join(file))
    .into();
    for folder in ["docs", "docs/guide", "docs/reference"] {
        let pages = std::fs::read_dir(root.join(folder)).expect("docs");
        documents.extend(
            pages
                .map(|entry| entry.expect("an entry").path())
                .filter(|path| path.extension() == Some("md".as_ref())),
        );
    }
    assert!(documents.len() >= 20);
    for document in documents {
        let found = mistakes(&read(&document), document.parent().expect("a folder"));
        assert!(found.is_empty(), "{}: {found:#?}", document.display());
    }
}

#[test]
fn the_table_from_paper_to_code_names_files_that_exist() {
    let source = root().join("ofc-core/src");
    let lib = read(&source.join("lib.rs"));
    let rows: Vec<&str> =
        lib.lines().filter(|line| line.starts_with("//! | ") && !line.contains("---")).collect();
    let files = rows.iter().skip(1).flat_map(|row| {
        let cell = row.trim_end_matches(" |").rsplit(" | ").next().expect("a cell");
        cell.split(", ").map(|file| file.trim_matches('`'))
    });
    let mut count = 0;
    for file in files {
        assert!(source.join(file).exists(), "{file}");
        count += 1;
    }
    assert!(count > 30, "{count}");
}

#[test]
fn what_is_cited_is_this_version() {
    let citation = read(&root().join("CITATION.cff"));
    assert!(citation.contains(concat!("\nversion: ", env!("CARGO_PKG_VERSION"), "\n")));
}

#[test]
fn mistakes_are_found() {
    let docs = root().join("docs");
    let text = "# A heading: here\n[a](nowhere.md) [b](#a-heading-here) [c](#none) [d](README.md#none)\n\
                | `NEAR`, of a layer | 7.5 | [`shadows.rs`](../ofc-core/src/color/shadows.rs) |\n\
                | `NEAR`, of a layer | 2.0 | [`shadows.rs`](../ofc-core/src/color/shadows.rs) |\n\
                | `NO_SUCH` | 2.0 | [`shadows.rs`](../ofc-core/src/color/shadows.rs) |\n";
    assert_eq!(mistakes(text, &docs).len(), 5, "{:#?}", mistakes(text, &docs));
}
