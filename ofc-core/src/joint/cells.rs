//! Moments of N over small squares of pixels, and how two by two of them make the next size.

use super::windows::Area;
use crate::image::for_each_bit;
use crate::mat3::Mat3;
use crate::select::{kth_smallest, median_rank};
use core::num::NonZero;

/// Pixels along the side of the smallest squares.
pub(super) const SIDE: usize = 4;

/// Numbers of a cell: see [`Moments`].
pub(super) const NUMBERS: usize = 15;

/// Numbers of the residuals of a cell's smallest squares: how many they are, and the sum of their covariances.
const RESIDUALS: usize = 7;

/// Numbers of their gradients: how many, and the sum.
const GRADIENTS: usize = 7;

/// Numbers of a cell while its sums are taken.
pub(super) const SUMS: usize = NUMBERS + RESIDUALS + GRADIENTS;

/// A smallest square has a gradient if this many of its 16 pixels are inliers, and residuals if that many: three are spent on
/// the plane.
const SMALLEST_COUNTS: [f64; 2] = [10.0, 12.0];

/// Cells whose residuals are above this many times the median are creases and edges rather than noise.
const CREASE: f32 = 4.0;

/// How many of the smallest squares a picture has.
pub(super) const fn count(width: usize, height: usize) -> usize {
    (width / SIDE).saturating_mul(height / SIDE)
}

/// Sums over the inliers of a square, x right and y up from its middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moments {
    /// Of 1, x, y, x^2, x y, y^2.
    pub position: [f64; 6],
    /// Of N.
    pub normal: [f64; 3],
    /// Of x N.
    pub along_x: [f64; 3],
    /// Of y N.
    pub along_y: [f64; 3],
}

/// The plane `N = middle + x N_x + y N_y` through the inliers of a square, about their mean position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// The mean of N.
    pub middle: [f64; 3],
    /// `N_x` and `N_y`.
    pub gradient: [[f64; 3]; 2],
    /// The variances of `N_x` and `N_y` and their covariance (xx, xy, yy), as multiples of that of a pixel.
    pub variance: [f64; 3],
}

impl Moments {
    pub fn load(numbers: &[f32; NUMBERS]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = numbers.map(f64::from);
        Self { position: [a, b, c, d, e, f], normal: [g, h, i], along_x: [j, k, l], along_y: [m, n, o] }
    }

    pub fn store(&self, numbers: &mut [f32; NUMBERS]) {
        let all = self.position.iter().chain(&self.normal).chain(&self.along_x).chain(&self.along_y);
        for (slot, &value) in numbers.iter_mut().zip(all) {
            *slot = value as f32;
        }
    }

    /// Pixels that are inliers.
    pub const fn count(&self) -> f64 {
        let [count, ..] = self.position;
        count
    }

    pub fn add_pixel(&mut self, x: f64, y: f64, n: [f64; 3]) {
        for (sum, term) in self.position.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
            *sum += term;
        }
        let sums = self.normal.iter_mut().zip(&mut self.along_x).zip(&mut self.along_y);
        for (((sum, along_x), along_y), value) in sums.zip(n) {
            *sum += value;
            *along_x += x * value;
            *along_y += y * value;
        }
    }

    /// Adds the sums of a square whose middle lies at (`dx`, `dy`) from this one's.
    pub fn add(&mut self, other: &Self, dx: f64, dy: f64) {
        let [n, x, y, xx, xy, yy] = other.position;
        let shifted = [
            n,
            x + dx * n,
            y + dy * n,
            xx + dx * (2.0 * x + dx * n),
            xy + dx * y + dy * (x + dx * n),
            yy + dy * (2.0 * y + dy * n),
        ];
        for (sum, term) in self.position.iter_mut().zip(shifted) {
            *sum += term;
        }
        for (i, &value) in other.normal.iter().enumerate() {
            let at = |values: &[f64; 3]| values.get(i).copied().unwrap_or(0.0);
            let (along_x, along_y) = (at(&other.along_x), at(&other.along_y));
            for (sums, term) in [
                (&mut self.normal, value),
                (&mut self.along_x, along_x + dx * value),
                (&mut self.along_y, along_y + dy * value),
            ] {
                if let Some(sum) = sums.get_mut(i) {
                    *sum += term;
                }
            }
        }
    }

    /// The plane; `None` where the inliers lie on a line.
    pub fn plane(&self) -> Option<Plane> {
        let [n, x, y, xx, xy, yy] = self.position;
        if n < 3.5 {
            return None;
        }
        let (x, y) = (x / n, y / n);
        let (xx, xy, yy) = (xx - n * x * x, xy - n * x * y, yy - n * y * y);
        let determinant = xx * yy - xy * xy;
        if determinant.is_nan() || determinant <= 1e-6 * n * n {
            return None;
        }
        let (a, b, c) = (yy / determinant, -xy / determinant, xx / determinant);
        let (mut gradient, mut middle) = ([[0.0; 3]; 2], self.normal);
        let [along_x, along_y] = &mut gradient;
        let sums = self.normal.iter().zip(self.along_x).zip(self.along_y);
        for ((((&sum, sx), sy), out_x), out_y) in sums.zip(along_x).zip(along_y) {
            let (sx, sy) = (sx - x * sum, sy - y * sum);
            (*out_x, *out_y) = (a * sx + b * sy, b * sx + c * sy);
        }
        for value in &mut middle {
            *value /= n;
        }
        Some(Plane { middle, gradient, variance: [a, b, c] })
    }
}

