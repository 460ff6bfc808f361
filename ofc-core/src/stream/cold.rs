//! The passes of a cold start, with the direct method.

use super::kept_row::{keep, kept};
use super::memory::{Memory, room};
use super::parameters::FULL;
use super::pass::{Pass, StreamError};
use super::rows::Rows;
use super::state::{Held, State};
use super::strata::{Sampled, Slots, Strata};
use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Inliers;
use crate::color::lmeds::{self, FitError, Method};
use crate::color::scale::reciprocal_power_of_two;
use crate::light::constrained_slant::{self, Candidates, MAX_CANDIDATES, SlantRoot};
use crate::light::tilt::{TiltEstimator, Tilts, pentland};
use crate::math::rng::Rng;
use crate::orientation::integrability;
use crate::picture::cells::{Block, for_each_block_of_rows};
use crate::picture::second_differences;
use crate::picture::{Image, PixelCounts, Usable, Window, for_each_bit};
use crate::solve::{Choice, Outcome, SlantFallback, SlantSource, orient};

impl State {
    pub(super) fn begin_colors(&mut self) {
        let lmeds = self.params.solve.lmeds;
        self.strata = Strata::new(lmeds.seed, room(self.width, self.height, lmeds.sample_size));
        self.pixel_counts = PixelCounts::default();
        self.second_differences = (0.0, 0);
    }

    #[inline(never)]
    pub(super) fn row_colors(&mut self, y: usize, row: &Image, memory: &mut Memory) {
        let Some((mut slots, _)) = self.slots(memory) else { return };
        // The shadows are those of a model that this frame may replace.
        let usable = Usable::below(self.usable().saturation);
        row.for_each_window(|window| {
            let bits = usable.count_window(window, &mut self.pixel_counts);
            let (sum, count) = &mut self.second_differences;
            second_differences(window, bits, sum, count);
            for_each_bit(bits, |i| self.strata.offer(window, y, i, &mut slots));
        });
    }

