//! Whole rectangles without weights and prior are solved directly: cosine transforms of the columns leave the equations of
//! a row for every frequency.
//!
//! # Reference
//! R. W. Hockney, "A fast direct solution of Poisson's equation using Fourier analysis", J. ACM 12 (1965).

use super::cosine_transform::{CosineTransform, Rows};
use super::fourier::Lengths;
use super::grid::{FineArrays, Grid, Parts};
use super::operator::at;
use super::poisson::{Answer, Job, NO_DEPTH};
use super::regions::sum;
use super::sweep::{Buffers, dot};
use super::trend::Trend;
use super::{DepthResult, Method, tridiagonal};
use libm::sqrt;

/// A residual of this part of the depth is what f32 leaves, and no worse than what was asked for.
const ROUNDING: f64 = 2e-6;

/// The lines that the cosine transform goes along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    Columns,
    Rows,
}

impl Job<'_> {
    /// How to solve directly, if all weights are one, there is no prior, and the height or the width has no prime factor
    /// above 7.
    pub fn is_direct(&self) -> Option<Along> {
        let Parts { grid, fine, hierarchy, .. } = &self.parts;
        let anchored = self.params.prior_weight > 0.0 && self.input.prior.is_some();
        if anchored || (0..grid.height).any(|y| !is_one(grid.row(fine.weights, y))) {
            return None;
        }
        let fits =
            |n| Lengths::new(n).is_some() && CosineTransform::workspace_len(n) <= hierarchy.coarse.len();
        if fits(grid.height) { Some(Along::Columns) } else { fits(grid.width).then_some(Along::Rows) }
    }

    /// As [`depth`](Self::depth), directly.
    #[inline(never)]
    pub fn rectangle(mut self, along: Along, so_far: DepthResult, converged: bool) -> Answer {
        let Parts { grid, fine, hierarchy, .. } = &mut self.parts;
        let grid = *grid;
        let trend = Trend::fit(&grid, fine.weights, fine.correction, fine.direction);
        let squared = fill(&grid, &trend, fine.correction, fine.direction, fine.residual);
        solve(&grid, along, fine, hierarchy.coarse)?;
        let Remainder { residual, depth } = self.finish_rectangle(&trend);
        let (residual, norm) = (sqrt(residual), sqrt(squared));
        let reached = residual <= (self.params.tolerance * norm).max(ROUNDING * sqrt(depth));
        Some(Ok(DepthResult {
            converged: converged && reached,
            residual: if norm > 0.0 { residual / norm } else { 0.0 },
            regions: 1,
            ..so_far
        }))
    }

    /// Puts the trend back, takes the mean off, scales, and marks what has no depth.
    #[inline(never)]
    fn finish_rectangle(&mut self, trend: &Trend) -> Remainder {
        let Parts { grid, fine, buffers, .. } = &mut self.parts;
        let mut buffers = Buffers::new(buffers);
        let [buffer, ..] = buffers.cut(grid.width);
        let mut remainder = Remainder::default();
        let (mut total, mut count) = (0.0, 0.0);
        let mask = if self.params.method == Method::Paper { self.input.mask } else { None };
        for y in 0..grid.height {
            let row = grid.row(fine.direction, y);
            left_over(grid, y, fine.direction, grid.row(fine.residual, y), buffer);
            remainder.residual += dot(buffer, buffer);
            remainder.depth += dot(row, row);
            let [constant, linear, square] = trend.depth(y);
            if let Some(mask) = mask {
                let inside = (0_u32..).zip(row).zip(mask.row(y)).filter(|&(_, &m)| m != 0);
                for ((x, &z), _) in inside {
                    let x = f64::from(x);
                    total += f64::from(z) + (constant + x * (linear + x * square));
                    count += 1.0;
                }
            } else {
                // Sums of x and of its square along the row.
                let n = grid.width as f64;
                let (once, twice) = (n * (n - 1.0) / 2.0, n * (n - 1.0) * (2.0 * n - 1.0) / 6.0);
                total += sum(row) + (n * constant + once * linear + twice * square);
                count += n;
            }
        }
        let (mean, pitch) = (if count > 0.0 { total / count } else { 0.0 }, self.params.pixel_pitch);
        for y in 0..grid.height {
            let [constant, linear, square] = trend.depth(y);
            let constant = constant - mean;
            let row = self.output.row_mut(y);
            for ((x, out), &z) in (0_u32..).zip(row.iter_mut()).zip(grid.row(fine.direction, y)) {
                let x = f64::from(x);
                *out = ((f64::from(z) + (constant + x * (linear + x * square))) * pitch) as f32;
            }
            if let Some(mask) = mask {
                for (out, _) in row.iter_mut().zip(mask.row(y)).filter(|&(_, &m)| m == 0) {
                    *out = NO_DEPTH;
                }
            }
        }
        remainder
    }
}

/// Squared norms of what is left of the right side and of the depth without the trend.
#[derive(Default)]
struct Remainder {
    residual: f64,
    depth: f64,
}

/// Whether all numbers are one.
fn is_one(row: &[f32]) -> bool {
    row.iter().fold(0, |others, weight| others | (weight.to_bits() ^ 1.0_f32.to_bits())) == 0
}

