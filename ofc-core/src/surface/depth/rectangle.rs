//! Whole rectangles without weights and prior are solved directly: cosine transforms of the columns leave the equations of
//! a row for every frequency.
//!
//! # Reference
//! R. W. Hockney, "A fast direct solution of Poisson's equation using Fourier analysis", J. ACM 12 (1965).

use super::cosine_transform::{CosineTransform, Rows};
use super::fourier::Lengths;
use super::grid::Grid;
use super::hierarchy::{FineArrays, Parts};
use super::input::SlopeRow;
use super::job::{Answer, Job, NO_DEPTH};
use super::parameters::{DepthError, DepthResult, Method};
use super::sweep::{Buffers, dot};
use super::trend::{Fit, Trend};
use super::tridiagonal;
use libm::sqrt;

/// A residual of this part of the depth is what f32 leaves, and no worse than what was asked for.
const ROUNDING: f64 = 2e-6;

/// The lines that the cosine transform goes along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Along {
    Columns,
    Rows,
}

/// What is known once the right side stands.
pub(super) struct RightSide {
    trend: Trend,
    /// The squared norm of what it would be with the trend.
    squared: f64,
    /// Pixels of the mask and usable ones.
    counts: [usize; 2],
}

impl Job<'_> {
    /// How to solve directly, if there is no prior, and the height or the width has no prime factor above 7.
    pub fn rectangle_along(&self) -> Option<Along> {
        let Parts { grid, hierarchy, .. } = &self.parts;
        let fits = |n| {
            let len = CosineTransform::workspace_len(n);
            len <= hierarchy.coarse.len() && Lengths::new(n).is_some()
        };
        if self.params.prior_weight > 0.0 && self.input.prior.is_some() {
            None
        } else if fits(grid.height) {
            Some(Along::Columns)
        } else {
            fits(grid.width).then_some(Along::Rows)
        }
    }

    /// Writes the right side, less the trend, into the residual; `None` if a weight is not one.
    #[inline(never)]
    pub fn read_rectangle(&mut self) -> Option<RightSide> {
        let Parts { grid, fine, buffers, .. } = &mut self.parts;
        let min_n3 = self.params.min_n3 as f32;
        let mut buffers = Buffers::new(buffers);
        let [p, before, current, next] = buffers.cut(grid.width);
        let root = grid.row_mut(fine.direction, 0);
        // In the paper's rectangle everybody has weight one, and slopes of unusable pixels are zero already.
        let all = self.params.method == Method::Paper;
        let mut read = |y: usize, p: &mut [f32], q: &mut [f32]| {
            let counts = self.input.read(y, min_n3, &mut SlopeRow { p, q, root });
            if all {
                root.fill(1.0);
            }
            is_one(root).then_some(counts)
        };
        let mut fit = Fit::new(grid);
        for y in Fit::rows(grid) {
            read(y, p, current)?;
            fit.add(y, |_| true, p, current);
        }
        let trend = fit.trend();
        let last = grid.height - 1;
        let (mut squared, mut counts) = (0.0, [0, 0]);
        let mut ring = [before, current, next];
        for y in 0..=grid.height {
            let [before, current, next] = &mut ring;
            if y < grid.height {
                for (sum, count) in counts.iter_mut().zip(read(y, p, next)?) {
                    *sum += count;
                }
                differ_along(p, grid.row_mut(fine.residual, y));
            }
            if let Some(y) = y.checked_sub(1) {
                let out = grid.row_mut(fine.residual, y);
                // The rise of an edge that is not there is zero.
                match (y == 0, y == last) {
                    (true, true) => {}
                    (true, false) => add_half(current, next, [1.0, 1.0], out),
                    (false, false) => add_half(before, next, [-1.0, 1.0], out),
                    (false, true) => add_half(before, current, [-1.0, -1.0], out),
                }
                squared += dot(out, out);
                subtract_trend(&trend, y, last, out);
            }
            ring.rotate_left(1);
        }
        Some(RightSide { trend, squared, counts })
    }

    /// From the right side to the answer.
    #[inline(never)]
    pub fn integrate_rectangle(mut self, along: Along, right: &RightSide) -> Answer {
        let [masked, usable] = right.counts;
        if usable == 0 {
            return Some(Err(DepthError::Empty));
        }
        let Parts { grid, fine, hierarchy, .. } = &mut self.parts;
        let grid = *grid;
        solve(&grid, along, fine, hierarchy.coarse)?;
        let Remainder { residual, depth } = self.finish_rectangle(&right.trend);
        let (residual, norm) = (sqrt(residual), sqrt(right.squared));
        Some(Ok(DepthResult {
            converged: residual <= (self.params.tolerance * norm).max(ROUNDING * sqrt(depth)),
            cycles: 0,
            residual: if norm > 0.0 { residual / norm } else { 0.0 },
            regions: 1,
            pixels: masked,
            excluded: masked - usable,
        }))
    }

    /// Puts the trend back, takes the mean off, scales, and marks what has no depth.
    #[inline(never)]
    fn finish_rectangle(&mut self, trend: &Trend) -> Remainder {
        let Parts { grid, fine, buffers, .. } = &mut self.parts;
        let mut buffers = Buffers::new(buffers);
        let [buffer, ..] = buffers.cut(grid.width);
        let mask = self.input.mask.filter(|_| self.params.method == Method::Paper);
        let (mut total, mut count) = (0.0, 0.0);
        for y in 0..grid.height {
            let [constant, linear, square] = trend.depth(y);
            if let Some(mask) = mask {
                let row = (0_i32..).zip(grid.row(fine.direction, y)).zip(mask.row(y));
                for ((x, &z), _) in row.filter(|&(_, &m)| m != 0) {
                    let x = f64::from(x);
                    total += f64::from(z) + (constant + x * (linear + x * square));
                    count += 1.0;
                }
            } else {
                // All that has a mean is the trend; sums of x and of its square along the row are known.
                let n = grid.width as f64;
                let (once, twice) = (n * (n - 1.0) / 2.0, n * (n - 1.0) * (2.0 * n - 1.0) / 6.0);
                total += n * constant + once * linear + twice * square;
                count += n;
            }
        }
        let (mean, pitch) = (if count > 0.0 { total / count } else { 0.0 }, self.params.pixel_pitch);
        let mut remainder = Remainder::default();
        for y in 0..grid.height {
            let row = grid.row(fine.direction, y);
            left_over(grid, y, fine.direction, grid.row(fine.residual, y), buffer);
            remainder.residual += dot(buffer, buffer);
            remainder.depth += dot(row, row);
            let [constant, linear, square] = trend.depth(y);
            let constant = constant - mean;
            let out_row = self.output.row_mut(y);
            for ((x, out), &z) in (0_i32..).zip(out_row.iter_mut()).zip(row) {
                let x = f64::from(x);
                *out = ((f64::from(z) + (constant + x * (linear + x * square))) * pitch) as f32;
            }
            if let Some(mask) = mask {
                for (out, _) in out_row.iter_mut().zip(mask.row(y)).filter(|&(_, &m)| m == 0) {
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
    // Without a way out of the loop, so that many are compared at once.
    row.iter().filter(|&&weight| weight != 1.0).count() == 0
}

/// The rise of the edge to the left of each pixel less that of the edge to its right: half the difference of its
/// neighbors' slopes, but at the ends.
fn differ_along(p: &[f32], out: &mut [f32]) {
    let ([first, second, after @ ..], [before @ .., second_last, last]) = (p, p) else {
        out.fill(0.0);
        return;
    };
    if let [out_first, out @ .., out_last] = out {
        *out_first = -0.5 * (first + second);
        *out_last = 0.5 * (second_last + last);
        for ((out, &l), &r) in out.iter_mut().zip(before).zip(after) {
            *out = 0.5 * (l - r);
        }
    }
}

/// Adds half of two rows.
#[inline(always)]
fn add_half(a: &[f32], b: &[f32], [sign_a, sign_b]: [f32; 2], out: &mut [f32]) {
    for ((out, &a), &b) in out.iter_mut().zip(a).zip(b) {
        *out += 0.5 * (sign_b * b + sign_a * a);
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
    for (x, out) in (0_i32..).zip(out) {
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
    let mut transform = CosineTransform::new(n, weight, workspace, fine.words)?;
    let right = Rows { data: fine.residual.get(inner..grid.len())?, stride };
    if along == Along::Columns {
        let mut spectrum = Rows { data: &mut *fine.correction, stride: n + 1 };
        transform.forward(&right, width, &mut spectrum);
        tridiagonal::solve(&mut spectrum, width, n);
        let mut depth = Rows { data: fine.direction.get_mut(inner..)?, stride };
        transform.backward(&spectrum.view(), width, &mut depth);
    } else {
        let mut turned = Rows { data: &mut *fine.correction, stride: width };
        turn(&right, [n, width], &mut turned);
        let mut spectrum = Rows { data: &mut *fine.direction, stride: n + 1 };
        transform.forward(&turned.view(), width, &mut spectrum);
        tridiagonal::solve(&mut spectrum, width, n);
        transform.backward(&spectrum.view(), width, &mut turned);
        // The spectrum is done with: its array takes the depth.
        let mut depth = Rows { data: fine.direction.get_mut(inner..)?, stride };
        turn(&turned.view(), [width, n], &mut depth);
    }
    Some(())
}

/// Columns that are turned together, so that whole cache lines are read.
const BAND: usize = 16;

/// Writes the columns of a picture of this width and height as rows.
fn turn(from: &Rows<&[f32]>, [width, height]: [usize; 2], to: &mut Rows<&mut [f32]>) {
    let bands = to.data.chunks_mut((BAND * to.stride).max(1));
    for (x, band) in (0..width).step_by(BAND).zip(bands) {
        for (y, from) in from.data.chunks(from.stride.max(1)).take(height).enumerate() {
            let columns = from.get(x..width.min(x + BAND)).unwrap_or_default();
            for (row, &value) in band.chunks_mut(to.stride.max(1)).zip(columns) {
                if let Some(slot) = row.get_mut(y) {
                    *slot = value;
                }
            }
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
