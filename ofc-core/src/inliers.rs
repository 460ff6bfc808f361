//! The pixels that obey the model, as a pure function of their color.
//!
//! Both rejections of the paper ask how far rho^T C rho is from where it should be, so each is a band of values; no
//! mask needs to be kept, and the test can be applied to the next frame of a video just as well.
//!
//! # Reference
//! Section 2.2.

use crate::ellipsoid::{Coefficients, quadratic_form};
use crate::image::{Image, Usable, Window};
use crate::location::Location;
use crate::pixels::Pixels;

/// Deviations below this are rounding of f32 colors: an exact fit accepts them all.
const EXACT_FIT: f64 = 1e-5;

/// Colors for which `low <= rho^T C rho <= high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// C.
    pub form: Coefficients,
    /// Smallest accepted value.
    pub low: f64,
    /// Largest accepted value.
    pub high: f64,
}

impl Band {
    /// The band that every finite color lies in.
    pub const EVERYTHING: Self = Self { form: [0.0; 6], low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// The band that no color lies in.
    pub const NOTHING: Self = Self { form: [0.0; 6], low: f64::INFINITY, high: f64::NEG_INFINITY };

    /// Colors whose residual rho^T C rho - 1 is within `rejection` dispersions of zero: the first rejection.
    #[must_use]
    pub fn residual(form: Coefficients, dispersion: f64, rejection: f64) -> Self {
        let limit = (rejection * dispersion).max(EXACT_FIT);
        Self { form, low: 1.0 - limit, high: 1.0 + limit }
    }

    /// Colors whose normal, of length sqrt(rho^T C rho), is within `rejection` dispersions of the location of the
    /// lengths: the second rejection.
    #[must_use]
    pub fn norm(form: Coefficients, lengths: &Location, rejection: f64) -> Self {
        let limit = (rejection * lengths.dispersion).max(EXACT_FIT);
        let low = (lengths.location - limit).max(0.0);
        let high = lengths.location + limit;
        Self { form, low: low * low, high: high * high }
    }

    #[inline]
    fn contains(&self, r: f32, g: f32, b: f32) -> bool {
        let value = quadratic_form(&self.form, r, g, b);
        value >= self.low && value <= self.high
    }
}

/// Usable colors inside the bands of both rejections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inliers {
    /// Which pixels can be used at all.
    pub usable: Usable,
    /// The rejection by residual, under the C that the least median of squares found.
    pub residual: Band,
    /// The rejection by the length of the normal, under the C of the reweighted fit.
    pub norm: Band,
}

impl Inliers {
    /// Every usable pixel.
    #[must_use]
    pub const fn all(usable: Usable) -> Self {
        Self { usable, residual: Band::EVERYTHING, norm: Band::EVERYTHING }
    }

    /// No pixel.
    #[must_use]
    pub const fn none(usable: Usable) -> Self {
        Self { usable, residual: Band::NOTHING, norm: Band::NOTHING }
    }

    /// The bits of `window`'s inliers.
    #[must_use]
    #[inline]
    pub fn bits(&self, window: &Window) -> u64 {
        let usable = self.usable.bits(window);
        if usable == 0 {
            return 0;
        }
        usable & window.bits(|r, g, b| self.residual.contains(r, g, b) & self.norm.contains(r, g, b))
    }

    /// How many inliers `pixels` hold.
    #[must_use]
    pub fn count(&self, pixels: &impl Pixels) -> usize {
        let mut count = 0;
        pixels.for_each_window(|window| count += self.bits(window).count_ones() as usize);
        count
    }

    /// Writes 255 for every inlier of `image` and 0 for every other pixel.
    ///
    /// # Shape
    /// `mask` is width x height, rows without gaps; what lies behind is left alone.
    pub fn mark(&self, image: &Image, mask: &mut [u8]) {
        image.for_each_window(|window| {
            let bits = self.bits(window);
            let row = mask.get_mut(window.y * image.width() + window.x..).unwrap_or_default();
            for (i, byte) in row.iter_mut().take(window.len).enumerate() {
                *byte = if bits >> i & 1 == 1 { u8::MAX } else { 0 };
            }
        });
    }
}
