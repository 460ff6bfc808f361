//! The right side of the equations: what the slopes, less the trend, want of every pixel.
//!
//! Between two neighboring pixels the depth should differ by the mean of their slopes. Least squares over these
//! equations, an edge each, has the normal equations `sum of w_ij (z_i - z_j) = sum of w_ij g_ij`.

use super::operator::{Coefficients, Operator, Unit, at};
use super::regions::sum;
use super::span::{Span, StoredSpan};
use super::sweep::dot;
use super::trend::Trend;

/// Rows of slopes: p with its neighbors left and right, q with those above and below, in grid layout.
struct Segment<'a> {
    p: [&'a [f32]; 3],
    q: [&'a [f32]; 3],
}

/// The trend's part in a row.
struct TrendRow {
    /// p at the left end of the row and its slope, from the middle of the edge to the left of column 0.
    p: [f32; 2],
    /// q in the middles of the edges above and below column 0, and their slope.
    q: [f32; 3],
}

/// Sizes of a right side.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Size {
    /// The squared norm of what it would be with the trend.
    pub squared: f64,
    /// The weighted sum of squares of what the equations ask for, without the trend.
    pub energy: f64,
}

/// Writes the right side into `right`; uses two rows of scratch.
#[inline(never)]
pub(super) fn fill<O: Operator>(
    operator: &O,
    spans: &[StoredSpan],
    trend: &Trend,
    p: &mut [f32],
    q: &mut [f32],
    right: &mut [f32],
    [whole, energies]: [&mut [f32]; 2],
) -> Size {
    let grid = operator.grid();
    for y in 0..grid.height {
        let [[p0, pp], [q0, qp]] = trend.slopes(y as f64);
        for (array, start, slope) in [(&mut *p, p0, pp), (&mut *q, q0, qp)] {
            let (start, slope) = (start as f32, slope as f32);
            // 32 bits with a sign are what converts quickly.
            for (x, value) in (0_i32..).zip(grid.row_mut(array, y)) {
                *value -= start + slope * x as f32;
            }
        }
    }
    let mut size = Size::default();
    for y in 0..grid.height {
        let (start, stride) = (grid.start(y), grid.stride());
        let [[p0, pp], _] = trend.slopes(y as f64);
        let [_, [above, qp]] = trend.slopes(y as f64 - 0.5);
        let [_, [below, _]] = trend.slopes(y as f64 + 0.5);
        let trend =
            TrendRow { p: [(p0 - 0.5 * pp) as f32, pp as f32], q: [above as f32, below as f32, qp as f32] };
        let span = Span::load(spans, y, grid.width);
        let ([first, last], [from, to]) = (span.active, span.unit);
        for (from, to, unit) in [(first, from, false), (from, to, true), (to, last, false)] {
            let (start, n) = (start + from, to - from);
            let cut = |array, start| grid_cut(array, start, n);
            let slopes = Segment {
                p: [cut(p, start - 1), cut(p, start), cut(p, start + 1)],
                q: [cut(q, start - stride), cut(q, start), cut(q, start + stride)],
            };
            let Some(out) = right.get_mut(start..start + n) else { continue };
            let Some(whole) = whole.get_mut(from..from + n) else { continue };
            let Some(energies) = energies.get_mut(from..from + n) else { continue };
            if unit {
                segment(&Unit, &trend, &slopes, from, [out, whole, energies]);
            } else if let Some(row) = operator.row(start, n) {
                segment(&row, &trend, &slopes, from, [out, whole, energies]);
            }
        }
        let whole = span.cut(whole);
        size.squared += dot(whole, whole);
        size.energy += sum(span.cut(energies));
    }
    size
}

fn grid_cut(array: &[f32], start: usize, n: usize) -> &[f32] {
    array.get(start..start + n).unwrap_or_default()
}

#[inline(always)]
fn segment<C: Coefficients>(
    coefficients: &C,
    trend: &TrendRow,
    slopes: &Segment,
    from: usize,
    [out, whole, energies]: [&mut [f32]; 3],
) {
    let n = out.len();
    if slopes.p.iter().chain(&slopes.q).any(|row| row.len() != n) || whole.len() != n {
        return;
    }
    let ([p_left, p, p_right], [q_above, q, q_below]) = (slopes.p, slopes.q);
    let [p_trend, pp] = trend.p;
    let [above_trend, below_trend, qp] = trend.q;
    let first = i32::try_from(from).unwrap_or(0);
    for (i, ((out, whole), energy)) in out.iter_mut().zip(whole).zip(energies).enumerate() {
        let [wl, wr, wu, wd] = coefficients.edges(i);
        let left = 0.5 * (at(p_left, i) + at(p, i));
        let right = 0.5 * (at(p, i) + at(p_right, i));
        let above = 0.5 * (at(q_above, i) + at(q, i));
        let below = 0.5 * (at(q, i) + at(q_below, i));
        *out = (wl * left - wr * right) + (wd * below - wu * above);
        // Every edge once: the ones to the right and above.
        *energy = wr * right * right + wu * above * above;
        let x = (first + i as i32) as f32;
        let (left_trend, across) = (p_trend + pp * x, qp * x);
        *whole = *out
            + ((wl * left_trend - wr * (left_trend + pp))
                + (wd * (below_trend + across) - wu * (above_trend + across)));
    }
}
