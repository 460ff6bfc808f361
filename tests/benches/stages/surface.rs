//! The whole surface.

use crate::scenes::{Case, Subject, VGA, answer};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::surface::completion::{CompletionParams, Outputs, complete, need};
use ofc_tests::depth_workspace::Workspace;

const CASES: [Case; 3] = [
    Case { subject: Subject::Egg, size: [256, 256] },
    Case { subject: Subject::Egg, size: VGA },
    Case { subject: Subject::Dome, size: VGA },
];

/// Normals, uncertainty, depth and class of every pixel of the mask.
#[divan::bench(args = CASES)]
fn completion(bencher: Bencher, case: &Case) {
    let photograph = case.photograph();
    let image = photograph.image();
    let sources = answer(&image).uncertainty_sources().expect("the joint method knows");
    let (width, pixels) = (image.width(), image.width() * image.height());
    let mut workspace = Workspace::of(need(width, image.height()).expect("a picture"), 0.0);
    let (mut normals, mut angles, mut depths) = (vec![0.0; 3 * pixels], vec![0.0; pixels], vec![0.0; pixels]);
    let mut classes = vec![0; pixels];
    bencher.counter(ItemsCount::new(pixels)).bench_local(|| {
        let outputs = Outputs {
            normals: (&mut normals, 3 * width),
            angles: (&mut angles, width),
            depths: (&mut depths, width),
            classes: (&mut classes, width),
        };
        let params = CompletionParams::default();
        complete(black_box(&image), &sources, 255.0, &params, workspace.arena(), outputs).expect("a surface")
    });
}
