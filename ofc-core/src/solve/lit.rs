//! A second fit, without the colors that a light does not reach.

use super::{Params, Solution};
use crate::ellipsoid::Coefficients;
use crate::image::{Image, Usable};
use crate::inliers::Inliers;
use crate::lmeds::{self, Fit};
use crate::shadows;

/// Times that shadows are looked for: an ellipsoid that they no longer bend shows more of them.
const ROUNDS: usize = 2;

/// At least one in so many pixels is lit by all three lights.
const SMALLEST_SHARE: usize = 3;

impl Solution {
    /// Looks for shadows, and where there are any replaces the fit, which is there, and the usable pixels.
    ///
    /// # Scratch
    /// As the fit.
    #[inline(never)]
    pub(super) fn leave_out_shadows(&mut self, image: &Image, params: &Params, workspace: &mut [f32]) {
        let count = self.fit.as_ref().map_or(0, |fit| fit.usable);
        let mut left = count;
        for _ in 0..ROUNDS {
            let Some(fewer) = self.leave_out_faces(image, count, &params.lmeds, workspace) else { break };
            left = fewer;
        }
        self.census.usable = left;
        self.census.shaded = count - left;
    }

    /// One round over the `count` pixels that are usable but for shadows: how many are lit; `None`, with nothing done, where
    /// there are no shadows.
    fn leave_out_faces(
        &mut self,
        image: &Image,
        count: usize,
        params: &lmeds::Params,
        workspace: &mut [f32],
    ) -> Option<usize> {
        let fit = self.fit.as_ref()?;
        let usable = Usable::below(self.inliers.usable.saturation);
        let shadows =
            shadows::find(image, usable, count, fit.band, fit.noise_deviation, params.seed, workspace)?;
        let (z, mut refit) = (fit.z(), None);
        let lit = Usable { shadows, ..usable };
        let mut left = self.refit(image, lit, z, params, workspace, &mut refit)?;
        let confirmed = Usable { shadows: shadows.confirmed(image, usable, refit.as_ref()?.band)?, ..usable };
        if confirmed != lit {
            left = self.refit(image, confirmed, z, params, workspace, &mut refit)?;
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
        image: &Image,
        usable: Usable,
        z: Coefficients,
        params: &lmeds::Params,
        workspace: &mut [f32],
        out: &mut Option<Fit>,
    ) -> Option<usize> {
        let count = Inliers::all(usable).count(image);
        let scale = lmeds::reciprocal_power_of_two(self.census.largest);
        if count < lmeds::MIN_PIXELS {
            return None;
        }
        // The band is about the z that it begins at: once more about its own.
        let mut z = z;
        for _ in 0..2 {
            let scaled = z.map(|c| c / (scale * scale));
            lmeds::judge::<true>(image, usable, count, scale, Some(scaled), params, workspace, out).ok()?;
            z = out.as_ref()?.z();
        }
        Some(count)
    }
}
