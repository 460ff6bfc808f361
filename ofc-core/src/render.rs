//! The forward model: the color picture of a depth map under any number of distant lights.
//!
//! # Reference
//! Section 1.1, eqs. 1-7, and section 4 for shadows, scale and noise.

mod canvas;
mod cast_shadow;
mod depth_map;
mod lights;

pub use canvas::Canvas;
pub use depth_map::{DepthMap, DepthMapError};
pub use lights::{Lights, LightsError, MAX_LIGHTS};

use crate::math::mat3;
use crate::math::rng::Rng;
use cast_shadow::{Caster, NO_TILES};
use core::fmt;
use libm::sqrt;

/// What is added to eq. 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// Whether the surface casts shadows; parts that face away from a light are dark in any case. Default `true`.
    pub cast_shadows: bool,
    /// Colors are scaled by one factor so that the largest modulus of a color is this, from 0 to 1e30; 0 for no scaling.
    /// Default 255.
    pub peak: f64,
    /// The standard deviation of Gaussian noise, from 0 to 1e30 in pixel values, after scaling. Default 0.
    pub noise: f64,
    /// Fixes the noise: it depends on nothing but this and a pixel's number in picture order. Default 0.
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { cast_shadows: true, peak: 255.0, noise: 0.0, seed: 0 }
    }
}

/// Rows of values, `row_stride` values apart; what lies between rows is left alone.
#[derive(Debug)]
pub struct Rows<'a, T> {
    /// The values.
    pub values: &'a mut [T],
    /// From the start of one row to the start of the next, in values.
    pub row_stride: usize,
}

impl<T> Rows<'_, T> {
    /// Whether there is room for `height` rows of `len`.
    fn hold(&self, len: usize, height: usize) -> bool {
        let last = height.checked_sub(1).and_then(|rows| self.row_stride.checked_mul(rows));
        let need = last.and_then(|last| last.checked_add(len));
        self.row_stride >= len && need.is_some_and(|need| self.values.len() >= need)
    }

    fn set<const N: usize>(&mut self, x: usize, y: usize, values: [T; N]) {
        let start = y * self.row_stride + x * N;
        if let Some(out) = self.values.get_mut(start..).and_then(|rest| rest.first_chunk_mut()) {
            *out = values;
        }
    }
}

/// Where the results go.
#[derive(Debug)]
pub struct Outputs<'a> {
    /// The picture, black outside the mask.
    pub picture: Canvas<'a>,
    /// A value a pixel: bit `i` is set where the surface sees light `i`; 0 outside the mask.
    pub seen: Option<Rows<'a, u32>>,
    /// Three values a pixel: the unit normals, (0, 0, 0) outside the mask.
    pub normals: Option<Rows<'a, f32>>,
}

/// Why nothing was rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RenderError {
    /// A depth inside the mask is NaN or infinite.
    NonFiniteDepth,
    /// `peak` is out of its range.
    Peak,
    /// `noise` is out of its range.
    Noise,
    /// An output is too short for the depth map, or the picture's size is not the depth map's.
    Size,
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NonFiniteDepth => "a depth inside the mask is not finite",
            Self::Peak => "the peak is out of its range",
            Self::Noise => "the noise is out of its range",
            Self::Size => {
                "an output is too short for the depth map, or the picture's size is not the depth map's"
            }
        })
    }
}

impl core::error::Error for RenderError {}

/// What was rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rendering {
    /// The largest modulus of a color before scaling; 0 when all is dark.
    pub largest: f64,
    /// The factor applied: the picture's F is this times `Lights::orientation`.
    pub scale: f64,
}

