//! Conjugate gradients, each step preconditioned by one multigrid V-cycle.
//!
//! On a mask without necks and cuts the cycle alone nearly solves the equations; what it cannot represent on coarse
//! grids, conjugate gradients find. The residual is carried along and never computed anew from the solution, so that
//! rounding the solution to f32 (where neighboring depths of hundreds of pixels differ in the last digits) does not
//! limit the accuracy.
//!
//! # Reference
//! O. Tatebe, "The multigrid preconditioned conjugate gradient method" (1993); Y. Saad, "Iterative Methods for Sparse
//! Linear Systems", 2nd ed., algorithm 9.1.

use super::coarsen::equations;
use super::grid::Grid;
use super::hierarchy::Hierarchy;
use super::operator::Operator;
use super::span::{Span, StoredSpan};
use super::sweep::{self, Buffers, dot, map_row, rows_at};
use libm::sqrt;

/// When to stop.
#[derive(Clone, Copy)]
pub(super) struct Stop {
    /// The residual to reach.
    pub residual: f64,
    /// The energy (the weighted sum of squares over all equations) of the right side: what is not explained by depth zero.
    pub energy: f64,
    /// The number of equations.
    pub equations: f64,
    /// Cycles at most.
    pub cycles: u32,
}

/// Below this part of the first residual, squared, rounding has its say ...
const ROUNDING: f64 = 1e-8;

/// ... and when the residual rises by this, squared, only rounding is left: equations that fix no mean depth cannot take
/// what rounding adds to the sum of their right sides.
const RISE: f64 = 100.0;

/// A residual is blind to errors that only few edges feel, such as the step between two regions that a neck joins. So the
/// energy of what is still missing must also be below this part of the energy that an equation keeps on average because
/// the slopes contradict each other: then noise has a larger say in every such step than the iteration has. (At a part
/// of 0.02 the depths of a disc with a neck are within half a per cent of their error from the exact solution.)
const NOISE: f64 = 0.02;

/// A residual this much below the one asked for is enough without that, for slopes that hardly contradict each other.
const ENOUGH: f64 = 0.1;

/// How it went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Outcome {
    pub cycles: u32,
    /// The 2-norm of the last residual.
    pub residual: f64,
}

/// Rows of the caller's picture.
pub(super) struct Output<'a> {
    pub data: &'a mut [f32],
    pub row_stride: usize,
    pub width: usize,
}

impl Output<'_> {
    pub fn row_mut(&mut self, y: usize) -> &mut [f32] {
        let start = y * self.row_stride;
        self.data.get_mut(start..start + self.width).unwrap_or_default()
    }
}

/// The finest grid's part in a solution.
pub(super) struct Work<'a> {
    pub residual: &'a mut [f32],
    pub correction: &'a mut [f32],
    pub direction: &'a mut [f32],
}

/// One V-cycle on `right`; returns the product of `right` and `correction`.
fn cycle<O: Operator>(
    finest: &O,
    hierarchy: &mut Hierarchy,
    right: &[f32],
    correction: &mut [f32],
    buffers: &mut Buffers,
) -> Option<f64> {
    let levels = hierarchy.levels();
    if levels == 1 {
        sweep::solve_coarsest(finest, right, correction);
        return Some(dot(right, correction));
    }
    let (first, spans) = hierarchy.first()?;
    sweep::descend(finest, spans, right, correction, first.right, buffers);
    for level in 1..levels - 1 {
        let grid = hierarchy.grid(level);
        let (own, next, spans) = hierarchy.pair(level)?;
        let (operator, right, correction) = equations(grid, own);
        sweep::descend(&operator, spans, right, correction, next.right, buffers);
    }
    let (grid, last, _) = hierarchy.level(levels - 1)?;
    let (operator, coarse_right, coarse_correction) = equations(grid, last);
    sweep::solve_coarsest(&operator, coarse_right, coarse_correction);
    for level in (1..levels - 1).rev() {
        let grid = hierarchy.grid(level);
        let (own, next, spans) = hierarchy.pair(level)?;
        let (operator, right, correction) = equations(grid, own);
        sweep::ascend(&operator, spans, right, correction, next.correction, buffers);
    }
    let (first, spans) = hierarchy.first()?;
    Some(sweep::ascend(finest, spans, right, correction, first.correction, buffers))
}

