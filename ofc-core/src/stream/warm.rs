//! One pass that makes a new model of an old one.
//!
//! The inliers of the old model are fitted by least squares, from the sums over them; so are the tilts. Of the slants
//! that agree with both those nearest to the old ones are taken. The dispersion grows or shrinks with the deviation of
//! the inliers' residuals: as it was truncated before, so it is now.

use super::{Memory, Pass, State};
use crate::constrained_slant;
use crate::ellipsoid;
use crate::image::{Census, Image, for_each_bit};
use crate::inliers::{Band, Inliers};
use crate::lmeds::{MIN_PIXELS, Refit};
use crate::location::Location;
use crate::mat3::{self, Mat3};
use crate::regression::Moments;
use crate::solve::{
    Candidate, Choice, Outcome, SMALLEST_NOISE_MARGIN, SlantFallback, SlantSource, candidates, chosen_root,
    orient,
};
use crate::tilt::{TiltEstimator, Tilts, pentland};
use libm::{atan2, sqrt};

/// What a frame says of the model from before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// The share of usable pixels that the old model's residuals accept.
    pub inlier_share: f64,
    /// What changed; `None` where there is no new model, and the next pass is over colors.
    pub change: Option<Change>,
}

/// From one model to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The angles between the old and the new rows of F, in radians.
    pub angles: [f64; 3],
    /// The lengths of the new rows of F over those of the old.
    pub strengths: [f64; 3],
    /// The dispersion of the new residuals over that of the old.
    pub dispersion: f64,
}

impl State {
    /// What the last frame that a model was refined with says of it; `None` before the first and after a cold start.
    #[must_use]
    pub const fn drift(&self) -> Option<&Drift> {
        self.drift.as_ref()
    }

    pub(super) fn begin_refine(&mut self) {
        self.census = Census::default();
        self.moments = Moments::default();
        self.differences = pentland::Sums::default();
        self.inlier_count = 0;
    }

    #[inline(never)]
    pub(super) fn row_refine(&mut self, y: usize, row: &Image, memory: &mut Memory) {
        self.row_moments(row);
        self.row_tilts(y, row, memory);
    }

    #[inline(never)]
    fn row_moments(&mut self, row: &Image) {
        let inliers = Inliers { norm: Band::EVERYTHING, ..self.solution.inliers };
        row.for_each_window(|window| {
            inliers.usable.count_window(window, &mut self.census);
            let mut sums = Moments::default();
            for_each_bit(inliers.bits(window), |i| {
                sums.add(window.pixel(i).map(|c| f64::from(c) * self.scale));
            });
            self.moments.merge(&sums);
        });
    }

    #[inline(never)]
    pub(super) fn end_refine(&mut self, memory: &mut Memory) {
        self.last_row_tilts(memory);
        let inlier_share = f64::from(self.moments.count) / self.census.usable.max(1) as f64;
        let enough = self.census.usable >= MIN_PIXELS && inlier_share >= self.params.smallest_share;
        let change = if enough { self.refine() } else { None };
        self.drift = Some(Drift { inlier_share, change });
        self.pass = if change.is_some() { Pass::Refine } else { Pass::Colors };
    }

    /// The new model; `None`, with the old one kept, where there is none.
    #[inline(never)]
    fn refine(&mut self) -> Option<Change> {
        let params = self.params.solve;
        let confidence = params.lmeds.limits_confidence;
        let refit = Refit::new(&self.moments, self.scale, confidence, |_, z| self.moments.residual_sum(z))?;
        if refit.degenerate_noise_deviation <= SMALLEST_NOISE_MARGIN * refit.noise_deviation {
            return None;
        }
        let z = refit.coefficients.map(|estimate| estimate.value);
        let ellipsoid = ellipsoid::decompose(&z).ok()?;
        let tilts = match params.tilts {
            TiltEstimator::Given(tilts) => Tilts::alone(tilts),
            _ => self.differences.tilts()?,
        };
        let orient = |slants| orient(&ellipsoid, slants, tilts.tilts, &params);
        let old = self.solution.choice.as_ref()?;
        let candidates = candidates(&ellipsoid, tilts.tilts);
        let choice = match nearest(&candidates, old.slants) {
            Some(chosen) => chosen_root(candidates, chosen, orient)?,
            None if params.fallback == SlantFallback::LeastSquares => {
                let slants = constrained_slant::least_squares(tilts.tilts, ellipsoid.cosines).slants;
                let orientation = orient(slants);
                Choice { slants, source: SlantSource::LeastSquares, candidates, chosen: 0, orientation }
            }
            None => return None,
        };
        if choice.orientation.rank < 3 {
            return None;
        }
        let fit = self.solution.fit.as_mut()?;
        // An exact fit stays one.
        let ratio = refit.residual_deviation / fit.residual_deviation.max(f64::MIN_POSITIVE);
        let dispersion = if fit.residual_deviation > 0.0 { ratio } else { 1.0 };
        let change = change(&old.orientation.f, &choice.orientation.f, dispersion);

        fit.robust = z;
        fit.median_residual *= dispersion;
        fit.dispersion *= dispersion;
        fit.r_squared = 1.0 - fit.median_residual * fit.median_residual;
        fit.band = Band::residual(z, fit.dispersion, params.lmeds.rejection);
        fit.coefficients = refit.coefficients;
        fit.residual_deviation = refit.residual_deviation;
        fit.color_deviations = refit.color_deviations;
        fit.noise_deviation = refit.noise_deviation;
        fit.degenerate_noise_deviation = refit.degenerate_noise_deviation;
        fit.usable = self.census.usable;
        fit.inliers = refit.count as usize;
        self.solution.inliers.residual = fit.band;
        if let Some(norms) = &mut self.solution.norm_location {
            *norms = Location {
                location: norms.location,
                median_distance: norms.median_distance * dispersion,
                dispersion: norms.dispersion * dispersion,
            };
            self.solution.inliers.norm = Band::norm(z, norms, params.lmeds.rejection);
        }
        self.solution.census = self.census;
        self.solution.color_deviations = refit.color_deviations;
        self.solution.inlier_count = self.inlier_count;
        self.solution.ellipsoid = Some(ellipsoid);
        self.solution.tilts = Some(tilts);
        self.solution.choice = Some(choice);
        self.solution.outcome = Outcome::Solved;
        Some(change)
    }
}

/// Which candidate's slants are nearest to these.
fn nearest(candidates: &[Candidate], slants: [f64; 3]) -> Option<usize> {
    let distance = |candidate: &Candidate| {
        candidate.slants.iter().zip(slants).map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
    };
    let nearer =
        |(_, a): &(usize, &Candidate), (_, b): &(usize, &Candidate)| distance(a).total_cmp(&distance(b));
    candidates.iter().enumerate().min_by(nearer).map(|(chosen, _)| chosen)
}

fn change(old: &Mat3, new: &Mat3, dispersion: f64) -> Change {
    let (mut angles, mut strengths) = ([0.0; 3], [0.0; 3]);
    for ((angle, strength), (&old, &new)) in angles.iter_mut().zip(&mut strengths).zip(old.iter().zip(new)) {
        let cross = mat3::cross(old, new);
        *angle = atan2(sqrt(mat3::dot(cross, cross)), mat3::dot(old, new));
        *strength = sqrt(mat3::dot(new, new) / mat3::dot(old, old).max(f64::MIN_POSITIVE));
    }
    Change { angles, strengths, dispersion }
}
