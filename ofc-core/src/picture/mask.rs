//! A view over one byte a pixel that says which pixels are meant.

use super::layout::{ImageError, span};

/// One byte a pixel, zero meaning "leave this pixel out".
#[derive(Clone, Copy, Debug)]
pub struct Mask<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) row_stride: usize,
}

impl<'a> Mask<'a> {
    /// A view of `width` x `height` bytes, rows `row_stride` bytes apart.
    ///
    /// # Errors
    /// What [`span`] refuses, and [`ImageError::TooShort`] when `bytes` ends before the last pixel.
    pub fn new(bytes: &'a [u8], width: usize, height: usize, row_stride: usize) -> Result<Self, ImageError> {
        let need = span(width, height, 1, row_stride)?;
        let bytes = bytes.get(..need).ok_or(ImageError::TooShort)?;
        Ok(Self { bytes, row_stride })
    }

    /// Whether the pixel at `(x, y)`, which must be within the width, is selected.
    pub(crate) fn contains(&self, x: usize, y: usize) -> bool {
        self.bytes.get(y * self.row_stride + x).is_some_and(|&byte| byte != 0)
    }

    /// One bit a pixel for the `len` pixels from `(x, y)` on, set where the mask is not zero.
    pub(crate) fn bits(&self, x: usize, y: usize, len: usize) -> u64 {
        let row = self.bytes.get(y * self.row_stride + x..).unwrap_or_default();
        let mut bits = 0;
        for (i, &byte) in row.iter().take(len).enumerate() {
            bits |= u64::from(byte != 0) << i;
        }
        bits
    }
}
