//! How to complete a surface, what comes out beside the pictures, and why nothing does.

use crate::math::arena::Need;
use core::fmt;

/// How to complete a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompletionParams {
    /// Width and height of a pixel on the surface, in the unit that depth is wanted in: in [1e-30, 1e30]. Default 1.
    pub pixel_pitch: f64,
    /// Determines every random choice. Default 0.
    pub seed: u64,
    /// Whether every channel is a photograph of its own under one light: then the rows of F are the lights, and none is searched
    /// for. Default `false`.
    pub channels_are_lights: bool,
}

impl Default for CompletionParams {
    fn default() -> Self {
        Self { pixel_pitch: 1.0, seed: 0, channels_are_lights: false }
    }
}

impl CompletionParams {
    pub(super) fn is_valid(&self) -> bool {
        (1e-30..=1e30).contains(&self.pixel_pitch)
    }
}

/// The pictures that are written, each with the numbers from one row to the next; what lies between rows is left alone.
#[derive(Debug)]
pub struct Outputs<'a> {
    /// Three numbers a pixel: unit normals, x right, y up, z toward the camera; zero outside of the mask.
    pub normals: (&'a mut [f32], usize),
    /// The angle in radians below which 68 % of errors are expected to lie; pi outside of the mask.
    pub angles: (&'a mut [f32], usize),
    /// The depth, growing toward the camera, in the unit of the pixel pitch; NaN outside of the mask.
    pub depths: (&'a mut [f32], usize),
    /// A byte a pixel: class, lights that are seen, doubt.
    pub classes: (&'a mut [u8], usize),
}

/// How the dual vector of a light was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DualSource {
    /// It was not: pixels in this light's shadow are interpolated.
    #[default]
    None,
    /// From the directions of all three lights.
    Directions,
    /// From what the shadows of one or two lights show, by a search.
    Search,
    /// The search found none that the normals in the shadow agree with: pixels there are interpolated.
    Rejected,
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The unit vector toward the light.
    pub direction: [f64; 3],
    /// The color of a surface that faces the light, in pixel values; `None` where the dual vector is not known.
    pub color: Option<[f64; 3]>,
    /// How that was found.
    pub dual: DualSource,
}

/// What came out, beside the pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Completion {
    /// The lights whose shadows were found.
    pub lights: [Option<Light>; 3],
    /// How many pixels are of each class, the number of the class being the index.
    pub counts: [usize; 8],
    /// By how much normals differ across the borders of shadows in the median, beyond what they do among lit pixels: radians.
    pub border_gap: f64,
    /// Connected regions of the mask. Each has zero mean depth.
    pub regions: usize,
    /// Whether the last integration reached its tolerance.
    pub converged: bool,
}

/// Why nothing was completed; the outputs are untouched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CompletionError {
    /// There are more than [`MAX_PIXELS`](crate::surface::depth::MAX_PIXELS).
    Size,
    /// A parameter is outside its range.
    Parameter,
    /// The workspace holds less than this.
    Workspace(Need),
    /// An output ends before its last row, or its row stride is smaller than a row.
    Output,
    /// No pixel of the mask is usable.
    Empty,
    /// The solution is that of another picture: lit pixels do not have colors of its ellipsoid.
    OtherPicture,
}

impl fmt::Display for CompletionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => f.write_str("the picture has too many pixels"),
            Self::Parameter => f.write_str("a parameter is out of its range"),
            Self::Workspace(need) => write!(f, "the workspace holds less than {} bytes", need.bytes()),
            Self::Output => f.write_str("an output ends before its last row, or its rows are too short"),
            Self::Empty => f.write_str("no pixel of the mask is usable"),
            Self::OtherPicture => f.write_str("the solution is that of another picture"),
        }
    }
}

impl core::error::Error for CompletionError {}
