//! The fit evaluated by colors instead of pixels, for a picture most of which is one flat part.
//!
//! The pixels of a flat part have one color and carry one constraint, however many they are; where they are the majority, an
//! ellipsoid through their color and anything else has the least median. So the search runs on a sample in which a pixel has the weight
//! count^-1/2, with `count` the pixels of its cell of color space, 16 levels a channel. With count^-1 the weight would lie on the tails
//! of the noise, and a clean plane would pass for determined.
//!
//! It is taken only where it says clearly more than the fit evaluated by pixels, see [`Problem::fit_by_colors`].

use super::params::MIN_PIXELS;
use super::problem::Problem;
use super::result::Fit;
use super::search::Sample;
use crate::color::ellipsoid::is_positive_definite;
use crate::color::inliers::Inliers;
use crate::math::rng::Rng;
use crate::picture::{Colors, Image, Usable, for_each_bit};
use libm::sqrt;

/// Levels of a channel.
const LEVELS: usize = 16;

/// Cells of color space.
const CELLS: usize = LEVELS * LEVELS * LEVELS;

/// Where two pixels taken at random share a cell with less than this probability, no color is a majority: that costs the search.
const CONCENTRATION: f64 = 0.04;

/// A fit by colors counts if its degenerate noise is at least so many times its noise.
const SURE_MARGIN: f64 = 5.0;

/// The margin of the fit by colors is at least so many times the other's.
const GAIN: f64 = 1.5;

/// A sample of fewer colors is not searched.
const FEWEST: usize = 256;

impl Problem<'_, Image<'_>> {
    /// The fit by colors where it says more than the one by pixels: its C is positive definite, its margin of noise is at
    /// least [`SURE_MARGIN`] and [`GAIN`] times the other's, and at least half of all usable pixels are among its inliers. The margins
    /// of degenerate scenes reach 1.6.
    ///
    /// # Scratch
    /// As long as [`workspace_len`](super::workspace_len); pictures of less than some 2,000 pixels have no room for this.
    pub(super) fn fit_by_colors(
        &self,
        by_pixels: Option<&Fit>,
        subsets: u32,
        workspace: &mut [f32],
    ) -> Option<Fit> {
        let before = by_pixels.filter(|fit| is_positive_definite(&fit.z())).map_or(0.0, margin);
        let (counts, workspace) = workspace.split_at_mut_checked(CELLS)?;
        let rows = self.pixels.sample_rows();
        let part = Problem { pixels: &rows, ..*self };
        if part.count_colors(counts) < CONCENTRATION {
            return None;
        }
        let mut rng = Rng::new(self.params.seed);
        let len = self.count.min(self.params.sample_size as usize).min(workspace.len() / 4);
        let (red, rest) = workspace.split_at_mut_checked(len)?;
        let (green, rest) = rest.split_at_mut_checked(len)?;
        let (blue, rest) = rest.split_at_mut_checked(len)?;
        let scratch = rest.get_mut(..len)?;
        let len = part.draw_by_colors(counts, [&mut *red, &mut *green, &mut *blue], &mut rng);
        let [red, green, blue] = [red.get_mut(..len)?, green.get_mut(..len)?, blue.get_mut(..len)?];
        let scratch = scratch.get_mut(..len)?;
        if len < FEWEST {
            return None;
        }
        let scaled = Sample::new([&*red, &*green, &*blue], &mut *scratch).best(subsets, &mut rng)?;
        for value in red.iter_mut().chain(&mut *green).chain(&mut *blue) {
            // Exact: the scale is a power of two.
            *value = (f64::from(*value) / self.scale) as f32;
        }
        let colors = Colors { channels: [red, green, blue], sample: self.pixels.sample() };
        let usable = Usable::below(f32::INFINITY);
        let sample = Problem { pixels: &colors, usable, count: len, scale: self.scale, params: self.params };
        let mut fit = None;
        sample.evaluate::<true>(Some(scaled), scratch, &mut fit).ok()?;
        let mut fit = fit?;
        let is_sure = is_positive_definite(&fit.z()) && margin(&fit) >= SURE_MARGIN.max(GAIN * before);
        if !is_sure {
            return None;
        }
        let inliers = Inliers { residual: fit.band, ..Inliers::all(self.usable) };
        (fit.usable, fit.inliers, fit.by_colors) = (self.count, inliers.count(self.pixels), true);
        (2 * fit.inliers >= fit.usable && fit.inliers >= MIN_PIXELS).then_some(fit)
    }

    /// Counts the usable pixels of each cell, and returns the probability that two of them share one. Single precision counts to
    /// 2^24, and no further.
    fn count_colors(&self, counts: &mut [f32]) -> f64 {
        counts.fill(0.0);
        self.for_each_color(|cell, _| {
            if let Some(count) = counts.get_mut(cell) {
                *count += 1.0;
            }
        });
        concentration(counts)
    }

    /// Draws scaled colors, each pixel with the weight count^-1/2, and returns how many there are.
    fn draw_by_colors(&self, counts: &[f32], channels: [&mut [f32]; 3], rng: &mut Rng) -> usize {
        let [red, green, blue] = channels;
        let total: f64 = counts.iter().map(|&count| sqrt(f64::from(count))).sum();
        let step = total / red.len() as f64;
        let mut slots = red.iter_mut().zip(green).zip(blue);
        let (mut sum, mut taken) = (0.0, 0_usize);
        let mut wanted = step * rng.unit();
        self.for_each_color(|cell, color| {
            sum += counts.get(cell).map_or(0.0, |&count| 1.0 / sqrt(f64::from(count.max(1.0))));
            while sum > wanted {
                let Some(((r, g), b)) = slots.next() else { return };
                [*r, *g, *b] = color;
                taken += 1;
                wanted = step * (taken as f64 + rng.unit());
            }
        });
        taken
    }

    /// Visits the scaled colors of the usable pixels, each with the number of its cell.
    fn for_each_color(&self, mut visit: impl FnMut(usize, [f32; 3])) {
        self.pixels.for_each_window(|window| {
            for_each_bit(self.usable.bits(window), |i| {
                let color = window.pixel(i).map(|c| (f64::from(c) * self.scale) as f32);
                visit(cell(color), color);
            });
        });
    }
}

impl Sample<'_> {
    /// Whether some color may be a majority: where those that were searched say no, no more need be counted.
    pub(super) fn may_be_concentrated(&mut self) -> bool {
        let ([red, green, blue], Some(counts)) = self.searched_with(CELLS) else { return true };
        counts.fill(0.0);
        for ((&r, &g), &b) in red.iter().zip(green).zip(blue) {
            if let Some(count) = counts.get_mut(cell([r, g, b])) {
                *count += 1.0;
            }
        }
        concentration(counts) >= CONCENTRATION
    }
}

/// The cell of a scaled color.
#[expect(clippy::cast_sign_loss, reason = "a channel below zero is of the lowest level")]
fn cell(color: [f32; 3]) -> usize {
    let [r, g, b] = color.map(|value| usize::from((value * LEVELS as f32) as u8).min(LEVELS - 1));
    (r * LEVELS + g) * LEVELS + b
}

/// The probability that two colors taken at random share a cell.
fn concentration(counts: &[f32]) -> f64 {
    let (sum, squares) = counts.iter().fold((0.0, 0.0), |(sum, squares), &count| {
        (sum + f64::from(count), squares + f64::from(count) * f64::from(count))
    });
    squares / (sum * sum)
}

/// How many times its noise would make a degenerate scene look like this one.
fn margin(fit: &Fit) -> f64 {
    fit.degenerate_noise_deviation / fit.noise_deviation
}
