//! The exact median of a large picture's residuals, and the sums over the inliers that follow from it, in one pass.
//!
//! A sample says between which two numbers the median lies almost surely. A pixel whose residual lies below them is counted, one
//! that may lie between them is kept; and likewise a pixel that is an inlier whatever the median turns out to be is summed at once,
//! and one that may be is kept. Both that are kept are a few in a hundred, and are looked at when the pass is over. Single precision
//! decides wherever its error cannot matter.

use super::problem::Problem;
use super::rejection::Rejection;
use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::color::inliers::Band;
use crate::color::regression::{Moments, WindowMoments};
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, Pixels, Usable, Window, for_each_bit};
use libm::{fabs, fabsf, sqrt};

/// The rank of the median differs by a deviation of half the root of a sample's size: of ten million samples one fails, and then costs
/// another pass.
const DEVIATIONS: f64 = 5.5;

/// Two numbers between which the median residual lies almost surely.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bracket {
    low: f32,
    high: f32,
}

impl Bracket {
    /// By the residuals of a sample.
    #[expect(clippy::cast_sign_loss, reason = "a root")]
    pub fn of(residuals: &[f32]) -> Option<Self> {
        let rank = median_rank(residuals.len());
        let slack = (0.5 * DEVIATIONS * sqrt(residuals.len() as f64)) as usize + 1;
        let low = kth_smallest(residuals, rank.saturating_sub(slack))?;
        let high = kth_smallest(residuals, (rank + slack).min(residuals.len().saturating_sub(1)))?;
        Some(Self { low, high })
    }

    /// By the residuals of the usable ones of these pixels.
    ///
    /// # Scratch
    /// One `f32` a usable pixel.
    pub fn of_pixels(
        pixels: &impl Pixels,
        usable: Usable,
        z: &Coefficients,
        workspace: &mut [f32],
    ) -> Option<Self> {
        let residual = |r, g, b| fabs(quadratic_form(z, r, g, b) - 1.0);
        Self::of(pixels.gather(|window| usable.bits(window), workspace, residual))
    }
}

/// A residual in single precision, and what its rounding can amount to at most.
struct Residual {
    form: [f32; 6],
}

impl Residual {
    /// Sixteen roundings: four in each term and its coefficient, five in the sum, one in the sum of absolute values, three in the
    /// differences with limits.
    const RELATIVE: f32 = 1.0 / (1 << 20) as f32;
    /// Terms that are too small to be represented are less than this.
    const ABSOLUTE: f32 = 1e-9;

    /// Of the scaled form, for colors below 2; `None` where its terms could be too large or too small for single precision.
    fn new(scaled: &Coefficients) -> Option<Self> {
        let [c11, c22, c33, c12, c13, c23] = *scaled;
        let form = [c11, c22, c33, 2.0 * c12, 2.0 * c13, 2.0 * c23].map(|c| c as f32);
        form.iter().all(|c| fabsf(*c) < 1e20).then_some(Self { form })
    }

    /// The absolute residual, and its error.
    #[inline]
    fn of(&self, [r, g, b]: [f32; 3]) -> [f32; 2] {
        let [c11, c22, c33, c12, c13, c23] = self.form;
        let (rr, gg, bb) = (c11 * r * r, c22 * g * g, c33 * b * b);
        let (rg, rb, gb) = (c12 * r * g, c13 * r * b, c23 * g * b);
        let value = rr + gg + bb + (rg + rb + gb);
        let size = fabsf(rr) + fabsf(gg) + fabsf(bb) + (fabsf(rg) + fabsf(rb) + fabsf(gb)) + 1.0;
        [fabsf(value - 1.0), size * Self::RELATIVE + Self::ABSOLUTE]
    }
}

/// What is known of a window's residuals before the median is.
struct Known {
    below: u64,
    may_be_between: u64,
    inliers: u64,
    may_be_inliers: u64,
}

/// The limits that residuals are compared with.
struct Limits {
    residual: Residual,
    bracket: Bracket,
    /// Of inliers whatever the median is.
    least: f32,
    /// Of what can be inliers.
    most: f32,
}

impl Limits {
    fn compare(&self, window: &Window, scale: f32) -> Known {
        const BELOW: u8 = 1;
        const ABOVE: u8 = 2;
        const INSIDE: u8 = 4;
        const OUTSIDE: u8 = 8;
        let flags = window.flags(|color| {
            let [residual, error] = self.residual.of(color.map(|value| value * scale));
            let (largest, smallest) = (residual + error, residual - error);
            let flag = |holds: bool, flag: u8| if holds { flag } else { 0 };
            flag(largest < self.bracket.low, BELOW)
                | flag(smallest > self.bracket.high, ABOVE)
                | flag(largest < self.least, INSIDE)
                | flag(smallest > self.most, OUTSIDE)
        });
        let [below, above, inliers, outside] = flags;
        Known { below, may_be_between: !(below | above), inliers, may_be_inliers: !(inliers | outside) }
    }
}

