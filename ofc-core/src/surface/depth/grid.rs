//! Where everything lies in the caller's workspace: padded grids, each half as wide and high as the one before.
//!
//! A grid is stored with one column of padding (it stands to the right of a row and to the left of the next), a row
//! above, a row below and one number more. The padding stays zero, so that every pixel has four neighbors and no
//! kernel knows about borders.

/// Coarser grids at most: halving the longest side that [`MAX_PIXELS`](super::parameters::MAX_PIXELS) allows.
pub(super) const MAX_LEVELS: usize = 30;

/// Numbers that the coarse grids keep for each of their pixels: two edge weights, a mass, right side and correction.
const COARSE_ARRAYS: u64 = 5;

/// Arrays of the finest grid: weights, residual, correction and search direction.
const FINE_ARRAYS: u64 = 4;

/// Numbers that a row keeps about itself, see [`Span`].
const SPAN_NUMBERS: u64 = 4;

/// Rows of scratch.
const ROW_BUFFERS: u64 = 4;

/// A padded grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    pub width: usize,
    pub height: usize,
}

impl Grid {
    /// From a pixel to the one below.
    pub const fn stride(&self) -> usize {
        self.width + 1
    }

    /// Numbers in one array.
    pub const fn len(&self) -> usize {
        (self.height + 2) * self.stride() + 1
    }

    /// Index of the first pixel of row `y`.
    pub const fn start(&self, y: usize) -> usize {
        (y + 1) * self.stride() + 1
    }

    /// The next coarser grid, of 2x2 blocks.
    pub const fn coarser(&self) -> Self {
        Self { width: self.width.div_ceil(2), height: self.height.div_ceil(2) }
    }

    /// A single pixel has no equation left to solve by going coarser.
    pub const fn is_coarsest(&self) -> bool {
        self.width <= 1 && self.height <= 1
    }

    /// Zeroes all of `array` that is not a pixel.
    fn clear_padding(&self, array: &mut [f32]) {
        let stride = self.stride();
        let (above, rest) = array.split_at_mut_checked(stride + 1).unwrap_or_default();
        above.fill(0.0);
        for row in rest.chunks_mut(stride.max(1)).take(self.height) {
            row.iter_mut().skip(self.width).for_each(|padding| *padding = 0.0);
        }
        rest.iter_mut().skip(self.height * stride).for_each(|padding| *padding = 0.0);
    }

    /// Row `y` of `array`, none when there is no such row.
    pub fn row<'a>(&self, array: &'a [f32], y: usize) -> &'a [f32] {
        let start = self.start(y);
        array.get(start..start + self.width).unwrap_or_default()
    }

    /// Row `y` of `array` for writing.
    pub fn row_mut<'a>(&self, array: &'a mut [f32], y: usize) -> &'a mut [f32] {
        let start = self.start(y);
        array.get_mut(start..start + self.width).unwrap_or_default()
    }

    /// Row `y` with the padding (or the neighbor's padding) before and after it.
    pub fn padded_row<'a>(&self, array: &'a [f32], y: usize) -> &'a [f32] {
        let start = self.start(y) - 1;
        array.get(start..start + self.width + 2).unwrap_or_default()
    }

    /// The row above row `y`: padding above row 0.
    pub fn row_above<'a>(&self, array: &'a [f32], y: usize) -> &'a [f32] {
        let start = self.start(y) - self.stride();
        array.get(start..start + self.width).unwrap_or_default()
    }
}

/// Numbers the workspace must hold for a picture of this size: at most 17/3 a pixel and some rows.
///
/// The sum over the coarse grids is bounded in closed form: level k is at most (w / 2^k + 1) pixels wide.
pub(super) const fn workspace_len(width: usize, height: usize) -> Option<usize> {
    if width == 0 || height == 0 || width > super::parameters::MAX_PIXELS / height {
        return None;
    }
    let (w, h, levels) = (width as u64, height as u64, MAX_LEVELS as u64);
    let fine = FINE_ARRAYS * ((h + 2) * (w + 1) + 1);
    let coarse = COARSE_ARRAYS * (w * h / 3 + 3 * w + 2 * h + 6 * levels);
    let spans = SPAN_NUMBERS * (2 * h + levels);
    let len = fine + coarse + spans + ROW_BUFFERS * (w + 2);
    if len > isize::MAX as u64 / 4 { None } else { Some(len as usize) }
}

/// The arrays of the finest grid.
pub(super) struct FineArrays<'a> {
    /// Root weights of pixels, see `operator`.
    pub weights: &'a mut [f32],
    /// The residual: the right side until the first step.
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
    /// Four rows of `width + 2`.
    pub buffers: &'a mut [f32],
}

/// The coarse grids and the spans of every grid.
pub(super) struct Hierarchy<'a> {
    /// The finest grid, which is not stored here.
    pub finest: Grid,
    /// All coarse arrays, level after level.
    pub coarse: &'a mut [f32],
    /// [`SPAN_NUMBERS`] a row, level after level, the finest first.
    pub spans: &'a mut [f32],
}

