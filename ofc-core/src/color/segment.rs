//! Regions of one material and one light environment, each with its own ellipsoid: Petrov and Kontsevich.
//!
//! The colors at six contiguous pixels determine the six coefficients of the form (10). Around the six of the best of many
//! random blocks the region is grown outward, to every neighbor whose residual |rho^T C rho - 1| is within the
//! tolerance. Then C is fitted again by least squares to the whole region and the region is grown again with it, for as long
//! as that makes it larger: the one thing added to \[14\], where "no regression is used", because six neighboring pixels of
//! a noisy picture say little about C. For the same reason the six pixels may lie further apart than one pixel (blocks of 2x3
//! and 3x2 with the spacings 1, 2, 4, 8 and 16 are tried). Which block is best is decided by how many pixels around it agree
//! with its C.
//!
//! Regions are found one after the other, and a pixel belongs to the first that takes it. Where the ellipsoids of two
//! materials intersect, a few pixels of one are within the tolerance of the other. Materials that differ in brightness
//! by less than half the tolerance are one. Patches of less than rank 3 (planes, cylinders, one light) have no form of
//! their own and stay unlabelled; [`rank::patches`](super::rank::patches) finds out where they are.
//!
//! It runs before the regression of section 2 on pictures that hold more than one material or light environment:
//! [`mark`] makes a mask of one label, and `Image::with_mask` points `solve` at it.
//!
//! # Reference
//! Section 1.2. \[13\]: A. P. Petrov, L. L. Kontsevich, J. Opt. Soc. Am. A 11, 1994. \[14\]: L. L. Kontsevich, A. P. Petrov,
//! I. S. Vergelskaya, J. Opt. Soc. Am. A 11, 1994.

mod field;
mod grow;
mod params;
mod seed;

pub use params::{MAX_REGIONS, Params};

use super::ellipsoid::Coefficients;
use super::rank::{Rank, rank};
use super::scale::reciprocal_power_of_two;
use crate::math::rng::Rng;
use crate::picture::{Image, Usable, Window, for_each_bit};
use core::fmt;
use field::{FREE, Field, TRIED, UNUSABLE};
use heapless::Vec;

/// Why there is no segmentation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SegmentError {
    /// A parameter is out of its range.
    Params,
    /// The label map is shorter than the picture has pixels.
    LabelsTooShort,
    /// A workspace is too short.
    WorkspaceTooShort,
}

impl fmt::Display for SegmentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Params => "a parameter is out of its range",
            Self::LabelsTooShort => "the label map is shorter than the picture has pixels",
            Self::WorkspaceTooShort => "a workspace is too short",
        })
    }
}

impl core::error::Error for SegmentError {}

/// One region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Its value in the label map, from 1 on.
    pub label: u16,
    /// How many pixels it has.
    pub pixels: usize,
    /// The form over its pixels, in (pixel value)^-2.
    pub coefficients: Coefficients,
    /// The standard deviation of the residuals.
    pub residual_deviation: f64,
    /// The ranks of its colors and normals.
    pub rank: Option<Rank>,
    /// The top left pixel (column, row) of the block that it began at, and the step from pixel to pixel.
    pub block: [u32; 2],
    /// The distance between the pixels of that block.
    pub spacing: u32,
}

/// The regions, in the order in which they were found.
pub type Regions = Vec<Region, MAX_REGIONS>;

/// `f32` of workspace for a picture of `pixels` pixels.
#[must_use]
pub const fn colors_len(pixels: usize) -> usize {
    pixels.saturating_mul(3)
}

