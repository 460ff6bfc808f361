//! From the rows of a picture to the orientation, in one pass or in two.

use super::cells::Cells;
use super::constants::{FEWEST_CELLS, SIDE};
use super::estimate::estimate;
use super::grid::{self, Grid};
use super::integrable::Integrable;
use super::outward::Outward;
use super::result::Joint;
use super::used::used;
use super::windows;
use crate::color::inliers::Inliers;
use crate::math::mat3::{self, Mat3};
use crate::picture::Window;

/// Rows that are summed at a time.
pub(crate) const STRIP: usize = SIDE;

/// Which pixels of the rows of a strip are summed.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Strip {
    inliers: [u64; STRIP],
    /// Those that quads are made of, the row above first.
    used: [u64; STRIP + 1],
}

impl Strip {
    /// Looks at a window of a row, the one above the strip first, and says in which of its pixels the surface is seen.
    pub fn see(&mut self, row: usize, window: &Window, inliers: &Inliers) -> u64 {
        let exposed = inliers.usable.exposed(window);
        let bits = inliers.bits_among(window, exposed);
        if let Some(slot) = self.used.get_mut(row) {
            *slot = used(inliers, window, exposed, bits);
        }
        if let Some(slot) = row.checked_sub(1).and_then(|row| self.inliers.get_mut(row)) {
            *slot = bits;
        }
        exposed
    }
}

/// How many `f32` rows are summed into, at least, where they are too many for cells of four pixels.
pub(crate) const fn least_room(width: usize, height: usize) -> usize {
    let squares = (width / SIDE).saturating_mul(height / SIDE);
    let cells = if squares < FEWEST_CELLS { squares } else { FEWEST_CELLS };
    cells * grid::SUMS + grid::rows_len(width)
}

/// Sums over the rows of a picture, four by four: all that its orientation is found from where there is room for cells of
/// four pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellSums {
    grid: Grid,
    whole: MeanPosition,
}

impl CellSums {
    /// Over a picture of this size, of cells as small as `room` numbers allow, which they are put into; `None` where there is
    /// nothing to sum.
    pub fn begin(width: usize, height: usize, room: usize, numbers: &mut [f32]) -> Option<Self> {
        let grid = Grid::finest(width, height, room)?;
        grid.clear(numbers);
        Some(Self { grid, whole: MeanPosition::default() })
    }

    /// The pixels of a window that the surface is seen in, shaded ones among them.
    pub fn see(&mut self, x: usize, y: usize, exposed: u64) {
        self.whole.add(x, y, exposed);
    }

    /// Adds `len` columns of four rows, at the given pixel whose row is a multiple of four: which pixels, and `color` of row, that above the
    /// strip first, and column.
    #[inline]
    pub fn add(
        &self,
        at: [usize; 2],
        len: usize,
        strip: &Strip,
        root: &Mat3,
        color: impl Fn(usize, usize) -> [f32; 3],
        numbers: &mut [f32],
    ) {
        let normal = |row, column| mat3::apply(root, color(row, column).map(f64::from));
        self.grid.add(at, len, strip.inliers, strip.used, normal, numbers);
    }

    /// The transformation, from the sums in these numbers; `None` where there are too few inliers.
    #[inline(never)]
    pub fn end(&self, numbers: &mut [f32]) -> Option<Joint> {
        let (cells, rest) = Cells::of(&self.grid, numbers)?;
        let outward = Outward::of(&cells, rest, self.whole.position())?;
        let noise = cells.noise(rest)?;
        let (pixels, rest) = windows::collect(&cells, 0, &noise, rest);
        let (squares, _) = windows::collect(&cells, 1, &noise, rest);
        Some(estimate(&outward, [pixels, squares].map(|windows| Integrable { windows, stride: 1, noise })))
    }
}

/// The mean position of pixels.
#[derive(Clone, Copy, Debug, Default)]
struct MeanPosition {
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
