//! Between a grid and the next coarser one: linear interpolation from the block a pixel lies in and the two blocks
//! beyond its edges out of the block, and its transpose.
//!
//! A pixel lies a quarter of a block from its block's center in both directions, so half of its own block and a
//! quarter of each neighbor reproduce planes exactly. An edge of weight zero takes its block out of the mean.
//!
//! # Reference
//! M. Khalil, P. Wesseling, "Vertex-centered and cell-centered multigrid for interface problems", J. Comput. Phys.
//! 98 (1992); D. Y. Kwak, "V-cycle multigrid for cell-centered finite differences", SIAM J. Sci. Comput. 21 (1999).

use super::grid::Grid;
use super::operator::{Network, Operator, at};
use super::span::Span;
use super::word::Attachment;

/// Shares of a pixel's own block, of the block beside it and of the block across.
pub(super) type Shares = [f32; 3];

const UNIFORM: Shares = [0.5, 0.25, 0.25];

/// Column or row of the block beyond the pixel's edge out of its block; outside the grid it may be one too far.
pub(super) const fn beyond(position: usize) -> usize {
    if position.is_multiple_of(2) { (position / 2).wrapping_sub(1) } else { position / 2 + 1 }
}

/// The coarse grid's right side is the residual times this: a correction that is a little too large leaves ten times less
/// after four cycles than one without it (measured; 1.00 and 1.04 are both worse).
const EMPHASIS: f32 = 1.02;

/// The shares of pixel `(x, y)`.
pub(super) fn shares<N: Network>(operator: &N, x: usize, y: usize) -> Shares {
    match operator.attachment(operator.grid().start(y) + x) {
        Attachment::None => [0.0; 3],
        Attachment::Beside => [0.0, 1.0, 0.0],
        Attachment::Across => [0.0, 0.0, 1.0],
        Attachment::Own => {
            let [beside, across] = operator.outward(x, y).map(|(weight, neighbor)| {
                if weight > 0.0 && operator.attachment(neighbor) == Attachment::Own { 0.25 } else { 0.0 }
            });
            [1.0 - beside - across, beside, across]
        }
    }
}

/// The whole blocks inside the unit part, by column; none if there are too few to be worth it.
const fn uniform_blocks(span: Span) -> (usize, usize) {
    let [from, to] = span.unit;
    let (from, to) = (from.div_ceil(2), to / 2);
    if to < from + 4 { (0, 0) } else { (from, to) }
}

/// Index of column `x` of row `y` in the coarse grid, none outside of it.
pub(super) fn coarse_index(grid: &Grid, x: usize, y: usize) -> Option<usize> {
    (x < grid.width && y < grid.height).then(|| grid.start(y) + x)
}

/// Adds what the coarse correction says to row `y` of `correction`.
#[inline(always)]
pub(super) fn prolong<O: Operator>(
    operator: &O,
    span: Span,
    y: usize,
    coarse: &[f32],
    correction: &mut [f32],
) {
    let grid = operator.grid();
    let coarse_grid = grid.coarser();
    let row = grid.row_mut(correction, y);
    let (from, to) = uniform_blocks(span);
    let value = |x: usize, y: usize| coarse_index(&coarse_grid, x, y).map_or(0.0, |index| at(coarse, index));
    let [first, last] = span.active;
    let parts = if from < to { [(first, 2 * from), (2 * to, last)] } else { [(first, last), (0, 0)] };
    for (skip, end) in parts {
        for (x, out) in row.iter_mut().enumerate().take(end).skip(skip) {
            let [own, beside, across] = shares(operator, x, y);
            *out += own * value(x / 2, y / 2)
                + (beside * value(beyond(x), y / 2) + across * value(x / 2, beyond(y)));
        }
    }
    if from >= to {
        return;
    }
    let (start, beyond_start) = (coarse_grid.start(y / 2) + from, coarse_grid.start(beyond(y)) + from);
    let n = to - from;
    let (Some(left), Some(center), Some(right), Some(across), Some(out)) = (
        coarse.get(start - 1..start - 1 + n),
        coarse.get(start..start + n),
        coarse.get(start + 1..start + 1 + n),
        coarse.get(beyond_start..beyond_start + n),
        row.get_mut(2 * from..2 * to),
    ) else {
        return;
    };
    let [own, beside, _] = UNIFORM;
    for ((((pair, l), c), r), a) in
        out.as_chunks_mut::<2>().0.iter_mut().zip(left).zip(center).zip(right).zip(across)
    {
        let both = own * c + beside * a;
        let [even, odd] = pair;
        *even += both + beside * l;
        *odd += both + beside * r;
    }
}

/// Adds row `y` of the fine residual to the right side `coarse`, with the same shares.
#[inline(always)]
pub(super) fn restrict<O: Operator>(
    operator: &O,
    span: Span,
    y: usize,
    residual: &[f32],
    coarse: &mut [f32],
) {
    let grid = operator.grid();
    let coarse_grid = grid.coarser();
    let (from, to) = uniform_blocks(span);
    let mut add = |x: usize, y: usize, value: f32| {
        let value = EMPHASIS * value;
        if let Some(slot) = coarse_index(&coarse_grid, x, y).and_then(|index| coarse.get_mut(index)) {
            *slot += value;
        }
    };
    let [start, last] = span.active;
    let parts = if from < to { [(start, 2 * from), (2 * to, last)] } else { [(start, last), (0, 0)] };
    for (skip, end) in parts {
        for (x, &value) in residual.iter().enumerate().take(end).skip(skip) {
            let [own, beside, across] = shares(operator, x, y);
            add(x / 2, y / 2, own * value);
            if beside != 0.0 {
                add(beyond(x), y / 2, beside * value);
            }
            if across != 0.0 {
                add(x / 2, beyond(y), across * value);
            }
        }
    }
    if from >= to {
        return;
    }
    let [own, beside, _] = UNIFORM;
    // The blocks at both ends lack one neighbor inside the span and give to one outside of it.
    let (first, last) = (at(residual, 2 * from), at(residual, 2 * to - 1));
    add(from.wrapping_sub(1), y / 2, beside * first);
    add(to, y / 2, beside * last);
    let after_first = at(residual, 2 * from + 2);
    let before_last = at(residual, 2 * to - 3);
    add(from, y / 2, own * (first + at(residual, 2 * from + 1)) + beside * after_first);
    add(to - 1, y / 2, own * (at(residual, 2 * to - 2) + last) + beside * before_last);
    let n = to - from;
    let [own, beside, across] = UNIFORM.map(|share| EMPHASIS * share);
    let start = coarse_grid.start(beyond(y)) + from;
    let pairs = residual.get(2 * from..2 * to).unwrap_or_default().as_chunks::<2>().0;
    for (slot, [even, odd]) in coarse.get_mut(start..start + n).unwrap_or_default().iter_mut().zip(pairs) {
        *slot += across * (even + odd);
    }
    let start = coarse_grid.start(y / 2) + from + 1;
    let before = residual.get(2 * from + 1..2 * to - 3).unwrap_or_default().as_chunks::<2>().0;
    let inside = residual.get(2 * from + 2..2 * to - 2).unwrap_or_default().as_chunks::<2>().0;
    let after = residual.get(2 * from + 3..2 * to - 1).unwrap_or_default().as_chunks::<2>().0;
    let slots = coarse.get_mut(start..start + n - 2).unwrap_or_default();
    for (((slot, [l, _]), [even, odd]), [_, r]) in slots.iter_mut().zip(before).zip(inside).zip(after) {
        *slot += own * (even + odd) + beside * (l + r);
    }
}