    /// The sample's room, and that behind it.
    fn slots<'a>(&self, memory: &'a mut Memory) -> Option<(Slots<'a>, &'a mut [f32])> {
        let room = room(self.width, self.height, self.params.solve.lmeds.sample_size);
        let (red, rest) = memory.values.split_at_mut_checked(room)?;
        let (green, rest) = rest.split_at_mut_checked(room)?;
        let (blue, rest) = rest.split_at_mut_checked(room)?;
        Some((Slots { colors: [red, green, blue], places: memory.places }, rest))
    }

    #[inline(never)]
    pub(super) fn end_colors(&mut self, memory: &mut Memory) -> Result<(), StreamError> {
        self.solution.restart(self.pixel_counts);
        self.concluded = false;
        lmeds::enough(&self.pixel_counts, self.width * self.height).map_err(StreamError::Fit)?;
        self.scale = reciprocal_power_of_two(self.pixel_counts.largest);
        self.rows = Rows::new(self.height, &self.pixel_counts, self.params.refine_pixels);
        self.drift = None;
        let found = self.search(memory);
        let fit = self.fit(found, memory);
        let has_model = self.model(fit, memory).map_err(StreamError::Fit)?;
        let next = if FULL && self.params.solve.is_joint() { Pass::Outward } else { Pass::Tilts };
        self.go_on(has_model, next);
        Ok(())
    }

    /// The fit to the sample, from the z that was found in it.
    #[inline(never)]
    fn fit(&mut self, found: Option<Coefficients>, memory: &mut Memory) -> Result<(), FitError> {
        let (pixels, workspace) = self.sampled(memory).ok_or(FitError::WorkspaceTooShort)?;
        let params = &self.params.solve.lmeds;
        let (usable, count, scale) = (self.usable(), self.strata.len(), self.scale);
        let problem = lmeds::Problem { pixels: &pixels, usable, count, scale, params };
        let scaled = match params.method {
            Method::LeastMedian => found,
            Method::LeastSquares => problem.least_squares(),
        };
        problem.evaluate::<FULL>(scaled, workspace, &mut self.solution.fit)
    }

    /// What follows from the fit; whether there is a model of the colors.
    #[inline(never)]
    fn model(&mut self, fit: Result<(), FitError>, memory: &mut Memory) -> Result<bool, FitError> {
        let (pixels, workspace) = self.sampled(memory).ok_or(FitError::WorkspaceTooShort)?;
        let params = self.params.solve;
        if FULL && fit.is_ok() && params.rejects_shadows() {
            self.solution.reject_shadows(&pixels, &params, workspace);
        }
        self.solution.take_regression(&pixels, fit, params.lmeds.method)?;
        let has_model = self.decide_on_model();
        if has_model {
            self.solution.reject_lengths(&pixels, params.lmeds.rejection, workspace);
        }
        Ok(has_model)
    }

    /// Whether there is a model of the colors.
    #[inline(never)]
    fn decide_on_model(&mut self) -> bool {
        let model = self.solution.model(self.params.solve.lmeds.method);
        if let Err(reason) = model {
            self.solution.end_without_model(reason);
        }
        model.is_ok()
    }

    /// The sample as pixels, and the room behind it.
    fn sampled<'a>(&self, memory: &'a mut Memory) -> Option<(Sampled<'a>, &'a mut [f32])> {
        let (Slots { colors: [red, green, blue], places }, workspace) = self.slots(memory)?;
        let count = self.strata.len();
        let pixels = Sampled {
            colors: [red.get(..count)?, green.get(..count)?, blue.get(..count)?],
            places: if self.strata.is_whole() { places.get(..count)? } else { &[] },
            format: self.format,
            second_differences: self.second_differences,
        };
        Some((pixels, workspace))
    }

    /// The scaled z that least median of squares finds on the sample.
    #[inline(never)]
    fn search(&self, memory: &mut Memory) -> Option<Coefficients> {
        let lmeds = self.params.solve.lmeds;
        if lmeds.method != Method::LeastMedian {
            return None;
        }
        let count = self.strata.len();
        let (Slots { colors, .. }, residuals) = self.slots(memory)?;
        let residuals = residuals.get_mut(..count)?;
        let mut colors = colors.map(|channel| channel.get_mut(..count).unwrap_or_default());
        // Where it was before its colors were drawn.
        let mut rng = Rng::new(lmeds.seed);
        rng.skip(count as u64);
        multiply(&mut colors, self.scale);
        let scaled = colors.each_ref().map(|channel| &**channel);
        let found = lmeds::Sample::new(scaled, residuals).best(lmeds.subset_count()?, &mut rng);
        multiply(&mut colors, 1.0 / self.scale);
        found
    }

    pub(super) fn begin_tilts(&mut self) {
        self.differences = pentland::Sums::default();
        self.inlier_count = 0;
    }

    #[inline(never)]
    pub(super) fn row_tilts(&mut self, y: usize, row: &Image, memory: &mut Memory) {
        if y > 0 {
            self.tilts_of_blocks(Some(row), memory);
        }
        keep(row, memory);
    }

    /// The blocks of the row before and this one.
    #[inline(never)]
    fn tilts_of_blocks(&mut self, row: Option<&Image>, memory: &Memory) {
        let (differences, count) = (&mut self.differences, &mut self.inlier_count);
        for_each_block_of_stream(self.width, &self.solution.inliers, row, memory, |block| {
            differences.add(block);
            *count += block.own_top().count_ones() as usize;
        });
    }

    /// The pairs along the last row, which has none below.
    fn last_row_tilts(&mut self, memory: &Memory) {
        self.tilts_of_blocks(None, memory);
    }

    #[inline(never)]
    pub(super) fn end_tilts(&mut self, memory: &mut Memory) {
        self.last_row_tilts(memory);
        self.solution.inlier_count = self.inlier_count;
        self.solution.tilts = self.tilts();
        self.history = self.differences;
        if self.solution.tilts.is_none() {
            self.solution.outcome = Outcome::NoTilt;
            return self.go_on(false, Pass::Colors);
        }
        let goes_on = self.find_candidates(memory);
        self.go_on(goes_on, Pass::Slants);
    }

    /// The tilts that the differences, or the caller, have.
    fn tilts(&self) -> Option<Tilts> {
        match self.params.solve.tilts {
            TiltEstimator::Given(tilts) => Some(Tilts::alone(tilts)),
            _ => self.differences.tilts(),
        }
    }

    /// The candidates, and F where there is one at most; whether there are more.
    #[inline(never)]
    fn find_candidates(&mut self, memory: &mut Memory) -> bool {
        let (Some(Tilts { tilts, .. }), Some(ellipsoid)) = (self.solution.tilts, &self.solution.ellipsoid)
        else {
            return false;
        };
        let mut roots = Candidates::new();
        constrained_slant::roots_within(tilts, ellipsoid.cosines, memory.boxes, &mut roots);
        let fallback = self.params.solve.fallback;
        if let Some((slants, source)) = slants_of(roots.first(), tilts, ellipsoid.cosines, fallback) {
            self.solution.choice = None;
            self.adopt_candidates(&roots, slants, source);
        }
        if roots.len() > 1 {
            self.orient_candidates(&roots);
            return true;
        }
        self.solution.conclude();
        false
    }

    /// Chooses these slants, of all roots the first one's if there is one.
    #[inline(never)]
    fn adopt_candidates(&mut self, roots: &Candidates, slants: [f64; 3], source: SlantSource) {
        let choice = self.solution.choice.get_or_insert_with(Choice::none);
        choice.set_candidates(roots);
        (choice.slants, choice.source) = (slants, source);
        self.orient();
    }

    /// F of the slants that were chosen.
    fn orient(&mut self) {
        if let (Some(choice), Some(Tilts { tilts, .. }), Some(ellipsoid)) =
            (&mut self.solution.choice, self.solution.tilts, &self.solution.ellipsoid)
        {
            choice.orientation = orient(ellipsoid, choice.slants, tilts, &self.params.solve);
        }
    }

    /// F^-1 of every candidate.
    #[inline(never)]
    fn orient_candidates(&mut self, roots: &Candidates) {
        if let (Some(Tilts { tilts, .. }), Some(ellipsoid)) = (self.solution.tilts, &self.solution.ellipsoid)
        {
            let (mut inverses, integrals) =
                ([None; MAX_CANDIDATES], [integrability::Sum::default(); MAX_CANDIDATES]);
            for (inverse, root) in inverses.iter_mut().zip(roots) {
                let orientation = orient(ellipsoid, root.slants, tilts, &self.params.solve);
                *inverse = (orientation.rank == 3).then_some(orientation.f_inverse);
            }
            self.held = Held::Candidates { inverses, integrals };
        }
    }

    pub(super) fn begin_slants(&mut self) {
        if let Held::Candidates { integrals, .. } = &mut self.held {
            integrals.fill(integrability::Sum::default());
        }
    }

    #[inline(never)]
    pub(super) fn row_slants(&mut self, y: usize, row: &Image, memory: &mut Memory) {
        if y > 0
            && let Held::Candidates { inverses, integrals } = &mut self.held
        {
            for_each_block_of_stream(self.width, &self.solution.inliers, Some(row), memory, |block| {
                for (integral, inverse) in integrals.iter_mut().zip(inverses.iter()) {
                    if let Some(inverse) = inverse {
                        integral.add(block, inverse);
                    }
                }
            });
        }
        keep(row, memory);
    }

    #[inline(never)]
    pub(super) fn end_slants(&mut self) {
        if let (Some(choice), Held::Candidates { inverses, integrals }) =
            (&mut self.solution.choice, &self.held)
        {
            let sums = inverses.iter().zip(integrals);
            for (candidate, (inverse, integral)) in choice.candidates.iter_mut().zip(sums) {
                let mean = if inverse.is_some() { integral.mean() } else { None };
                candidate.integral = mean.map_or(f64::INFINITY, |integral| integral.mean);
            }
            if let Some((chosen, slants)) = choice.most_integrable() {
                (choice.chosen, choice.slants) = (chosen, slants);
            }
        }
        self.orient();
        self.solution.conclude();
        self.go_on(false, Pass::Colors);
    }
}

