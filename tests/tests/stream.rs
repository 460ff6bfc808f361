//! Rows instead of pictures.

use ofc_core::image::{Image, Order, Sample};
use ofc_core::normals::{self, Length};
use ofc_core::rng::Rng;
use ofc_core::solve::{Outcome, SlantFallback, Solution, solve, workspace_len};
use ofc_core::stream::{Memory, Params, Pass, State, Stream, StreamError, places_len, values_len};
use ofc_core::tilt::TiltEstimator;
use ofc_tests::photographs::load;
use ofc_tests::scenes::{Layout, Scene, cylinder, ellipsoid, plane, sphere, table_1_f, three_lights};

/// A stream over buffers of its own.
struct Camera {
    state: State,
    values: Vec<f32>,
    places: Vec<u8>,
}

impl Camera {
    fn new(image: &Image, params: Params) -> Self {
        let (width, height, sample) = (image.width(), image.height(), params.solve.lmeds.sample_size);
        let state = State::new(width, height, image.sample(), params).unwrap();
        // Whatever the memory holds, it means nothing.
        let values = vec![f32::NAN; values_len(width, height, sample)];
        Self { state, values, places: vec![0xa5; places_len(width, height, sample)] }
    }

    fn stream(&mut self) -> Stream<'_> {
        let memory = Memory { values: &mut self.values, places: &mut self.places };
        Stream::new(&mut self.state, memory).unwrap()
    }

    /// One frame.
    fn frame(&mut self, image: &Image) -> Result<Pass, StreamError> {
        self.stream().begin().unwrap();
        for y in 0..image.height() {
            // As if the caller had been away between any two rows.
            self.stream().row(y, &image.row(y).unwrap()).unwrap();
        }
        self.stream().end()
    }

    /// Frames until there is an answer, at most three.
    fn cold(&mut self, image: &Image) -> Result<Pass, StreamError> {
        for expected in [Pass::Tilts, Pass::Slants, Pass::Solved] {
            let next = self.frame(image)?;
            if next != expected {
                return Ok(next);
            }
        }
        Ok(Pass::Solved)
    }
}

fn sampling(sample_size: u32) -> Params {
    let mut params = Params::default();
    params.solve.lmeds.sample_size = sample_size;
    params
}

fn whole(image: &Image, params: &Params) -> Solution {
    let pixels = image.width() * image.height();
    let mut workspace = vec![0.0; workspace_len(pixels, params.solve.lmeds.sample_size)];
    solve(image, &params.solve, &mut workspace).unwrap()
}

/// Every number of a solution, with its bits: shortest round-trip digits, and the sign of zero.
fn digits(solution: &Solution) -> String {
    format!("{solution:?}")
}

/// Sample, model, tilts, choice, normals and inliers of rows are those of the picture, to the bit.
fn assert_same(image: &Image, params: Params) -> Outcome {
    let expected = whole(image, &params);
    let mut camera = Camera::new(image, params);
    let pass = camera.cold(image).unwrap();
    assert_eq!(digits(camera.state.solution()), digits(&expected));
    assert_eq!(pass == Pass::Solved, expected.outcome == Outcome::Solved);
    if pass != Pass::Solved {
        return expected.outcome;
    }
    let choice = expected.choice.as_ref().unwrap();
    let (width, height) = (image.width(), image.height());
    let mut picture = vec![0.0; width * height * 3];
    let bits = |window: &_| expected.inliers.bits(window);
    normals::compute(image, bits, &choice.orientation.f_inverse, Length::Unit, &mut picture, width * 3)
        .unwrap();
    let mut mask = vec![0; width * height];
    expected.inliers.mark(image, &mut mask);
    let (mut row, mut packed, mut flags) = (vec![9.0; width * 3], vec![9; width * 3], vec![9; width]);
    for y in 0..height {
        let view = image.row(y).unwrap();
        camera.state.normals(&view, &mut row).unwrap();
        camera.state.packed_normals(&view, &mut packed).unwrap();
        camera.state.inliers(&view, &mut flags).unwrap();
        let expected = &picture[y * width * 3..][..width * 3];
        assert!(row.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits()), "row {y}");
        assert_eq!(flags, mask[y * width..][..width]);
        for (i, (&byte, &component)) in packed.iter().zip(expected).enumerate() {
            let normal = if flags[i / 3] == 0 { 0.0 } else { f64::midpoint(f64::from(component), 1.0) * 255.0 };
            assert!((f64::from(byte) - normal).abs() <= 0.5 + 1e-4, "row {y}: {byte} for {component}");
        }
    }
    Outcome::Solved
}

#[test]
fn a_sample_of_everything_gives_the_same_bits() {
    let mut rng = Rng::new(3);
    let formats = [Sample::U8, Sample::U16, Sample::F32];
    let mut solved = 0;
    for (width, height) in [(110, 90), (64, 65), (63, 71), (130, 63), (65, 64)] {
        let radius = 0.45 * width.min(height) as f64;
        let bodies = [
            Scene::render(width, height, three_lights(), sphere(radius / 0.6, 36.0)),
            Scene::render(width, height, table_1_f(), ellipsoid([radius, 0.9 * radius, radius], 30.0)),
        ];
        for (i, body) in bodies.into_iter().enumerate() {
            let noisy = body.with_noise(0.7, &mut rng);
            for (sample, order) in formats.into_iter().zip([Some(Order::Rgb), Some(Order::Bgra), None]) {
                let scene = if sample == Sample::F32 { noisy.clone() } else { noisy.clone().rounded() };
                let encoded = scene.encode_as(Layout { sample, order, gap: 12 });
                let usable = scene.colors.iter().filter(|c| c.iter().any(|&v| v > 0.0)).count();
                // All pixels, and exactly as many as there are.
                for size in [width * height, usable] {
                    let outcome = assert_same(&encoded.image(), sampling(size as u32));
                    solved += usize::from(outcome == Outcome::Solved);
                    println!("{width} x {height} {i} {sample:?} {usable}: {outcome:?}");
                }
            }
        }
    }
    assert!(solved > 30, "{solved} were solved");
}
