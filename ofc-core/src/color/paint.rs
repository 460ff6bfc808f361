//! C where the paint is uneven, from pairs of neighbors.
//!
//! With an albedo a(x) the model is rho = a(x) F n. The least median of squares takes every color's length for that of its normal,
//! so uneven paint bends its ellipsoid or spoils its noise. Paint changes the length of a color and not its direction, and
//! neighbors share it: for two of them, p and q, p^T C p = q^T C q, which is linear and homogeneous in C. So C follows up to
//! its scale, whatever the paint, as far as paint changes more slowly than the surface's direction.
//!
//! [`estimate`] draws pairs at three distances, begins at the best of many forms through five pairs each, and goes on with a
//! reweighted generalized eigenproblem whose second matrix holds what paint itself adds to the first. It says how well the colors
//! determine C by noise *across* their direction, which paint can neither hide nor fake, how rough the paint is at each
//! distance, and whether it can be told from the shape. [`albedo`] is then the smoothed length of the normals that C makes, and
//! [`divide`](albedo::divide) the picture as if its paint were even, for `solve` and everything after it.
//!
//! `docs/paint.md` derives all of it and says where it fails.

pub mod albedo;
mod hues;
mod local_noise;
mod pairs;
mod proposals;
mod refinement;
mod sampler;

use crate::color::ellipsoid::{self, Coefficients};
use crate::color::regression::Moments;
use crate::color::scale::reciprocal_power_of_two;
use crate::math::mat3;
use crate::math::rng::Rng;
use crate::picture::{Image, PixelCounts, Usable, for_each_bit};
use core::fmt;
use libm::sqrt;
use local_noise::local_noise;
pub use pairs::DISTANCES;
use pairs::Pairs;
use refinement::Refined;
use sampler::Sampler;

/// The shortest distance is the root of the number of usable pixels divided by this, and at least [`SHORTEST`].
const SHARE_OF_SIZE: u32 = 32;
/// The means of three by three pixels that are compared overlap at shorter distances than two pixels by more than a third.
const SHORTEST: u32 = 2;

/// Fewer usable pixels are no picture to draw pairs of.
pub const MIN_PIXELS: usize = 100;

/// Below this margin noise may be all that determines C: degenerate scenes of even hue reach 1.2, whatever their paint.
pub const SMALLEST_MARGIN: f64 = 2.0;
/// Below this ratio the paint is as rough as the shape, and C may be wrong.
pub const SMALLEST_RATIO: f64 = 1.7;
/// From this ratio on C is as good as with known paint.
pub const SURE_RATIO: f64 = 4.0;
/// Above this disagreement between the forms of two halves of the pairs, C is not determined: it is 1.3 at most where it is right.
pub const LARGEST_DISAGREEMENT: f64 = 1.5;
/// From this excess on the paint has two hues or more: one hue reaches 7.5.
pub const LEAST_HUE_EXCESS: f64 = 8.0;

/// The shortest distance over which steps of the hue are looked for, in pixels, and the longer one: blurred borders are
/// narrower.
const STEP: u32 = 3;
const LONG_STEP: u32 = 6;
/// The longer one is at least the root of the number of usable pixels divided by this.
const STEP_SHARE_OF_SIZE: u32 = 64;

/// How to estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Params {
    /// Fixes every random choice. Default 0.
    pub seed: u64,
}

/// What the paint is, or why it cannot be told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The paint is smooth against the shape: C is about as good as if the paint were known.
    Smooth,
    /// The paint is nearly as rough as the shape: C is up to twice as wrong as if the paint were known.
    Rough,
    /// The paint is as rough as the shape, and C may be wrong.
    Busy,
    /// The paint has two hues or more, and C is wrong: the picture must be divided into regions of one paint each.
    TwoHues,
    /// Colors, whatever their paint, do not determine C: normals or lights span too little.
    Undetermined,
    /// No form that the pairs agree with is an ellipsoid, or too few pairs differ.
    NoEllipsoid,
}