/// The slants of this root, or without one those of the fallback; `None` where that is to refuse.
pub(super) fn slants_of(
    root: Option<&SlantRoot>,
    tilts: [f64; 3],
    cosines: [f64; 3],
    fallback: SlantFallback,
) -> Option<([f64; 3], SlantSource)> {
    match root {
        Some(root) => Some((root.slants, SlantSource::Root)),
        None if fallback == SlantFallback::LeastSquares => {
            let slants = constrained_slant::without_roots(tilts, cosines).slants;
            Some((slants, SlantSource::LeastSquares))
        }
        None => None,
    }
}

/// A power of two times all colors, so that nothing is lost.
fn multiply(colors: &mut [&mut [f32]; 3], factor: f64) {
    for value in colors.iter_mut().flat_map(|channel| channel.iter_mut()) {
        *value = (f64::from(*value) * factor) as f32;
    }
}

/// Visits the blocks of the row before and this one, or nothing below the last row.
fn for_each_block_of_stream(
    width: usize,
    inliers: &Inliers,
    row: Option<&Image>,
    memory: &Memory,
    visit: impl FnMut(&Block),
) {
    let read = |x, window: &mut Window, lower| match (lower, row) {
        (0, _) => kept(x, width, memory, window),
        (_, Some(row)) => row.read(x, 0, window),
        (_, None) => (window.len, window.masked) = (0, 0),
    };
    for_each_block_of_rows(width, &mut Block::default(), read, |window| inliers.bits(window), visit);
}