/// Finds the regions of `image`, and writes the label of every pixel: that of its region, or 0.
///
/// # Shape
/// `labels` is width x height, rows without gaps; what lies behind is left alone. `colors` is [`colors_len`] `f32` and
/// `queue` one `u32` a pixel.
///
/// # Errors
/// See [`SegmentError`]; nothing is written then. No region is no error.
///
/// # Scratch
/// `colors` and `queue`; what they hold before does not matter. About 10 KiB of stack.
///
/// # Example
/// A picture of one gray has no region: its pixels agree on no one ellipsoid.
/// ```
/// use ofc_core::color::segment::{Params, colors_len, segment};
/// use ofc_core::picture::Usable;
/// use ofc_core::{Image, Order, Sample};
///
/// let gray = [90_u8; 3 * 32 * 32];
/// let image = Image::interleaved(&gray, 32, 32, 3 * 32, Sample::U8, Order::Rgb).unwrap();
/// let (mut labels, mut colors, mut queue) = ([0; 32 * 32], vec![0.0; colors_len(32 * 32)], [0; 32 * 32]);
/// let usable = Usable::below(Sample::U8.saturation());
/// let regions = segment(&image, usable, &Params::default(), &mut labels, &mut colors, &mut queue).unwrap();
/// assert!(regions.is_empty());
/// ```
pub fn segment(
    image: &Image,
    usable: Usable,
    params: &Params,
    labels: &mut [u16],
    colors: &mut [f32],
    queue: &mut [u32],
) -> Result<Regions, SegmentError> {
    if !params.are_valid() {
        return Err(SegmentError::Params);
    }
    let pixels = image.width() * image.height();
    let labels = labels.get_mut(..pixels).ok_or(SegmentError::LabelsTooShort)?;
    let (colors, _) =
        colors.get_mut(..colors_len(pixels)).ok_or(SegmentError::WorkspaceTooShort)?.as_chunks_mut::<3>();
    let queue = queue.get_mut(..pixels).ok_or(SegmentError::WorkspaceTooShort)?;

    let scale = load(image, usable, labels, colors);
    let mut field = Field { width: image.width(), labels, colors, queue };
    let mut rng = Rng::new(params.seed);
    let mut regions = Regions::new();
    // Every attempt that fails takes its pixels out of the next ones.
    for _ in 0..2 * params.max_regions {
        if regions.len() as u32 >= params.max_regions {
            break;
        }
        let Some(seed) = seed::best(&mut field, params, &mut rng) else { break };
        let label = regions.len() as u16 + 1;
        let grown = grow::region(&mut field, &seed, label, params);
        if grown.pixels < params.min_pixels as usize {
            field.relabel(grown.pixels, TRIED);
            continue;
        }
        let region = Region {
            label,
            pixels: grown.pixels,
            coefficients: grown.form.map(|c| c * scale * scale),
            residual_deviation: grown.residual_deviation,
            rank: None,
            block: seed.corner,
            spacing: seed.spacing,
        };
        // There are no more regions than room.
        let _ = regions.push(region);
    }
    for label in field.labels.iter_mut() {
        if *label >= UNUSABLE {
            *label = FREE;
        }
    }
    for region in &mut regions {
        let fit = Some((region.coefficients, region.residual_deviation));
        region.rank = rank(image, |window| bits(field.labels, image.width(), region.label, window), fit);
    }
    Ok(regions)
}

/// Reads the picture: colors, and what labels begin with. Returns the power of two that the colors were multiplied by.
fn load(image: &Image, usable: Usable, labels: &mut [u16], colors: &mut [[f32; 3]]) -> f64 {
    let largest = usable.count(image).largest;
    let scale = if largest > 0.0 { reciprocal_power_of_two(largest) } else { 1.0 };
    labels.fill(UNUSABLE);
    image.for_each_window(|window| {
        let start = window.y * image.width() + window.x;
        let labels = labels.get_mut(start..).unwrap_or_default();
        let colors = colors.get_mut(start..).unwrap_or_default();
        for_each_bit(usable.bits(window), |i| {
            if let (Some(label), Some(color)) = (labels.get_mut(i), colors.get_mut(i)) {
                *label = FREE;
                *color = window.pixel(i).map(|value| (f64::from(value) * scale) as f32);
            }
        });
    });
    scale
}

/// The bits of `window`'s pixels with this label, in a map `width` wide.
#[must_use]
pub fn bits(labels: &[u16], width: usize, label: u16, window: &Window) -> u64 {
    let row = labels.get(window.y * width + window.x..).unwrap_or_default();
    let mut bits = 0;
    for (i, &own) in row.iter().take(window.len).enumerate() {
        bits |= u64::from(own == label) << i;
    }
    bits
}

/// Writes 255 where the label is this one and 0 elsewhere: the mask that points `solve` at a region, by
/// `image.with_mask(mask, width)`. What `mask` holds beyond the map is left alone.
pub fn mark(labels: &[u16], label: u16, mask: &mut [u8]) {
    for (byte, &own) in mask.iter_mut().zip(labels) {
        *byte = if own == label { u8::MAX } else { 0 };
    }
}
