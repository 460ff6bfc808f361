//! A second fit, without the colors that a light does not reach.

use super::parameters::Params;
use super::solution::Solution;
use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Inliers;
use crate::color::lmeds::{self, Fit, FitError};
use crate::color::scale::reciprocal_power_of_two;
use crate::color::shadows;
use crate::picture::{Image, Pixels, Usable};

/// Times that shadows are looked for: an ellipsoid that they no longer bend shows more of them.
const ROUNDS: usize = 2;

/// Colors that shadows are looked for in, where there are more than [`ENOUGH`].
const SAMPLE: usize = 1 << 14;

/// Of no more than this many colors no sample is taken.
const ENOUGH: usize = 3 * SAMPLE;

/// At least one in so many pixels is lit by all three lights.
const SMALLEST_SHARE: usize = 3;

impl Solution {
    /// The fit to the pixels that all lights reach, which takes its place here, and leaves those out of the usable ones that a light
    /// does not reach.
    ///
    /// # Errors
    /// [`FitError`].
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    #[inline(never)]
    pub(crate) fn fit_lit(
        &mut self,
        image: &Image,
        params: &Params,
        workspace: &mut [f32],
    ) -> Result<(), FitError> {
        let counts = self.pixel_counts;
        let all = lmeds::Problem::of(image, self.inliers.usable, &counts, &params.lmeds)?;
        let found = all.search(workspace)?;
        let looks_for_shadows = params.rejects_shadows();
        let is_large = all.count > ENOUGH.max(params.lmeds.sample_size as usize);
        // Where a color is the majority, a fit to all pixels may turn out another than the search found.
        let is_sampled = looks_for_shadows && is_large && !found.is_concentrated;
        self.fit = if is_sampled { None } else { Some(all.fit(&found, workspace)?) };
        if looks_for_shadows && !is_large {
            self.reject_shadows(image, params, workspace);
        } else if looks_for_shadows {
            self.fit_lit_by_sample(&all, found.scaled, params, workspace);
        }
        if self.fit.is_none() {
            self.fit = Some(all.fit(&found, workspace)?);
        }
        Ok(())
    }

    /// Looks for shadows in a sample of the colors, as a plane of them needs no more, and fits to all pixels that are lit; where there
    /// is no fit yet, beginning at the `scaled` z. `None`, with nothing done, where there are no shadows.
    #[inline(never)]
    fn fit_lit_by_sample(
        &mut self,
        all: &lmeds::Problem<Image>,
        scaled: Option<Coefficients>,
        params: &Params,
        workspace: &mut [f32],
    ) -> Option<()> {
        let exposed = self.inliers.usable;
        let (colors, workspace) = all.colors(SAMPLE, workspace)?;
        let fit_to_all = self.fit;
        if fit_to_all.is_none() {
            let sample = lmeds::Problem {
                pixels: &colors,
                usable: exposed,
                count: SAMPLE,
                scale: all.scale,
                params: all.params,
            };
            if sample.evaluate::<false>(scaled, workspace, &mut self.fit).is_err() {
                self.fit = None;
                return None;
            }
        }
        let left = self.leave_out_shadows::<false>(&colors, SAMPLE, params, workspace);
        let (usable, fit) = (self.inliers.usable, self.fit);
        (self.inliers.usable, self.fit) = (exposed, fit_to_all);
        if usable == exposed {
            return None;
        }
        let about = (all.count as u64 * left as u64 / SAMPLE as u64) as usize;
        let lit = lmeds::Problem { usable, count: about, ..*all };
        let z = fit?.z();
        // Without one, the count would have to be exact.
        let bracket = Some(lmeds::Bracket::of_pixels(&colors, usable, &z, workspace)?);
        let scaled = z.map(|c| c / (lit.scale * lit.scale));
        let mut fit = None;
        lit.evaluate_within::<true>(Some(scaled), bracket, workspace, &mut fit).ok()?;
        let count = fit.as_ref()?.usable;
        (self.fit, self.inliers.usable) = (fit, usable);
        self.pixel_counts.shaded = self.pixel_counts.usable - count;
        self.pixel_counts.usable = count;
        Some(())
    }

    /// Looks for shadows among these pixels, all or a sample of them, and where there are any replaces the fit, which is there, and the
    /// usable pixels; the pixel counts say how many that makes of all.
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    #[inline(never)]
    pub(crate) fn reject_shadows(&mut self, pixels: &impl Pixels, params: &Params, workspace: &mut [f32]) {
        let count = self.fit.as_ref().map_or(0, |fit| fit.usable);
        let left = self.leave_out_shadows::<true>(pixels, count, params, workspace);
        let usable = self.pixel_counts.usable;
        self.pixel_counts.shaded = ((count - left) as u64 * usable as u64 / count.max(1) as u64) as usize;
        self.pixel_counts.usable = usable - self.pixel_counts.shaded;
    }

    /// How many of the `count` pixels that are usable but for shadows are lit. The errors of the fit to these are there if `ERRORS`.
    fn leave_out_shadows<const ERRORS: bool>(
        &mut self,
        pixels: &impl Pixels,
        count: usize,
        params: &Params,
        workspace: &mut [f32],
    ) -> usize {
        let mut left = count;
        for _ in 0..ROUNDS {
            let Some(fewer) = self.leave_out_faces::<ERRORS>(pixels, count, &params.lmeds, workspace) else {
                break;
            };
            left = fewer;
        }
        left
    }

    /// One round over the `count` pixels that are usable but for shadows: how many are lit; `None`, with nothing done, where
    /// there are no shadows.
    fn leave_out_faces<const ERRORS: bool>(
        &mut self,
        pixels: &impl Pixels,
        count: usize,
        params: &lmeds::Params,
        workspace: &mut [f32],
    ) -> Option<usize> {
        let fit = self.fit.as_ref()?;
        let usable = Usable::below(self.inliers.usable.saturation);
        let scale = reciprocal_power_of_two(self.pixel_counts.largest);
        let all = lmeds::Problem { pixels, usable, count, scale, params };
        let faces = shadows::find(&all, fit, workspace.get_mut(..2 * count)?)?;
        let above = |shadow_faces| {
            let usable = Usable { shadow_faces, ..usable };
            lmeds::Problem { usable, count: Inliers::all(usable).count(pixels), ..all }
        };
        let z = fit.z();
        let mut fit = refit::<ERRORS>(&above(faces), z, workspace)?;
        let confirmed = shadows::confirmed(&faces, &all, fit.band)?;
        if confirmed != faces {
            fit = refit::<ERRORS>(&above(confirmed), z, workspace)?;
        }
        let left = fit.usable;
        if SMALLEST_SHARE * left < count {
            return None;
        }
        self.fit = Some(fit);
        self.inliers.usable = Usable { shadow_faces: confirmed, ..usable };
        Some(left)
    }
}

/// The fit that begins at `z`; `None` where the pixels are too few, or determine none.
#[inline(never)]
fn refit<const ERRORS: bool>(
    problem: &lmeds::Problem<impl Pixels>,
    z: Coefficients,
    workspace: &mut [f32],
) -> Option<Fit> {
    if problem.count < lmeds::MIN_PIXELS {
        return None;
    }
    let scaled = z.map(|c| c / (problem.scale * problem.scale));
    // The band is about the z that it begins at: once more about its own.
    let scaled = problem.reweighted_z(&scaled, workspace)?;
    let mut fit = None;
    problem.evaluate::<ERRORS>(Some(scaled), workspace, &mut fit).ok()?;
    fit
}
