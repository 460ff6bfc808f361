//! How long a VGA picture takes: `cargo bench -p ofc-tests`. The bounds on one core are 0.25 s a solve, 20 ns a pixel of
//! normals, 100 ms for the regions of a picture, and 50 ms for rendering 256 x 256 pixels under three lights with cast
//! shadows. How integration compares with others is `depth_peers.py`'s matter.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::color::segment;
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Order, Sample, Usable, Window};
use ofc_core::render::{self, Canvas, Lights, Outputs, render};
use ofc_core::solve::{OrientationMethod, Outcome, Params, Solution, solve, workspace_len};
use ofc_core::surface::depth::{self, DepthInput, DepthParams, Method, Plane, Slopes};
use ofc_core::surface::normals::{Length, compute};
use ofc_tests::depth_maps::{TABLE_1_COLORS, bust, table_1_directions, terrain};
use ofc_tests::depth_workspace::Workspace;
use ofc_tests::linear_scenes::{Encoded, Layout, Scene, ellipsoid, three_lights};
use ofc_tests::shaded_scenes::{self, CLEAN, OTHER, cap, moved};

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
    answer_by(OrientationMethod::Joint, encoded, workspace)
}

fn answer_by(orientation_method: OrientationMethod, encoded: &Encoded, workspace: &mut [f32]) -> Solution {
    let params = Params { orientation_method, ..Params::default() };
    let solution = solve(&black_box(encoded).image(), &params, workspace).expect("enough pixels");
    assert_eq!(solution.outcome, Outcome::Solved);
    solution
}

fn workspace() -> Vec<f32> {
    vec![0.0; workspace_len(PIXELS, Params::default().lmeds.sample_size)]
}

/// The whole pipeline with default parameters, and with the direct method, for what the other one adds: a quarter at most.
#[divan::bench(args = [OrientationMethod::Joint, OrientationMethod::Direct], consts = [false, true])]
fn solve_vga<const FLOATS: bool>(bencher: Bencher, orientation_method: OrientationMethod) {
    let sample = if FLOATS { Sample::F32 } else { Sample::U8 };
    let (encoded, mut workspace) = (scene(sample), workspace());
    bencher.bench_local(|| answer_by(orientation_method, &encoded, &mut workspace));
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

/// The regions of a picture of two objects under different lights.
#[divan::bench]
fn segment_vga(bencher: Bencher) {
    let (left, right) = (moved(cap(280.0, 160.0), [-156.0, 0.0]), moved(cap(240.0, 150.0), [160.0, 5.0]));
    let left = shaded_scenes::Scene::new(640, 480, &CLEAN, left);
    let both =
        left.behind(&shaded_scenes::Scene::new(640, 480, &OTHER, right)).with_noise(1.0, 9).quantized();
    let params = segment::Params::default();
    let (mut labels, mut queue) = (vec![0; PIXELS], vec![0; PIXELS]);
    let mut colors = vec![0.0; segment::colors_len(PIXELS)];
    bencher.bench_local(|| {
        let usable = Usable::below(255.0);
        let image = black_box(&both).image();
        segment::segment(&image, usable, &params, &mut labels, &mut colors, &mut queue).expect("room for all")
    });
}

/// A rough terrain and a bust, rendered under the paper's three lights with cast shadows.
#[divan::bench(args = [0, 1])]
fn render_256_terrain_bust(bencher: Bencher, which: usize) {
    let relief = [terrain, bust][which](256, 256);
    let bytes = relief.bytes();
    let directions = table_1_directions();
    let lights = Lights::new(&directions, &TABLE_1_COLORS).expect("the paper's lights");
    let mut pixels = vec![0_u8; 256 * 256 * 3];
    bencher.bench_local(|| {
        let depth = relief.view(black_box(&bytes));
        let picture =
            Canvas::new(&mut pixels, 256, 256, 256 * 3, Sample::U8, Order::Rgb).expect("room for all");
        let outputs = Outputs { picture, seen: None, normals: None };
        render(&depth, &lights, &render::Params { noise: 1.0, ..render::Params::default() }, outputs)
    });
}

/// Depth from the normals of the solved picture.
#[divan::bench(args = [Method::Poisson, Method::Paper, Method::Coupled])]
fn integrate_vga(bencher: Bencher, method: Method) {
    let encoded = scene(Sample::U8);
    let solution = answer(&encoded, &mut workspace());
    let f_inverse = solution.choice.expect("an answer").orientation.f_inverse;
    let mut normals = vec![0.0_f32; PIXELS * 3];
    let inliers = solution.inliers;
    let bits = |window: &Window| inliers.bits(window);
    compute(&encoded.image(), bits, &f_inverse, Length::Unit, &mut normals, 640 * 3).expect("room for all");
    let slopes = Slopes::Normals(Plane::new(&normals, 640, 480, 3, 640 * 3).expect("its own size"));
    let input = DepthInput { slopes, mask: None, weights: None, prior: None };
    let params = DepthParams { method, ..DepthParams::default() };
    let mut workspace = Workspace::new(640, 480, 0.0);
    let mut depths = vec![0.0; PIXELS];
    bencher.bench_local(|| depth::integrate(black_box(&input), &params, workspace.arena(), &mut depths, 640));
}

fn main() {
    divan::main();
}
