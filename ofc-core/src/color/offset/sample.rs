//! Colors from all over the inliers, each with the block of the picture that it is from.

use super::result::{LEAST, OffsetError};
use crate::color::dispersion::{CONSISTENCY, SECOND_DIFFERENCE};
use crate::color::inliers::Inliers;
use crate::color::rounding;
use crate::math::rng::Rng;
use crate::math::select;
use crate::picture::{Image, Sample as StoredAs, Window, for_each_bit};
use libm::{fabsf, hypotf};

/// Blocks along the longer side of the box around the inliers.
const SIDE: usize = 12;
/// Numbers of blocks are below this.
pub(super) const BLOCKS: usize = SIDE * SIDE;

/// A color takes three numbers, its block one, and its distance one.
const NUMBERS: usize = 5;

/// How many `f32` a fit to so many colors takes.
#[must_use]
pub const fn workspace_len(sample_size: usize) -> usize {
    sample_size.saturating_mul(NUMBERS)
}

/// Colors in units of their median length, each with the number of its block.
pub(super) struct Sample<'w> {
    /// The unit, in pixel values.
    pub(super) unit: f64,
    /// The noise of a channel, in pixel values.
    pub(super) noise: f64,
    pub(super) colors: &'w [[f32; 4]],
    /// Room for a number a color.
    pub(super) distances: &'w mut [f32],
}

/// The smallest box of the picture that holds all inliers, and how many they are.
struct Extent {
    low: [usize; 2],
    high: [usize; 2],
    count: usize,
}

impl Extent {
    fn of(image: &Image, bits: impl Fn(&Window) -> u64) -> Self {
        let mut extent = Self { low: [usize::MAX; 2], high: [0; 2], count: 0 };
        image.for_each_window(|window| {
            let bits = bits(window);
            if bits != 0 {
                let ([left, top], [right, bottom]) = (extent.low, extent.high);
                let (first, last) =
                    (window.x + bits.trailing_zeros() as usize, window.x + bits.ilog2() as usize);
                extent.low = [left.min(first), top.min(window.y)];
                extent.high = [right.max(last), bottom.max(window.y)];
                extent.count += bits.count_ones() as usize;
            }
        });
        extent
    }
}

impl<'w> Sample<'w> {
    /// Draws one of every so-many inliers.
    pub(super) fn draw(
        image: &Image,
        inliers: &Inliers,
        sample_size: usize,
        workspace: &'w mut [f32],
    ) -> Result<Self, OffsetError> {
        let selector = inliers.selector();
        let extent = Extent::of(image, selector);
        let workspace =
            workspace.get_mut(..workspace_len(sample_size)).ok_or(OffsetError::WorkspaceTooShort)?;
        let (colors, distances) =
            workspace.split_at_mut_checked(sample_size * 4).ok_or(OffsetError::WorkspaceTooShort)?;
        let colors = colors.as_chunks_mut::<4>().0;
        if extent.count < LEAST || sample_size < LEAST {
            return Err(OffsetError::TooFewPixels);
        }
        let group = extent.count.div_ceil(sample_size.max(1)).max(1);
        let ([left, top], [right, bottom]) = (extent.low, extent.high);
        let side = (right - left).max(bottom - top) / SIDE + 1;
        // One of each group, drawn so that no pattern of the picture is met at every row.
        let mut rng = Rng::new(0);
        let (mut seen, mut drawn, mut taken) = (0_usize, rng.below(group as u32) as usize, 0);
        let mut triples = 0;
        image.for_each_window(|window| {
            let bits = selector(window);
            for_each_bit(bits, |i| {
                if seen == drawn
                    && let Some(slot) = colors.get_mut(taken)
                {
                    let [r, g, b] = window.pixel(i);
                    let column = (window.x + i - left).checked_div(side).unwrap_or(0);
                    let row = (window.y - top).checked_div(side).unwrap_or(0);
                    *slot = [r, g, b, (row * SIDE + column) as f32];
                    taken += 1;
                    // Every channel has its turn.
                    if bits >> i & 0b111 == 0b111
                        && let Some(slot) = distances.get_mut(triples)
                        && let Some(channel) = window.color.get(taken % 3)
                        && let Some(&[left, middle, right]) =
                            channel.get(i..).and_then(|row| row.first_chunk::<3>())
                    {
                        *slot = fabsf(left - 2.0 * middle + right);
                        triples += 1;
                    }
                }
                seen += 1;
                if seen == group {
                    (seen, drawn) = (0, rng.below(group as u32) as usize);
                }
            });
        });
        let colors = colors.get_mut(..taken).unwrap_or_default();
        let distances = distances.get_mut(..taken).unwrap_or_default();
        let noise = noise(distances.get(..triples).unwrap_or_default(), image.sample());
        let unit = median_length(colors, distances).ok_or(OffsetError::TooFewPixels)?;
        for [r, g, b, _] in colors.iter_mut() {
            for value in [r, g, b] {
                *value = (f64::from(*value) / unit) as f32;
            }
        }
        Ok(Self { unit, noise, colors, distances })
    }
}

/// The noise of a channel by the median of second differences along rows, in which a smooth surface does not count.
fn noise(differences: &[f32], sample: StoredAs) -> f64 {
    let median = select::kth_smallest(differences, select::median_rank(differences.len())).unwrap_or(0.0);
    let floor = if sample == StoredAs::F32 { 0.0 } else { rounding::DEVIATION };
    (CONSISTENCY / SECOND_DIFFERENCE * f64::from(median)).max(floor)
}

fn median_length(colors: &[[f32; 4]], lengths: &mut [f32]) -> Option<f64> {
    for (length, [r, g, b, _]) in lengths.iter_mut().zip(colors) {
        *length = hypotf(hypotf(*r, *g), *b);
    }
    let median = select::kth_smallest(lengths, select::median_rank(lengths.len()))?;
    (median > 0.0 && median.is_finite()).then(|| f64::from(median))
}