/// How a picture is cut into cells: squares of a multiple of [`SIDE`] pixels, from its top left corner. The last ones
/// may reach beyond it; rows and columns that do not fill a square of [`SIDE`] are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    width: usize,
    height: usize,
    /// How many of the smallest squares lie along a side.
    times: NonZero<usize>,
}

impl Grid {
    /// The smallest squares for which `room` numbers are enough; `None` where there is nothing to cut.
    pub fn finest(width: usize, height: usize, room: usize) -> Option<Self> {
        let (columns, rows, most) = (width / SIDE, height / SIDE, room / SUMS);
        if columns == 0 || rows == 0 || most == 0 {
            return None;
        }
        let mut grid = Self { width: columns, height: rows, times: NonZero::<usize>::MIN };
        while grid.count() > most {
            grid.times = grid.times.saturating_add(1);
            let fill = grid.times.get() - 1;
            (grid.width, grid.height) = ((columns + fill) / grid.times, (rows + fill) / grid.times);
        }
        Some(grid)
    }

    /// Cells that can be merged to windows of every size.
    pub const fn is_fine(&self) -> bool {
        self.times.get() == 1
    }

    const fn count(&self) -> usize {
        self.width * self.height
    }

    /// Numbers of the cells and the windows that they are merged to.
    pub const fn len(&self) -> usize {
        self.count() * (NUMBERS + super::integrable::NUMBERS)
    }

    /// The numbers of the cells, and the sums that are only taken over the smallest ones: residuals and gradients.
    fn split<'w>(&self, numbers: &'w mut [f32]) -> Option<Room<'w>> {
        let (cells, rest) = numbers.split_at_mut_checked(self.count() * NUMBERS)?;
        let (residuals, rest) = rest.split_at_mut_checked(self.count() * RESIDUALS)?;
        let (gradients, _) = rest.split_at_mut_checked(self.count() * GRADIENTS)?;
        Some(Room {
            cells: cells.as_chunks_mut().0,
            residuals: residuals.as_chunks_mut().0,
            gradients: gradients.as_chunks_mut().0,
        })
    }

    /// Before the first strip.
    pub fn clear(&self, numbers: &mut [f32]) {
        numbers.iter_mut().take(self.count() * SUMS).for_each(|number| *number = 0.0);
    }

    /// Adds `len` columns of four rows, the top left pixel given: `bits` of them, whose N is `normal` of row and column.
    #[inline]
    pub fn add(
        &self,
        [x, y]: [usize; 2],
        len: usize,
        bits: [u64; SIDE],
        normal: impl Fn(usize, usize) -> [f64; 3],
        numbers: &mut [f32],
    ) {
        if bits == [0; SIDE] {
            return;
        }
        let Some(mut room) = self.split(numbers) else { return };
        for from in (0..len / SIDE).map(|i| i * SIDE) {
            let nibbles = bits.map(|bits| bits >> from & ((1 << SIDE) - 1));
            if nibbles != [0; SIDE] {
                let small = Small::of(nibbles, |row, column| normal(row, from + column));
                let (column, row) = ((x + from) / SIDE, y / SIDE);
                // Where its middle lies from that of the cell.
                let middle = 0.5 * (self.times.get() - 1) as f64;
                let [dx, dy] = [column, row].map(|at| SIDE as f64 * ((at % self.times) as f64 - middle));
                room.add(row / self.times * self.width + column / self.times, [dx, -dy], &small);
            }
        }
    }
}

