//! Cells of a picture, what they say of its noise, and how two by two of them make the next size.

use super::area::{Area, Parts};
use super::constants::{CREASE, SIDE};
use super::grid::{GRADIENTS, Grid, RESIDUALS};
use super::moments::{Moments, NUMBERS};
use crate::math::mat3::Mat3;
use crate::math::select::{kth_smallest, median_rank};

/// Cells whose sums are complete.
pub(super) struct Cells<'w> {
    numbers: &'w mut [f32],
    width: usize,
    height: usize,
    side: usize,
}

impl<'w> Cells<'w> {
    /// The cells of a grid, and what lies behind them: residuals, gradients and scratch.
    pub fn of(grid: &Grid, numbers: &'w mut [f32]) -> Option<(Self, &'w mut [f32])> {
        let (numbers, rest) = numbers.split_at_mut_checked(grid.count() * NUMBERS)?;
        let Grid { width, height, times } = *grid;
        Some((Self { numbers, width, height, side: SIDE * times.get() }, rest))
    }

    /// The sum of gradients over the smallest squares of a cell, each times its inliers, from what lies behind the cells.
    pub fn gradient(&self, x: usize, y: usize, rest: &[f32]) -> [[f64; 3]; 2] {
        let gradients = rest.get(self.width * self.height * RESIDUALS..).unwrap_or_default();
        let (gradients, _) = gradients.as_chunks::<GRADIENTS>();
        let [_, a, b, c, d, e, f] =
            gradients.get(y * self.width + x).copied().unwrap_or_default().map(f64::from);
        [[a, b, c], [d, e, f]]
    }

    /// The covariance of a pixel's N, from the residuals behind the cells; the gradients are lost. `None` without any.
    pub fn noise(&self, rest: &mut [f32]) -> Option<Mat3> {
        let n = self.width * self.height;
        let (residuals, scratch) = rest.split_at_mut_checked(n * RESIDUALS)?;
        let (residuals, _) = residuals.as_chunks::<RESIDUALS>();
        let scratch = scratch.get_mut(..n)?;
        let mut used = 0;
        let mean = |[count, a, _, _, d, _, f]: [f32; RESIDUALS]| (a + d + f) / count;
        for (residual, slot) in residuals.iter().zip(scratch.iter_mut()) {
            let [count, ..] = *residual;
            used += usize::from(count > 0.0);
            *slot = if count > 0.0 { mean(*residual) } else { f32::INFINITY };
        }
        let median = kth_smallest(scratch, median_rank(used))?;
        let mut sums = [0.0_f64; RESIDUALS];
        for residual in residuals {
            let [count, ..] = *residual;
            if count > 0.0 && mean(*residual) <= CREASE * median {
                for (sum, &value) in sums.iter_mut().zip(residual) {
                    *sum += f64::from(value);
                }
            }
        }
        let [count, rest @ ..] = sums;
        let [a, b, c, d, e, f] = rest.map(|sum| sum / count);
        (count > 0.0).then_some([[a, b, c], [b, d, e], [c, e, f]])
    }

    /// Cells in a row, and rows.
    pub const fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The first and the last column and row of cells that hold inliers; `None` without any.
    fn bounds(&self) -> Option<[[usize; 2]; 2]> {
        let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
        for y in 0..self.height {
            for x in 0..self.width {
                if self.at(x, y).count() > 0.0 {
                    for ((low, high), at) in low.iter_mut().zip(&mut high).zip([x, y]) {
                        *low = at.min(*low);
                        *high = at.max(*high);
                    }
                }
            }
        }
        let ([first, _], [last, _]) = (low, high);
        (first <= last).then_some([low, high])
    }

    /// What lies around all inliers; `None` without any.
    pub fn area(&self) -> Option<Area> {
        let [[x0, y0], [x1, y1]] = self.bounds()?;
        let pixels = |cells: usize| (cells * self.side) as u32;
        Some(Area { from: [x0, y0].map(pixels), size: [x1 + 1 - x0, y1 + 1 - y0].map(pixels) })
    }

    /// The parts of the picture, around all cells that hold an inlier; `None` where none does.
    pub fn parts(&self) -> Option<Parts> {
        let [[left, top], [right, bottom]] = self.bounds()?;
        let (from, [x1, y1]) = (self.middle(left, bottom), self.middle(right, top));
        let [x0, y0] = from;
        Some(Parts { from, size: [x1 - x0 + 1.0, y1 - y0 + 1.0] })
    }

    /// Pixels along the side of a cell.
    pub const fn side(&self) -> usize {
        self.side
    }

    /// The sums of a cell.
    pub fn at(&self, x: usize, y: usize) -> Moments {
        let (cells, _) = self.numbers.as_chunks::<NUMBERS>();
        let index = if x < self.width { Some(y * self.width + x) } else { None };
        index.and_then(|index| cells.get(index)).map(Moments::load).unwrap_or_default()
    }

    /// The middle of a cell in pixels, x right and y up from the top left pixel.
    pub fn middle(&self, x: usize, y: usize) -> [f64; 2] {
        let half = 0.5 * (self.side as f64 - 1.0);
        [(x * self.side) as f64 + half, -((y * self.side) as f64) - half]
    }

