//! Passes over one grid, several steps deep: while one row is smoothed for the first time, the row above it is
//! smoothed for the second and the residual of the one above that goes to the coarser grid, all from cache.

use super::grid::Grid;
use super::operator::{Coefficients, Operator, Unit, at, copy};
use super::span::{Span, StoredSpan};
use super::transfer;

/// The two steps of a Jacobi iteration that damps everything between a sixth and all of the spectrum most evenly:
/// inverse roots of the second Chebyshev polynomial on [0.35, 2].
const STEPS: [f32; 2] = [1.690_220_4, 0.568_712_6];

/// Sums run in this many lanes, in this order, on every target.
const LANES: usize = 8;

/// The sum of products, in lanes within the row.
pub(super) fn dot(a: &[f32], b: &[f32]) -> f64 {
    let mut lanes = [0.0_f32; LANES];
    let (a_chunks, a_rest) = a.as_chunks::<LANES>();
    let (b_chunks, b_rest) = b.as_chunks::<LANES>();
    for (a, b) in a_chunks.iter().zip(b_chunks) {
        for ((lane, &a), &b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    for ((lane, &a), &b) in lanes.iter_mut().zip(a_rest).zip(b_rest) {
        *lane += a * b;
    }
    lanes.iter().map(|&lane| f64::from(lane)).sum()
}

/// What a formula knows of one pixel.
pub(super) struct Point {
    /// The value.
    pub value: f32,
    /// The right side.
    pub right: f32,
    /// `-(A z)`.
    pub flow: f32,
    /// One over the diagonal, or zero.
    pub inverse: f32,
}

/// A row and its neighbors: `center` has one more number at both ends.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub above: &'a [f32],
    pub center: &'a [f32],
    pub below: &'a [f32],
}

/// `out = formula` for every pixel of row `y`, by the coefficients of `operator` outside the span and one inside.
#[inline(always)]
pub(super) fn map_row<O: Operator>(
    operator: &O,
    span: Span,
    y: usize,
    rows: Rows,
    right: &[f32],
    out: &mut [f32],
    formula: impl Fn(Point) -> f32 + Copy,
) {
    let grid = operator.grid();
    let start = grid.start(y);
    let ([first, last], [from, to]) = (span.active, span.unit);
    for (from, to) in [(first, from), (to, last)] {
        if from < to
            && let Some(row) = operator.row(start + from, to - from)
        {
            segment(&row, from, to - from, rows, right, out, formula);
        }
    }
    if from < to {
        segment(&Unit, from, to - from, rows, right, out, formula);
    }
}

#[inline(always)]
fn segment<C: Coefficients>(
    coefficients: &C,
    from: usize,
    n: usize,
    rows: Rows,
    right: &[f32],
    out: &mut [f32],
    formula: impl Fn(Point) -> f32,
) {
    let Some(out) = out.get_mut(from..from + n) else { return };
    let (Some(above), Some(below), Some(right)) =
        (rows.above.get(from..from + n), rows.below.get(from..from + n), right.get(from..from + n))
    else {
        return;
    };
    let (Some(l), Some(c), Some(r)) = (
        rows.center.get(from..from + n),
        rows.center.get(from + 1..from + 1 + n),
        rows.center.get(from + 2..from + 2 + n),
    ) else {
        return;
    };
    for i in 0..n {
        let value = at(c, i);
        let flow = coefficients.flow(i, value, [at(l, i), at(r, i), at(above, i), at(below, i)]);
        let inverse = coefficients.inverse_diagonal(i);
        if let Some(out) = out.get_mut(i) {
            *out = formula(Point { value, right: at(right, i), flow, inverse });
        }
    }
}

/// The rows `y - 1`, `y`, `y + 1` of one array.
pub(super) fn rows_at<'a>(grid: &Grid, array: &'a [f32], y: usize) -> Rows<'a> {
    Rows { above: grid.row_above(array, y), center: grid.padded_row(array, y), below: grid.row(array, y + 1) }
}

/// Scratch rows.
pub(super) struct Buffers<'a> {
    rows: [&'a mut [f32]; 4],
}

