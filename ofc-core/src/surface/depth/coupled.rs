//! Harris's coupled depth/slope model: slopes that span the gaps, smooth and with a depth that has them.
//!
//! Over the mask, depth z and slopes s = (p, q) together minimize
//!
//! ```text
//!   sum over pixels of weight |s - data|^2
//! + smoothness * sum over edges of |difference of s|^2
//! + MISFIT * smoothness * ( sum over edges of (difference of z - mean slope along the edge)^2
//!                         + prior_weight * sum over pixels of known depth of (z - prior)^2 ).
//! ```
//!
//! Weights are zero at unusable pixels. There the slopes follow from their neighbors, and from being the slopes of one
//! surface: p and q that were smoothed apart from each other would not be that, and their depth would be a compromise.
//!
//! # How it is solved
//! Depth and slopes are iterated together, by multigrid: settling them in turn hardly moves what is smooth across a gap,
//! where the misfit is all that holds. Slopes are kept; depth, which they leave no choice, is then integrated from them once
//! more by the solver of the other methods, to its accuracy.
//!
//! Residuals hardly show the soft ways in which a gap can bend. So the iteration stops by what it does to depth: when the
//! changes, if they go on to shrink as they last did, no longer add up to the tolerance's part of the depth.
//!
//! # Reference
//! J. G. Harris, "A new approach to surface reconstruction: the coupled depth/slope model", ICCV 1987. On corrections whose
//! length is searched for: A. Reusken, "Steplength optimization and linear multigrid methods", Numer. Math. 58 (1991).

use super::coupled_change::Change;
use super::coupled_equations::{Equations, Field, MISFIT, Right};
use super::coupled_levels::{Finest, Levels, Slopes};
use super::hierarchy::Parts;
use super::input::{DepthInput, SlopeRow};
use super::job::{Answer, Job};
use super::operator::{Fine, Packing};
use super::parameters::{DepthError, DepthParams, DepthResult};
use super::sweep::Buffers;
use super::word;
use libm::{pow, sqrt};

/// Of the stiffness of a grid, that of the next coarser one: its pixels are twice as wide.
const QUARTER: f32 = 0.25;

pub(super) fn integrate(mut job: Job) -> Answer {
    let [masked, usable] = job.read();
    if usable == 0 {
        return Some(Err(DepthError::Empty));
    }
    let params = job.params;
    let inverse = (1.0 / params.smoothness) as f32;
    let Parts { grid, fine, .. } = &mut job.parts;
    for y in 0..grid.height {
        for (slot, masked) in grid.row_mut(fine.words, y).iter_mut().zip(job.input.masked(y)) {
            let root = word::number(*slot);
            *slot = if masked { Slopes::word(inverse * root * root) } else { 0 };
        }
    }
    job.mark_prior();
    let (cycles, converged) = job.couple(masked)?;
    let Parts { grid, fine, .. } = &mut job.parts;
    for y in 0..grid.height {
        for slot in grid.row_mut(fine.words, y) {
            *slot = if *slot == 0 { 0 } else { word::ONE };
        }
    }
    let so_far = DepthResult { cycles, pixels: masked, excluded: masked - usable, ..DepthResult::default() };
    job.depth(so_far, converged)
}

impl Job<'_> {
    /// Leaves the slopes in the correction (p) and the direction (q). Returns the cycles and whether they were enough.
    #[inline(never)]
    fn couple(&mut self, pixels: usize) -> Option<(u32, bool)> {
        let params = self.params;
        let anchor = self.anchor();
        let origin = if anchor > 0.0 { self.mean_prior() } else { 0.0 };
        let Parts { grid, fine, hierarchy, buffers } = &mut self.parts;
        let grid = *grid;
        let mut levels = Levels { hierarchy, more: fine.residual };
        levels.build(grid, fine.words, anchor)?;
        for y in 0..grid.height {
            self.output.row_mut(y).fill(0.0);
            grid.row_mut(fine.correction, y).fill(0.0);
            grid.row_mut(fine.direction, y).fill(0.0);
        }
        let (buffers, above) = buffers.split_at_mut_checked(4 * (grid.width + 2))?;
        let mut above = above.chunks_exact_mut((grid.width + 2).max(1));
        let mut above = [(); 3].map(|()| above.next().unwrap_or_default());
        let stiffness = (1.0 / MISFIT) as f32;
        let operator = Finest { slopes: Fine { grid, words: fine.words, packing: Slopes }, anchor };
        let depth = Field {
            data: &mut *self.output.data,
            first: 0,
            stride: self.output.row_stride,
            width: grid.width,
        };
        let [p, q] = [&mut *fine.correction, &mut *fine.direction].map(|array| Field::of(grid, array));
        let right =
            Data { input: self.input, params, operator, stiffness, origin, buffers: Buffers::new(buffers) };
        let mut finest = Equations { operator, stiffness, right, unknowns: [depth, p, q] };
        let mut moves = Moves::default();
        for cycles in 1..=params.max_cycles {
            let change = cycle(&mut levels, &mut finest, &mut above)?;
            let [moved, size] = change.sizes(pixels as f64);
            moves.add(moved);
            if moves.left(size) <= params.tolerance * size {
                return Some((cycles, true));
            }
        }
        Some((params.max_cycles, false))
    }

    /// The mean of the known depths, in pixels.
    fn mean_prior(&self) -> f64 {
        let Parts { grid, fine, .. } = &self.parts;
        let Some(prior) = self.input.prior else { return 0.0 };
        let (mut sum, mut count) = (0.0, 0.0);
        for y in 0..grid.height {
            for (&word, &prior) in grid.row(fine.words, y).iter().zip(prior.row(y)) {
                if word::is_known(word) {
                    sum += f64::from(prior) / self.params.pixel_pitch;
                    count += 1.0;
                }
            }
        }
        if count > 0.0 { sum / count } else { 0.0 }
    }
}

