//! The whole pipeline, and the regions of a picture.

use crate::scenes::{Case, VGA, answer_by, cases, dome_as, workspace};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::color::segment;
use ofc_core::picture::{Order, Sample, Usable};
use ofc_core::solve::OrientationMethod;
use ofc_tests::shaded_scenes::{CLEAN, OTHER, Scene, cap, moved};

/// With default parameters, and the mask: most of an egg's picture is background.
#[divan::bench(args = cases())]
fn joint(bencher: Bencher, case: &Case) {
    let photograph = case.photograph();
    let image = photograph.image();
    let mut workspace = workspace(&image);
    bencher
        .counter(ItemsCount::new(image.width() * image.height()))
        .bench_local(|| answer_by(OrientationMethod::Joint, black_box(&image), &mut workspace));
}

/// The same dome in single precision, and by both methods.
#[divan::bench(args = [OrientationMethod::Joint, OrientationMethod::Direct])]
fn floats(bencher: Bencher, orientation_method: OrientationMethod) {
    let encoded = dome_as(VGA[0], VGA[1], Sample::F32, Some(Order::Rgb));
    let image = encoded.image();
    let mut workspace = workspace(&image);
    bencher.bench_local(|| answer_by(orientation_method, black_box(&image), &mut workspace));
}

/// The regions of a picture of two objects under different lights.
#[divan::bench]
fn segments(bencher: Bencher) {
    let (left, right) = (moved(cap(280.0, 160.0), [-156.0, 0.0]), moved(cap(240.0, 150.0), [160.0, 5.0]));
    let left = Scene::new(640, 480, &CLEAN, left);
    let both = left.behind(&Scene::new(640, 480, &OTHER, right)).with_noise(1.0, 9).quantized();
    let params = segment::Params::default();
    let pixels = VGA[0] * VGA[1];
    let (mut labels, mut queue) = (vec![0; pixels], vec![0; pixels]);
    let mut colors = vec![0.0; segment::colors_len(pixels)];
    bencher.bench_local(|| {
        let usable = Usable::below(255.0);
        let image = black_box(&both).image();
        segment::segment(&image, usable, &params, &mut labels, &mut colors, &mut queue).expect("room for all")
    });
}
