//! Random pixels of a picture, and what lies around them.

use crate::math::rng::Rng;
use crate::picture::{Image, Sample, Usable, Window, for_each_bit};

/// The side of the square that colors are averaged over: single pixels are too noisy to compare directions by, and fine texture of
/// the paint is averaged away with the noise.
const SIDE: usize = 3;

/// Draws pixels from where the usable ones are.
pub(super) struct Sampler<'a> {
    image: &'a Image<'a>,
    usable: Usable,
    pub(super) rng: Rng,
    /// Column and row of the first pixel of the box around all usable pixels, and its size.
    corner: [usize; 2],
    size: [usize; 2],
    window: Window,
}

impl<'a> Sampler<'a> {
    pub(super) fn new(image: &'a Image<'a>, usable: Usable, rng: Rng) -> Self {
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        image.for_each_window(|window| {
            let bits = usable.bits(window);
            if bits != 0 {
                let first = window.x + bits.trailing_zeros() as usize;
                let last = window.x + bits.ilog2() as usize;
                low = [low[0].min(first), low[1].min(window.y)];
                high = [high[0].max(last), high[1].max(window.y)];
            }
        });
        let size = [0, 1].map(|i| if low[i] <= high[i] { high[i] - low[i] + 1 } else { 0 });
        Self { image, usable, rng, corner: low, size, window: Window::new() }
    }

    /// How samples were stored.
    pub(super) const fn sample(&self) -> Sample {
        self.image.sample()
    }

    /// A random pixel of the box, usable or not.
    pub(super) fn draw(&mut self) -> [usize; 2] {
        let [width, height] = self.size.map(|size| size as u32);
        let (x, y) = (self.rng.below(width), self.rng.below(height));
        [self.corner[0] + x as usize, self.corner[1] + y as usize]
    }

    /// `N` neighbors of one row, the first one here; `None` unless all are usable.
    pub(super) fn row<const N: usize>(&mut self, at: [usize; 2]) -> Option<[[f32; 3]; N]> {
        self.image.crop(at, [N, 1])?.read(0, 0, &mut self.window);
        let all = (1 << N) - 1;
        (self.usable.bits(&self.window) & all == all).then(|| core::array::from_fn(|i| self.window.pixel(i)))
    }

    /// The mean of the three by three pixels around this one; `None` unless all are usable.
    pub(super) fn mean(&mut self, [x, y]: [usize; 2]) -> Option<[f64; 3]> {
        let corner = [x.checked_sub(1)?, y.checked_sub(1)?];
        let square = self.image.crop(corner, [SIDE; 2])?;
        let mut sum = [0.0; 3];
        for row in 0..SIDE {
            square.read(0, row, &mut self.window);
            let bits = self.usable.bits(&self.window);
            if bits & 0b111 != 0b111 {
                return None;
            }
            for_each_bit(0b111, |i| {
                for (sum, value) in sum.iter_mut().zip(self.window.pixel(i)) {
                    *sum += f64::from(value);
                }
            });
        }
        Some(sum.map(|sum| sum / (SIDE * SIDE) as f64))
    }
}
