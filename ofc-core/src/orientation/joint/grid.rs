//! Rows of a picture, four by four, summed into cells.

use super::constants::{SIDE, SMALLEST_GRADIENT_COUNT, SMALLEST_RESIDUAL_COUNT};
use super::moments::{Moments, NUMBERS, Plane};
use super::record;
use crate::picture::for_each_bit;
use core::num::NonZero;

/// Numbers of the residuals of a cell's smallest squares: how many they are, and the sum of their covariances.
pub(super) const RESIDUALS: usize = 7;

/// Numbers of their gradients: how many, and the sum.
pub(super) const GRADIENTS: usize = 7;

/// Numbers of a cell while its sums are taken.
pub(super) const SUMS: usize = NUMBERS + RESIDUALS + GRADIENTS;

/// Numbers of a cell of the smallest size and of the window that it is merged to with its neighbors.
pub(super) const ROOM: usize = NUMBERS + record::ROOM;

/// How many of the smallest squares a picture has.
pub(super) const fn count(width: usize, height: usize) -> usize {
    (width / SIDE).saturating_mul(height / SIDE)
}

/// How a picture is cut into cells: squares of a multiple of [`SIDE`] pixels, from its top left corner. The last ones
/// may reach beyond it; rows and columns that do not fill a square of [`SIDE`] are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    pub width: usize,
    pub height: usize,
    /// How many of the smallest squares lie along a side.
    pub times: NonZero<usize>,
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

    /// How many cells there are.
    pub const fn count(&self) -> usize {
        self.width * self.height
    }

    /// Numbers of the cells and the windows that they are merged to.
    pub const fn len(&self) -> usize {
        self.count() * ROOM
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
        if count >= SMALLEST_GRADIENT_COUNT
            && let Some(plane) = sums.plane()
        {
            let [[a, b, c], [d, e, f]] = plane.gradient;
            small.gradient = Some([a, b, c, d, e, f].map(|slope| count * slope));
            if count >= SMALLEST_RESIDUAL_COUNT {
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
