//! From the rows of a picture to the orientation, in one pass or in two.

use super::area::Area;
use super::cells::Cells;
use super::constants::{FEWEST_CELLS, SIDE, WINDOW_SIZES};
use super::grid::{self, Grid};
use super::outward::Outward;
use super::record::{self, Record, Records};
use super::result::Joint;
use super::scales::Estimate;
use super::windows::Windows;
use crate::color::inliers::Inliers;
use crate::math::mat3::{self, Mat3};
use crate::picture::Image;

/// Rows that are summed at a time.
pub(crate) const STRIP: usize = SIDE;

/// How many `f32` rows are summed into, at least, where they are too many for cells of four pixels.
pub(crate) const fn least_room(width: usize, height: usize) -> usize {
    let count = grid::count(width, height);
    grid::SUMS * if count < FEWEST_CELLS { count } else { FEWEST_CELLS }
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

    /// Adds `len` columns of four rows, at the given pixel whose row is a multiple of four: their inliers, and `color` of row
    /// and column.
    #[inline]
    pub fn add(
        &self,
        at: [usize; 2],
        len: usize,
        inliers: [u64; STRIP],
        root: &Mat3,
        color: impl Fn(usize, usize) -> [f32; 3],
        numbers: &mut [f32],
    ) {
        let normal = |row, column| mat3::apply(root, color(row, column).map(f64::from));
        self.grid.add(at, len, inliers, normal, numbers);
    }

    /// The cells, what lies behind them, what they say of outward normals, and the noise.
    fn evidence<'w>(&self, numbers: &'w mut [f32]) -> Option<(Cells<'w>, &'w mut [f32], Outward, Mat3)> {
        let (cells, rest) = Cells::of(&self.grid, numbers)?;
        let outward = Outward::of(&cells, rest, self.whole.position())?;
        let noise = cells.noise(rest)?;
        Some((cells, rest, outward, noise))
    }

    /// The transformation, from the sums in the first of these numbers; `None` where there are too few inliers, or was not room
    /// enough.
    #[inline(never)]
    pub fn end(&self, numbers: &mut [f32]) -> Option<Joint> {
        if !self.grid.is_fine() || numbers.len() < self.grid.len() {
            return None;
        }
        let (mut cells, rest, outward, noise) = self.evidence(numbers)?;
        let mut estimate = Estimate::new(&outward, &noise);
        for _ in WINDOW_SIZES {
            let goes_on = collect(&cells, rest).is_none_or(|records| estimate.admit(records));
            if !goes_on || !cells.merge() {
                break;
            }
        }
        Some(estimate.end())
    }

    /// What cells of any size say; windows of the area that they lie in are to be summed next.
    #[inline(never)]
    pub fn window_sums(&self, numbers: &mut [f32]) -> Option<WindowSums> {
        let (cells, _, outward, noise) = self.evidence(numbers)?;
        Some(WindowSums { outward, noise, area: cells.area()? })
    }
}

/// What is known before windows are summed, where there is not room for all of them.
#[derive(Clone, Debug)]
pub(crate) struct WindowSums {
    outward: Outward,
    noise: Mat3,
    area: Area,
}

impl WindowSums {
    /// Before the first row.
    pub fn begin(&self, numbers: &mut [f32]) {
        self.windows(numbers).clear(numbers);
    }

    /// Adds the inliers of row `y`.
    pub fn add(&self, y: usize, row: &Image, inliers: &Inliers, root: &Mat3, numbers: &mut [f32]) {
        let windows = self.windows(numbers);
        row.for_each_window(|window| windows.add(y, window, inliers.bits(window), root, numbers));
    }

    fn windows(&self, numbers: &[f32]) -> Windows {
        Windows::new(&self.area, numbers.len())
    }

    /// The transformation, from the windows that were summed; `None` where there was not room enough.
    #[inline(never)]
    pub fn end(&self, numbers: &mut [f32]) -> Option<Joint> {
        let windows = self.windows(numbers);
        let parts = self.area.parts();
        let mut estimate = Estimate::new(&self.outward, &self.noise);
        for spread in windows.spreads() {
            let (own, scratch) = windows.split(spread, numbers)?;
            let n = spread.replace(own, |sums, at| Record::of(sums, spread.size as f64, at));
            let (numbers, scratch) = (own.as_chunks().0.get(..n)?, scratch.get_mut(..2 * n)?);
            if !estimate.admit(Records { numbers, scratch, parts, independent: spread.independent() }) {
                break;
            }
        }
        Some(estimate.end())
    }
}

/// The windows of two by two cells; `None` without any.
fn collect<'r>(cells: &Cells, numbers: &'r mut [f32]) -> Option<Records<'r>> {
    let [width, height] = cells.size();
    let (numbers, scratch) = numbers.split_at_mut_checked(width * height * record::NUMBERS)?;
    let (numbers, _) = numbers.as_chunks_mut();
    let (parts, side) = (cells.parts()?, 2.0 * cells.side() as f64);
    let mut n = 0;
    for y in 0..height.saturating_sub(1) {
        for x in 0..width.saturating_sub(1) {
            if let Some(window) = cells.two_by_two(x, y)
                && let Some(record) = Record::of(&window, side, cells.middle(x, y))
                && let Some(slot) = numbers.get_mut(n)
            {
                record.store(slot);
                n += 1;
            }
        }
    }
    // One begins half a side after the other.
    let independent = record::independent(0.5);
    Some(Records { numbers: numbers.get(..n)?, scratch: scratch.get_mut(..2 * n)?, parts, independent })
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
