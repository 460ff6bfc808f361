//! Normals of inliers and their uncertainty; counts are of all pixels of the picture.

use crate::scenes::{Case, answer, cases, dome_as, sizes};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::picture::{Image, Order, Sample, Window};
use ofc_core::surface::normals::{Length, compute};
use ofc_core::surface::uncertainty::Uncertainty;

fn time_unit_normals(bencher: Bencher, image: &Image) {
    let solution = answer(image);
    let f_inverse = solution.choice.expect("an answer").orientation.f_inverse;
    let (width, pixels) = (image.width(), image.width() * image.height());
    let mut normals = vec![0.0_f32; pixels * 3];
    bencher.counter(ItemsCount::new(pixels)).bench_local(|| {
        let inliers = black_box(solution.inliers);
        let bits = |window: &Window| inliers.bits(window);
        compute(image, bits, &f_inverse, Length::Unit, &mut normals, width * 3).expect("room for all");
    });
}

/// Of 8 bits with a mask.
#[divan::bench(args = cases())]
fn masked(bencher: Bencher, case: &Case) {
    let photograph = case.photograph();
    time_unit_normals(bencher, &photograph.image());
}

const FORMATS: [(&str, Sample, Option<Order>); 9] = [
    ("RGB8", Sample::U8, Some(Order::Rgb)),
    ("BGRA8", Sample::U8, Some(Order::Bgra)),
    ("PLANES8", Sample::U8, None),
    ("RGB16", Sample::U16, Some(Order::Rgb)),
    ("BGRA16", Sample::U16, Some(Order::Bgra)),
    ("PLANES16", Sample::U16, None),
    ("RGB32F", Sample::F32, Some(Order::Rgb)),
    ("BGRA32F", Sample::F32, Some(Order::Bgra)),
    ("PLANES32F", Sample::F32, None),
];

/// Of a dome of the largest size, without a mask.
#[divan::bench(args = FORMATS.map(|(name, ..)| name))]
fn formats(bencher: Bencher, name: &str) {
    let (_, sample, order) = FORMATS.into_iter().find(|format| format.0 == name).expect("one of them");
    let [width, height] = sizes().pop().expect("sizes");
    time_unit_normals(bencher, &dome_as(width, height, sample, order).image());
}

/// The angle of each normal.
#[divan::bench(args = cases())]
fn uncertainty(bencher: Bencher, case: &Case) {
    let photograph = case.photograph();
    let image = photograph.image();
    let solution = answer(&image);
    let sources = solution.uncertainty_sources().expect("the joint method knows");
    let (width, pixels) = (image.width(), image.width() * image.height());
    let mut angles = vec![0.0; pixels];
    bencher.counter(ItemsCount::new(pixels)).bench_local(|| {
        let uncertainty = Uncertainty::new(black_box(&sources));
        uncertainty.compute(&image, solution.inliers.selector(), &mut angles, width).expect("room for all");
    });
}