/// Renders a depth map (eq. 5, summed over the lights that each pixel sees).
///
/// A pixel sees light `i` if `a_i . n > 0` and, with cast shadows, no part of the surface inside picture and mask is in
/// the way.
///
/// # Shape
/// The outputs have the depth map's width and height. Frame: x right, y up, z toward the camera.
///
/// # Errors
/// [`RenderError`]; the outputs are then untouched.
///
/// # Scratch
/// None: a first pass finds the largest modulus, a second one writes. Stack below 3 KiB.
///
/// # Example
/// ```
/// use ofc_core::render::{Canvas, DepthMap, Lights, Outputs, Params, render};
/// use ofc_core::{Order, Sample};
///
/// // A dome, under a red light from the camera, a green one from the right and a blue one from above.
/// let depth = |i: usize| 30.0 - 0.01 * (((i % 64) as f32 - 31.5).powi(2) + ((i / 64) as f32 - 31.5).powi(2));
/// let depths: Vec<u8> = (0..64 * 64).flat_map(|i| depth(i).to_ne_bytes()).collect();
/// let surface = DepthMap::new(&depths, 64, 64, 4 * 64, 1.0).unwrap();
/// let (a, b) = ([0.0, 0.0, 1.0, 0.6, 0.0, 0.8, 0.0, 0.6, 0.8], [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
/// let lights = Lights::new(&a, &b).unwrap();
///
/// let mut pixels = vec![0; 3 * 64 * 64];
/// let picture = Canvas::new(&mut pixels, 64, 64, 3 * 64, Sample::U8, Order::Rgb).unwrap();
/// render(&surface, &lights, &Params::default(), Outputs { picture, seen: None, normals: None }).unwrap();
/// let [red, green, blue] = [0, 1, 2].map(|channel| pixels[3 * (64 * 32 + 60) + channel]);
/// assert!(green > red && red > blue); // on the right
/// ```
pub fn render(
    depth: &DepthMap,
    lights: &Lights,
    params: &Params,
    outputs: Outputs,
) -> Result<Rendering, RenderError> {
    let (width, height) = (depth.width(), depth.height());
    let Outputs { mut picture, mut seen, mut normals } = outputs;
    if !(0.0..=1e30).contains(&params.peak) {
        return Err(RenderError::Peak);
    }
    if !(0.0..=1e30).contains(&params.noise) {
        return Err(RenderError::Noise);
    }
    if picture.size() != [width, height]
        || seen.as_ref().is_some_and(|rows| !rows.hold(width, height))
        || normals.as_ref().is_some_and(|rows| !rows.hold(width * 3, height))
    {
        return Err(RenderError::Size);
    }
    let range = depth.range().ok_or(RenderError::NonFiniteDepth)?;
    let mut tiles = NO_TILES;
    let caster = params.cast_shadows.then(|| Caster::new(depth, range, &mut tiles));
    let scene = Scene { depth, lights, caster };
    let largest = scene.largest_modulus();
    let scale = if params.peak > 0.0 && largest > 0.0 { params.peak / largest } else { 1.0 };
    for y in 0..height {
        for x in 0..width {
            let (mut color, mut bits, mut normal) = ([0.0; 3], 0, [0.0; 3]);
            if let Some(n) = depth.normal(x, y) {
                normal = n;
                (color, bits) = scene.shade(x, y, n, true);
                color = mat3::scale(color, scale);
                if params.noise > 0.0 {
                    let noise = noise(params.seed, (y * width + x) as u64);
                    for (value, noise) in color.iter_mut().zip(noise) {
                        *value += params.noise * noise;
                    }
                }
            }
            picture.set(x, y, color);
            if let Some(rows) = &mut seen {
                rows.set(x, y, [bits]);
            }
            if let Some(rows) = &mut normals {
                rows.set(x, y, normal.map(|component| component as f32));
            }
        }
    }
    Ok(Rendering { largest, scale })
}

/// Writes the unit normals of a depth map, as [`DepthMap::normal`] has them, and (0, 0, 0) where there is no surface.
///
/// # Errors
/// [`RenderError::Size`]; `normals` is then untouched.
pub fn normals_from_depth(depth: &DepthMap, normals: &mut Rows<f32>) -> Result<(), RenderError> {
    if !normals.hold(depth.width() * 3, depth.height()) {
        return Err(RenderError::Size);
    }
    for y in 0..depth.height() {
        for x in 0..depth.width() {
            let normal = depth.normal(x, y).unwrap_or_default();
            normals.set(x, y, normal.map(|component| component as f32));
        }
    }
    Ok(())
}

/// A surface under lights.
struct Scene<'a> {
    depth: &'a DepthMap<'a>,
    lights: &'a Lights<'a>,
    caster: Option<Caster<'a>>,
}

impl Scene<'_> {
    /// The unscaled color at (x, y), and the lights it comes from.
    fn shade(&self, x: usize, y: usize, normal: [f64; 3], cast_shadows: bool) -> ([f64; 3], u32) {
        let (mut color, mut seen) = ([0.0; 3], 0);
        let caster = self.caster.as_ref().filter(|_| cast_shadows);
        for (light, (direction, strength)) in self.lights.iter().enumerate() {
            let cosine = mat3::dot(direction, normal);
            if cosine > 0.0 && !caster.is_some_and(|caster| caster.hides(x, y, direction)) {
                seen |= 1 << light;
                for (value, strength) in color.iter_mut().zip(strength) {
                    *value += cosine * strength;
                }
            }
        }
        (color, seen)
    }

    fn largest_modulus(&self) -> f64 {
        let mut largest = 0.0;
        for y in 0..self.depth.height() {
            for x in 0..self.depth.width() {
                let Some(normal) = self.depth.normal(x, y) else { continue };
                let (bright, _) = self.shade(x, y, normal, false);
                // No color is negative, so a cast shadow makes the modulus smaller: few pixels need to look for one.
                if self.caster.is_none() {
                    largest = mat3::dot(bright, bright).max(largest);
                } else if mat3::dot(bright, bright) > largest {
                    let (color, _) = self.shade(x, y, normal, true);
                    largest = mat3::dot(color, color).max(largest);
                }
            }
        }
        sqrt(largest)
    }
}

/// Three standard normal numbers that belong to a pixel.
fn noise(seed: u64, pixel: u64) -> [f64; 3] {
    const DRAWS: u64 = 4;
    let mut rng = Rng::new(seed);
    rng.skip(pixel * DRAWS);
    let ([red, green], [blue, _]) = (rng.normal_pair(), rng.normal_pair());
    [red, green, blue]
}
