//! Rows of a picture, four by four, summed into cells.

use super::constants::{
    MOST_CELLS, SCALES, SIDE, SMALLEST_GRADIENT_COUNT, SMALLEST_RESIDUAL_COUNT, SMALLEST_TIMES,
};
use super::moments::{Moments, NUMBERS, Plane};
use super::pixels::{self, Normals};
use super::quads::{self, Quads};
use super::squares::{self, SQUARE_NUMBERS, Square};
use super::window;
use core::num::NonZero;

/// Numbers of the residuals of a cell's smallest squares: how many they are, and the sum of their covariances.
pub(super) const RESIDUALS: usize = 7;

/// Numbers of their gradients: how many, and the sum.
pub(super) const GRADIENTS: usize = 7;

/// Numbers of a cell while its sums are taken, and of the windows that are made of them.
pub(super) const SUMS: usize = NUMBERS + SCALES * quads::NUMBERS + RESIDUALS + GRADIENTS + window::NUMBERS;

/// Divides and rounds up, without a way to panic; zero by zero.
const fn div_ceil(a: usize, b: usize) -> usize {
    match (a.saturating_add(b.saturating_sub(1))).checked_div(b) {
        Some(quotient) => quotient,
        None => 0,
    }
}

/// How many smallest squares lie along a side of a cell, and cells along both sides of a picture, where there are to be at most
/// `most`; zero cells where the picture is too small for any.
const fn cut(width: usize, height: usize, most: usize) -> [usize; 3] {
    let (columns, rows) = (width / SIDE, height / SIDE);
    let mut times = SMALLEST_TIMES;
    let most = if most < MOST_CELLS { most } else { MOST_CELLS };
    if columns == 0 || rows == 0 || most == 0 {
        return [times, 0, 0];
    }
    while div_ceil(columns, times).saturating_mul(div_ceil(rows, times)) > most {
        times += 1;
    }
    [times, div_ceil(columns, times), div_ceil(rows, times)]
}

/// Numbers of the two rows of smallest squares that quads are made of.
pub(super) const fn rows_len(width: usize) -> usize {
    width / SIDE * 2 * SQUARE_NUMBERS
}

/// Numbers of at most so many cells of a picture, and of the rows that they are summed from; zero where it is too small.
pub(super) const fn len(width: usize, height: usize, most: usize) -> usize {
    let [_, columns, rows] = cut(width, height, most);
    if columns == 0 { 0 } else { columns * rows * SUMS + rows_len(width) }
}

/// How a picture is cut into cells: squares of a multiple of [`SIDE`] pixels, from its top left corner. The last ones
/// may reach beyond it; rows and columns that do not fill a square of [`SIDE`] are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Grid {
    pub width: usize,
    pub height: usize,
    /// How many smallest squares are in a row.
    columns: usize,
    /// How many of the smallest squares lie along a side.
    pub times: NonZero<usize>,
}

impl Grid {
    /// The smallest cells for which `room` numbers are enough; `None` where there is nothing to cut.
    pub fn finest(width: usize, height: usize, room: usize) -> Option<Self> {
        let columns = width / SIDE;
        let [times, width, height] = cut(width, height, room.checked_sub(rows_len(width))? / SUMS);
        let times = NonZero::new(times)?;
        (width > 0).then_some(Self { width, height, columns, times })
    }

    /// How many cells there are.
    pub const fn count(&self) -> usize {
        self.width * self.height
    }

    /// The numbers of the cells, and the sums that are only taken over the smallest ones: residuals and gradients.
    fn split<'w>(&self, numbers: &'w mut [f32]) -> Option<Room<'w>> {
        let (cells, rest) = numbers.split_at_mut_checked(self.count() * NUMBERS)?;
        let (quads, rest) = rest.split_at_mut_checked(self.count() * SCALES * quads::NUMBERS)?;
        let (residuals, rest) = rest.split_at_mut_checked(self.count() * RESIDUALS)?;
        let (gradients, rest) = rest.split_at_mut_checked(self.count() * GRADIENTS)?;
        let (squares, _) = rest.as_chunks_mut();
        let (even, odd) = squares.split_at_mut_checked(self.columns)?;
        Some(Room {
            cells: cells.as_chunks_mut().0,
            quads: quads.as_chunks_mut().0,
            residuals: residuals.as_chunks_mut().0,
            gradients: gradients.as_chunks_mut().0,
            even,
            odd,
        })
    }

    /// Before the first strip.
    pub fn clear(&self, numbers: &mut [f32]) {
        numbers
            .iter_mut()
            .take(self.count() * SUMS + self.columns * 2 * SQUARE_NUMBERS)
            .for_each(|number| *number = 0.0);
    }

    /// Adds `len` columns of four rows, the top left pixel given: their inliers, and what is used of them and of the row above, which
    /// comes first and whose rows those of `normal` are.
    #[inline]
    pub fn add(
        &self,
        [x, y]: [usize; 2],
        len: usize,
        inliers: [u64; SIDE],
        used: [u64; SIDE + 1],
        normal: impl Fn(usize, usize) -> [f64; 3],
        numbers: &mut [f32],
    ) {
        let Some(mut room) = self.split(numbers) else { return };
        for from in (0..len / SIDE).map(|i| i * SIDE) {
            let own = inliers.map(|bits| bits >> from & ((1 << SIDE) - 1));
            // With the column to the left, which a window does not know of the one before it.
            let around = used.map(|bits| (bits << 1 >> from) & ((1 << (SIDE + 1)) - 1));
            let (column, row) = ((x + from) / SIDE, y / SIDE);
            if own.iter().chain(&around).all(|&bits| bits == 0) {
                room.quad(column, row, None);
                continue;
            }
            let normals = normals(own, around, |row, column| normal(row, from + column - 1));
            let small = Small::of(own, &normals);
            let both = [pixels::quads(around, &normals), room.quad(column, row, small.middle)];
            // Where its middle lies from that of the cell.
            let middle = 0.5 * (self.times.get() - 1) as f64;
            let [dx, dy] = [column, row].map(|at| SIDE as f64 * ((at % self.times) as f64 - middle));
            room.add(row / self.times * self.width + column / self.times, [dx, -dy], &small, &both);
        }
    }
}

