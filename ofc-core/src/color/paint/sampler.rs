//! Random pixels of a picture, and what lies around them.

use crate::math::rng::Rng;
use crate::picture::{Image, Sample, Usable, Window, first_bits};

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
        let extent = |low: usize, high: usize| if low <= high { high - low + 1 } else { 0 };
        let size = [extent(low[0], high[0]), extent(low[1], high[1])];
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
        self.read::<N>(&self.image.crop(at, [N, 1])?, 0)
    }

    /// The mean of the three by three pixels around this one; `None` unless all are usable.
    pub(super) fn mean(&mut self, [x, y]: [usize; 2]) -> Option<[f64; 3]> {
        let square = self.image.crop([x.checked_sub(1)?, y.checked_sub(1)?], [SIDE; 2])?;
        let mut sum = [0.0; 3];
        for row in 0..SIDE {
            for color in self.read::<SIDE>(&square, row)? {
                for (sum, value) in sum.iter_mut().zip(color) {
                    *sum += f64::from(value);
                }
            }
        }
        Some(sum.map(|sum| sum / (SIDE * SIDE) as f64))
    }

    fn read<const N: usize>(&mut self, part: &Image, row: usize) -> Option<[[f32; 3]; N]> {
        part.read(0, row, &mut self.window);
        let colors = core::array::from_fn(|i| self.window.pixel(i));
        let all = first_bits(N);
        let is_usable =
            self.window.masked & all == all && colors.iter().all(|&color| self.usable.accepts(color));
        is_usable.then_some(colors)
    }
}
