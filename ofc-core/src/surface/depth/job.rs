//! What all methods share: reading the input, and the last step from slopes to depth.

use super::coarsen;
use super::hierarchy::Parts;
use super::input::{DepthInput, SlopeRow};
use super::operator::{Anchored, Fine, Packing};
use super::parameters::{DepthError, DepthParams, DepthResult, Method};
use super::regions::{Regions, Total, next_run, sum};
use super::right_side::{self, Size};
use super::solver::{Outcome, Output, Stop, Work, solve};
use super::sweep::Buffers;
use super::trend::Trend;
use super::word::{is_known, known, word};
use libm::sqrt;

/// Everything a method works with.
pub(super) struct Job<'a> {
    pub input: &'a DepthInput<'a>,
    pub params: &'a DepthParams,
    pub parts: Parts<'a>,
    pub output: Output<'a>,
}

/// The inner `None` of a method: an array is not as long as it should be, which does not happen.
pub(super) type Answer = Option<Result<DepthResult, DepthError>>;

/// A prior that bends a surface by less than this part is not felt.
const NEGLIGIBLE: f64 = 1e-7;

/// Depths of the prior beyond this many pixels are taken for unknown.
pub(super) const MAX_PRIOR: f64 = 1e9;

impl Job<'_> {
    /// Reads p into the correction, q into the direction and root weights into the words. Returns the pixels of the mask and the
    /// usable ones.
    pub fn read(&mut self) -> [usize; 2] {
        let Parts { grid, fine, buffers, .. } = &mut self.parts;
        let mut buffers = Buffers::new(buffers);
        let min_n3 = self.params.min_n3 as f32;
        let mut counts = [0, 0];
        for y in 0..grid.height {
            let [root, ..] = buffers.cut(grid.width);
            let mut row =
                SlopeRow { p: grid.row_mut(fine.correction, y), q: grid.row_mut(fine.direction, y), root };
            let row_counts = self.input.read(y, min_n3, &mut row);
            for (slot, &root) in grid.row_mut(fine.words, y).iter_mut().zip(&*row.root) {
                *slot = word(root);
            }
            for (sum, count) in counts.iter_mut().zip(row_counts) {
                *sum += count;
            }
        }
        counts
    }

    /// Integrates the slopes in the correction (p) and the direction (q). `so_far` is the result to complete,
    /// `converged` says whether all went well until now.
    #[inline(never)]
    pub fn depth(mut self, so_far: DepthResult, converged: bool) -> Answer {
        let params = self.params;
        self.mark_prior();
        let packing = Anchored { mass: self.anchor() };
        let Parts { grid, fine, hierarchy, buffers } = &mut self.parts;
        coarsen::build(*grid, fine.words, packing, hierarchy)?;
        let trend = Trend::fit(grid, fine.words, fine.correction, fine.direction);
        let mut buffers = Buffers::new(buffers);
        let operator = Fine { grid: *grid, words: fine.words, packing };
        let [whole, energies, ..] = buffers.cut(grid.width);
        let mut size = right_side::fill(
            &operator,
            hierarchy.spans,
            &trend,
            fine.correction,
            fine.direction,
            fine.residual,
            [whole, energies],
        );
        if packing.mass > 0.0 {
            let prior = Prior { input: self.input, params, trend: &trend };
            prior.add(&operator, fine.residual, &mut size);
        }
        let norm = sqrt(size.squared);
        for y in 0..grid.height {
            self.output.row_mut(y).fill(0.0);
        }
        let work = Work { residual: fine.residual, correction: fine.correction, direction: fine.direction };
        let stop = Stop {
            residual: params.tolerance * norm,
            energy: size.energy,
            equations: 2.0 * so_far.pixels as f64,
            cycles: params.max_cycles,
        };
        let Outcome { cycles, residual } =
            solve(&operator, hierarchy, work, &mut self.output, &mut buffers, stop)?;
        let regions = self.finish(&trend);
        Some(Ok(DepthResult {
            converged: converged && residual <= stop.residual,
            cycles: so_far.cycles + cycles,
            residual: if norm > 0.0 { residual / norm } else { 0.0 },
            regions,
            ..so_far
        }))
    }

    /// The weight of known depths in the equations: none where it is so small that the shape of no region would feel it. The
    /// smallest curvature of a shape is about the inverse square of its length; and rounding, which has a say in the mean
    /// depth that grows as the weight falls, would then move it far. The mean follows from the prior directly, see
    /// [`finish`](Self::finish).
    pub fn anchor(&self) -> f32 {
        let Parts { grid, .. } = &self.parts;
        let length_squared =
            (grid.width as f64) * (grid.width as f64) + (grid.height as f64) * (grid.height as f64);
        let is_felt = self.params.prior_weight * length_squared > NEGLIGIBLE;
        if is_felt && self.input.prior.is_some() { self.params.prior_weight as f32 } else { 0.0 }
    }

    /// Notes of which pixels the prior knows the depth, unless it has no weight at all.
    pub fn mark_prior(&mut self) {
        let Parts { grid, fine, .. } = &mut self.parts;
        let Some(prior) = self.input.prior.filter(|_| self.params.prior_weight > 0.0) else { return };
        for y in 0..grid.height {
            for (word, &prior) in grid.row_mut(fine.words, y).iter_mut().zip(prior.row(y)) {
                if *word != 0 && (f64::from(prior) / self.params.pixel_pitch).abs() <= MAX_PRIOR {
                    *word = known(*word);
                }
            }
        }
    }

    /// Puts the trend back, frees every region of its mean or of that beyond the known depths, scales, and marks what has no depth. Returns the number of
    /// regions.
    #[inline(never)]
    fn finish(&mut self, trend: &Trend) -> usize {
        let Parts { grid, fine, .. } = &mut self.parts;
        let output = &mut self.output;
        let mut regions =
            Regions { grid: *grid, words: fine.words, sums: fine.direction, rests: fine.residual, count: 0 };
        // The paper's rectangle is the only one with pixels of weight outside the mask.
        let mask = if self.params.method == Method::Paper { self.input.mask } else { None };
        let pitch = self.params.pixel_pitch;
        for y in 0..grid.height {
            let [constant, linear, square] = trend.depth(y);
            let row = output.row_mut(y);
            for (x, z) in (0_i32..).zip(row.iter_mut()) {
                let x = f64::from(x);
                *z = (f64::from(*z) + (constant + x * (linear + x * square))) as f32;
            }
            let row = &*row;
            regions.add_row(y, |[from, to], words| {
                let run = row.get(from..to).unwrap_or_default();
                if let Some(prior) = self.input.prior
                    && words.iter().any(|&word| is_known(word))
                {
                    // All equations of a region together say that known depths are right on average.
                    let mut total = Total { anchored: true, ..Total::default() };
                    let pixels = run.iter().zip(prior.row(y).iter().skip(from)).zip(words);
                    for ((&z, &prior), _) in pixels.filter(|&(_, &word)| is_known(word)) {
                        total.count += 1;
                        total.sum += f64::from(z) - f64::from(prior) / pitch;
                    }
                    return total;
                }
                let Some(mask) = mask else {
                    return Total { count: to - from, sum: sum(run), anchored: false };
                };
                let mut total = Total::default();
                for (&z, _) in run.iter().zip(mask.row(y).iter().skip(from)).filter(|&(_, &m)| m != 0) {
                    total.count += 1;
                    total.sum += f64::from(z);
                }
                total
            });
        }
        for y in 0..grid.height {
            let row = output.row_mut(y);
            let mut done = 0;
            let mut end = 0;
            while let Some([from, to]) = next_run(grid.row(regions.words, y), end) {
                end = to;
                row.get_mut(done..from).unwrap_or_default().fill(NO_DEPTH);
                let offset = regions.offset(from, y);
                for z in row.get_mut(from..to).unwrap_or_default() {
                    *z = ((f64::from(*z) - offset) * pitch) as f32;
                }
                done = to;
            }
            row.get_mut(done..).unwrap_or_default().fill(NO_DEPTH);
            if let Some(mask) = mask {
                for (z, _) in row.iter_mut().zip(mask.row(y)).filter(|&(_, &m)| m == 0) {
                    *z = NO_DEPTH;
                }
            }
        }
        regions.count
    }
}

