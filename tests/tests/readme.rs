//! README's programs compile without a warning, and do what they are there for. `newcomer/` does all that README says.

use ofc_core::{Image, Order, Params, Sample, normals, solve};
use ofc_tests::shipped::{self, root};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const WIDTH: usize = 640;
const HEIGHT: usize = 480;
const STRICT: [&str; 7] =
    ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wsign-conversion", "-Wshadow", "-Werror"];

/// README's blocks of code in a language.
fn blocks(language: &str) -> Vec<String> {
    let text = std::fs::read_to_string(root().join("README.md")).expect("README.md");
    let fence = format!("\n```{language}\n");
    let after = text.split(&fence).skip(1);
    after.map(|rest| rest.split_once("\n```").expect("an end").0.to_owned() + "\n").collect()
}

fn write(name: &str, text: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, text).expect("a file");
    path
}

/// What the compiler says of a file, with these options besides the strict ones.
fn compile(compiler: &str, file: &Path, more: &[&str]) -> String {
    let (file, include) = (file.to_string_lossy(), format!("-I{}", root().join("include").display()));
    let mut arguments = vec![file.as_ref(), &include, "-isystem", "/usr/include/opencv4", "-O1"];
    arguments.extend(STRICT);
    arguments.extend(more);
    let output = shipped::run(compiler, &arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.success(), said.is_empty(), "{said}");
    said
}

/// A ball under three lights, in RGB.
#[expect(clippy::cast_sign_loss, reason = "colors are not negative")]
fn ball() -> Vec<u8> {
    const F: [[f64; 3]; 3] = [[110.0, 15.0, 95.0], [-65.0, 90.0, 100.0], [-40.0, -95.0, 90.0]];
    let pixel = |i: usize| {
        let x = ((i % WIDTH) as f64 - 319.5) / 400.0;
        let y = (239.5 - (i / WIDTH) as f64) / 400.0;
        let n = [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()];
        F.map(|row| row.iter().zip(n).map(|(f, n)| f * n).sum::<f64>().round().max(0.0) as u8)
    };
    (0..WIDTH * HEIGHT).flat_map(pixel).collect()
}

#[test]
fn the_program_in_c_gives_the_normals() {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readme-c");
    let text = &blocks("c")[0];
    let options = ["-std=c99", shipped::archive(), "-Wl,--gc-sections", "-o", &program.to_string_lossy()];
    assert_eq!(compile("gcc", &write("readme.c", text), &options), "");
    let mut process = Command::new(&program)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("a program");
    let pixels = ball();
    process.stdin.take().expect("a pipe").write_all(&pixels).expect("the program reads");
    let output = process.wait_with_output().expect("the program ends");
    assert!(output.status.success());

    let image =
        Image::interleaved(&pixels, WIDTH, HEIGHT, 3 * WIDTH, Sample::U8, Order::Rgb).expect("a picture");
    let params = Params::default();
    let mut workspace = vec![0.0; solve::workspace_len(WIDTH * HEIGHT, params.lmeds.sample_size)];
    let solution = solve(&image, &params, &mut workspace).expect("a fit");
    let inverse = solution.choice.as_ref().expect("F").orientation.f_inverse;
    let mut expected = vec![0.0_f32; 3 * WIDTH * HEIGHT];
    let (inliers, unit) = (solution.inliers.selector(), normals::Length::Unit);
    normals::compute(&image, inliers, &inverse, unit, &mut expected, 3 * WIDTH).expect("room");
    assert!(expected.iter().flat_map(|n| n.to_ne_bytes()).eq(output.stdout));
}

#[test]
fn the_program_in_cpp_compiles_without_a_warning() {
    let programs = blocks("cpp");
    assert_eq!(programs.len(), 1);
    let file = write("readme.cpp", &programs[0]);
    for compiler in ["g++", "clang++"] {
        for dialect in ["-std=c++17", "-std=c++20"] {
            let said = compile(compiler, &file, &[dialect, "-Wold-style-cast", "-fsyntax-only"]);
            assert_eq!(said, "", "{compiler} {dialect}");
        }
    }
}

#[test]
fn every_other_block_in_c_compiles_within_a_function() {
    let others = &blocks("c")[1..];
    assert_eq!(others.len(), 1);
    let mut text =
        "#include <ofc.h>\n#include <stdlib.h>\nstatic float normals[480][640][3], depth[480][640];\n"
            .to_owned();
    for (i, block) in others.iter().enumerate() {
        let _ = writeln!(
            text,
            "ofc_status f{i}(void);\nofc_status f{i}(void) {{ ofc_status status;\n{block}return status; }}"
        );
    }
    assert_eq!(compile("gcc", &write("readme-others.c", &text), &["-std=c99", "-fsyntax-only"]), "");
    let unknown = write("readme-wrong.c", &text.replace("pixel_pitch", "pixel_pich"));
    assert_ne!(compile("gcc", &unknown, &["-std=c99", "-fsyntax-only"]), "");
}