impl<'a> Buffers<'a> {
    /// Cuts `buffers` into rows.
    pub fn new(buffers: &'a mut [f32]) -> Self {
        let mut rows = buffers.chunks_exact_mut((buffers.len() / 4).max(1));
        Self { rows: [(); 4].map(|()| rows.next().unwrap_or_default()) }
    }

    /// The first `width` numbers of each row.
    pub fn cut(&mut self, width: usize) -> [&mut [f32]; 4] {
        self.rows.each_mut().map(|row| row.get_mut(..width).unwrap_or_default())
    }
}

/// One damped Jacobi step on row `y` in place. `old` holds what the row above was before its own step and holds row
/// `y` as it was afterwards.
#[inline(always)]
fn smooth_row<O: Operator>(
    operator: &O,
    span: Span,
    y: usize,
    step: f32,
    right: &[f32],
    correction: &mut [f32],
    [old, new]: [&mut [f32]; 2],
) {
    let grid = operator.grid();
    let rows = Rows { above: old, ..rows_at(&grid, correction, y) };
    map_row(operator, span, y, rows, grid.row(right, y), new, |p| {
        p.value + step * p.inverse * (p.right + p.flow)
    });
    let row = span.cut_mut(grid.row_mut(correction, y));
    copy(span.cut_mut(old), row);
    copy(row, span.cut(new));
}

/// Smooths from zero and sends the residual to the right side `coarse` of the next grid.
#[inline(never)]
pub(super) fn descend<O: Operator>(
    operator: &O,
    spans: &[StoredSpan],
    right: &[f32],
    correction: &mut [f32],
    coarse: &mut [f32],
    buffers: &mut Buffers,
) {
    let grid = operator.grid();
    let [old, new, residual, _] = buffers.cut(grid.width);
    old.fill(0.0);
    coarse.fill(0.0);
    let [first, second] = STEPS;
    let load = |y| Span::load(spans, y, grid.width);
    for y in 0..grid.height + 2 {
        if y < grid.height {
            // The first step, from zero: neighbors do not matter yet.
            let rows = rows_at(&grid, right, y);
            let (span, out) = (load(y), grid.row_mut(correction, y));
            map_row(operator, span, y, rows, grid.row(right, y), out, |p| first * p.inverse * p.right);
        }
        if (1..=grid.height).contains(&y) {
            smooth_row(operator, load(y - 1), y - 1, second, right, correction, [old, new]);
        }
        if let Some(y) = y.checked_sub(2) {
            let (span, rows) = (load(y), rows_at(&grid, correction, y));
            map_row(operator, span, y, rows, grid.row(right, y), residual, |p| p.right + p.flow);
            transfer::restrict(operator, span, y, residual, coarse);
        }
    }
}

/// Adds the coarse grid's correction, smooths in the opposite order, and returns the product of right side and
/// correction.
#[inline(never)]
pub(super) fn ascend<O: Operator>(
    operator: &O,
    spans: &[StoredSpan],
    right: &[f32],
    correction: &mut [f32],
    coarse: &[f32],
    buffers: &mut Buffers,
) -> f64 {
    let grid = operator.grid();
    let [first_old, second_old, new, _] = buffers.cut(grid.width);
    first_old.fill(0.0);
    second_old.fill(0.0);
    let [first, second] = STEPS;
    let load = |y| Span::load(spans, y, grid.width);
    let mut product = 0.0;
    for y in 0..grid.height + 2 {
        if y < grid.height {
            transfer::prolong(operator, load(y), y, coarse, correction);
        }
        if (1..=grid.height).contains(&y) {
            smooth_row(operator, load(y - 1), y - 1, second, right, correction, [first_old, new]);
        }
        if let Some(y) = y.checked_sub(2) {
            let span = load(y);
            smooth_row(operator, span, y, first, right, correction, [second_old, new]);
            product += dot(span.cut(grid.row(right, y)), span.cut(grid.row(correction, y)));
        }
    }
    product
}

/// Solves the coarsest grid, a single pixel.
pub(super) fn solve_coarsest<O: Operator>(operator: &O, right: &[f32], correction: &mut [f32]) {
    let grid = operator.grid();
    let mass = operator.mass(grid.start(0));
    for (value, &right) in grid.row_mut(correction, 0).iter_mut().zip(grid.row(right, 0)) {
        *value = if mass > 0.0 { right / mass } else { 0.0 };
    }
}