/// Writes the right side, less what the trend asks for; returns the squared norm of all of it.
///
/// Inside, the rises of the two edges of a pixel differ by half the difference of its neighbours' slopes.
#[inline(never)]
fn fill(grid: &Grid, trend: &Trend, p: &[f32], q: &[f32], right: &mut [f32]) -> f64 {
    let last = grid.height - 1;
    let mut squared = 0.0;
    for y in 0..grid.height {
        let out = grid.row_mut(right, y);
        differ_along(grid.row(p, y), out);
        if last > 0 {
            // The rise of an edge that is not there is zero.
            let above = if y == 0 { 0.5 } else { -0.5 };
            let below = if y == last { -0.5 } else { 0.5 };
            let rows = grid.row(q, y.saturating_sub(1)).iter().zip(grid.row(q, last.min(y + 1)));
            for (out, (&q_above, &q_below)) in out.iter_mut().zip(rows) {
                *out += below * q_below + above * q_above;
            }
        }
        squared += dot(out, out);
        subtract_trend(trend, y, last, out);
    }
    squared
}

/// The rise of the edge to the left of each pixel less that of the edge to its right.
fn differ_along(p: &[f32], out: &mut [f32]) {
    let [before @ .., second_last, last] = p else {
        out.fill(0.0);
        return;
    };
    let [first, second, after @ ..] = p else { return };
    if let [out_first, out @ .., out_last] = out {
        *out_first = -0.5 * (first + second);
        *out_last = 0.5 * (second_last + last);
        for ((out, &l), &r) in out.iter_mut().zip(before).zip(after) {
            *out = 0.5 * (l - r);
        }
    }
}

/// Takes off row `y` of the right side what the trend has in it.
fn subtract_trend(trend: &Trend, y: usize, last: usize, out: &mut [f32]) {
    let [[p, pp], _] = trend.slopes(y as f64);
    let [_, above] = trend.slopes(y as f64 - 0.5);
    let [_, below] = trend.slopes(y as f64 + 0.5);
    let (up, down) = (if y > 0 { 1.0 } else { 0.0 }, if y < last { 1.0 } else { 0.0 });
    let [mut constant, linear] = [0, 1].map(|i| {
        let part = |slope: &[f64; 2]| slope.get(i).copied().unwrap_or(0.0);
        down * part(&below) - up * part(&above)
    });
    if let [first, inner @ .., last] = out {
        let end = p + pp * (inner.len() as f64 + 0.5);
        *first += (p + 0.5 * pp - pp) as f32;
        *last -= (end + pp) as f32;
        constant -= pp;
    }
    let (constant, linear) = (constant as f32, linear as f32);
    for (x, out) in out.iter_mut().enumerate() {
        *out -= constant + linear * x as f32;
    }
}

/// Leaves the depth in the direction; the right side stays, all else is used up.
#[inline(never)]
fn solve(grid: &Grid, along: Along, fine: &mut FineArrays, workspace: &mut [f32]) -> Option<()> {
    let (inner, stride) = (grid.start(0), grid.stride());
    let [n, width] = match along {
        Along::Columns => [grid.height, grid.width],
        Along::Rows => [grid.width, grid.height],
    };
    // What the equations of a frequency leave out, and what the cosine transforms do.
    let weight = |k| if k == 0 { 1.0 } else { 1.0 - tridiagonal::gap(k, n) } / n as f64;
    let mut transform = CosineTransform::new(n, weight, workspace)?;
    let right = Rows { data: fine.residual.get(inner..)?, stride };
    let mut depth = Rows { data: fine.direction.get_mut(inner..)?, stride };
    let mut spectrum = Rows { data: &mut *fine.correction, stride: n + 1 };
    let mut turned = Rows { data: &mut *fine.weights, stride: width };
    if along == Along::Columns {
        transform.forward(&right, width, &mut spectrum);
    } else {
        turn(&right, [n, width], &mut turned);
        transform.forward(&turned.view(), width, &mut spectrum);
    }
    tridiagonal::solve(&mut spectrum, width, n);
    if along == Along::Columns {
        transform.backward(&spectrum.view(), width, &mut depth);
    } else {
        transform.backward(&spectrum.view(), width, &mut turned);
        turn(&turned.view(), [width, n], &mut depth);
    }
    Some(())
}

/// Writes the columns of a picture of this width and height as rows.
fn turn(from: &Rows<&[f32]>, [width, height]: [usize; 2], to: &mut Rows<&mut [f32]>) {
    for (x, row) in to.data.chunks_mut(to.stride.max(1)).take(width).enumerate() {
        for (out, from) in row.iter_mut().zip(from.data.chunks(from.stride.max(1))).take(height) {
            *out = at(from, x);
        }
    }
}

/// The right side less the equations of row `y` for this depth.
fn left_over(grid: &Grid, y: usize, depth: &[f32], right: &[f32], out: &mut [f32]) {
    let row = grid.row(depth, y);
    let above = if y > 0 { grid.row_above(depth, y) } else { row };
    let below = if y + 1 < grid.height { grid.row(depth, y + 1) } else { row };
    let columns = row.iter().zip(above).zip(below).zip(right);
    for (out, (((&z, &above), &below), &right)) in out.iter_mut().zip(columns) {
        *out = right + ((above - z) + (below - z));
    }
    let steps = row.iter().zip(row.get(1..).unwrap_or_default());
    for (out, (&z, &next)) in out.iter_mut().zip(steps.clone()) {
        *out += next - z;
    }
    for (out, (&z, &next)) in out.iter_mut().skip(1).zip(steps) {
        *out += z - next;
    }
}