/// What [`Grid::split`] makes of the room.
struct Room<'w> {
    cells: &'w mut [[f32; NUMBERS]],
    residuals: &'w mut [[f32; RESIDUALS]],
    gradients: &'w mut [[f32; GRADIENTS]],
}

impl Room<'_> {
    /// Adds a smallest square to the cell that it lies in, its middle (`dx`, `dy`) from the cell's, x right and y up.
    #[inline(never)]
    fn add(&mut self, index: usize, [dx, dy]: [f64; 2], small: &Small) {
        if let Some(cell) = self.cells.get_mut(index) {
            let mut sums = Moments::load(cell);
            sums.add(&small.sums, dx, dy);
            sums.store(cell);
        }
        if let (Some(terms), Some(out)) = (small.residual, self.residuals.get_mut(index)) {
            accumulate(out, terms);
        }
        if let (Some(terms), Some(out)) = (small.gradient, self.gradients.get_mut(index)) {
            accumulate(out, terms);
        }
    }
}

/// Adds 1 and `terms`.
fn accumulate<const N: usize>(out: &mut [f32; N], terms: [f64; 6]) {
    for (out, term) in out.iter_mut().zip([1.0].into_iter().chain(terms)) {
        *out = (f64::from(*out) + term) as f32;
    }
}

/// One of the smallest squares.
struct Small {
    sums: Moments,
    /// The covariance of the pixels about their plane, the upper triangle row by row.
    residual: Option<[f64; 6]>,
    /// `N_x` and `N_y`, times the count.
    gradient: Option<[f64; 6]>,
}

impl Small {
    /// Of the pixels that are set, whose N is `normal` of row and column.
    #[inline]
    fn of(nibbles: [u64; SIDE], normal: impl Fn(usize, usize) -> [f64; 3]) -> Self {
        const HALF: f64 = 0.5 * (SIDE as f64 - 1.0);
        let mut sums = Moments::default();
        let mut squares = [0.0; 6];
        for (row, bits) in nibbles.into_iter().enumerate() {
            let y = HALF - row as f64;
            for_each_bit(bits, |i| {
                let n = normal(row, i);
                sums.add_pixel(i as f64 - HALF, y, n);
                let [a, b, c] = n;
                for (sum, term) in squares.iter_mut().zip([a * a, a * b, a * c, b * b, b * c, c * c]) {
                    *sum += term;
                }
            });
        }
        Self::finish(sums, squares)
    }

    #[inline(never)]
    fn finish(sums: Moments, squares: [f64; 6]) -> Self {
        let mut small = Self { sums, residual: None, gradient: None };
        let count = sums.count();
        if count >= SMALLEST_COUNTS[0]
            && let Some(plane) = sums.plane()
        {
            let [[a, b, c], [d, e, f]] = plane.gradient;
            small.gradient = Some([a, b, c, d, e, f].map(|slope| count * slope));
            if count >= SMALLEST_COUNTS[1] {
                small.residual = Some(residual(&sums, &plane, squares));
            }
        }
        small
    }
}

/// The covariance of pixels, of whose N these are the sums of squares, about their plane.
fn residual(sums: &Moments, plane: &Plane, squares: [f64; 6]) -> [f64; 6] {
    let [n, x, y, ..] = sums.position;
    let at = |values: &[f64; 3], i: usize| values.get(i).copied().unwrap_or(0.0);
    let explained = |i: usize, j: usize| {
        let [gx, gy] = &plane.gradient;
        let (sx, sy) = (
            at(&sums.along_x, j) - x / n * at(&sums.normal, j),
            at(&sums.along_y, j) - y / n * at(&sums.normal, j),
        );
        at(&plane.middle, i) * at(&sums.normal, j) + at(gx, i) * sx + at(gy, i) * sy
    };
    let (mut residual, pairs) = (squares, [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)]);
    for (entry, (i, j)) in residual.iter_mut().zip(pairs) {
        *entry = (*entry - explained(i, j)) / (n - 3.0);
    }
    residual
}