/// The one NaN that is ever written.
pub(super) const NO_DEPTH: f32 = f32::from_bits(0x7fc0_0000);

/// Known depths on their way into the equations.
struct Prior<'a> {
    input: &'a DepthInput<'a>,
    params: &'a DepthParams,
    trend: &'a Trend,
}

impl Prior<'_> {
    /// Adds the known depths, less the trend, to the right side.
    fn add(&self, operator: &Fine<Anchored>, right: &mut [f32], size: &mut Size) {
        let Some(prior) = self.input.prior else { return };
        let grid = operator.grid;
        for y in 0..grid.height {
            let [constant, linear, square] = self.trend.depth(y);
            let words = grid.row(operator.words, y);
            let row = grid.row_mut(right, y).iter_mut().zip(words).zip(prior.row(y));
            for (x, ((right, &word), &prior)) in (0_u32..).zip(row) {
                let mass = f64::from(operator.packing.mass(word));
                if mass > 0.0 {
                    let (x, depth) = (f64::from(x), f64::from(prior) / self.params.pixel_pitch);
                    let rest = depth - (constant + x * (linear + x * square));
                    *right += (mass * rest) as f32;
                    size.squared += (mass * depth) * (mass * depth);
                    size.energy += mass * rest * rest;
                }
            }
        }
    }
}
