//! Square cells of a picture, and what is known of each.

use core::num::NonZero;

/// Cells along the longer side, about.
const CELLS: usize = 160;

/// Fewer cells than this lie along any side.
pub const MOST_ALONG: usize = CELLS + CELLS / 2;

/// The shorter side has at least so many cells.
const FEWEST: usize = 32;

/// Square cells of a picture; pixels beyond the last whole cell belong to none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Cells in a row.
    pub width: usize,
    /// Rows of cells.
    pub height: usize,
    /// Pixels along each side of a cell.
    pub side: usize,
}

impl Grid {
    /// The cells of a picture of this size; `None` where they would be too few.
    #[must_use]
    pub const fn of(width: usize, height: usize) -> Option<Self> {
        let longer = if width > height { width } else { height };
        let side = longer.saturating_add(CELLS / 2) / CELLS;
        let side = if side == 0 { 1 } else { side };
        let grid = Self { width: width / side, height: height / side, side };
        if grid.width < FEWEST || grid.height < FEWEST { None } else { Some(grid) }
    }

    /// How many cells there are.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.width * self.height
    }

    /// Whether there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The cell of a pixel: the nearest one for a pixel beyond the last whole cell.
    #[must_use]
    pub fn cell(&self, x: usize, y: usize) -> usize {
        let along =
            |i: usize, count: usize| i.checked_div(self.side).unwrap_or(0).min(count.saturating_sub(1));
        along(y, self.height) * self.width + along(x, self.width)
    }

    /// Of which rows and columns the cells are at most about so many: every one, every second, every third ...
    pub(super) fn step(&self, most: usize) -> NonZero<usize> {
        let step = (1..self.width).find(|step| self.len() <= most * step * step).unwrap_or(1);
        NonZero::new(step).unwrap_or(NonZero::<usize>::MIN)
    }

    /// Column and row of a cell.
    pub(crate) fn place(&self, cell: usize) -> [usize; 2] {
        // A grid has a width; what divides is never zero.
        let row = cell.checked_div(self.width).unwrap_or(0);
        [cell - row * self.width, row]
    }

    /// The middle of a cell, in [-1, 1] across and down the picture.
    pub(crate) fn middle(&self, cell: usize) -> [f64; 2] {
        let along = |i: usize, count: usize| (2 * i + 1) as f64 / count as f64 - 1.0;
        let [x, y] = self.place(cell);
        [along(x, self.width), along(y, self.height)]
    }
}

/// Whether a cell is in the picture's mask, and has a color.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Cell {
    /// Most of its pixels are masked out.
    Outside = 0,
    /// Most of its pixels are in the mask, but too few of them are usable.
    Missing = 1,
    /// It has a color.
    Known = 2,
}

/// Three planes of one number a cell.
pub(crate) type Planes<'w> = [&'w mut [f32]; 3];

/// The class of a cell from its state, which may also say that it has no color of its own.
pub(crate) const fn class(state: u32) -> u32 {
    state & !BRIDGED
}

/// The bit of a state that says that the cell's color is that of its neighbors.
pub(super) const BRIDGED: u32 = 1 << 8;

/// The cells to the left, right, above and below.
pub(super) fn neighbors(grid: &Grid, cell: usize) -> impl Iterator<Item = usize> + use<> {
    let (width, len) = (grid.width, grid.len());
    let [x, _] = grid.place(cell);
    let left = (x > 0).then(|| cell - 1);
    let right = (x + 1 < width).then_some(cell + 1);
    let above = cell.checked_sub(width);
    let below = Some(cell + width).filter(|&below| below < len);
    [left, right, above, below].into_iter().flatten()
}

/// A cell and the up to eight around it.
pub(super) fn around(grid: &Grid, cell: usize) -> impl Iterator<Item = usize> + use<> {
    let ([x, y], width) = (grid.place(cell), grid.width);
    let span = |i: usize, len: usize| i.saturating_sub(1)..(i + 2).min(len);
    let columns = span(x, grid.width);
    span(y, grid.height).flat_map(move |y| columns.clone().map(move |x| y * width + x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_side_has_more_cells_than_it_may() {
        let most =
            (FEWEST..100_000).filter_map(|longer| Grid::of(longer, longer)).map(|grid| grid.width).max();
        assert_eq!(most, Some(MOST_ALONG - 1));
    }
}