/// The mean position of pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MeanPosition {
    count: u64,
    columns: u64,
    rows: u64,
}

impl MeanPosition {
    /// Adds pixels of a window.
    pub fn add(&mut self, x: usize, y: usize, bits: u64) {
        let count = u64::from(bits.count_ones());
        self.count += count;
        self.columns += count * x as u64 + sum_of_places(bits);
        self.rows += count * y as u64;
    }

    /// In pixels, x right and y up from the top left pixel.
    pub fn position(&self) -> [f64; 2] {
        let mean = |sum: u64| if self.count > 0 { sum as f64 / self.count as f64 } else { 0.0 };
        [mean(self.columns), -mean(self.rows)]
    }
}

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

    /// The covariance of a pixel's N, from the residuals behind the cells, which are lost; `None` without any.
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

    /// What lies around all inliers; `None` without any.
    pub fn area(&self) -> Option<Area> {
        let (mut low, mut high) = ([u32::MAX; 2], [0; 2]);
        for y in 0..self.height {
            for x in 0..self.width {
                if self.at(x, y).count() > 0.0 {
                    for ((low, high), at) in low.iter_mut().zip(&mut high).zip([x, y]) {
                        *low = (at as u32).min(*low);
                        *high = (at as u32 + 1).max(*high);
                    }
                }
            }
        }
        let ([x0, y0], [x1, y1], side) = (low, high, self.side as u32);
        (x1 > x0).then(|| Area { from: [x0 * side, y0 * side], size: [(x1 - x0) * side, (y1 - y0) * side] })
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

    /// The sums of two by two cells, the top left one given, about their common corner.
    pub fn two_by_two(&self, x: usize, y: usize) -> Moments {
        let half = 0.5 * self.side as f64;
        let mut sums = Moments::default();
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let (right, up) = (if dx == 0 { -half } else { half }, if dy == 0 { half } else { -half });
            sums.add(&self.at(x + dx, y + dy), right, up);
        }
        sums
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
                if let Some(cell) = cells.get_mut(y * width + x) {
                    sums.store(cell);
                }
            }
        }
        (self.width, self.height, self.side) = (width, height, 2 * self.side);
        true
    }
}

/// The sum of the numbers of the bits that are set.
fn sum_of_places(bits: u64) -> u64 {
    /// Bits of whose numbers the first, second, ... binary digit is one.
    const DIGITS: [u64; 6] = [
        0xaaaa_aaaa_aaaa_aaaa,
        0xcccc_cccc_cccc_cccc,
        0xf0f0_f0f0_f0f0_f0f0,
        0xff00_ff00_ff00_ff00,
        0xffff_0000_ffff_0000,
        0xffff_ffff_0000_0000,
    ];
    DIGITS.iter().enumerate().map(|(digit, mask)| u64::from((bits & mask).count_ones()) << digit).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    /// A picture of random normals in so many cells at most.
    fn summed(width: usize, height: usize, cells: usize) -> (Grid, std::vec::Vec<f32>) {
        let mut rng = Rng::new(5);
        let normals: std::vec::Vec<[f64; 3]> =
            (0..width * height).map(|_| [0.3, 0.5, 2.0].map(|middle| middle + 0.1 * rng.unit())).collect();
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
            noises.push(cells.noise(&mut std::vec::Vec::from(&*rest)).unwrap()[0][0]);
        }
        // Uniform over 0.1; two more pixels than parameters make one square as good as another.
        let [first, .., last] = &gradients[..] else { panic!() };
        assert!((first - last).abs() < 1e-3, "{gradients:?}");
        for noise in noises {
            assert!((noise / (0.01 / 12.0) - 1.0).abs() < 0.1, "{noise}");
        }
    }
}
