//! One pass that makes a new model of an old one.
//!
//! Every n-th row is looked at. The inliers of the old model are fitted by least squares, from the sums over them. The
//! tilts are those of the mean differences along the rows, and between one row that is looked at and the next: in a column
//! of inliers these add up to the difference between its ends, however far the rows lie apart. As others are looked at in
//! every frame, the differences of about n frames are averaged. Of the slants
//! that agree with both those nearest to the old ones are taken. The dispersion grows or shrinks with the deviation of
//! the inliers' residuals: as it was truncated before, so it is now. With the joint method the orthogonal transformation is kept,
//! as far as the new C lets it.

use super::cold::slants_of;
use super::drift::{Change, Drift};
use super::kept_row::{keep_window, kept};
use super::memory::Memory;
use super::orientation::nearest_rows;
use super::parameters::FULL;
use super::pass::Pass;
use super::state::State;
use crate::color::ellipsoid::{self, Coefficients, Ellipsoid};
use crate::color::inliers::{Band, Inliers};
use crate::color::lmeds::{MIN_PIXELS, Refit};
use crate::color::regression::Moments;
use crate::light::constrained_slant::{self, Candidates, SlantRoot};
use crate::light::tilt::{TiltEstimator, Tilts, pentland};
use crate::math::mat3::{self, Mat3};
use crate::orientation::matrix::Orientation;
use crate::picture::{Image, PixelCounts, Window, for_each_bit};
use crate::solve::{SMALLEST_NOISE_MARGIN, orient, oriented};
use libm::{atan2, sqrt};

impl State {
    /// What the last frame that a model was refined with says of it; `None` before the first and after a cold start.
    #[must_use]
    pub const fn drift(&self) -> Option<&Drift> {
        self.drift.as_ref()
    }

    pub(super) fn begin_refine(&mut self) {
        self.pixel_counts = PixelCounts::default();
        self.moments = Moments::default();
        self.differences = pentland::Sums::default();
        self.inlier_count = 0;
    }

    pub(super) fn row_refine(&mut self, y: usize, row: &Image, memory: &mut Memory) {
        if self.rows.hold(y) {
            self.row_sums(y > self.rows.first(), row, memory);
        }
    }

    /// The sums of a row that is looked at; `follows` another one, which is kept.
    #[inline(never)]
    fn row_sums(&mut self, follows: bool, row: &Image, memory: &mut Memory) {
        let Inliers { usable, residual, norm } = &self.solution.inliers;
        let scale = self.scale;
        let (mut above, mut left) = (Window::new(), None);
        row.for_each_window(|window| {
            let fitting = residual.bits(window, usable.count_window(window, &mut self.pixel_counts));
            let mut sums = Moments::default();
            if fitting != 0 {
                for_each_bit(fitting, |i| {
                    let [r, g, b] = window.pixel(i);
                    sums.add([f64::from(r) * scale, f64::from(g) * scale, f64::from(b) * scale]);
                });
                self.moments.merge(&sums);
            }
            let inliers = norm.bits(window, fitting);
            self.inlier_count += inliers.count_ones() as usize;
            let mut inliers_above = 0;
            if follows && inliers != 0 {
                kept(window.x, row.width(), memory, &mut above);
                inliers_above = above.masked & above.bits(|r, _, _| !r.is_nan());
            }
            self.differences.add_rows((&above, inliers_above), (window, inliers), &mut left);
            keep_window(row.width(), window, inliers, memory.values);
        });
    }

    #[inline(never)]
    pub(super) fn end_refine(&mut self, memory: &mut Memory) {
        let inlier_share = f64::from(self.moments.count) / self.pixel_counts.usable.max(1) as f64;
        let enough = self.pixel_counts.usable >= MIN_PIXELS && inlier_share >= self.params.smallest_share;
        self.history.remember(&self.differences, self.rows.step());
        self.rows.advance();
        let change = if enough { self.refine(memory.boxes) } else { None };
        self.drift = Some(Drift { inlier_share, change });
        self.pass = if change.is_some() { Pass::Refine } else { Pass::Colors };
    }

    /// The new model; `None`, with the old one kept, where there is none.
    fn refine(&mut self, boxes: &mut [f64]) -> Option<Change> {
        let form = self.refined_form()?;
        let (angles, strengths) = self.adopt_orientation(&form, boxes)?;
        let dispersion = self.adopt_fit()?;
        Some(Change { angles, strengths, dispersion })
    }

    /// Takes over what follows from C and the tilts, and says by how much the rows of F turned and grew.
    #[inline(never)]
    fn adopt_orientation(&mut self, form: &Coefficients, boxes: &mut [f64]) -> Option<([f64; 3], [f64; 3])> {
        if FULL && self.solution.joint.is_some() {
            return self.adopt_form(form);
        }
        let tilts = match self.params.solve.tilts {
            TiltEstimator::Given(tilts) => Tilts::alone(tilts),
            _ => self.history.tilts_along_axes()?,
        };
        let cosines = cosines(form)?;
        let mut roots = Candidates::new();
        constrained_slant::roots_within(tilts.tilts, cosines, boxes, &mut roots);
        let chosen = nearest(&roots, self.solution.choice.as_ref()?.slants);
        let fallback = self.params.solve.fallback;
        let (slants, source) = slants_of(roots.get(chosen), tilts.tilts, cosines, fallback)?;
        let change = self.adopt_slants(form, &tilts, slants)?;
        let choice = self.solution.choice.as_mut()?;
        choice.set_candidates(&roots);
        (choice.source, choice.chosen) = (source, chosen);
        Some(change)
    }

