//! The colors of a set of pixels as a whole: their moments, their noise, and in which directions of the picture they change.

use crate::color::rounding;
use crate::color::second_moments::SecondMoments;
use crate::math::mat3::{self, Mat3};
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, Sample, WINDOW, Window, for_each_bit};
use libm::sqrt;

/// More noise than this share of the brightness is not that of a camera: pixels are as different from their neighbors as from any
/// other, and there is no surface.
pub(super) const SMOOTH: f64 = 0.05;
/// Pixels between those that a derivative is taken of: far enough for noise, near enough for a surface.
const STEP: usize = 2;

/// What the colors of a set of pixels are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Survey {
    /// How many pixels there are, made up from the rows that were looked at.
    pub count: usize,
    /// The root mean squares of the colors along their principal axes, descending.
    pub deviations: [f64; 3],
    /// The standard deviations of the channels.
    pub spread: [f64; 3],
    /// The noise of a channel, by second differences along rows, and at least that of rounding.
    pub noise: f64,
    /// The mean square of what the colors change by over [`STEP`] pixels each way, noise taken off, along the direction of the
    /// picture in which they change most, and across it.
    pub change: [f64; 2],
}

impl Survey {
    /// Of the pixels that `selected` gives the bits of, in a sample of the rows; `None` without any.
    ///
    /// # Scratch
    /// One `f32` a pixel.
    #[inline(never)]
    pub fn of(image: &Image, selected: impl Fn(&Window) -> u64, workspace: &mut [f32]) -> Option<Self> {
        let step = image.sample_step();
        let rows = &image.rows_apart(step);
        let (mut sum, mut moments, mut count) = ([0.0; 3], SecondMoments::default(), 0_usize);
        rows.for_each_window(|window| {
            let bits = selected(window);
            for_each_bit(bits, |i| {
                let color = window.pixel(i).map(f64::from);
                for (sum, value) in sum.iter_mut().zip(color) {
                    *sum += value;
                }
                moments.add(color);
            });
            count += bits.count_ones() as usize;
        });
        if count == 0 {
            return None;
        }
        let moments = moments.mean(count as f64);
        let mean = sum.map(|sum| sum / count as f64);
        let deviations = mat3::symmetric_eigen(&moments).values.map(|square| sqrt(square.max(0.0)));
        let noise = noise(rows, &selected, deviations, workspace);
        let change = change(image, step, &selected, noise);
        Some(Self { count: count * step, deviations, spread: spread(&moments, mean), noise, change })
    }

    /// Whether the colors span space: all their deviations are above so many times the noise.
    pub fn spans_space(&self, noises: f64) -> bool {
        self.deviations.iter().all(|&deviation| deviation > noises * self.noise)
    }

    /// The spread of the channel that varies most.
    pub fn largest_spread(&self) -> f64 {
        self.spread.iter().fold(0.0, |largest: f64, &spread| largest.max(spread))
    }
}

/// The standard deviations of the channels.
fn spread(moments: &Mat3, mean: [f64; 3]) -> [f64; 3] {
    let [[rr, ..], [_, gg, _], [.., bb]] = *moments;
    let [r, g, b] = mean;
    [rr - r * r, gg - g * g, bb - b * b].map(|variance| sqrt(variance.max(0.0)))
}

/// The noise of a channel: half of the second differences along rows are above it, and edges, which are few, do not matter.
#[inline(never)]
fn noise(
    image: &Image,
    selected: &impl Fn(&Window) -> u64,
    [largest, ..]: [f64; 3],
    workspace: &mut [f32],
) -> f64 {
    /// Without rounding there is noise of this share of the colors, or it does not matter.
    const SMALLEST: f64 = 1e-4;
    /// The median of the sum of the squares of three normal numbers, one a channel, times the sum of the squares of the weights
    /// 1, -2 and 1.
    const MEDIAN: f64 = 2.366 * 6.0;
    let floor = match image.sample() {
        Sample::U8 | Sample::U16 => rounding::DEVIATION,
        Sample::F32 => SMALLEST * largest,
    };
    let mut count = 0;
    image.for_each_window(|window| {
        let bits = selected(window);
        for_each_bit(bits & (bits >> 1) & (bits >> 2), |i| {
            let (left, middle, right) = (window.pixel(i), window.pixel(i + 1), window.pixel(i + 2));
            let mut square = 0.0;
            for ((left, middle), right) in left.into_iter().zip(middle).zip(right) {
                let difference = left - 2.0 * middle + right;
                square += difference * difference;
            }
            if let Some(slot) = workspace.get_mut(count) {
                *slot = square;
                count += 1;
            }
        });
    });
    let squares = workspace.get_mut(..count).unwrap_or_default();
    let median = kth_smallest(squares, median_rank(count)).map_or(0.0, f64::from);
    sqrt(median / MEDIAN).max(floor)
}

/// The eigenvalues of the mean structure tensor at every `step`th row, noise taken off.
#[inline(never)]
fn change(image: &Image, step: usize, selected: &impl Fn(&Window) -> u64, noise: f64) -> [f64; 2] {
    let mut rows = [const { Window::new() }; 3];
    let (mut tensor, mut count) = ([0.0; 3], 0_u64);
    for y in (STEP..image.height().saturating_sub(STEP)).step_by(step.max(1)) {
        for x in (0..image.width()).step_by(WINDOW - 2 * STEP) {
            for (row, y) in rows.iter_mut().zip([y - STEP, y, y + STEP]) {
                image.read(x, y, row);
            }
            let [above, middle, below] = &rows;
            let sides = selected(middle);
            // Bit i is the pixel STEP to the left of the one that the derivatives belong to.
            let bits = sides & (sides >> (2 * STEP)) & (selected(above) >> STEP) & (selected(below) >> STEP);
            for_each_bit(bits, |i| {
                let (left, right) = (middle.pixel(i), middle.pixel(i + 2 * STEP));
                let (up, down) = (above.pixel(i + STEP), below.pixel(i + STEP));
                for ((left, right), (up, down)) in left.into_iter().zip(right).zip(up.into_iter().zip(down)) {
                    let (along_x, along_y) = (f64::from(right - left), f64::from(up - down));
                    let terms = [along_x * along_x, along_x * along_y, along_y * along_y];
                    for (sum, term) in tensor.iter_mut().zip(terms) {
                        *sum += term;
                    }
                }
                count += 1;
            });
        }
    }
    let [xx, xy, yy] = tensor.map(|sum| sum / count.max(1) as f64);
    // Three channels, two pixels each.
    let noise = 6.0 * noise * noise;
    let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let root = sqrt(half * half + xy * xy);
    [middle + root, middle - root].map(|value| (value - noise).max(0.0))
}
