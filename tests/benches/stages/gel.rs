//! Frames of a tactile sensor: as one picture, and with the model of a rig.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::orientation::relief::{ReliefParams, estimate, need};
use ofc_core::picture::{Image, Order, Sample};
use ofc_core::rig::{self, Frame, Model, Rig};
use ofc_tests::depth_workspace::Workspace;
use ofc_tests::relief_scenes::{HEIGHT, Kind, WIDTH, frame};

const PIXELS: usize = WIDTH * HEIGHT;

fn picture(rgb: &[u8]) -> Image<'_> {
    Image::interleaved(rgb, WIDTH, HEIGHT, 3 * WIDTH, Sample::U8, Order::Rgb).expect("a picture")
}

fn workspace() -> Workspace {
    Workspace::of(need(WIDTH, HEIGHT).expect("large enough"), 0.0)
}

/// The model of a rig after six balls of which nothing is known.
fn model() -> Model {
    let mut rig = Rig::new(WIDTH, HEIGHT).expect("large enough");
    for number in 1..7 {
        let scene = frame(1, Kind::Ball, number);
        let (image, background) = (picture(&scene.rgb), picture(&scene.background));
        let frame = Frame { image: &image, background: Some(&background), saturation: None, seed: 0 };
        rig::add(&mut rig, &frame, None, workspace().arena(), None).expect("a contact");
    }
    rig::solve(&rig, None, None, false).expect("a model")
}

/// A relief from one picture and its background.
#[divan::bench]
fn alone(bencher: Bencher) {
    let scene = frame(1, Kind::Ball, 7);
    let (image, background) = (picture(&scene.rgb), picture(&scene.background));
    let (mut workspace, mut classes) = (workspace(), vec![0; PIXELS]);
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| {
        let params = ReliefParams::default();
        estimate(black_box(&image), Some(&background), &params, workspace.arena(), &mut classes)
            .expect("a relief")
    });
}

/// Classes and normals of a frame with a model.
#[divan::bench]
fn with_model(bencher: Bencher) {
    let (model, scene) = (model(), frame(1, Kind::Ball, 7));
    let (image, background) = (picture(&scene.rgb), picture(&scene.background));
    let (mut workspace, mut classes) = (workspace(), vec![0; PIXELS]);
    let mut normals = vec![[0.0; 4]; PIXELS];
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| {
        let image = black_box(&image);
        rig::classify(&model, image, Some(&background), workspace.arena(), &mut classes).expect("classes");
        rig::normals(&model, image, Some(&background), &classes, |x, y, [a, b, c], deviation| {
            normals[y * WIDTH + x] = [a, b, c, deviation];
        })
        .expect("normals");
    });
}