    /// The sums of two by two cells, the top left one given, about their common corner; `None` where there are not so many.
    pub fn two_by_two(&self, x: usize, y: usize) -> Option<Moments> {
        let (cells, _) = self.numbers.as_chunks::<NUMBERS>();
        let row = |y: usize| {
            let row = cells.get(y * self.width + x..).unwrap_or_default();
            row.first_chunk::<2>().filter(|_| x + 1 < self.width)
        };
        let ([top_left, top_right], [bottom_left, bottom_right]) = (row(y)?, row(y + 1)?);
        Some(Moments::of_four([top_left, top_right, bottom_left, bottom_right], 0.5 * self.side as f64))
    }

    /// Makes cells of twice the side in place; false where there is not even one.
    pub fn merge(&mut self) -> bool {
        let (width, height) = (self.width / 2, self.height / 2);
        if width == 0 || height == 0 {
            return false;
        }
        for y in 0..height {
            for x in 0..width {
                // What is overwritten has been read: cell (x, y) comes no later than (2x, 2y).
                let sums = self.two_by_two(2 * x, 2 * y);
                let (cells, _) = self.numbers.as_chunks_mut::<NUMBERS>();
                if let (Some(sums), Some(cell)) = (sums, cells.get_mut(y * width + x)) {
                    sums.store(cell);
                }
            }
        }
        (self.width, self.height, self.side) = (width, height, 2 * self.side);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::SUMS;
    use super::*;
    use crate::math::mat3;
    use crate::math::rng::Rng;

    /// What is made of three independent numbers that are uniform over 0.1.
    const MIXED: Mat3 = [[1.0, 0.0, 0.0], [0.5, 1.0, 0.0], [-0.3, 0.4, 2.0]];

    /// A picture of random normals in so many cells at most.
    fn summed(width: usize, height: usize, cells: usize) -> (Grid, std::vec::Vec<f32>) {
        let mut rng = Rng::new(5);
        let mut normal = || {
            let [a, b, c] = mat3::apply(&MIXED, [(); 3].map(|()| 0.1 * rng.unit()));
            [0.3 + a, 0.5 + b, 2.0 + c]
        };
        let normals: std::vec::Vec<[f64; 3]> = (0..width * height).map(|_| normal()).collect();
        let holes: std::vec::Vec<u64> = (0..height).map(|_| rng.next_u64() | rng.next_u64()).collect();
        let mut numbers = std::vec![f32::NAN; cells * SUMS];
        let grid = Grid::finest(width, height, numbers.len()).unwrap();
        grid.clear(&mut numbers);
        for y in (0..height / SIDE * SIDE).step_by(SIDE) {
            let bits = [0, 1, 2, 3].map(|row| holes[y + row]);
            grid.add([0, y], width, bits, |row, column| normals[(y + row) * width + column], &mut numbers);
        }
        (grid, numbers)
    }

    #[test]
    fn large_cells_are_merged_small_ones() {
        let (fine, mut fine_numbers) = summed(64, 40, 1000);
        let (coarse, mut coarse_numbers) = summed(64, 40, 40);
        assert!(fine.is_fine() && !coarse.is_fine());
        let (mut cells, _) = Cells::of(&fine, &mut fine_numbers).unwrap();
        assert!(cells.merge());
        let (expected, _) = Cells::of(&coarse, &mut coarse_numbers).unwrap();
        assert_eq!((cells.size(), cells.side()), ([8, 5], 8));
        assert_eq!((expected.size(), expected.side()), ([8, 5], 8));
        for (x, y) in (0..5).flat_map(|y| (0..8).map(move |x| (x, y))) {
            assert_eq!(cells.middle(x, y), expected.middle(x, y));
            let (a, b) = (cells.at(x, y), expected.at(x, y));
            assert_eq!(a.position, b.position);
            for (a, b) in a.normal.iter().zip(b.normal).chain(a.along_x.iter().zip(b.along_x)) {
                assert!((a - b).abs() < 1e-3, "{a} {b}");
            }
        }
    }

    #[test]
    fn noise_and_gradients_do_not_depend_on_the_cells() {
        let mut noises = std::vec::Vec::new();
        let mut gradients = std::vec::Vec::new();
        for room in [1000, 40, 3, 1] {
            let (grid, mut numbers) = summed(64, 40, room);
            let (cells, rest) = Cells::of(&grid, &mut numbers).unwrap();
            let [width, height] = cells.size();
            assert!(width * height <= room);
            let all = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            gradients.push(all.map(|(x, y)| cells.gradient(x, y, rest)[0][0]).sum::<f64>());
            noises.push(cells.noise(&mut std::vec::Vec::from(&*rest)).unwrap());
        }
        // Uniform over 0.1; two more pixels than parameters make one square as good as another.
        let [first, .., last] = &gradients[..] else { panic!() };
        assert!((first - last).abs() < 1e-3, "{gradients:?}");
        let expected = mat3::multiply(&MIXED, &mat3::transpose(&MIXED));
        for noise in noises {
            for (found, expected) in noise.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((found / (0.01 / 12.0) - expected).abs() < 0.15, "{noise:?}");
            }
        }
    }
}
