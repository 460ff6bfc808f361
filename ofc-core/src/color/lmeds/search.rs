//! The search: random subsets propose, the median over a sample evaluates them, concentration steps polish.

use super::bracketed::Bracket;
use super::problem::Problem;
use crate::color::ellipsoid::{Coefficients, single_residual};
use crate::color::regression::{self, Moments, TERMS, WindowMoments};
use crate::math::rng::Rng;
use crate::math::select::{kth_smallest, median_rank, take_kth_smallest_within};
use crate::picture::{Image, WINDOW, stretches};
use libm::sqrt;

/// Times that the better half is fitted again, at most: measured, ten reach the smallest objective that thousands of restarts
/// find.
const CONCENTRATION_STEPS: usize = 10;

/// How many times as many colors decide where the search ends: by the ten thousand that are searched the objective of a picture comes
/// within 2 % of the least, and by three times as many within 1 %.
const LAST_SHARE: usize = 3;

/// Times that the better half of these is fitted again.
const LAST_STEPS: usize = 8;

/// Scaled colors of some usable pixels, channels apart, and room for a residual of each.
pub(crate) struct Sample<'w> {
    red: &'w [f32],
    green: &'w [f32],
    blue: &'w [f32],
    residuals: &'w mut [f32],
    /// How many of them, the first, are searched.
    searched: usize,
}

impl Problem<'_, Image<'_>> {
    /// One pixel from each of equal parts of the usable pixels in picture order, at a random place within it: all where the
    /// parameters ask for no fewer, and otherwise [`LAST_SHARE`] times as many as they ask for, or what `workspace` holds. `None`
    /// where that is shorter than four `f32` for each that they ask for.
    pub fn sample<'w>(&self, rng: &mut Rng, workspace: &'w mut [f32]) -> Option<Sample<'w>> {
        let (available, asked) = (self.count, self.params.sample_size as usize);
        let searched = available.min(asked);
        // As many parts of one size as there are pixels, and room for them.
        let most = asked.saturating_mul(LAST_SHARE).min(available).min(workspace.len() / 4);
        let parts = most.checked_div(searched)?;
        let len = searched * parts;
        let (red, rest) = workspace.split_at_mut_checked(len)?;
        let (green, rest) = rest.split_at_mut_checked(len)?;
        let (blue, rest) = rest.split_at_mut_checked(len)?;
        let residuals = rest.get_mut(..len)?;
        self.draw(rng, searched, [&mut *red, &mut *green, &mut *blue]);
        Some(Sample { red, green, blue, residuals, searched })
    }
}

impl<'w> Sample<'w> {
    /// Of these scaled colors, channels apart; `residuals` is room for one of each color.
    pub const fn new([red, green, blue]: [&'w [f32]; 3], residuals: &'w mut [f32]) -> Self {
        Self { red, green, blue, residuals, searched: red.len() }
    }

    /// Where the median residual of the whole picture lies.
    pub fn bracket(&mut self, z: &Coefficients) -> Option<Bracket> {
        self.fill_residuals(z);
        Bracket::of(self.residuals)
    }

    /// The channels of those that are searched, and room for so many numbers where there is as much.
    pub fn searched_with(&mut self, room: usize) -> ([&[f32]; 3], Option<&mut [f32]>) {
        let searched = self.searched;
        let channels = [self.red, self.green, self.blue];
        (channels.map(|channel| channel.get(..searched).unwrap_or_default()), self.residuals.get_mut(..room))
    }

    /// Those that are searched.
    fn searched(&mut self) -> Option<Sample<'_>> {
        let Self { red, green, blue, residuals, searched } = self;
        let residuals = residuals.get_mut(..*searched)?;
        Some(Sample::new([red.get(..*searched)?, green.get(..*searched)?, blue.get(..*searched)?], residuals))
    }

    /// How many there are.
    pub const fn len(&self) -> usize {
        self.red.len()
    }

    fn color(&self, i: u32) -> [f64; 3] {
        [self.red, self.green, self.blue]
            .map(|channel| channel.get(i as usize).map_or(0.0, |&value| f64::from(value)))
    }

    fn colors(&self) -> impl Iterator<Item = (f32, f32, f32)> {
        self.red.iter().zip(self.green).zip(self.blue).map(|((&r, &g), &b)| (r, g, b))
    }

    /// The scaled z that `subsets` find; `None` when none of them determines one.
    pub fn best(mut self, subsets: u32, rng: &mut Rng) -> Option<Coefficients> {
        let proposal = self.search(subsets, rng)?;
        Some(self.concentrate(proposal))
    }

    /// The same among those that are searched; all of them decide where it ends.
    pub fn best_of_part(&mut self, subsets: u32, rng: &mut Rng) -> Option<Coefficients> {
        let best = self.searched()?.best(subsets, rng)?;
        Some(if self.searched < self.len() { self.concentrate_last(best) } else { best })
    }

    /// Least squares over the better half of all colors, a fixed number of times: where the objective no longer falls, what
    /// remains is its noise, and the last fit has least of it.
    fn concentrate_last(&mut self, start: Coefficients) -> Coefficients {
        let mut z = start;
        let mut objective = self.objective(&z);
        for _ in 0..LAST_STEPS {
            let Some(fit) = self.many_moments_within(&z, objective).solve() else { break };
            z = fit.coefficients;
            objective = self.objective_near(&z, objective);
        }
        z
    }

