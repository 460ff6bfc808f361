//! The search: random subsets propose, the median over a sample evaluates them, concentration steps polish.

use crate::color::ellipsoid::Coefficients;
use crate::color::regression::{self, Moments, TERMS};
use crate::math::rng::Rng;
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, Usable, for_each_bit};

const CONCENTRATION_STEPS: usize = 10;

/// The scaled z that `subsets` find among these scaled colors, channels apart; `None` when none determines one. `residuals`
/// is room for one of each color.
pub(crate) fn search(
    [red, green, blue]: [&[f32]; 3],
    residuals: &mut [f32],
    subsets: u32,
    rng: &mut Rng,
) -> Option<Coefficients> {
    Sample { red, green, blue, residuals }.best(subsets, rng)
}

/// Scaled colors of some usable pixels, channels apart, and room for a residual each.
pub(super) struct Sample<'w> {
    red: &'w [f32],
    green: &'w [f32],
    blue: &'w [f32],
    residuals: &'w mut [f32],
}

impl<'w> Sample<'w> {
    /// One pixel from each of `len` equal parts of the usable pixels in picture order, at a random place within it.
    pub fn gather(
        image: &Image,
        usable: Usable,
        available: usize,
        len: usize,
        scale: f64,
        rng: &mut Rng,
        workspace: &'w mut [f32],
    ) -> Option<Self> {
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
        image.for_each_window(|window| {
            for_each_bit(usable.bits(window), |i| {
                if seen == wanted && taken < len {
                    let pixel = window.pixel(i).map(|c| (f64::from(c) * scale) as f32);
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
        Some(Self { red, green, blue, residuals })
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

    /// The z that the search finds; `None` when no subset determines an ellipsoid.
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
            if best.as_ref().is_none_or(|best| self.count_below(&z, best.objective) > median_rank(self.len()))
            {
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

/// |rho^T C rho - 1| in single precision: what the search compares. The answer's residuals are computed in double.
#[inline]
fn absolute_residual(z: &[f32; TERMS], r: f32, g: f32, b: f32) -> f32 {
    let [c11, c22, c33, c12, c13, c23] = *z;
    let red = r * (c11 * r + 2.0 * (c12 * g + c13 * b));
    let green = g * (c22 * g + 2.0 * c23 * b);
    (red + green + c33 * b * b - 1.0).abs()
}

#[derive(Clone, Copy)]
struct Proposal {
    z: Coefficients,
    objective: f32,
}