/// Cuts and prepares as much of `workspace` as is needed; `None` if it is too short.
pub(super) fn split(grid: Grid, workspace: &mut [f32]) -> Option<Parts<'_>> {
    let mut rest = workspace.get_mut(..workspace_len(grid.width, grid.height)?)?;
    let fine = FineArrays {
        weights: rest.split_off_mut(..grid.len())?,
        residual: rest.split_off_mut(..grid.len())?,
        correction: rest.split_off_mut(..grid.len())?,
        direction: rest.split_off_mut(..grid.len())?,
    };
    for array in [&mut *fine.weights, fine.residual, fine.correction, fine.direction] {
        grid.clear_padding(array);
    }
    let buffers = rest.split_off_mut(..ROW_BUFFERS as usize * (grid.width + 2))?;
    let spans = rest.split_off_mut(..SPAN_NUMBERS as usize * (2 * grid.height + MAX_LEVELS))?;
    buffers.fill(0.0);
    Some(Parts { grid, fine, hierarchy: Hierarchy { finest: grid, coarse: rest, spans }, buffers })
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
                arrays += COARSE_ARRAYS as usize * grid.len();
            }
            spans += SPAN_NUMBERS as usize * grid.height;
            grid = grid.coarser();
        }
        (grid, arrays, spans)
    }

    /// The grid of `level`.
    pub fn grid(&self, level: usize) -> Grid {
        self.locate(level).0
    }

    /// Spans of `level` for writing.
    pub fn spans_mut(&mut self, level: usize) -> &mut [f32] {
        let (grid, _, start) = self.locate(level);
        self.spans.get_mut(start..start + SPAN_NUMBERS as usize * grid.height).unwrap_or_default()
    }

    /// Grid, arrays and spans of a coarse `level`.
    pub fn level(&mut self, level: usize) -> Option<(Grid, CoarseArrays<'_>, &mut [f32])> {
        let (grid, start, spans) = self.locate(level);
        let arrays = cut(self.coarse.get_mut(start..)?, grid)?;
        Some((grid, arrays, self.spans.get_mut(spans..spans + SPAN_NUMBERS as usize * grid.height)?))
    }

    /// The arrays of the first coarse grid and the spans of the finest grid.
    pub fn first(&mut self) -> Option<(CoarseArrays<'_>, &[f32])> {
        let arrays = cut(self.coarse, self.finest.coarser())?;
        Some((arrays, self.spans))
    }

    /// The arrays of a coarse `level` and of the next, and the spans of the first.
    pub fn pair(&mut self, level: usize) -> Option<(CoarseArrays<'_>, CoarseArrays<'_>, &mut [f32])> {
        let (grid, start, spans) = self.locate(level);
        let (own, next) =
            self.coarse.get_mut(start..)?.split_at_mut_checked(COARSE_ARRAYS as usize * grid.len())?;
        let spans = self.spans.get_mut(spans..spans + SPAN_NUMBERS as usize * grid.height)?;
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

/// What a row is made of: nothing, some pixels, many pixels in one piece that are all alike, some pixels, nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Span {
    /// From the first to behind the last pixel that has an equation.
    pub active: [usize; 2],
    /// The pixels (within `active`) that have four edges of weight one and no mass, and whose neighbors stand for
    /// their own blocks.
    pub unit: [usize; 2],
}

impl Span {
    /// The span of row `y`.
    pub fn load(spans: &[f32], y: usize, width: usize) -> Self {
        let mut numbers = [0; SPAN_NUMBERS as usize];
        for (number, stored) in numbers.iter_mut().zip(spans.iter().skip(SPAN_NUMBERS as usize * y)) {
            *number = stored.to_bits() as usize;
        }
        // Indices fit and are in order; saying so again spares the checks later.
        let [first, from, to, last] = numbers;
        let last = last.min(width);
        let to = to.min(last);
        let from = from.min(to);
        Self { active: [first.min(from), last], unit: [from, to] }
    }

    /// Stores the span of row `y`.
    pub fn store(self, spans: &mut [f32], y: usize) {
        let ([first, last], [from, to]) = (self.active, self.unit);
        let stored = spans.iter_mut().skip(SPAN_NUMBERS as usize * y);
        for (slot, value) in stored.zip([first, from, to, last]) {
            *slot = f32::from_bits(u32::try_from(value).unwrap_or(0));
        }
    }

    /// The part of a row that has equations.
    pub fn cut<'a>(&self, row: &'a [f32]) -> &'a [f32] {
        let [first, last] = self.active;
        row.get(first..last).unwrap_or_default()
    }

    /// The part of a row that [`cut`](Self::cut) gives, for writing.
    pub fn cut_mut<'a>(&self, row: &'a mut [f32]) -> &'a mut [f32] {
        let [first, last] = self.active;
        row.get_mut(first..last).unwrap_or_default()
    }
}
