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
        let row = row.get(..len).unwrap_or(row);
        let (groups, rest) = row.as_chunks::<4>();
        let mut bits = 0;
        for byte in rest.iter().rev() {
            bits = (bits << 1) | u64::from(*byte != 0);
        }
        for group in groups.iter().rev() {
            bits = (bits << 4) | u64::from(nonzero(u32::from_le_bytes(*group)));
        }
        bits
    }
}

/// A bit for each of four bytes, set where it is not zero.
const fn nonzero(bytes: u32) -> u32 {
    const LOW: u32 = 0x7f7f_7f7f;
    // The highest bit of a byte: its own, or the carry of its others.
    let high = (((bytes & LOW) + LOW) | bytes) & !LOW;
    // Bit 7 of byte i becomes bit 28 + i; no two of the products' bits meet.
    (high >> 7).wrapping_mul(0x1020_4080) >> 28
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn a_bit_is_a_byte_that_is_not_zero() {
        let mut rng = Rng::new(4);
        let bytes: [u8; 200] = core::array::from_fn(|_| [0, 1, 0x7f, 0x80, 0xff][rng.below(5) as usize]);
        for x in 0..130 {
            for len in [0, 1, 7, 8, 9, 63, 64] {
                let mask = Mask::new(&bytes, 200, 1, 200).unwrap();
                let wanted =
                    (0..len).filter(|i| mask.contains(x + i, 0)).fold(0_u64, |bits, i| bits | 1 << i);
                assert_eq!(mask.bits(x, 0, len), wanted, "{x} {len}");
            }
        }
    }
}
