//! `ofc-ffi` turns the pointers of C into values, slices and references in one file, and is unsafe nowhere else but where a
//! call says that its caller keeps the contract.

use ofc_tests::shipped::root;

/// What only the fence may do.
const FENCED: [&str; 8] =
    [".cast(", ".cast::<", " as *", "from_raw_parts", "transmute", "MaybeUninit", ".read()", "&mut *"];

/// What is unsafe outside of the fence: the promise, the stream's memory, and how C sees a function.
const UNSAFE: [&str; 4] = [
    "unsafe { Contract::kept() }",
    "unsafe { self.object(",
    "pub unsafe extern \"C\" fn",
    "#[unsafe(no_mangle)]",
];

/// The lines of a file that belong behind the fence.
fn outside(text: &str) -> Vec<&str> {
    let code = |line: &&str| !line.trim_start().starts_with("//");
    let belongs = |line: &&str| {
        FENCED.iter().any(|sign| line.contains(sign))
            || line.contains("unsafe") && !UNSAFE.iter().any(|allowed| line.contains(allowed))
    };
    text.lines().filter(code).filter(belongs).collect()
}

#[test]
fn pointers_are_followed_in_one_file() {
    let files = std::fs::read_dir(root().join("ofc-ffi/src")).expect("a folder");
    for file in files.map(|file| file.expect("an entry").path()) {
        let text = std::fs::read_to_string(&file).expect("a source");
        let is_fence = file.ends_with("pointers.rs");
        assert_eq!(outside(&text).is_empty(), !is_fence, "{}: {:?}", file.display(), outside(&text));
    }
}

#[test]
fn what_belongs_behind_the_fence_is_found() {
    let text =
        "// unsafe\nlet a = unsafe { *b };\nlet c = d.cast::<u8>();\nlet e = unsafe { Contract::kept() };\n";
    assert_eq!(outside(text), ["let a = unsafe { *b };", "let c = d.cast::<u8>();"]);
}