/// What the pairs say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// What to make of it.
    pub verdict: Verdict,
    /// C with the median albedo 1, in (pixel value)^-2; there unless the verdict is [`Verdict::NoEllipsoid`].
    pub form: Option<Coefficients>,
    /// The noise that would explain the colors by a scene that does not determine C, over the noise across their direction.
    pub margin: f64,
    /// The noise of a channel across the direction of the color, in pixel values.
    pub direction_noise: f64,
    /// The root of the second smallest over the smallest eigenvalue: how much worse the next best form explains the pairs.
    /// NaN without a form.
    pub ratio: f64,
    /// How much the forms of two halves of the pairs differ: what is a sphere for one is an ellipsoid for the other, and this is the
    /// ratio of its longest to its shortest semi-axis. Infinite where a half has no form, NaN without a form.
    pub disagreement: f64,
    /// By how many deviations steps of one hue stand out among the steps of the colors' direction.
    pub hue_excess: f64,
    /// The gradient of log a across the picture, a pixel, x right and y up.
    pub gradient: [f64; 2],
    /// The distances at which pairs were drawn, in pixels.
    pub distances: [u32; DISTANCES],
    /// The deviation of log a(p)^2 - log a(q)^2 over the pairs of each distance, beyond what noise and the gradient explain: the
    /// variogram of paint. NaN where there are too few pairs.
    pub variogram: [f64; DISTANCES],
    /// How many pairs were found at each distance.
    pub pairs: [u32; DISTANCES],
    /// What became of the pixels.
    pub pixel_counts: PixelCounts,
}

/// Why nothing was estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PaintError {
    /// The workspace is shorter than [`WORKSPACE_LEN`].
    WorkspaceTooShort,
    /// There are fewer than [`MIN_PIXELS`] usable pixels.
    TooFewPixels,
    /// As before, and most pixels are black.
    Dark,
    /// As before, and most pixels are saturated.
    Saturated,
}

impl fmt::Display for PaintError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::WorkspaceTooShort => "the workspace is too short",
            Self::TooFewPixels => "too few usable pixels",
            Self::Dark => "too few usable pixels: most are black",
            Self::Saturated => "too few usable pixels: most are saturated",
        })
    }
}

impl core::error::Error for PaintError {}

/// How many `f32` of workspace [`estimate`] takes, whatever the picture's size.
pub const WORKSPACE_LEN: usize = pairs::LEN + pairs::PER_DISTANCE;
const _: () = assert!(hues::LEN <= WORKSPACE_LEN);

/// Estimates C up to its scale, and says what the paint is like.
///
/// # Units
/// Pixel values.
///
/// # Errors
/// See [`PaintError`].
///
/// # Scratch
/// [`WORKSPACE_LEN`] `f32` in `workspace`; three passes over the picture and at most 400,000 reads of a few pixels. Below 8 KiB of stack.
///
/// # Example
/// A plane does not determine C, whatever its paint:
/// ```
/// use ofc_core::color::paint::{Params, Verdict, WORKSPACE_LEN, estimate};
/// use ofc_core::picture::Usable;
/// use ofc_core::{Image, Order, Sample};
///
/// let painted: Vec<u8> = (0..40 * 40).flat_map(|i| [60, 80, 100].map(|c| c + (i % 40) as u8)).collect();
/// let image = Image::interleaved(&painted, 40, 40, 3 * 40, Sample::U8, Order::Rgb).unwrap();
/// let usable = Usable::below(Sample::U8.saturation());
/// let paint = estimate(&image, usable, &Params::default(), &mut vec![0.0; WORKSPACE_LEN]).unwrap();
/// assert_ne!(paint.verdict, Verdict::Smooth);
/// ```
pub fn estimate(
    image: &Image,
    usable: Usable,
    params: &Params,
    workspace: &mut [f32],
) -> Result<Paint, PaintError> {
    let workspace = workspace.get_mut(..WORKSPACE_LEN).ok_or(PaintError::WorkspaceTooShort)?;
    let pixel_counts = usable.count(image);
    enough(&pixel_counts)?;
    let scale = reciprocal_power_of_two(pixel_counts.largest);
    let moments = moments(image, usable, scale);
    let mut sampler = Sampler::new(image, usable, Rng::new(params.seed));
    let noise = local_noise(&mut sampler, workspace);
    let size = (pixel_counts.usable as u32).isqrt();
    let long_step = LONG_STEP.max(size / STEP_SHARE_OF_SIZE);
    let hue_excess = hues::excess(&mut sampler, STEP, noise.across, workspace);
    let hue_excess = hue_excess.max(hues::excess(&mut sampler, long_step, noise.across, workspace));
    let shortest = ((size + SHARE_OF_SIZE / 2) / SHARE_OF_SIZE).max(SHORTEST);
    let mut paint = Paint {
        verdict: Verdict::NoEllipsoid,
        form: None,
        margin: margin(&moments, noise.across * scale),
        direction_noise: noise.across,
        ratio: f64::NAN,
        disagreement: f64::NAN,
        hue_excess,
        gradient: [0.0; 2],
        distances: [shortest, 2 * shortest, 4 * shortest],
        variogram: [f64::NAN; DISTANCES],
        pairs: [0; DISTANCES],
        pixel_counts,
    };
    let (room, values) = workspace.split_at_mut_checked(pairs::LEN).unwrap_or_default();
    // Directions are compared where the colors' second moments are a unit matrix.
    if let Some(whitening) = mat3::inverse(&moments.second_moments()) {
        let (room, _) = room.as_chunks_mut();
        let pairs = Pairs::draw(&mut sampler, &whitening, scale, paint.distances, room);
        paint.pairs = pairs.counts();
        let mut fit = Fit { noise: noise.of_means * scale, rng: sampler.rng, values };
        fit.describe(&pairs, scale, &mut paint);
    }
    paint.verdict = paint.judged();
    Ok(paint)
}

