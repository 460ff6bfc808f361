//! The search: random subsets propose, the median over a sample evaluates them, concentration steps polish.

use super::problem::Problem;
use crate::color::ellipsoid::{Coefficients, single_residual};
use crate::color::regression::{self, Moments, TERMS};
use crate::math::rng::Rng;
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, for_each_bit};
use libm::sqrt;

/// Times that the better half is fitted again, at most: measured, ten reach the smallest objective that thousands of restarts
/// find.
const CONCENTRATION_STEPS: usize = 10;

/// Scaled colors of some usable pixels, channels apart, and room for a residual of each.
pub(crate) struct Sample<'w> {
    red: &'w [f32],
    green: &'w [f32],
    blue: &'w [f32],
    residuals: &'w mut [f32],
}

impl Problem<'_, Image<'_>> {
    /// One pixel from each of equal parts of the usable pixels in picture order, at a random place within it: as many as
    /// the parameters ask for, and all of them where there are no more. `None` where `workspace` is shorter than four `f32` for
    /// each.
    pub fn sample<'w>(&self, rng: &mut Rng, workspace: &'w mut [f32]) -> Option<Sample<'w>> {
        let (available, len) = (self.count, self.count.min(self.params.sample_size as usize));
        let (red, rest) = workspace.split_at_mut_checked(len)?;
        let (green, rest) = rest.split_at_mut_checked(len)?;
        let (blue, rest) = rest.split_at_mut_checked(len)?;
        let residuals = rest.get_mut(..len)?;
        let mut stratum = |i: usize| {
            let border = |i: usize| (available * i).checked_div(len).unwrap_or(0);
            border(i) + rng.below((border(i + 1) - border(i)) as u32) as usize
        };
        let (mut taken, mut seen) = (0, 0);
        let mut wanted = stratum(0);
        self.pixels.for_each_window(|window| {
            for_each_bit(self.usable.bits(window), |i| {
                if seen == wanted && taken < len {
                    let pixel = window.pixel(i).map(|c| (f64::from(c) * self.scale) as f32);
                    if let (Some(r), Some(g), Some(b)) =
                        (red.get_mut(taken), green.get_mut(taken), blue.get_mut(taken))
                    {
                        [*r, *g, *b] = pixel;
                    }
                    taken += 1;
                    if taken < len {
                        wanted = stratum(taken);
                    }
                }
                seen += 1;
            });
        });
        Some(Sample { red, green, blue, residuals })
    }
}

impl<'w> Sample<'w> {
    /// Of these scaled colors, channels apart; `residuals` is room for one of each color.
    pub const fn new([red, green, blue]: [&'w [f32]; 3], residuals: &'w mut [f32]) -> Self {
        Self { red, green, blue, residuals }
    }

    fn len(&self) -> usize {
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
            let mut moments = Moments::default();
            for (r, g, b) in self.colors() {
                if absolute_residual(&best.z.map(|c| c as f32), r, g, b) <= best.objective {
                    moments.add([r, g, b].map(f64::from));
                }
            }
            let Some(fit) = moments.solve() else { break };
            let objective = self.objective(&fit.coefficients);
            if objective >= best.objective {
                break;
            }
            best = Proposal { objective, z: fit.coefficients };
        }
        best.z
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
        let z = z.map(|c| c as f32);
        let Self { red, green, blue, residuals } = self;
        for (((&r, &g), &b), residual) in red.iter().zip(*green).zip(*blue).zip(residuals.iter_mut()) {
            *residual = absolute_residual(&z, r, g, b);
        }
        kth_smallest(residuals, median_rank(residuals.len())).unwrap_or(f32::INFINITY)
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
