//! Two paints: where one meets the other, colors step by the same ratio everywhere. Shading has no steps, and other edges step by
//! another ratio at every place.

use super::finding::{Finding, Reason, share};
use super::survey::Survey;
use crate::math::mat3::{self, Mat3};
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, Window, for_each_bit};
use libm::{fabs, log, sqrt};

/// A step is at least this many times the noise of the darkest of its values.
const NOISES: f64 = 6.0;
/// A step is a ratio of the colors over three pixels that is at least this much, as a logarithm.
const SMALLEST_STEP: f64 = 0.15;
/// A ratio that is less than [`SMALLEST_STEP`] says: what is below it needs no logarithm.
const SMALLEST_RATIO: f32 = 1.16;
/// It is so many times what colors change by over two pixels on both sides of it.
const SHARPNESS: f64 = 3.0;
/// Steps that differ from the median by less than this share of it are the same.
const SAME: f64 = 0.3;
/// Steps there are at least, times the square root of the number of pixels.
const LONG: f64 = 0.4;
/// Steps that can be nothing but those of two paints, and steps that are hardly anything else.
pub(super) const ALIKE: f64 = 0.9;
pub(super) const MOSTLY_ALIKE: f64 = 2.0 / 3.0;

/// The steps of a picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    /// How many there are.
    pub count: usize,
    /// The share of them that are the same.
    pub same: f64,
}

impl Steps {
    /// Of the pixels that `selected` gives the bits of, along a sample of the rows; the number is made up to that of all rows.
    ///
    /// # Scratch
    /// One `f32` a pixel.
    #[inline(never)]
    pub fn of(image: &Image, selected: impl Fn(&Window) -> u64, noise: f64, workspace: &mut [f32]) -> Self {
        let step = image.sample_step();
        let image = &image.rows_apart(step);
        let mut tensor: Mat3 = [[0.0; 3]; 3];
        let mut count = 0_usize;
        for_each_step(image, &selected, noise, |step| {
            count += 1;
            for (row, a) in tensor.iter_mut().zip(step) {
                for (entry, b) in row.iter_mut().zip(step) {
                    *entry += a * b;
                }
            }
        });
        // Steps up and down are one: along the direction that they have in common.
        let [direction, ..] = mat3::symmetric_eigen(&tensor).vectors;
        let mut written = 0;
        for_each_step(image, &selected, noise, |step| {
            if let Some(slot) = workspace.get_mut(written) {
                *slot = fabs(mat3::dot(step, direction)) as f32;
                written += 1;
            }
        });
        let lengths = workspace.get_mut(..written).unwrap_or_default();
        let Some(median) = kth_smallest(lengths, median_rank(written)) else {
            return Self { count: 0, same: 0.0 };
        };
        let median = f64::from(median);
        let mut same = 0_usize;
        for_each_step(image, &selected, noise, |step| {
            let along = mat3::dot(step, direction);
            let across = mat3::dot(step, step) - along * along;
            let off = (fabs(along) - median) / median;
            same += usize::from(off * off + across / (median * median) < SAME * SAME);
        });
        Self { count: count * step, same: share(same, count) }
    }

    /// That there are two paints: steps along a border that is as long as to cross the surface, of which this share is the same.
    pub fn of_two_paints(&self, survey: &Survey, limit: f64) -> Option<Finding> {
        let is_long = self.count as f64 > LONG * sqrt(survey.count as f64);
        if is_long { Finding::above(Reason::TwoPaints, self.same, limit) } else { None }
    }
}

/// Visits the steps, as differences of the logarithms of the channels.
fn for_each_step(
    image: &Image,
    selected: &impl Fn(&Window) -> u64,
    noise: f64,
    mut visit: impl FnMut([f64; 3]),
) {
    // Below this no step is above its noise.
    let smallest = (NOISES * noise) as f32;
    image.for_each_window(|window| {
        let mut bits = selected(window) & window.bits(|r, g, b| r.min(g).min(b) > smallest);
        for shift in [1, 2, 4] {
            bits &= bits >> shift;
        }
        // Eight pixels side by side: the step is between the third and the sixth.
        for_each_bit(bits, |i| {
            let (before, after) = (window.pixel(i + 2), window.pixel(i + 5));
            if !before.into_iter().zip(after).any(|(a, b)| a.max(b) > SMALLEST_RATIO * a.min(b)) {
                return;
            }
            let logarithm = |j: usize| window.pixel(i + j).map(|value| log(f64::from(value)));
            let difference = |a: usize, b: usize| {
                let ([r, g, b], [r2, g2, b2]) = (logarithm(a), logarithm(b));
                [r2 - r, g2 - g, b2 - b]
            };
            let size = |[r, g, b]: [f64; 3]| fabs(r).max(fabs(g)).max(fabs(b));
            let step = difference(2, 5);
            let darkest = before.into_iter().chain(after).fold(f32::INFINITY, f32::min);
            let noise = NOISES * noise / f64::from(darkest);
            let least =
                noise.max(SMALLEST_STEP).max(SHARPNESS * size(difference(0, 2)).max(size(difference(5, 7))));
            if size(step) > least {
                visit(step);
            }
        });
    });
}