/// What fits of pairs share.
struct Fit<'w> {
    noise: f64,
    rng: Rng,
    values: &'w mut [f32],
}

impl Fit<'_> {
    fn form(&mut self, pairs: &Pairs) -> Option<Refined> {
        let start = proposals::best(pairs, &mut self.rng, self.values)?;
        refinement::refine(pairs, start, self.noise, self.values)
    }

    /// Adds what all pairs and their halves say.
    fn describe(&mut self, pairs: &Pairs, scale: f64, paint: &mut Paint) {
        let Some(all) = self.form(pairs) else { return };
        let [first, second] = pairs.halves().map(|half| self.form(&half));
        paint.disagreement = match (first, second) {
            (Some(first), Some(second)) => disagreement(&first.form, &second.form),
            _ => f64::INFINITY,
        };
        paint.form = Some(all.form.map(|c| c * scale * scale));
        paint.ratio = all.ratio;
        paint.variogram = all.variogram;
        let [along, down] = all.gradient;
        paint.gradient = [0.5 * along, -0.5 * down];
    }
}

/// The ratio of the semi-axes of the ellipsoid that the normals of one form make of the other's sphere.
fn disagreement(first: &Coefficients, second: &Coefficients) -> f64 {
    let Ok(sphere) = ellipsoid::decompose(first) else { return f64::INFINITY };
    let back = sphere.root_inverse();
    let product = mat3::multiply(&ellipsoid::matrix(second), &back);
    let [largest, _, smallest] =
        mat3::symmetric_eigen(&mat3::multiply(&mat3::transpose(&back), &product)).values;
    if smallest > 0.0 { sqrt(largest / smallest) } else { f64::INFINITY }
}

impl Paint {
    /// The verdict that follows from the numbers.
    fn judged(&self) -> Verdict {
        if self.margin < SMALLEST_MARGIN {
            Verdict::Undetermined
        } else if self.form.is_none() {
            Verdict::NoEllipsoid
        } else if self.hue_excess >= LEAST_HUE_EXCESS {
            Verdict::TwoHues
        } else if self.ratio < SMALLEST_RATIO {
            Verdict::Busy
        } else if self.disagreement > LARGEST_DISAGREEMENT {
            Verdict::Undetermined
        } else if self.ratio < SURE_RATIO {
            Verdict::Rough
        } else {
            Verdict::Smooth
        }
    }
}

fn enough(counts: &PixelCounts) -> Result<(), PaintError> {
    if counts.usable >= MIN_PIXELS {
        return Ok(());
    }
    let others = counts.usable + counts.non_finite + counts.shaded;
    Err(if counts.dark > others && counts.dark >= counts.saturated {
        PaintError::Dark
    } else if counts.saturated > others {
        PaintError::Saturated
    } else {
        PaintError::TooFewPixels
    })
}

/// The moments of the usable colors, scaled.
fn moments(image: &Image, usable: Usable, scale: f64) -> Moments {
    let mut moments = Moments::default();
    image.for_each_window(|window| {
        for_each_bit(usable.bits(window), |i| {
            moments.add(window.pixel(i).map(|value| f64::from(value) * scale));
        });
    });
    moments
}

/// How far the colors determine C: the noise that would let a second form vanish on them, over the noise across their direction.
/// Such a form is homogeneous, so paint does not change where it vanishes.
fn margin(moments: &Moments, noise: f64) -> f64 {
    let degenerate = moments.solve().map_or(0.0, |fit| moments.degenerate_noise(&fit));
    if noise > 0.0 { degenerate / noise } else { 0.0 }
}
