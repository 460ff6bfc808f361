//! Where everything lies in the caller's workspace: the arrays of the finest grid, and those of the coarser ones level after
//! level, each half as wide and high as the one before.

use super::grid::Grid;
use super::parameters::MAX_PIXELS;
use super::span::StoredSpan;
use crate::math::arena::{Arena, Need};

/// Coarser grids at most: halving the longest side that [`MAX_PIXELS`] allows.
const MAX_LEVELS: usize = 30;

/// Numbers that the coarse grids keep for each of their pixels: two edge weights, a mass, right side and correction.
const COARSE_ARRAYS: usize = 5;

/// Numbers that they keep beyond these while [`coupled`](super::coupled) looks for slopes: one right side and correction each
/// for p and q, less the arrays that are free to be used anew.
const MORE_COARSE_ARRAYS: usize = 3;

/// Arrays of numbers of the finest grid with the length of the grid: correction and search direction. The residual has that
/// of [`MORE_COARSE_ARRAYS`] of the coarse grids, which is more.
const FINE_ARRAYS: usize = 2;

/// Numbers of a stored span.
const SPAN_NUMBERS: usize = 4;

/// Rows of scratch.
const ROW_BUFFERS: usize = 7;

/// What the workspace must hold for a picture of this size: at most 17/3 words a pixel and some rows.
///
/// The sum over the coarse grids is bounded in closed form: level k is at most (w / 2^k + 1) pixels wide.
pub(super) const fn need(width: usize, height: usize) -> Option<Need> {
    if width == 0 || height == 0 || width > MAX_PIXELS / height {
        return None;
    }
    let (w, h) = (width as u64, height as u64);
    let fine = (h + 2) * (w + 1) + 1;
    let coarse =
        (COARSE_ARRAYS + MORE_COARSE_ARRAYS) as u64 * (w * h / 3 + 3 * w + 2 * h + 6 * MAX_LEVELS as u64);
    let spans = SPAN_NUMBERS as u64 * (2 * h + MAX_LEVELS as u64);
    let singles = FINE_ARRAYS as u64 * fine + coarse + ROW_BUFFERS as u64 * (w + 2);
    let integers = fine + spans;
    if singles + integers > isize::MAX as u64 / 4 {
        return None;
    }
    Some(Need { doubles: 0, singles: singles as usize, integers: integers as usize })
}

/// The arrays of the finest grid.
pub(super) struct FineArrays<'a> {
    /// Weights and flags of pixels, see [`word`](super::word).
    pub words: &'a mut [u32],
    /// The residual: the right side until the first step. Longer than the grid: [`coupled`](super::coupled) keeps coarse
    /// arrays in it.
    pub residual: &'a mut [f32],
    /// What one multigrid cycle makes of the residual.
    pub correction: &'a mut [f32],
    /// The search direction of conjugate gradients.
    pub direction: &'a mut [f32],
}

/// The arrays of one coarse grid.
pub(super) struct CoarseArrays<'a> {
    /// Weight of the edge to the right neighbor; its sign is half of the attachment.
    pub east: &'a mut [f32],
    /// Weight of the edge to the neighbor below; its sign is the other half.
    pub south: &'a mut [f32],
    /// What the equation of a pixel has on the diagonal beyond its edges.
    pub mass: &'a mut [f32],
    /// The right side.
    pub right: &'a mut [f32],
    /// The correction.
    pub correction: &'a mut [f32],
}

/// The workspace cut into its parts.
pub(super) struct Parts<'a> {
    pub grid: Grid,
    pub fine: FineArrays<'a>,
    pub hierarchy: Hierarchy<'a>,
    /// Seven rows of `width + 2`.
    pub buffers: &'a mut [f32],
}

/// The coarse grids and the spans of every grid.
pub(super) struct Hierarchy<'a> {
    /// The finest grid, which is not stored here.
    pub finest: Grid,
    /// All coarse arrays, level after level.
    pub coarse: &'a mut [f32],
    /// One for each row, level after level, the finest first.
    pub spans: &'a mut [StoredSpan],
}

