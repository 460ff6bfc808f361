//! The pictures that stages are timed on.

use ofc_core::math::rng::Rng;
use ofc_core::picture::{Image, Order, Sample};
use ofc_core::render::{self, Canvas, Lights, Outputs, render};
use ofc_core::solve::{OrientationMethod, Outcome, Params, Solution, solve, workspace_len};
use ofc_tests::depth_maps::{direction, egg};
use ofc_tests::linear_scenes::{Encoded, Layout, Scene, ellipsoid, three_lights};
use ofc_tests::photographs::{self, Photograph};
use ofc_tests::shaded_scenes::CLEAN;
use std::fmt;

/// What a picture shows.
#[derive(Clone, Copy)]
pub enum Subject {
    /// A cap that all lights reach, black around it, with a tenth of highlights.
    Dome,
    /// An egg with attached and cast shadows on a dark and noisy background.
    Egg,
    /// A photograph of porcelain.
    Cat,
}

/// A picture to be made.
#[derive(Clone, Copy)]
pub struct Case {
    /// What it shows.
    pub subject: Subject,
    /// Width and height; a photograph has its own.
    pub size: [usize; 2],
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [width, height] = self.size;
        match self.subject {
            Subject::Dome => write!(f, "dome {width} x {height}"),
            Subject::Egg => write!(f, "egg {width} x {height}"),
            Subject::Cat => write!(f, "cat"),
        }
    }
}

impl Case {
    /// The picture, with its mask.
    pub fn photograph(&self) -> Photograph {
        let [width, height] = self.size;
        match self.subject {
            Subject::Dome => dome(width, height),
            Subject::Egg => shaded_egg(width, height),
            Subject::Cat => photographs::load(CAT).expect("it was there"),
        }
    }
}

const CAT: &str = "cat_figurine";
/// VGA.
pub const VGA: [usize; 2] = [640, 480];

/// Sizes up to 1080p, and 12 million pixels where they are asked for.
pub fn sizes() -> Vec<[usize; 2]> {
    let large = std::env::var_os("OFC_BENCH_LARGE").map(|_| [4000, 3000]);
    [[256, 256], VGA, [1920, 1080]].into_iter().chain(large).collect()
}

/// Dome and egg in all sizes, and the cat where it is.
pub fn cases() -> Vec<Case> {
    let rendered = [Subject::Dome, Subject::Egg]
        .into_iter()
        .flat_map(|subject| sizes().into_iter().map(move |size| Case { subject, size }));
    let cat = photographs::directory().filter(|directory| directory.join(CAT).is_dir());
    rendered.chain(cat.map(|_| Case { subject: Subject::Cat, size: [0, 0] })).collect()
}

/// The colors of a dome of this size.
pub fn dome_scene(width: usize, height: usize) -> Scene {
    let mut rng = Rng::new(1);
    let scale = height as f64 / 480.0;
    let surface = ellipsoid([480.0, 380.0, 400.0].map(|axis| scale * axis), 42.0);
    let mut scene = Scene::render(width, height, three_lights(), surface).with_noise(1.0, &mut rng);
    for color in &mut scene.colors {
        if color[0] > 0.0 && rng.below(10) == 0 {
            *color = color.map(|c| 0.5 * c + 110.0);
        }
    }
    scene.rounded()
}

/// A dome in this format.
pub fn dome_as(width: usize, height: usize, sample: Sample, order: Option<Order>) -> Encoded {
    dome_scene(width, height).encode_as(Layout { sample, order, gap: 0 })
}

#[expect(clippy::cast_sign_loss, reason = "colors are not negative")]
fn dome(width: usize, height: usize) -> Photograph {
    let colors = dome_scene(width, height).colors;
    let mask = colors.iter().map(|color| if *color == [0.0; 3] { 0 } else { 255 }).collect();
    let rgb = colors.iter().flatten().map(|&value| value as u8).collect();
    Photograph { width, height, rgb, mask, normals: Vec::new() }
}

fn shaded_egg(width: usize, height: usize) -> Photograph {
    let relief = egg(width, height);
    let bytes = relief.bytes();
    let (mut directions, mut colors) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
    for (i, (angles, color)) in CLEAN.into_iter().enumerate() {
        directions[i] = direction(angles);
        for (row, value) in colors.iter_mut().zip(color) {
            row[i] = value;
        }
    }
    let lights = Lights::new(directions.as_flattened(), colors.as_flattened()).expect("three lights");
    let mut rgb = vec![0; 3 * width * height];
    let picture =
        Canvas::new(&mut rgb, width, height, 3 * width, Sample::U8, Order::Rgb).expect("room for all");
    let params = render::Params { noise: 1.0, ..render::Params::default() };
    render(&relief.view(&bytes), &lights, &params, Outputs { picture, seen: None, normals: None })
        .expect("a surface");
    let mut rng = Rng::new(2);
    for (color, &mask) in rgb.as_chunks_mut::<3>().0.iter_mut().zip(&relief.mask) {
        if mask == 0 {
            *color = color.map(|_| rng.below(4) as u8);
        }
    }
    Photograph { width, height, rgb, mask: relief.mask, normals: Vec::new() }
}

/// The workspace of a solution.
pub fn workspace(image: &Image) -> Vec<f32> {
    vec![0.0; workspace_len(image.width() * image.height(), Params::default().lmeds.sample_size)]
}

/// The solution with default parameters.
pub fn answer(image: &Image) -> Solution {
    answer_by(OrientationMethod::Joint, image, &mut workspace(image))
}

/// The solution by this method, which must exist.
pub fn answer_by(orientation_method: OrientationMethod, image: &Image, workspace: &mut [f32]) -> Solution {
    let params = Params { orientation_method, ..Params::default() };
    let solution = solve(image, &params, workspace).expect("enough pixels");
    assert_eq!(solution.outcome, Outcome::Solved);
    solution
}