/// Changes shrink by this a cycle in large gaps: a faster rate, which they have to begin with, is not believed.
const RATE: f64 = 0.75;

/// When so small a part of the size is left to go and changes shrink no more, they are rounding.
const ROUNDING: f64 = 1e-5;

/// How far depth has moved, cycle after cycle.
#[derive(Default)]
struct Moves {
    first: f64,
    last: [f64; 3],
    cycles: u32,
}

impl Moves {
    fn add(&mut self, moved: f64) {
        if self.cycles == 0 {
            self.first = moved;
        }
        let [_, b, c] = self.last;
        self.last = [b, c, moved];
        self.cycles += 1;
    }

    /// How far a surface of this size has still to go: as far as a geometric series goes on, of the slowest rate that there is
    /// to be seen.
    fn left(&self, size: f64) -> f64 {
        let [before, second, last] = self.last;
        if last == 0.0 {
            return 0.0;
        }
        if before == 0.0 || last >= self.first {
            return f64::INFINITY;
        }
        let whole = pow(last / self.first, 1.0 / f64::from(self.cycles - 1)).max(RATE);
        let series = |last: f64, rate: f64| last * rate / (1.0 - rate);
        if last < before {
            let rate = sqrt(last / before).max(whole);
            series(last.max(rate * second), rate)
        } else if series(last, whole) <= ROUNDING * size {
            0.0
        } else {
            f64::INFINITY
        }
    }
}

/// The right sides of the finest grid, read anew from the input whenever they are needed.
struct Data<'a> {
    input: &'a DepthInput<'a>,
    params: &'a DepthParams,
    operator: Finest<'a>,
    stiffness: f32,
    /// What is taken off the prior.
    origin: f64,
    buffers: Buffers<'a>,
}

impl Right for Data<'_> {
    fn row(&mut self, y: usize) -> [&[f32]; 3] {
        let Fine { grid, words, .. } = self.operator.slopes;
        let [z, p, q, root] = self.buffers.cut(grid.width);
        let min_n3 = self.params.min_n3 as f32;
        let _ = self.input.read(y, min_n3, &mut SlopeRow { p: &mut *p, q: &mut *q, root });
        let words = grid.row(words, y);
        for ((p, q), &word) in p.iter_mut().zip(q.iter_mut()).zip(words) {
            let mass = self.stiffness * Slopes.mass(word);
            *p *= mass;
            *q *= mass;
        }
        if let Some(prior) = self.input.prior {
            for ((z, &word), &prior) in z.iter_mut().zip(words).zip(prior.row(y)) {
                let depth = (f64::from(prior) / self.params.pixel_pitch - self.origin) as f32;
                *z = if word::is_known(word) { self.operator.anchor * depth } else { 0.0 };
            }
        } else {
            z.fill(0.0);
        }
        [z, p, q]
    }
}

/// One W-cycle over all grids.
fn cycle(
    levels: &mut Levels,
    finest: &mut Equations<Finest, Data>,
    above: &mut [&mut [f32]; 3],
) -> Option<Change> {
    let last = levels.hierarchy.levels() - 1;
    let mut change = Change::default();
    if last == 0 {
        finest.relax(levels.hierarchy.spans);
        return Some(change);
    }
    let mut stiffness = finest.stiffness;
    let mut top = 0;
    // Every second time that a grid has done its part, the next finer one goes on.
    for visit in 1_u32..=1 << (last - 1) {
        for level in top..last {
            if level == 0 {
                let (mut coarse, spans) = levels.first()?;
                finest.relax(spans);
                finest.descend(spans, &mut coarse);
            } else {
                let (own, mut coarse) = levels.pair(level)?;
                let spans = own.spans;
                let mut own = own.equations(stiffness);
                own.relax(spans);
                own.descend(spans, &mut coarse);
            }
            stiffness *= QUARTER;
        }
        let coarsest = levels.level(last)?;
        let spans = coarsest.spans;
        coarsest.equations(stiffness).relax(spans);
        top = last - 1 - visit.trailing_zeros() as usize;
        for level in (top..last).rev() {
            stiffness /= QUARTER;
            if level == 0 {
                let (coarse, spans) = levels.first()?;
                change = finest.correct(spans, &coarse, above);
                finest.relax(spans);
            } else {
                let (own, coarse) = levels.pair(level)?;
                let spans = own.spans;
                let mut own = own.equations(stiffness);
                let _ = own.correct(spans, &coarse, above);
                own.relax(spans);
            }
        }
    }
    Some(change)
}
