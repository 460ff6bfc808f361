//! The rooms of `ofc-core`: a room uses only rooms above it, and no two files import each other, however far around.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use syn::visit::{self, Visit};

/// Each room with the rooms above it that it may not use.
const ROOMS: [(&str, &[&str]); 11] = [
    ("math", &[]),
    ("picture", &[]),
    ("color", &[]),
    ("light", &[]),
    ("orientation", &[]),
    ("surface", &[]),
    ("render", &["color", "light", "orientation", "surface"]),
    ("solve", &[]),
    ("stream", &[]),
    ("rig", &["light", "surface", "render", "solve", "stream"]),
    ("check", &[]),
];

/// A file as the names that lead to it from the crate: `color::lmeds::search`.
type Module = Vec<String>;

/// What a file imports or names, as paths from the crate, and which of its names are other files' that it passes on.
#[derive(Default)]
struct Names {
    module: Module,
    children: BTreeSet<String>,
    used: Vec<Module>,
    /// Names without a path: another file's where they are passed on.
    bare: BTreeSet<String>,
    passed_on: BTreeMap<String, Module>,
}

impl Names {
    fn of(module: Module, text: &str) -> Self {
        let file = syn::parse_file(text).expect("Rust");
        let children = file.items.iter().filter_map(|item| match item {
            syn::Item::Mod(item) if item.content.is_none() => Some(item.ident.to_string()),
            _ => None,
        });
        let mut names = Self { children: children.collect(), module, ..Self::default() };
        names.visit_file(&file);
        let bare = names.bare.iter().filter_map(|name| names.passed_on.get(name)).cloned();
        names.used.extend(bare.collect::<Vec<_>>());
        names
    }

    /// A path from the crate; `None` for what another crate or this file itself defines.
    fn absolute(&self, path: &[String]) -> Option<Module> {
        let (first, rest) = path.split_first()?;
        let mut absolute = match first.as_str() {
            "crate" => Vec::new(),
            "self" => self.module.clone(),
            "super" => self.module.split_last()?.1.to_vec(),
            child if self.children.contains(child) => {
                [self.module.as_slice(), std::slice::from_ref(first)].concat()
            }
            _ => return None,
        };
        for name in rest {
            if name == "super" {
                absolute.pop();
            } else if name != "self" {
                absolute.push(name.clone());
            }
        }
        Some(absolute)
    }

    fn import(&mut self, tree: &syn::UseTree, before: &[String], is_public: bool) {
        let with = |name: &syn::Ident| [before, &[name.to_string()]].concat();
        let (path, name) = match tree {
            syn::UseTree::Path(path) => return self.import(&path.tree, &with(&path.ident), is_public),
            syn::UseTree::Group(group) => {
                return group.items.iter().for_each(|tree| self.import(tree, before, is_public));
            }
            syn::UseTree::Name(name) => (with(&name.ident), name.ident.to_string()),
            syn::UseTree::Rename(rename) => (with(&rename.ident), rename.rename.to_string()),
            syn::UseTree::Glob(_) => (before.to_vec(), "*".into()),
        };
        let Some(path) = self.absolute(&path) else { return };
        if is_public && path.starts_with(&self.module) {
            self.passed_on.insert(name, path);
        } else {
            self.used.push(path);
        }
    }
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"))
    })
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        if !is_test(&item.attrs) {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if !is_test(&item.attrs) {
            self.import(&item.tree, &[], !matches!(item.vis, syn::Visibility::Inherited));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<_> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if names.len() > 1
            && let Some(path) = self.absolute(&names)
        {
            self.used.push(path);
        }
        if let [name] = names.as_slice()
            && name.starts_with(char::is_uppercase)
        {
            self.bare.insert(name.clone());
        }
        visit::visit_path(self, path);
    }

    fn visit_expr_call(&mut self, call: &'ast syn::ExprCall) {
        if let syn::Expr::Path(function) = &*call.func
            && let Some(name) = function.path.get_ident()
        {
            self.bare.insert(name.to_string());
        }
        visit::visit_expr_call(self, call);
    }
}

