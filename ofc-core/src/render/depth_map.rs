//! A view over the caller's depth map, and the normals of its surface.

use crate::math::mat3;
use crate::picture::{ImageError, Mask, Sample, span};
use core::fmt;
use libm::sqrt;

/// Why a depth map's view cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthMapError {
    /// The sizes of the depths or the mask.
    Image(ImageError),
    /// The pixel pitch is not in [1e-30, 1e30].
    Pitch,
}

impl fmt::Display for DepthMapError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Image(error) => error.fmt(f),
            Self::Pitch => f.write_str("the pixel pitch is not in [1e-30, 1e30]"),
        }
    }
}

impl core::error::Error for DepthMapError {}

impl From<ImageError> for DepthMapError {
    fn from(error: ImageError) -> Self {
        Self::Image(error)
    }
}

/// Depths over borrowed bytes, f32 in the machine's byte order with any alignment, and an optional mask.
///
/// # Shape
/// `width` x `height`, row 0 at the top, rows `row_stride` bytes apart.
///
/// # Units
/// Depth grows toward the camera and has the unit of `pitch`, the distance between neighboring pixels. There is no surface
/// where the depth is not finite.
#[derive(Clone, Copy, Debug)]
pub struct DepthMap<'a> {
    bytes: &'a [u8],
    row_stride: usize,
    width: usize,
    height: usize,
    pitch: f64,
    mask: Option<Mask<'a>>,
}

impl<'a> DepthMap<'a> {
    /// A view of `width` x `height` depths.
    ///
    /// # Errors
    /// What [`span`] refuses, [`ImageError::TooShort`] when `bytes` ends before the last depth, and [`DepthMapError::Pitch`].
    pub fn new(
        bytes: &'a [u8],
        width: usize,
        height: usize,
        row_stride: usize,
        pitch: f64,
    ) -> Result<Self, DepthMapError> {
        let need = span(width, height, Sample::F32.bytes(), row_stride)?;
        let bytes = bytes.get(..need).ok_or(ImageError::TooShort)?;
        if !(1e-30..=1e30).contains(&pitch) {
            return Err(DepthMapError::Pitch);
        }
        Ok(Self { bytes, row_stride, width, height, pitch, mask: None })
    }

    /// The same surface restricted to the pixels where `mask` is not zero; depths elsewhere are never looked at.
    ///
    /// # Errors
    /// What [`Mask::new`] refuses.
    pub fn with_mask(self, bytes: &'a [u8], row_stride: usize) -> Result<Self, ImageError> {
        Ok(Self { mask: Some(Mask::new(bytes, self.width, self.height, row_stride)?), ..self })
    }

    /// Pixels in a row.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// The distance between neighboring pixels, in the unit of the depths.
    #[must_use]
    pub const fn pitch(&self) -> f64 {
        self.pitch
    }

    /// The depth at column `x` and row `y`; `None` outside the picture or the mask, or where it is not finite.
    #[must_use]
    #[inline]
    pub fn at(&self, x: usize, y: usize) -> Option<f64> {
        if x < self.width && y < self.height { self.inside(x, y) } else { None }
    }

    /// The depth at a pixel of the picture; `None` outside the mask, or where it is not finite.
    #[inline]
    pub(super) fn inside(&self, x: usize, y: usize) -> Option<f64> {
        self.given(x, y).filter(|z| z.is_finite())
    }

    /// The depth at a pixel of the picture, whatever it is; `None` outside the mask.
    #[inline]
    fn given(&self, x: usize, y: usize) -> Option<f64> {
        if self.mask.is_some_and(|mask| !mask.contains(x, y)) {
            return None;
        }
        let bytes = self.bytes.get(y * self.row_stride + x * Sample::F32.bytes()..)?;
        Some(f64::from(f32::from_ne_bytes(*bytes.first_chunk()?)))
    }

    /// The smallest and largest depth of the surface, (infinity, -infinity) where there is none; `None` when a depth is
    /// not finite.
    #[must_use]
    pub fn range(&self) -> Option<[f64; 2]> {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for y in 0..self.height {
            for x in 0..self.width {
                let Some(z) = self.given(x, y) else { continue };
                if !z.is_finite() {
                    return None;
                }
                low = low.min(z);
                high = high.max(z);
            }
        }
        Some([low, high])
    }

    /// The unit normal at column `x` and row `y`, n3 > 0; `None` outside the picture or the mask.
    ///
    /// p = -n1/n3 and q = -n2/n3 are central differences of the depth. Where one of the two neighbors is outside the
    /// picture or the mask the difference is one-sided, and where both are it is zero.
    #[must_use]
    #[inline]
    pub fn normal(&self, x: usize, y: usize) -> Option<[f64; 3]> {
        let here = self.at(x, y)?;
        let left = x.checked_sub(1).and_then(|x| self.at(x, y));
        let above = y.checked_sub(1).and_then(|y| self.at(x, y));
        let dx = difference(left, here, self.at(x + 1, y));
        let dy = difference(self.at(x, y + 1), here, above);
        let n = [-dx, -dy, self.pitch];
        Some(mat3::scale(n, 1.0 / sqrt(mat3::dot(n, n))))
    }
}

/// The difference of depth a pixel along an axis.
fn difference(before: Option<f64>, here: f64, after: Option<f64>) -> f64 {
    match (before, after) {
        (Some(before), Some(after)) => 0.5 * (after - before),
        (None, Some(after)) => after - here,
        (Some(before), None) => here - before,
        (None, None) => 0.0,
    }
}
