//! How long a VGA picture takes: `cargo bench -p ofc-tests`. The bounds are 0.25 s a solve and 20 ns a pixel of normals
//! on one core.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::image::{Order, Sample};
use ofc_core::normals::{Length, compute};
use ofc_core::rng::Rng;
use ofc_core::solve::{Outcome, Params, Solution, solve, workspace_len};
use ofc_tests::scenes::{Encoded, Layout, Scene, ellipsoid, three_lights};

const PIXELS: usize = 640 * 480;

/// An ellipsoid that fills most of the picture, with a tenth of highlights, in 8 bits.
fn scene(sample: Sample) -> Encoded {
    let mut rng = Rng::new(1);
    let surface = ellipsoid([480.0, 380.0, 400.0], 42.0);
    let mut scene = Scene::render(640, 480, three_lights(), surface).with_noise(1.0, &mut rng);
    for color in &mut scene.colors {
        if color[0] > 0.0 && rng.below(10) == 0 {
            *color = color.map(|c| 0.5 * c + 110.0);
        }
    }
    scene.rounded().encode_as(Layout { sample, order: Some(Order::Bgr), gap: 0 })
}

fn answer(encoded: &Encoded, workspace: &mut [f32]) -> Solution {
    let solution = solve(&black_box(encoded).image(), &Params::default(), workspace).expect("enough pixels");
    assert_eq!(solution.outcome, Outcome::Solved);
    solution
}

fn workspace() -> Vec<f32> {
    vec![0.0; workspace_len(PIXELS, Params::default().lmeds.sample_size)]
}

/// The whole pipeline with default parameters.
#[divan::bench(args = [Sample::U8, Sample::F32])]
fn solve_vga(bencher: Bencher, sample: Sample) {
    let (encoded, mut workspace) = (scene(sample), workspace());
    bencher.bench_local(|| answer(&encoded, &mut workspace));
}

/// A normal for every inlier; the count is of all pixels of the picture.
#[divan::bench(args = [Length::Kept, Length::Unit])]
fn normals_vga(bencher: Bencher, length: Length) {
    let encoded = scene(Sample::U8);
    let solution = answer(&encoded, &mut workspace());
    let f_inverse = solution.choice.expect("an answer").orientation.f_inverse;
    let mut normals = vec![0.0_f32; PIXELS * 3];
    bencher.counter(ItemsCount::new(PIXELS)).bench_local(|| {
        let inliers = black_box(solution.inliers);
        compute(&encoded.image(), |window| inliers.bits(window), &f_inverse, length, &mut normals, 640 * 3)
            .expect("room for all");
    });
}

fn main() {
    divan::main();
}