impl Problem<'_, Image<'_>> {
    /// How many pixels are usable, for which an estimate will do before, the rejection by this form, and the sums over what is left; `None`
    /// where the bracket does not hold the median, or more pixels are undecided than there is room for.
    #[inline(never)]
    pub(super) fn bracketed(
        &self,
        scaled: &Coefficients,
        bracket: Bracket,
        workspace: &mut [f32],
    ) -> Option<(usize, Rejection, Moments)> {
        let robust = scaled.map(|c| c * self.scale * self.scale);
        let limit = |median: f32| {
            let Band { low, high, .. } = self.rejection(robust, f64::from(median)).band;
            0.5 * (high - low)
        };
        // A rounding to single precision, what another count would change, and the rounding of limits that were subtracted from and
        // added to 1.
        let slack = 1e-6 + 5.0 / self.count as f64;
        let least = limit(bracket.low) * (1.0 - slack) - 1e-12;
        let most = limit(bracket.high) * (1.0 + slack) + 1e-12;
        let limits =
            Limits { residual: Residual::new(scaled)?, bracket, least: least as f32, most: most as f32 };
        // Colors below the normal numbers have a scale above them.
        let scale = Some(self.scale as f32).filter(|scale| scale.is_finite())?;
        let (between, edge) = workspace.split_at_mut_checked(workspace.len() / 2)?;
        let (edge, _) = edge.as_chunks_mut::<3>();
        let (mut moments, mut count, mut below) = (WindowMoments::new(), 0, 0);
        let (mut n_between, mut n_edge) = (0, 0);
        self.pixels.for_each_window(|window| {
            let usable = self.usable.bits(window);
            if usable == 0 {
                return;
            }
            count += usable.count_ones() as usize;
            let known = limits.compare(window, scale);
            below += (usable & known.below).count_ones() as usize;
            for_each_bit(usable & known.may_be_between, |i| {
                let [r, g, b] = window.pixel(i);
                if let Some(slot) = between.get_mut(n_between) {
                    *slot = fabs(quadratic_form(&robust, r, g, b) - 1.0) as f32;
                }
                n_between += 1;
            });
            for_each_bit(usable & known.may_be_inliers, |i| {
                if let Some(slot) = edge.get_mut(n_edge) {
                    *slot = window.pixel(i);
                }
                n_edge += 1;
            });
            moments.add(window, usable & known.inliers, scale);
        });
        let rank = median_rank(count).checked_sub(below)?;
        let median = kth_smallest(between.get(..n_between)?, rank)?;
        if !(median >= bracket.low && median <= bracket.high) {
            return None;
        }
        let rejection = Problem { count, ..*self }.rejection(robust, f64::from(median));
        let mut moments = moments.sum();
        for &color in edge.get(..n_edge)? {
            if rejection.band.contains(color) {
                moments.add(color.map(|value| f64::from(value) * self.scale));
            }
        }
        Some((count, rejection, moments))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::lmeds::{Params, workspace_len};
    use crate::color::scale::reciprocal_power_of_two;
    use crate::math::rng::Rng;
    use crate::picture::{Order, Sample};
    use std::vec::Vec;

    const SIZE: usize = 200;

    /// Colors about the form, a third of them anything, and a corner that is black.
    fn colors(form: &Coefficients, noise: f64, rng: &mut Rng) -> Vec<u8> {
        let mut bytes = Vec::new();
        for i in 0..SIZE * SIZE {
            let direction = [(); 3].map(|()| rng.unit() as f32);
            let [r, g, b] = direction;
            let length = sqrt(quadratic_form(form, r, g, b));
            let color =
                direction.map(|c| (f64::from(c) / length * (1.0 + noise * (rng.unit() - 0.5))) as f32);
            let color = if rng.below(3) == 0 { direction.map(|c| c * 2.0 / length as f32) } else { color };
            let is_black = i % SIZE < 70 && i / SIZE < 70;
            bytes.extend((if is_black { [0.0; 3] } else { color }).iter().flat_map(|c| c.to_ne_bytes()));
        }
        bytes
    }

    #[test]
    fn median_and_inliers_are_those_of_all_residuals() {
        let mut rng = Rng::new(21);
        let (mut failed, mut found) = (0, 0);
        for (scale, noise) in [(1e-3, 0.1), (1.0, 0.02), (5e4, 1e-4), (1.0, 0.0)] {
            let form = [3.0, 2.0, 5.0, -0.5, 0.25, -1.0].map(|c| c / (scale * scale));
            let bytes = colors(&form, noise, &mut rng);
            let image =
                Image::interleaved(&bytes, SIZE, SIZE, 12 * SIZE, Sample::F32, Order::Rgb).expect("an image");
            let usable = Usable::below(f32::INFINITY);
            let counts = usable.count(&image);
            let params = Params::default();
            let scale = reciprocal_power_of_two(counts.largest);
            let exact = Problem { pixels: &image, usable, count: counts.usable, scale, params: &params };
            // An estimate of the count is enough.
            let about = Problem { count: counts.usable * 99 / 100, ..exact };
            let mut workspace = std::vec![0.0; workspace_len(SIZE * SIZE, params.sample_size)];
            let expected = exact.rejection(form, exact.median_residual(&form, &mut workspace));
            let moments = exact.moments(&exact.inliers(&expected));
            let residual = expected.median_residual as f32;
            let scaled = form.map(|c| c / (scale * scale));
            for (low, high) in [(0.97, 1.04), (0.9, 1.0), (1.0, 1.1), (0.0, 9.0), (1.1, 1.2), (0.8, 0.9)] {
                let bracket = Bracket { low: low * residual, high: high * residual };
                let Some((count, rejection, sums)) = about.bracketed(&scaled, bracket, &mut workspace) else {
                    failed += 1;
                    continue;
                };
                found += 1;
                assert_eq!((count, sums.count), (counts.usable, moments.count));
                assert_eq!(rejection.median_residual, expected.median_residual);
                assert_eq!(rejection.band, expected.band);
                let [got, expected] = [&sums, &moments].map(|m| m.solve().expect("a solution").coefficients);
                for (got, expected) in got.iter().zip(expected) {
                    assert!((got - expected).abs() < 1e-9 * expected.abs(), "{got} {expected}");
                }
            }
        }
        // Three brackets in six miss the median or are too wide for the room, and residuals that are rounding alone have none.
        assert_eq!((failed, found), (15, 9));
    }
}