    /// [`Self::moments_within`], for many colors.
    fn many_moments_within(&self, z: &Coefficients, limit: f32) -> Moments {
        let z = z.map(|c| c as f32);
        let mut moments = WindowMoments::new();
        for [red, green, blue] in stretches([self.red, self.green, self.blue]) {
            let mut within = [[0.0; WINDOW]; 3];
            let [r_within, g_within, b_within] = &mut within;
            let mut count = 0;
            let inputs = red.iter().zip(green).zip(blue);
            let outputs = r_within.iter_mut().zip(g_within).zip(b_within);
            for (((&r, &g), &b), ((r_within, g_within), b_within)) in inputs.zip(outputs) {
                let is_within = absolute_residual(&z, r, g, b) <= limit;
                count += u32::from(is_within);
                *r_within = if is_within { r } else { 0.0 };
                *g_within = if is_within { g } else { 0.0 };
                *b_within = if is_within { b } else { 0.0 };
            }
            moments.add_colors(&within, count);
        }
        moments.sum()
    }

    /// [`Self::objective`], which is near another one.
    fn objective_near(&mut self, z: &Coefficients, other: f32) -> f32 {
        const NEAR: f32 = 0.03;
        self.fill_residuals(z);
        let rank = median_rank(self.residuals.len());
        let near = [(1.0 - NEAR) * other, (1.0 + NEAR) * other];
        take_kth_smallest_within(self.residuals, rank, near).unwrap_or(f32::INFINITY)
    }

    /// The proposal with the smallest median residual; `None` when no subset determines an ellipsoid.
    fn search(&mut self, subsets: u32, rng: &mut Rng) -> Option<Proposal> {
        let mut best: Option<Proposal> = None;
        for _ in 0..subsets {
            let subset = rng.distinct::<TERMS>(self.len() as u32)?;
            let Some(z) = regression::through(&subset.map(|i| self.color(i))) else { continue };
            // The median can only be smaller if more than half of the residuals are: counting is cheaper.
            if best.as_ref().is_none_or(|best| {
                self.may_be_better(&z, best.objective)
                    && self.count_below(&z, best.objective) > median_rank(self.len())
            }) {
                best = Some(Proposal { objective: self.objective(&z), z });
            }
        }
        best
    }

    /// Least squares over the better half, again and again, for as long as the objective falls.
    fn concentrate(&mut self, start: Proposal) -> Coefficients {
        let mut best = start;
        for _ in 0..CONCENTRATION_STEPS {
            let Some(fit) = self.moments_within(&best.z, best.objective).solve() else { break };
            let objective = self.objective(&fit.coefficients);
            if objective >= best.objective {
                break;
            }
            best = Proposal { objective, z: fit.coefficients };
        }
        best.z
    }

    /// The sums over the colors whose residuals are at most `limit`.
    fn moments_within(&self, z: &Coefficients, limit: f32) -> Moments {
        let z = z.map(|c| c as f32);
        let mut moments = Moments::default();
        for (r, g, b) in self.colors() {
            if absolute_residual(&z, r, g, b) <= limit {
                moments.add([r, g, b].map(f64::from));
            }
        }
        moments
    }

    /// Whether about half of every tenth color's residuals are below `limit`: fewer by two deviations of such a count, and one in
    /// fifty proposals that are hardly better is lost.
    fn may_be_better(&self, z: &Coefficients, limit: f32) -> bool {
        const STEP: usize = 10;
        let z = z.map(|c| c as f32);
        let [red, green, blue] =
            [self.red, self.green, self.blue].map(|channel| channel.as_chunks::<STEP>().0);
        let (mut count, mut below) = (0_u32, 0_u32);
        for (([r, ..], [g, ..]), [b, ..]) in red.iter().zip(green).zip(blue) {
            count += 1;
            below += u32::from(absolute_residual(&z, *r, *g, *b) < limit);
        }
        let (half, deviation) = (0.5 * f64::from(count), 0.5 * sqrt(f64::from(count)));
        f64::from(below) >= half - 2.0 * deviation
    }

    fn count_below(&self, z: &Coefficients, limit: f32) -> usize {
        let z = z.map(|c| c as f32);
        let mut count = 0_u32;
        for (r, g, b) in self.colors() {
            count += u32::from(absolute_residual(&z, r, g, b) < limit);
        }
        count as usize
    }

    fn objective(&mut self, z: &Coefficients) -> f32 {
        self.fill_residuals(z);
        kth_smallest(self.residuals, median_rank(self.residuals.len())).unwrap_or(f32::INFINITY)
    }

    fn fill_residuals(&mut self, z: &Coefficients) {
        let z = z.map(|c| c as f32);
        let Self { red, green, blue, residuals, .. } = self;
        for (((&r, &g), &b), residual) in red.iter().zip(*green).zip(*blue).zip(residuals.iter_mut()) {
            *residual = absolute_residual(&z, r, g, b);
        }
    }
}

/// |rho^T C rho - 1|.
#[inline]
fn absolute_residual(z: &[f32; TERMS], r: f32, g: f32, b: f32) -> f32 {
    single_residual(z, [r, g, b]).abs()
}

/// A form and its median residual over the sample.
#[derive(Clone, Copy)]
struct Proposal {
    z: Coefficients,
    objective: f32,
}
