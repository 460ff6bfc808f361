//! How pixels lie in memory, and whether a buffer is long enough for them.

use core::fmt;

/// The largest number of pixels in a picture, 2^31 - 1: sums and indices stay far from their limits.
pub const MAX_PIXELS: usize = i32::MAX as usize;

/// How one channel of one pixel is stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// Unsigned 8-bit.
    U8,
    /// Unsigned 16-bit, machine byte order.
    U16,
    /// 32-bit IEEE float, machine byte order.
    F32,
}

impl Sample {
    /// Bytes of one sample.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            Self::F32 => 4,
        }
    }

    /// The value at which a channel of this type saturates unless the caller says otherwise: the largest there is.
    #[must_use]
    pub const fn saturation(self) -> f32 {
        match self {
            Self::U8 => u8::MAX as f32,
            Self::U16 => u16::MAX as f32,
            Self::F32 => f32::INFINITY,
        }
    }
}

/// The order of the samples within an interleaved pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Red, green, blue.
    Rgb,
    /// Blue, green, red, as `OpenCV` has it.
    Bgr,
    /// Red, green, blue and a fourth sample that is ignored.
    Rgba,
    /// Blue, green, red and a fourth sample that is ignored.
    Bgra,
}

impl Order {
    /// Samples of one pixel.
    #[must_use]
    pub const fn samples(self) -> usize {
        match self {
            Self::Rgb | Self::Bgr => 3,
            Self::Rgba | Self::Bgra => 4,
        }
    }

    pub(crate) const fn positions(self) -> [usize; 3] {
        match self {
            Self::Rgb | Self::Rgba => [0, 1, 2],
            Self::Bgr | Self::Bgra => [2, 1, 0],
        }
    }
}

/// Why a view cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageError {
    /// Width or height is zero.
    Empty,
    /// More than [`MAX_PIXELS`] pixels, or a size in bytes beyond the address space.
    TooLarge,
    /// The row stride is smaller than a row.
    StrideTooSmall,
    /// The buffer ends before the last row does.
    TooShort,
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("width or height is zero"),
            Self::TooLarge => {
                write!(f, "more than {MAX_PIXELS} pixels, or a size in bytes beyond the address space")
            }
            Self::StrideTooSmall => f.write_str("the row stride is smaller than a row"),
            Self::TooShort => f.write_str("the buffer ends before the last row does"),
        }
    }
}

impl core::error::Error for ImageError {}

/// Checks a width, height and row stride against each other, and returns the bytes from the first pixel to the end
/// of the last row.
///
/// # Errors
/// [`ImageError::Empty`], [`ImageError::TooLarge`] or [`ImageError::StrideTooSmall`].
pub const fn span(
    width: usize,
    height: usize,
    pixel_bytes: usize,
    row_stride: usize,
) -> Result<usize, ImageError> {
    if width == 0 || height == 0 {
        return Err(ImageError::Empty);
    }
    let (Some(pixels), Some(row)) = (width.checked_mul(height), width.checked_mul(pixel_bytes)) else {
        return Err(ImageError::TooLarge);
    };
    if pixels > MAX_PIXELS {
        return Err(ImageError::TooLarge);
    }
    if row_stride < row {
        return Err(ImageError::StrideTooSmall);
    }
    let Some(rows) = row_stride.checked_mul(height - 1) else { return Err(ImageError::TooLarge) };
    match rows.checked_add(row) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(bytes),
        _ => Err(ImageError::TooLarge),
    }
}
