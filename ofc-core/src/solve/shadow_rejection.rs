//! A second fit, without the colors that a light does not reach.

use super::parameters::Params;
use super::solution::Solution;
use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Inliers;
use crate::color::lmeds::{self, Fit};
use crate::color::scale::reciprocal_power_of_two;
use crate::color::shadows;
use crate::picture::{Image, Pixels, Usable};

/// Times that shadows are looked for: an ellipsoid that they no longer bend shows more of them.
const ROUNDS: usize = 2;

/// At least one in so many pixels is lit by all three lights.
const SMALLEST_SHARE: usize = 3;

impl Solution {
    /// Looks for shadows, and where there are any replaces the fit, which is there, and the usable pixels. They are looked for in a
    /// sample of the rows: a plane of colors needs no more, and a fit to all pixels comes last.
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    #[inline(never)]
    pub(crate) fn reject_shadows_of(&mut self, image: &Image, params: &Params, workspace: &mut [f32]) {
        let step = image.sample_step();
        if step == 1 {
            return self.reject_shadows(image, params, workspace);
        }
        let (fit_to_all, rows) = (self.fit, image.rows_apart(step));
        let exposed = Usable::below(self.inliers.usable.saturation);
        self.leave_out_shadows(&rows, Inliers::all(exposed).count(&rows), params, workspace);
        let usable = self.inliers.usable;
        if usable == exposed {
            return;
        }
        let count = Inliers::all(usable).count(image);
        let scale = reciprocal_power_of_two(self.pixel_counts.largest);
        let lit = lmeds::Problem { pixels: image, usable, count, scale, params: &params.lmeds };
        if let Some(fit) = self.fit.as_ref().and_then(|fit| refit(&lit, fit.z(), workspace)) {
            self.fit = Some(fit);
            self.pixel_counts.shaded = self.pixel_counts.usable - count;
            self.pixel_counts.usable = count;
        } else {
            (self.fit, self.inliers.usable) = (fit_to_all, exposed);
        }
    }

    /// The same in a sample of pixels; the pixel counts say how many that makes of all.
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    #[inline(never)]
    pub(crate) fn reject_shadows(&mut self, pixels: &impl Pixels, params: &Params, workspace: &mut [f32]) {
        let count = self.fit.as_ref().map_or(0, |fit| fit.usable);
        let left = self.leave_out_shadows(pixels, count, params, workspace);
        let usable = self.pixel_counts.usable;
        self.pixel_counts.shaded = ((count - left) as u64 * usable as u64 / count.max(1) as u64) as usize;
        self.pixel_counts.usable = usable - self.pixel_counts.shaded;
    }

    /// How many of the `count` pixels that are usable but for shadows are lit.
    fn leave_out_shadows(
        &mut self,
        pixels: &impl Pixels,
        count: usize,
        params: &Params,
        workspace: &mut [f32],
    ) -> usize {
        let mut left = count;
        for _ in 0..ROUNDS {
            let Some(fewer) = self.leave_out_faces(pixels, count, &params.lmeds, workspace) else { break };
            left = fewer;
        }
        left
    }

    /// One round over the `count` pixels that are usable but for shadows: how many are lit; `None`, with nothing done, where
    /// there are no shadows.
    fn leave_out_faces(
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
        let mut fit = refit(&above(faces), z, workspace)?;
        let confirmed = shadows::confirmed(&faces, &all, fit.band)?;
        if confirmed != faces {
            fit = refit(&above(confirmed), z, workspace)?;
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
fn refit<P: Pixels>(problem: &lmeds::Problem<P>, z: Coefficients, workspace: &mut [f32]) -> Option<Fit> {
    if problem.count < lmeds::MIN_PIXELS {
        return None;
    }
    let scaled = z.map(|c| c / (problem.scale * problem.scale));
    // The band is about the z that it begins at: once more about its own.
    let scaled = problem.reweighted_z(&scaled, workspace)?;
    let mut fit = None;
    problem.evaluate::<true>(Some(scaled), workspace, &mut fit).ok()?;
    fit
}
