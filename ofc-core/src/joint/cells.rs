//! Moments of N over small squares of pixels, and how two by two of them make the next size.

use crate::image::{Image, WINDOW, Window, for_each_bit};
use crate::inliers::Inliers;
use crate::mat3::{self, Mat3};
use crate::select::{kth_smallest, median_rank};

/// Pixels along the side of the smallest cells.
pub(super) const SIDE: usize = 4;

/// Numbers of a cell: see [`Moments`].
pub(super) const NUMBERS: usize = 15;

/// Numbers of the covariance of a cell's pixels about their plane.
const COVARIANCE: usize = 6;

/// A cell's residuals count for the noise if this many pixels are inliers, of 16: three are spent on the plane.
const SMALLEST_COUNT: f32 = 12.0;

/// Cells whose residuals are above this many times the median are creases and edges rather than noise.
const CREASE: f32 = 4.0;

/// How many of the smallest cells a picture has.
pub(super) const fn count(width: usize, height: usize) -> usize {
    (width / SIDE).saturating_mul(height / SIDE)
}

/// How many numbers all of them are.
pub(super) const fn len(width: usize, height: usize) -> usize {
    count(width, height).saturating_mul(NUMBERS)
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
    fn load(numbers: &[f32; NUMBERS]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = numbers.map(f64::from);
        Self { position: [a, b, c, d, e, f], normal: [g, h, i], along_x: [j, k, l], along_y: [m, n, o] }
    }

    fn store(&self, numbers: &mut [f32; NUMBERS]) {
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

    fn add_pixel(&mut self, x: f64, y: f64, n: [f64; 3]) {
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

/// A picture as squares of equal size, from its top left corner; pixels that do not fill a square are left out.
pub(super) struct Cells<'w> {
    numbers: &'w mut [f32],
    width: usize,
    height: usize,
    side: usize,
    /// The mean position of the whole surface in pixels, x right and y up from the top left pixel.
    pub whole: [f64; 2],
}

impl<'w> Cells<'w> {
    /// The smallest cells. `rest` receives the covariance of each one's residuals.
    pub fn of(
        image: &Image,
        inliers: &Inliers,
        root: &Mat3,
        numbers: &'w mut [f32],
        rest: &mut [f32],
    ) -> Self {
        let (mut count, mut columns, mut rows) = (0, 0, 0);
        let (width, height) = (image.width() / SIDE, image.height() / SIDE);
        let mut windows = [const { Window::new() }; SIDE];
        let (cells, _) = numbers.as_chunks_mut::<NUMBERS>();
        let (residuals, _) = rest.as_chunks_mut::<COVARIANCE>();
        for y in 0..height {
            for from in (0..width * SIDE).step_by(WINDOW) {
                let mut bits = [0; SIDE];
                for ((row, window), bits) in windows.iter_mut().enumerate().zip(&mut bits) {
                    image.read(from, y * SIDE + row, window);
                    *bits = inliers.bits(window);
                    let exposed = inliers.usable.exposed(window);
                    let bits = u64::from(exposed.count_ones());
                    count += bits;
                    columns += bits * from as u64 + sum_of_places(exposed);
                    rows += bits * (y * SIDE + row) as u64;
                }
                let first = y * width + from / SIDE;
                let last = (y + 1) * width;
                let out = cells.get_mut(first..last).unwrap_or_default().iter_mut();
                let residuals = residuals.get_mut(first..last).unwrap_or_default();
                for (i, (cell, residual)) in out.zip(residuals).take(WINDOW / SIDE).enumerate() {
                    cell_of(&windows, bits, i * SIDE, root, cell, residual);
                }
            }
        }
        let mean = |sum: u64| if count > 0 { sum as f64 / count as f64 } else { 0.0 };
        let whole = [mean(columns), -mean(rows)];
        Self { numbers, width, height, side: SIDE, whole }
    }

    /// The covariance of a pixel's N, from the residuals that [`Cells::of`] left in `rest`; `None` without a cell.
    pub fn noise(&self, rest: &mut [f32]) -> Option<Mat3> {
        let n = self.width * self.height;
        let (residuals, scratch) = rest.split_at_mut_checked(n * COVARIANCE)?;
        let (residuals, _) = residuals.as_chunks::<COVARIANCE>();
        let mut used = 0;
        for ([a, _, _, d, _, f], slot) in residuals.iter().zip(scratch.iter_mut()) {
            // What is not a cell has a negative variance.
            if *a >= 0.0 {
                *slot = a + d + f;
                used += 1;
            } else {
                *slot = f32::INFINITY;
            }
        }
        let scratch = scratch.get_mut(..n)?;
        let median = kth_smallest(scratch, median_rank(used))?;
        let mut sums = [0.0_f64; COVARIANCE];
        let mut count = 0.0;
        for residual in residuals {
            let [a, _, _, d, _, f] = residual;
            if *a >= 0.0 && a + d + f <= CREASE * median {
                for (sum, &value) in sums.iter_mut().zip(residual) {
                    *sum += f64::from(value);
                }
                count += 1.0;
            }
        }
        if count == 0.0 {
            return None;
        }
        let [a, b, c, d, e, f] = sums.map(|sum| sum / count);
        Some([[a, b, c], [b, d, e], [c, e, f]])
    }

    /// Cells in a row, and rows.
    pub const fn size(&self) -> [usize; 2] {
        [self.width, self.height]
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

/// One of the smallest cells, `from` the given pixel of its four rows' windows.
fn cell_of(
    windows: &[Window; SIDE],
    bits: [u64; SIDE],
    from: usize,
    root: &Mat3,
    cell: &mut [f32; NUMBERS],
    residual: &mut [f32; COVARIANCE],
) {
    const HALF: f64 = 0.5 * (SIDE as f64 - 1.0);
    let mut sums = Moments::default();
    let mut squares = [0.0; COVARIANCE];
    for ((row, window), bits) in windows.iter().enumerate().zip(bits) {
        let y = HALF - row as f64;
        for_each_bit(bits >> from & ((1 << SIDE) - 1), |i| {
            let n = mat3::apply(root, window.pixel(from + i).map(f64::from));
            sums.add_pixel(i as f64 - HALF, y, n);
            let [a, b, c] = n;
            for (sum, term) in squares.iter_mut().zip([a * a, a * b, a * c, b * b, b * c, c * c]) {
                *sum += term;
            }
        });
    }
    sums.store(cell);
    *residual = [-1.0; COVARIANCE];
    let count = sums.count();
    if count < f64::from(SMALLEST_COUNT) {
        return;
    }
    let Some(plane) = sums.plane() else { return };
    let [n, x, y, ..] = sums.position;
    let explained = |i: usize, j: usize| {
        let at = |values: &[f64; 3], i: usize| values.get(i).copied().unwrap_or(0.0);
        let [gx, gy] = &plane.gradient;
        let (sx, sy) = (
            at(&sums.along_x, j) - x / n * at(&sums.normal, j),
            at(&sums.along_y, j) - y / n * at(&sums.normal, j),
        );
        at(&plane.middle, i) * at(&sums.normal, j) + at(gx, i) * sx + at(gy, i) * sy
    };
    let pairs = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
    for ((slot, square), (i, j)) in residual.iter_mut().zip(squares).zip(pairs) {
        *slot = ((square - explained(i, j)) / (count - 3.0)) as f32;
    }
}