    /// The slants for this form of C and these tilts, adopted; `None`, with nothing done, where F is rank-deficient.
    #[inline(never)]
    fn adopt_slants(
        &mut self,
        form: &Coefficients,
        tilts: &Tilts,
        slants: [f64; 3],
    ) -> Option<([f64; 3], [f64; 3])> {
        let ellipsoid = ellipsoid::decompose(form).ok()?;
        let orientation = orient(&ellipsoid, slants, tilts.tilts, &self.params.solve);
        self.adopt(&ellipsoid, tilts, slants, &orientation)
    }

    /// F of this form of C with the transformation kept, adopted; `None`, with nothing done, where it is rank-deficient.
    #[inline(never)]
    fn adopt_form(&mut self, form: &Coefficients) -> Option<([f64; 3], [f64; 3])> {
        let ellipsoid = ellipsoid::decompose(form).ok()?;
        let root_inverse = ellipsoid.root_inverse();
        let rows = nearest_rows(&self.solution.choice.as_ref()?.orientation.f_inverse, &root_inverse);
        let (tilts, new) = oriented(&rows, &root_inverse, self.params.solve.rank_threshold);
        let change = self.adopt(&ellipsoid, &tilts, new.slants, &new.orientation)?;
        if let Some(joint) = &mut self.solution.joint {
            joint.rows = rows;
        }
        Some(change)
    }

    /// Takes this orientation over with what it follows from, and says what it changes; `None`, with nothing done, where it is
    /// rank-deficient.
    fn adopt(
        &mut self,
        ellipsoid: &Ellipsoid,
        tilts: &Tilts,
        slants: [f64; 3],
        orientation: &Orientation,
    ) -> Option<([f64; 3], [f64; 3])> {
        let choice = self.solution.choice.as_mut()?;
        if orientation.rank < 3 {
            return None;
        }
        let change = change(&choice.orientation.f, &orientation.f);
        (choice.slants, choice.orientation) = (slants, *orientation);
        (self.solution.ellipsoid, self.solution.tilts) = (Some(*ellipsoid), Some(*tilts));
        Some(change)
    }

    fn refit(&self) -> Option<Refit> {
        let fit = self.moments.solve();
        let fit = fit.as_ref()?;
        let sum = self.moments.residual_sum(&fit.coefficients);
        Refit::new(&self.moments, fit, self.scale, self.params.solve.lmeds.limits_confidence, sum, 0.0)
    }

    /// C of the sums; `None` where they do not determine it.
    #[inline(never)]
    fn refined_form(&self) -> Option<Coefficients> {
        let refit = self.refit()?;
        (refit.degenerate_noise_deviation > SMALLEST_NOISE_MARGIN * refit.noise_deviation).then(|| refit.z())
    }

    /// Takes the fit of the sums over, with the bands that follow from it, and says by how much the dispersion grew.
    #[inline(never)]
    fn adopt_fit(&mut self) -> Option<f64> {
        let refit = self.refit()?;
        let rejection = self.params.solve.lmeds.rejection;
        let fit = self.solution.fit.as_mut()?;
        let z = refit.z();
        // An exact fit stays one.
        let dispersion = if fit.residual_deviation > 0.0 {
            refit.residual_deviation / fit.residual_deviation
        } else {
            1.0
        };
        fit.robust = z;
        fit.median_residual *= dispersion;
        fit.dispersion *= dispersion;
        fit.r_squared = 1.0 - fit.median_residual * fit.median_residual;
        fit.band = Band::residual(z, fit.dispersion, rejection);
        fit.coefficients = refit.coefficients;
        fit.residual_deviation = refit.residual_deviation;
        fit.color_deviations = refit.color_deviations;
        fit.noise_deviation = refit.noise_deviation;
        fit.degenerate_noise_deviation = refit.degenerate_noise_deviation;
        fit.usable = self.pixel_counts.usable;
        fit.inliers = refit.count as usize;
        self.solution.inliers.residual = fit.band;
        if let Some(norms) = &mut self.solution.norm_location {
            norms.median_distance *= dispersion;
            norms.dispersion *= dispersion;
            self.solution.inliers.norm = Band::norm(z, norms, rejection);
        }
        self.solution.pixel_counts = self.pixel_counts;
        self.solution.color_deviations = refit.color_deviations;
        self.solution.inlier_count = self.inlier_count;
        Some(dispersion)
    }
}

/// The cosines of the angles between the rows of F; `None` where C is not positive definite.
// Three numbers of the forty, kept through the search for slants.
#[inline(never)]
fn cosines(form: &Coefficients) -> Option<[f64; 3]> {
    ellipsoid::decompose(form).ok().map(|ellipsoid| ellipsoid.cosines)
}

/// Which root's slants are nearest to these; 0 without any.
fn nearest(roots: &Candidates, slants: [f64; 3]) -> usize {
    let distance =
        |root: &SlantRoot| root.slants.iter().zip(slants).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
    let roots = roots.iter().enumerate();
    roots.min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b))).map_or(0, |(chosen, _)| chosen)
}

/// The angles between the rows of two F, and their lengths over each other.
#[inline(never)]
fn change(old: &Mat3, new: &Mat3) -> ([f64; 3], [f64; 3]) {
    let (mut angles, mut strengths) = ([0.0; 3], [0.0; 3]);
    for ((angle, strength), (&old, &new)) in angles.iter_mut().zip(&mut strengths).zip(old.iter().zip(new)) {
        let cross = mat3::cross(old, new);
        *angle = atan2(sqrt(mat3::dot(cross, cross)), mat3::dot(old, new));
        *strength = sqrt(mat3::dot(new, new) / mat3::dot(old, old).max(f64::MIN_POSITIVE));
    }
    (angles, strengths)
}
