//! The coupled depth/slope model: smooth slopes that span the gaps, and the depth that fits them.
//!
//! Over the mask, p minimises `sum of weight (p - data)² + smoothness * sum over edges of (difference of p)²`, and q
//! minimises the same sum over its own data. Weights are zero at unusable pixels, so that there the slopes follow from their
//! neighbors. Depth is the
//! least-squares solution for these slopes. That is Harris's energy, in which depth, too, pulls at the slopes, in the limit
//! of a weak pull: the slopes are settled first.
//!
//! # Reference
//! J. G. Harris, "A new approach to surface reconstruction: the coupled depth/slope model", ICCV 1987.

use super::coarsen;
use super::hierarchy::Parts;
use super::input::SlopeRow;
use super::job::{Answer, Job};
use super::operator::{Fine, OnePlusMass, Packing, copy};
use super::parameters::{DepthError, DepthResult};
use super::solver::{Outcome, Stop, Work, solve};
use super::sweep::{Buffers, dot};
use super::word;
use libm::sqrt;

pub(super) fn integrate(mut job: Job) -> Answer {
    let [masked, usable] = job.read();
    if usable == 0 {
        return Some(Err(DepthError::Empty));
    }
    let inverse = (1.0 / job.params.smoothness) as f32;
    let packing = OnePlusMass;
    let Parts { grid, fine, hierarchy, .. } = &mut job.parts;
    for y in 0..grid.height {
        for (slot, masked) in grid.row_mut(fine.words, y).iter_mut().zip(job.input.masked(y)) {
            let root = word::number(*slot);
            *slot = if masked { word::word(1.0 + inverse * root * root) } else { 0 };
        }
    }
    coarsen::build(*grid, fine.words, packing, hierarchy)?;
    let first = job.smooth(Slope::Q)?;
    let Parts { grid, fine, .. } = &mut job.parts;
    for y in 0..grid.height {
        copy(grid.row_mut(fine.direction, y), job.output.row(y));
    }
    let second = job.smooth(Slope::P)?;
    let Parts { grid, fine, .. } = &mut job.parts;
    for y in 0..grid.height {
        copy(grid.row_mut(fine.correction, y), job.output.row(y));
        for slot in grid.row_mut(fine.words, y) {
            *slot = word::word(packing.root(*slot));
        }
    }
    let so_far = DepthResult {
        cycles: first.cycles + second.cycles,
        pixels: masked,
        excluded: masked - usable,
        ..DepthResult::default()
    };
    job.depth(so_far, first.converged && second.converged)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Slope {
    P,
    Q,
}

struct Smoothed {
    cycles: u32,
    converged: bool,
}

impl Job<'_> {
    /// Leaves the smooth slope in the output. The direction is used for q, and left alone (it holds q then) for p.
    fn smooth(&mut self, which: Slope) -> Option<Smoothed> {
        let params = self.params;
        let Parts { grid, fine, hierarchy, buffers } = &mut self.parts;
        let mut buffers = Buffers::new(buffers);
        let mut squared = 0.0;
        for y in 0..grid.height {
            let [other, root, ..] = buffers.cut(grid.width);
            let row = grid.row_mut(fine.residual, y);
            let (p, q) = if which == Slope::P { (&mut *row, other) } else { (other, &mut *row) };
            let _ = self.input.read(y, params.min_n3 as f32, &mut SlopeRow { p, q, root });
            for (right, &packed) in row.iter_mut().zip(grid.row(fine.words, y)) {
                *right *= OnePlusMass.mass(packed);
            }
            squared += dot(row, row);
            self.output.row_mut(y).fill(0.0);
        }
        let operator = Fine { grid: *grid, words: fine.words, packing: OnePlusMass };
        // Slopes are only a step on the way: their residual will do.
        let stop = Stop {
            residual: params.tolerance * sqrt(squared),
            energy: f64::INFINITY,
            equations: 1.0,
            cycles: params.max_cycles,
        };
        let work = Work {
            residual: fine.residual,
            correction: fine.correction,
            direction: if which == Slope::Q { Some(fine.direction) } else { None },
        };
        let Outcome { cycles, residual } =
            solve(&operator, hierarchy, work, &mut self.output, &mut buffers, stop)?;
        Some(Smoothed { cycles, converged: residual <= stop.residual })
    }
}
