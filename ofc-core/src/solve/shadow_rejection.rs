//! A second fit, without the colors that a light does not reach.

use super::parameters::Params;
use super::solution::Solution;
use crate::color::ellipsoid::Coefficients;
use crate::color::inliers::Inliers;
use crate::color::lmeds::{self, Fit};
use crate::color::shadows;
use crate::picture::Pixels;
use crate::picture::Usable;

/// Times that shadows are looked for: an ellipsoid that they no longer bend shows more of them.
const ROUNDS: usize = 2;

/// At least one in so many pixels is lit by all three lights.
const SMALLEST_SHARE: usize = 3;

impl Solution {
    /// Looks for shadows, and where there are any replaces the fit, which is there, and the usable pixels. Of a sample, the
    /// pixel counts says how many that makes of all.
    ///
    /// # Scratch
    /// Two `f32` a pixel.
    #[inline(never)]
    pub(crate) fn reject_shadows(&mut self, pixels: &impl Pixels, params: &Params, workspace: &mut [f32]) {
        let count = self.fit.as_ref().map_or(0, |fit| fit.usable);
        let mut left = count;
        for _ in 0..ROUNDS {
            let Some(fewer) = self.leave_out_faces(pixels, count, &params.lmeds, workspace) else { break };
            left = fewer;
        }
        let usable = self.pixel_counts.usable;
        self.pixel_counts.shaded = ((count - left) as u64 * usable as u64 / count.max(1) as u64) as usize;
        self.pixel_counts.usable = usable - self.pixel_counts.shaded;
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
        let room = workspace.get_mut(..2 * count)?;
        let faces = shadows::find(pixels, usable, count, fit.band, fit.noise_deviation, params.seed, room)?;
        let (z, mut refit) = (fit.z(), None);
        let lit = Usable { shadow_faces: faces, ..usable };
        let mut left = self.refit(pixels, lit, z, params, workspace, &mut refit)?;
        let confirmed = Usable {
            shadow_faces: shadows::confirmed(&faces, pixels, usable, refit.as_ref()?.band)?,
            ..usable
        };
        if confirmed != lit {
            left = self.refit(pixels, confirmed, z, params, workspace, &mut refit)?;
        }
        if SMALLEST_SHARE * left < count {
            return None;
        }
        self.fit = refit;
        self.inliers.usable = confirmed;
        Some(left)
    }

    /// Puts the fit that begins at `z` into `out`, and says how many pixels it is of.
    #[inline(never)]
    fn refit(
        &self,
        pixels: &impl Pixels,
        usable: Usable,
        z: Coefficients,
        params: &lmeds::Params,
        workspace: &mut [f32],
        out: &mut Option<Fit>,
    ) -> Option<usize> {
        let count = Inliers::all(usable).count(pixels);
        let scale = lmeds::reciprocal_power_of_two(self.pixel_counts.largest);
        if count < lmeds::MIN_PIXELS {
            return None;
        }
        // The band is about the z that it begins at: once more about its own.
        let mut z = z;
        for _ in 0..2 {
            let scaled = z.map(|c| c / (scale * scale));
            lmeds::evaluate::<true>(pixels, usable, count, scale, Some(scaled), params, workspace, out)
                .ok()?;
            z = out.as_ref()?.z();
        }
        Some(count)
    }
}