/// N of the pixels of a smallest square, and of what is used around it; `normal` is that of a row, the one above first, and a column.
#[inline]
fn normals(own: [u64; SIDE], around: [u64; SIDE + 1], normal: impl Fn(usize, usize) -> [f64; 3]) -> Normals {
    let mut normals = [[[0.0; 3]; SIDE + 1]; SIDE + 1];
    let own = core::iter::once(0).chain(own);
    for (row, ((normals, bits), own)) in normals.iter_mut().zip(around).zip(own).enumerate() {
        for (column, n) in normals.iter_mut().enumerate() {
            if (bits | own << 1) >> column & 1 == 1 {
                *n = normal(row, column);
            }
        }
    }
    normals
}

/// What [`Grid::split`] makes of the room.
struct Room<'w> {
    cells: &'w mut [[f32; NUMBERS]],
    /// Of pixels, then of the smallest squares.
    quads: &'w mut [[f32; SCALES * quads::NUMBERS]],
    residuals: &'w mut [[f32; RESIDUALS]],
    gradients: &'w mut [[f32; GRADIENTS]],
    /// Rows of the smallest squares.
    even: &'w mut [[f32; SQUARE_NUMBERS]],
    odd: &'w mut [[f32; SQUARE_NUMBERS]],
}

impl Room<'_> {
    /// The quad of a smallest square with those to the left and above, of which N in the middle is given: squares come row by row.
    fn quad(&mut self, column: usize, row: usize, normal: Option<[f64; 3]>) -> Quads {
        let (even, odd) = (&mut *self.even, &mut *self.odd);
        let (own, above) = if row.is_multiple_of(2) { (even, odd) } else { (odd, even) };
        let mut square = Square { normal, ends_quad: false };
        let known = |squares: &[[f32; SQUARE_NUMBERS]], column: Option<usize>| {
            column.and_then(|column| squares.get(column)).map(Square::load).unwrap_or_default()
        };
        let left = column.checked_sub(1);
        let quads =
            squares::quad(&known(above, left), &known(above, Some(column)), &known(own, left), &mut square);
        if let Some(slot) = own.get_mut(column) {
            square.store(slot);
        }
        quads
    }

    /// Adds a smallest square to the cell that it lies in, its middle (`dx`, `dy`) from the cell's, x right and y up.
    #[inline(never)]
    fn add(&mut self, index: usize, [dx, dy]: [f64; 2], small: &Small, both: &[Quads; SCALES]) {
        if let Some(cell) = self.cells.get_mut(index) {
            let mut sums = Moments::load(cell);
            sums.add(&small.sums, dx, dy);
            sums.store(cell);
        }
        if let Some(all) = self.quads.get_mut(index) {
            let (numbers, _) = all.as_chunks_mut();
            for (numbers, quads) in numbers.iter_mut().zip(both) {
                let mut sums = Quads::load(numbers);
                sums.add(quads);
                sums.store(numbers);
            }
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
    /// N in its middle.
    middle: Option<[f64; 3]>,
    /// The covariance of the pixels about their plane, the upper triangle row by row.
    residual: Option<[f64; 6]>,
    /// `N_x` and `N_y`, times the count.
    gradient: Option<[f64; 6]>,
}

impl Small {
    /// Of the pixels that are set, whose N are given with those around them.
    #[inline]
    fn of(bits: [u64; SIDE], normals: &Normals) -> Self {
        const HALF: f64 = 0.5 * (SIDE as f64 - 1.0);
        let mut sums = Moments::default();
        let mut squares = [0.0; 6];
        for (row, (bits, normals)) in bits.into_iter().zip(normals.iter().skip(1)).enumerate() {
            let y = HALF - row as f64;
            for (i, &n) in normals.iter().skip(1).enumerate() {
                if bits >> i & 1 == 0 {
                    continue;
                }
                sums.add_pixel(i as f64 - HALF, y, n);
                let [a, b, c] = n;
                for (sum, term) in squares.iter_mut().zip([a * a, a * b, a * c, b * b, b * c, c * c]) {
                    *sum += term;
                }
            }
        }
        Self::finish(sums, squares)
    }

    #[inline(never)]
    fn finish(sums: Moments, squares: [f64; 6]) -> Self {
        let mut small = Self { sums, middle: None, residual: None, gradient: None };
        let count = sums.count();
        if count >= SMALLEST_GRADIENT_COUNT
            && let Some(plane) = sums.plane()
        {
            let [_, x, y, ..] = sums.position;
            let ([[a, b, c], [d, e, f]], [p, q, r]) = (plane.gradient, plane.middle);
            let [x, y] = [x / count, y / count];
            small.middle = Some([p - x * a - y * d, q - x * b - y * e, r - x * c - y * f]);
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
