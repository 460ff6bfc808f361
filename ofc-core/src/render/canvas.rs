//! A picture that is written: the caller's pixels, checked once when the view is made.

use crate::picture::{ImageError, Order, Sample, span};
use libm::floor;

/// Interleaved pixels over borrowed bytes, of any alignment. u16 and f32 are in the machine's byte order.
///
/// # Shape
/// `width` x `height`, row 0 at the top, rows `row_stride` bytes apart; what lies between rows, and the fourth sample
/// of RGBA and BGRA, is left alone. `Image::interleaved` reads the same layout.
#[derive(Debug)]
pub struct Canvas<'a> {
    bytes: &'a mut [u8],
    row_stride: usize,
    width: usize,
    height: usize,
    sample: Sample,
    order: Order,
}

impl<'a> Canvas<'a> {
    /// A view of `width` x `height` pixels.
    ///
    /// # Errors
    /// What [`span`] refuses, and [`ImageError::TooShort`] when `bytes` ends before the last pixel.
    pub fn new(
        bytes: &'a mut [u8],
        width: usize,
        height: usize,
        row_stride: usize,
        sample: Sample,
        order: Order,
    ) -> Result<Self, ImageError> {
        let need = span(width, height, order.samples() * sample.bytes(), row_stride)?;
        let bytes = bytes.get_mut(..need).ok_or(ImageError::TooShort)?;
        Ok(Self { bytes, row_stride, width, height, sample, order })
    }

    /// Width and height.
    #[must_use]
    pub const fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Writes one pixel: integers are rounded, halves up, and limited to their range.
    pub(super) fn set(&mut self, x: usize, y: usize, color: [f64; 3]) {
        let step = self.sample.bytes();
        let start = y * self.row_stride + x * self.order.samples() * step;
        let Some(pixel) = self.bytes.get_mut(start..) else { return };
        for (value, position) in color.into_iter().zip(self.order.positions()) {
            let Some(out) = pixel.get_mut(position * step..(position + 1) * step) else { continue };
            match self.sample {
                Sample::U8 => copy(out, [quantized(value, u8::MAX.into()) as u8]),
                Sample::U16 => copy(out, quantized(value, u16::MAX.into()).to_ne_bytes()),
                Sample::F32 => copy(out, (value as f32).to_ne_bytes()),
            }
        }
    }
}

fn copy<const N: usize>(out: &mut [u8], bytes: [u8; N]) {
    for (out, byte) in out.iter_mut().zip(bytes) {
        *out = byte;
    }
}

#[allow(clippy::cast_sign_loss, reason = "limited to 0 and more")]
fn quantized(value: f64, largest: f64) -> u16 {
    // Not `clamp`, which panics where it cannot see that its limits are in order.
    floor(value + 0.5).max(0.0).min(largest) as u16
}