/// `direction = correction + factor * direction`, then `correction = A direction`; returns the product of both.
#[inline(never)]
fn turn<O: Operator>(
    operator: &O,
    spans: &[StoredSpan],
    factor: f32,
    direction: &mut [f32],
    correction: &mut [f32],
) -> f64 {
    let grid = operator.grid();
    let mut product = 0.0;
    for y in 0..=grid.height {
        if y < grid.height {
            let span = Span::load(spans, y, grid.width);
            let row = span.cut_mut(grid.row_mut(direction, y));
            for (d, &c) in row.iter_mut().zip(span.cut(grid.row(correction, y))) {
                *d = c + factor * *d;
            }
        }
        if let Some(y) = y.checked_sub(1) {
            let span = Span::load(spans, y, grid.width);
            let rows = rows_at(&grid, direction, y);
            let row = grid.row(direction, y);
            map_row(operator, span, y, rows, row, grid.row_mut(correction, y), |p| -p.flow);
            product += dot(span.cut(row), span.cut(grid.row(correction, y)));
        }
    }
    product
}

/// Solves `A z = b` from the residual `b - A z` in `work`, adding to `output` what is missing.
pub(super) fn solve<O: Operator>(
    finest: &O,
    hierarchy: &mut Hierarchy,
    work: Work,
    output: &mut Output,
    buffers: &mut Buffers,
    stop: Stop,
) -> Option<Outcome> {
    let grid = finest.grid();
    let Work { residual, correction, direction } = work;
    let mut squared = norm_squared(&grid, hierarchy.spans, residual);
    let (start, mut least) = (squared, squared);
    let (mut last_product, mut missing, mut explained) = (0.0, f64::INFINITY, 0.0);
    let mut cycles = 0;
    while cycles < stop.cycles {
        let norm = sqrt(squared);
        let noise = (stop.energy - explained).max(ROUNDING * stop.energy) / stop.equations;
        if norm <= ENOUGH * stop.residual || norm <= stop.residual && missing <= NOISE * noise {
            break;
        }
        let product = cycle(finest, hierarchy, residual, correction, buffers)?;
        let spans = &*hierarchy.spans;
        let factor = if last_product > 0.0 { product / last_product } else { 0.0 };
        let applied = turn(finest, spans, factor as f32, direction, correction);
        // Both are positive unless nothing but rounding is left.
        if !(product > 0.0 && applied > 0.0) {
            break;
        }
        let step = (product / applied) as f32;
        squared = advance(&grid, spans, step, direction, correction, residual, output);
        explained += product / applied * product;
        // As if this step took from the energy what the last one did.
        missing = if last_product > 0.0 { product / last_product * product } else { f64::INFINITY };
        last_product = product;
        cycles += 1;
        least = least.min(squared);
        if squared > RISE * least && least < ROUNDING * start {
            break;
        }
    }
    Some(Outcome { cycles, residual: sqrt(squared) })
}

/// The squared 2-norm of an array over its grid.
fn norm_squared(grid: &Grid, spans: &[StoredSpan], array: &[f32]) -> f64 {
    let rows = (0..grid.height).map(|y| Span::load(spans, y, grid.width).cut(grid.row(array, y)));
    rows.map(|row| dot(row, row)).sum()
}

/// Takes the step and returns the squared norm of the new residual.
#[inline(never)]
fn advance(
    grid: &Grid,
    spans: &[StoredSpan],
    step: f32,
    direction: &[f32],
    applied: &[f32],
    residual: &mut [f32],
    output: &mut Output,
) -> f64 {
    let mut squared = 0.0;
    for y in 0..grid.height {
        let span = Span::load(spans, y, grid.width);
        let depths = span.cut_mut(output.row_mut(y));
        for (z, &d) in depths.iter_mut().zip(span.cut(grid.row(direction, y))) {
            *z += step * d;
        }
        let row = span.cut_mut(grid.row_mut(residual, y));
        for (r, &a) in row.iter_mut().zip(span.cut(grid.row(applied, y))) {
            *r -= step * a;
        }
        squared += dot(row, row);
    }
    squared
}