/// Which file uses which.
fn arrows(files: &BTreeMap<Module, String>) -> BTreeMap<Module, BTreeSet<Module>> {
    let names: BTreeMap<_, _> =
        files.iter().map(|(module, text)| (module.clone(), Names::of(module.clone(), text))).collect();
    let resolve = |path: &Module| {
        let mut path = path.clone();
        loop {
            let depth = (0..=path.len()).rev().find(|&depth| names.contains_key(&path[..depth]))?;
            let (module, rest) = path.split_at(depth);
            match rest.first().and_then(|name| names[module].passed_on.get(name)) {
                Some(other) => path = [other.as_slice(), &rest[1..]].concat(),
                None => return Some(module.to_vec()),
            }
        }
    };
    let used = |names: &Names| {
        names.used.iter().filter_map(resolve).filter(|other| *other != names.module).collect()
    };
    names.values().map(|names| (names.module.clone(), used(names))).collect()
}

/// What is wrong with these files, a line each.
fn faults(files: &BTreeMap<Module, String>) -> Vec<String> {
    let arrows = arrows(files);
    let mut faults = Vec::new();
    let place =
        |module: &Module| ROOMS.iter().position(|(room, _)| module.first().is_some_and(|m| m == room));
    for (from, to) in arrows.iter().flat_map(|(from, used)| used.iter().map(move |to| (from, to))) {
        let (Some(below), Some(above)) = (place(from), place(to)) else {
            if !from.is_empty() {
                faults.push(format!("{} uses {}: not a room", from.join("::"), to.join("::")));
            }
            continue;
        };
        if above > below || ROOMS[below].1.contains(&ROOMS[above].0) {
            faults.push(format!("{} uses {}, which is below it", from.join("::"), to.join("::")));
        }
    }
    let reached = |from: &Module| {
        let (mut reached, mut next) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(module) = next.pop() {
            for other in arrows.get(&module).into_iter().flatten() {
                if reached.insert(other.clone()) {
                    next.push(other.clone());
                }
            }
        }
        reached
    };
    let circular: BTreeSet<_> = arrows.keys().filter(|module| reached(module).contains(*module)).collect();
    for from in &circular {
        let back = arrows[*from].iter().filter(|to| circular.contains(to) && reached(to).contains(*from));
        faults.extend(back.map(|to| format!("{} -> {}: in a circle", from.join("::"), to.join("::"))));
    }
    faults
}

fn read(folder: &Path, module: &Module, files: &mut BTreeMap<Module, String>) {
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry")) {
        let path = entry.path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let inner = if name == "lib" { Module::new() } else { [module.as_slice(), &[name]].concat() };
        if path.is_dir() {
            read(&path, &inner, files);
        } else {
            files.insert(inner, std::fs::read_to_string(&path).expect("text"));
        }
    }
}

#[test]
fn a_room_uses_only_rooms_above_it_and_no_files_go_in_a_circle() {
    let mut files = BTreeMap::new();
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../ofc-core/src"), &Module::new(), &mut files);
    assert!(files.len() > 80, "{} files", files.len());
    let faults = faults(&files);
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn wrong_arrows_are_seen() {
    let faults = |files: &[(&str, &str)]| {
        let module = |name: &str| name.split("::").map(String::from).collect::<Module>();
        faults(&files.iter().map(|(name, text)| (module(name), (*text).to_string())).collect()).len()
    };
    let picture = ("picture", "mod image; pub use image::Image;");
    let image = ("picture::image", "pub struct Image;");
    assert_eq!(faults(&[picture, image, ("color", "use crate::picture::Image;")]), 0);
    assert_eq!(faults(&[picture, image, ("math", "use crate::picture::Image;")]), 1);
    assert_eq!(faults(&[picture, image, ("math", "fn f(_: &crate::picture::Image) {}")]), 1);
    assert_eq!(faults(&[("color", "pub struct C;"), ("render", "use crate::color::C;")]), 1);
    assert_eq!(faults(&[("color", ""), ("render", "#[cfg(test)] mod tests { use crate::color::C; }")]), 0);
    assert_eq!(faults(&[("color", "use crate::attic::C;"), ("attic", "pub struct C;")]), 1);
    // Through a name that is passed on, and by a path to a child.
    let circle =
        [("picture::image", "use crate::color::C;"), ("color", "use crate::picture::Image; pub struct C;")];
    assert_eq!(faults(&[picture, circle[0], circle[1]]), 3);
    assert_eq!(
        faults(&[("color", "mod a; fn f() { a::g() }"), ("color::a", "use super::f; pub fn g() {}")]),
        2
    );
    assert_eq!(faults(&[("color", "mod a; pub use a::g;"), ("color::a", "use super::h; pub fn g() {}")]), 0);
    assert_eq!(faults(&[("color", "mod a; pub use a::g; fn h() { g() }"), ("color::a", "use super::h;")]), 2);
}