/// Cuts and prepares what [`need`] says off the arena; `None` if it holds less.
pub(super) fn split<'a>(grid: Grid, arena: &mut Arena<'a>) -> Option<Parts<'a>> {
    let need = need(grid.width, grid.height)?;
    if !arena.holds(need) {
        return None;
    }
    let buffers_len = ROW_BUFFERS * (grid.width + 2);
    let coarse_len = need.singles - FINE_ARRAYS * grid.len() - buffers_len;
    let residual_len = coarse_len / (COARSE_ARRAYS + MORE_COARSE_ARRAYS) * MORE_COARSE_ARRAYS;
    let fine = FineArrays {
        words: arena.integers(grid.len())?,
        residual: arena.singles(residual_len)?,
        correction: arena.singles(grid.len())?,
        direction: arena.singles(grid.len())?,
    };
    grid.clear_padding(fine.words);
    for array in [fine.residual.get_mut(..grid.len())?, fine.correction, fine.direction] {
        grid.clear_padding(array);
    }
    let buffers = arena.singles(buffers_len)?;
    buffers.fill(0.0);
    let coarse = arena.singles(coarse_len - residual_len)?;
    let spans = arena.integers(need.integers - grid.len())?.as_chunks_mut().0;
    Some(Parts { grid, fine, hierarchy: Hierarchy { finest: grid, coarse, spans }, buffers })
}

impl Hierarchy<'_> {
    /// Number of grids, the finest included.
    pub fn levels(&self) -> usize {
        let mut grid = self.finest;
        let mut levels = 1;
        while !grid.is_coarsest() && levels < MAX_LEVELS {
            grid = grid.coarser();
            levels += 1;
        }
        levels
    }

    /// The grid of `level`, 0 being the finest, where its arrays begin and where its spans begin.
    fn locate(&self, level: usize) -> (Grid, usize, usize) {
        let (mut grid, mut arrays, mut spans) = (self.finest, 0, 0);
        for k in 0..level.min(MAX_LEVELS) {
            if k > 0 {
                arrays += COARSE_ARRAYS * grid.len();
            }
            spans += grid.height;
            grid = grid.coarser();
        }
        (grid, arrays, spans)
    }

    /// The grid of `level`.
    pub fn grid(&self, level: usize) -> Grid {
        self.locate(level).0
    }

    /// Spans of `level` for writing.
    pub fn spans_mut(&mut self, level: usize) -> &mut [StoredSpan] {
        let (grid, _, start) = self.locate(level);
        self.spans.get_mut(start..start + grid.height).unwrap_or_default()
    }

    /// Grid, arrays and spans of a coarse `level`.
    pub fn level(&mut self, level: usize) -> Option<(Grid, CoarseArrays<'_>, &mut [StoredSpan])> {
        let (grid, start, spans) = self.locate(level);
        let arrays = cut(self.coarse.get_mut(start..)?, grid)?;
        Some((grid, arrays, self.spans.get_mut(spans..spans + grid.height)?))
    }

    /// The arrays of the first coarse grid and the spans of the finest grid.
    pub fn first(&mut self) -> Option<(CoarseArrays<'_>, &[StoredSpan])> {
        let arrays = cut(self.coarse, self.finest.coarser())?;
        Some((arrays, self.spans))
    }

    /// The arrays of a coarse `level` and of the next, and the spans of the first.
    pub fn pair(&mut self, level: usize) -> Option<(CoarseArrays<'_>, CoarseArrays<'_>, &mut [StoredSpan])> {
        let (grid, start, spans) = self.locate(level);
        let (own, next) = self.coarse.get_mut(start..)?.split_at_mut_checked(COARSE_ARRAYS * grid.len())?;
        let spans = self.spans.get_mut(spans..spans + grid.height)?;
        Some((cut(own, grid)?, cut(next, grid.coarser())?, spans))
    }
}

fn cut(mut rest: &mut [f32], grid: Grid) -> Option<CoarseArrays<'_>> {
    let len = grid.len();
    Some(CoarseArrays {
        east: rest.split_off_mut(..len)?,
        south: rest.split_off_mut(..len)?,
        mass: rest.split_off_mut(..len)?,
        right: rest.split_off_mut(..len)?,
        correction: rest.split_off_mut(..len)?,
    })
}
