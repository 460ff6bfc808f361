//! A stream with its memory, fed with pictures row by row, and what it is held against.

use crate::bust::bust;
use crate::linear::{Matrix, degrees_between, length};
use crate::shaded_scenes::{self, CLEAN, PAPER};
use ofc_core::light::constrained_slant::WORKSPACE_LEN;
use ofc_core::picture::Image;
use ofc_core::solve::{OrientationMethod, ShadowRejection, Solution, solve, workspace_len};
use ofc_core::stream::{Memory, Params, Pass, State, Stream, StreamError, places_len, values_len};

/// A stream over buffers of its own.
pub struct Camera {
    /// What the stream remembers.
    pub state: State,
    /// Its memory in doubles.
    pub boxes: Vec<f64>,
    /// Its memory in singles.
    pub values: Vec<f32>,
    /// Its memory in bytes.
    pub places: Vec<u8>,
}

impl Camera {
    /// A stream for pictures of the size and format of this one.
    pub fn new(image: &Image, params: Params) -> Self {
        let (width, height, sample) = (image.width(), image.height(), params.solve.lmeds.sample_size);
        let state = State::new(width, height, image.sample(), params).unwrap();
        // Whatever the memory holds, it means nothing.
        let values = vec![f32::NAN; values_len(width, height, sample, params.solve.orientation_method)];
        let (boxes, places) = (vec![f64::NAN; WORKSPACE_LEN], vec![0xa5; places_len(width, height, sample)]);
        Self { state, boxes, values, places }
    }

    /// The stream, its memory cut anew.
    pub fn stream(&mut self) -> Stream<'_> {
        let memory = Memory { boxes: &mut self.boxes, values: &mut self.values, places: &mut self.places };
        Stream::new(&mut self.state, memory).unwrap()
    }

    /// One frame.
    ///
    /// # Errors
    /// What the end of the pass says.
    pub fn frame(&mut self, image: &Image) -> Result<Pass, StreamError> {
        self.stream().begin().unwrap();
        for y in 0..image.height() {
            // As if the caller had been away between any two rows.
            self.stream().row(y, &image.row(y).unwrap()).unwrap();
        }
        self.stream().end()
    }

    /// Frames until there is an answer, at most five.
    ///
    /// # Errors
    /// What the end of a pass says.
    pub fn cold(&mut self, image: &Image) -> Result<Pass, StreamError> {
        let mut pass = self.frame(image)?;
        for expected in [Pass::Outward, Pass::Integrability, Pass::Tilts, Pass::Slants] {
            if pass == expected {
                pass = self.frame(image)?;
            }
        }
        Ok(pass)
    }
}

/// The defaults with a sample of this size.
pub fn sampling(sample_size: u32) -> Params {
    let mut params = Params::default();
    params.solve.lmeds.sample_size = sample_size;
    params
}

/// The direct method, as streams take it without the feature `full-streams`.
pub fn direct(mut params: Params) -> Params {
    params.solve.orientation_method = OrientationMethod::Direct;
    params
}

/// Both methods, with shadow rejection and without.
pub fn methods(params: Params) -> [Params; 4] {
    let with = |mut params: Params, shadow_rejection| {
        params.solve.shadow_rejection = shadow_rejection;
        params
    };
    [params, with(params, ShadowRejection::Off), direct(params), with(direct(params), ShadowRejection::On)]
}

/// The solution of the whole picture with the parameters of a stream.
pub fn whole(image: &Image, params: &Params) -> Solution {
    let pixels = image.width() * image.height();
    let mut workspace = vec![0.0; workspace_len(pixels, params.solve.lmeds.sample_size)];
    solve(image, &params.solve, &mut workspace).unwrap()
}

/// Every number of a solution, with its bits: shortest round-trip digits, and the sign of zero.
pub fn digits(solution: &Solution) -> String {
    format!("{solution:?}")
}

/// A bust in QVGA with noise, rounded to bytes, under lights that are well known on that method.
pub fn portrait(orientation_method: OrientationMethod, seed: u64) -> shaded_scenes::Scene {
    let lights = if orientation_method == OrientationMethod::Joint { CLEAN } else { PAPER };
    shaded_scenes::Scene::new(320, 240, &lights, bust(240.0)).with_noise(1.0, seed).quantized()
}

/// The largest angle between rows of two F, in degrees, and the largest relative difference of their lengths.
pub fn apart(a: &Matrix, b: &Matrix) -> (f64, f64) {
    let rows = || a.iter().zip(b);
    let angle = rows().map(|(&a, &b)| degrees_between(a, b)).fold(0.0, f64::max);
    (angle, rows().map(|(&a, &b)| (length(a) / length(b) - 1.0).abs()).fold(0.0, f64::max))
}
