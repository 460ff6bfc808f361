//! Views over the caller's pixels: checked once when made, then safe to read.
//!
//! Every layout is three strided channels over bytes: interleaved formats are planes whose pixels lie further apart,
//! and BGR differs from RGB only in where its channels begin. Pixels may have any alignment; u16 and f32 are in the
//! machine's byte order.

use super::layout::{ImageError, Order, Sample, span};
use super::mask::Mask;
use super::pixels::Pixels;
use super::window::{WINDOW, Window, first_bits};

/// A picture: three channels r, g, b over borrowed bytes, and an optional mask.
///
/// # Shape
/// `width` x `height`, row 0 at the top.
///
/// # Example
/// A region of interest of a larger picture, in `OpenCV`'s order, and three gray pictures as one:
/// ```
/// use ofc_core::{Image, Order, Sample};
///
/// let (width, height, large) = (64, 48, vec![0_u8; 3 * 640 * 480]);
/// let region = Image::interleaved(&large[3 * (100 * 640 + 50)..], width, height, 3 * 640, Sample::U8, Order::Bgr).unwrap();
/// assert_eq!((region.width(), region.height()), (64, 48));
///
/// let gray = vec![0_u8; 64 * 48];
/// assert!(Image::planes([&gray, &gray, &gray], width, height, width, Sample::U8).is_ok());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    channels: [&'a [u8]; 3],
    sample: Sample,
    pixel_stride: usize,
    row_stride: usize,
    width: usize,
    height: usize,
    mask: Option<Mask<'a>>,
}

impl<'a> Image<'a> {
    /// A view of interleaved pixels, rows `row_stride` bytes apart.
    ///
    /// # Errors
    /// What [`span`] refuses, and [`ImageError::TooShort`] when `bytes` ends before the last pixel.
    pub fn interleaved(
        bytes: &'a [u8],
        width: usize,
        height: usize,
        row_stride: usize,
        sample: Sample,
        order: Order,
    ) -> Result<Self, ImageError> {
        let pixel_stride = order.samples() * sample.bytes();
        let need = span(width, height, pixel_stride, row_stride)?;
        let bytes = bytes.get(..need).ok_or(ImageError::TooShort)?;
        let channels = order.positions().map(|p| bytes.get(p * sample.bytes()..).unwrap_or_default());
        Ok(Self { channels, sample, pixel_stride, row_stride, width, height, mask: None })
    }

    /// A view of three separate planes r, g, b with one row stride, such as three grayscale photographs under three
    /// lights.
    ///
    /// # Errors
    /// What [`span`] refuses, and [`ImageError::TooShort`] when a plane ends before its last pixel.
    pub fn planes(
        planes: [&'a [u8]; 3],
        width: usize,
        height: usize,
        row_stride: usize,
        sample: Sample,
    ) -> Result<Self, ImageError> {
        let need = span(width, height, sample.bytes(), row_stride)?;
        if planes.iter().any(|plane| plane.len() < need) {
            return Err(ImageError::TooShort);
        }
        let pixel_stride = sample.bytes();
        Ok(Self { channels: planes, sample, pixel_stride, row_stride, width, height, mask: None })
    }

    /// The same picture restricted to the pixels where `mask`, tightly packed or strided, is not zero.
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

    /// How samples are stored.
    #[must_use]
    pub const fn sample(&self) -> Sample {
        self.sample
    }

    /// Row `y` alone, with its mask, as a picture of height 1; `None` below the last row.
    #[must_use]
    pub fn row(&self, y: usize) -> Option<Self> {
        if y >= self.height {
            return None;
        }
        let start = y * self.row_stride;
        let channels = self.channels.map(|channel| channel.get(start..).unwrap_or_default());
        let mask = self.mask.map(|mask| Mask {
            bytes: mask.bytes.get(y * mask.row_stride..).unwrap_or_default(),
            row_stride: mask.row_stride,
        });
        Some(Self { channels, height: 1, mask, ..*self })
    }

    /// Every `step`th row, the first one to begin with, with its mask, as a picture.
    #[must_use]
    pub fn rows_apart(&self, step: usize) -> Self {
        let step = step.min(self.height).max(1);
        let apart = |stride: usize| stride.saturating_mul(step);
        let mask = self.mask.map(|mask| Mask { row_stride: apart(mask.row_stride), ..mask });
        let (height, row_stride) = (self.height.div_ceil(step), apart(self.row_stride));
        Self { row_stride, height, mask, ..*self }
    }

    /// How far apart the rows of a sample may be: some 65,536 pixels, or 64 rows, say of a larger picture what it is like.
    #[must_use]
    pub fn sample_step(&self) -> usize {
        const ENOUGH_PIXELS: usize = 1 << 16;
        const ENOUGH_ROWS: usize = 64;
        (self.width * self.height / ENOUGH_PIXELS).min(self.height / ENOUGH_ROWS).max(1)
    }

    /// Those rows: the whole of a small picture, and a sample of a larger one.
    #[must_use]
    pub fn sample_rows(&self) -> Self {
        self.rows_apart(self.sample_step())
    }

    /// The `width` x `height` pixels from column `x` and row `y` on, with their mask, as a picture; `None` where they are none
    /// or not all within this one.
    #[must_use]
    pub fn crop(&self, [x, y]: [usize; 2], [width, height]: [usize; 2]) -> Option<Self> {
        let fits = |start: usize, len: usize, all: usize| {
            len > 0 && start.checked_add(len).is_some_and(|end| end <= all)
        };
        if !(fits(x, width, self.width) && fits(y, height, self.height)) {
            return None;
        }
        let start = y * self.row_stride + x * self.pixel_stride;
        let channels = self.channels.map(|channel| channel.get(start..).unwrap_or_default());
        let mask = self.mask.map(|mask| Mask {
            bytes: mask.bytes.get(y * mask.row_stride + x..).unwrap_or_default(),
            row_stride: mask.row_stride,
        });
        Some(Self { channels, width, height, mask, ..*self })
    }

    /// Reads up to [`WINDOW`] pixels of row `y` from column `x` on, fewer at the end of the row and none beyond the
    /// picture.
    pub fn read(&self, x: usize, y: usize, window: &mut Window) {
        let len = if y < self.height { self.width.saturating_sub(x).min(WINDOW) } else { 0 };
        window.x = x;
        window.y = y;
        window.len = len;
        window.masked = first_bits(len);
        if len == 0 {
            return;
        }
        if let Some(mask) = &self.mask {
            window.masked &= mask.bits(x, y, len);
        }
        let start = y * self.row_stride + x * self.pixel_stride;
        let channels = self.channels.map(|channel| channel.get(start..).unwrap_or_default());
        if let (Sample::U8, 3 | 4) = (self.sample, self.pixel_stride) {
            return read_pixels(channels, self.pixel_stride, len, window);
        }
        if let (Sample::F32, FLOATS) = (self.sample, self.pixel_stride) {
            return read_floats(channels, len, window);
        }
        for (bytes, out) in channels.iter().zip(&mut window.color) {
            let out = out.get_mut(..len).unwrap_or_default();
            match self.sample {
                Sample::U8 => read_samples(bytes, 1, out, |[byte]| f32::from(byte)),
                Sample::U16 => {
                    read_samples(bytes, self.pixel_stride, out, |b| f32::from(u16::from_ne_bytes(b)));
                }
                Sample::F32 => read_samples(bytes, self.pixel_stride, out, f32::from_ne_bytes),
            }
        }
    }

    /// The bits of the up to [`WINDOW`] pixels of row `y` from column `x` on that are in the picture and its mask, without reading them.
    pub(crate) fn masked(&self, x: usize, y: usize) -> u64 {
        let len = if y < self.height { self.width.saturating_sub(x).min(WINDOW) } else { 0 };
        self.mask.map_or(u64::MAX, |mask| mask.bits(x, y, len)) & first_bits(len)
    }

    /// Calls `visit` with the whole picture, [`WINDOW`] pixels at a time, top row first.
    pub fn for_each_window(&self, mut visit: impl FnMut(&Window)) {
        let mut window = Window::new();
        for y in 0..self.height {
            for x in (0..self.width).step_by(WINDOW) {
                self.read(x, y, &mut window);
                visit(&window);
            }
        }
    }
}

impl Pixels for Image<'_> {
    fn for_each_window(&self, visit: impl FnMut(&Window)) {
        self.for_each_window(visit);
    }

    fn sample(&self) -> Sample {
        self.sample
    }

    fn len(&self) -> usize {
        self.width * self.height
    }

    fn of_part<R>(&self, visit: impl FnOnce(&Self) -> R) -> R {
        visit(&self.sample_rows())
    }
}

/// Pixels of three or four bytes, `len` of them at least if there are so many: a word each, which holds its three channels, and from
/// the words each channel at once.
fn read_pixels(channels: [&[u8]; 3], stride: usize, len: usize, window: &mut Window) {
    let [red, _, blue] = channels;
    let (pixels, shifts) = if red.len() >= blue.len() { (red, [0, 8, 16]) } else { (blue, [16, 8, 0]) };
    let mut words = [0_u32; WINDOW];
    if stride == 4 {
        for (pixel, word) in pixels.as_chunks().0.iter().zip(&mut words) {
            *word = u32::from_le_bytes(*pixel);
        }
    } else if len == WINDOW
        && let Some(pixels) = pixels.get(..3 * WINDOW + 1)
    {
        // The compiler knows that all of these words are within.
        for (i, word) in words.iter_mut().enumerate() {
            if let Some(bytes) = pixels.get(i * 3..).and_then(<[u8]>::first_chunk) {
                *word = u32::from_le_bytes(*bytes);
            }
        }
    } else {
        for (&[a, b, c], word) in pixels.as_chunks().0.iter().zip(&mut words) {
            *word = u32::from_le_bytes([a, b, c, 0]);
        }
    }
    for (channel, shift) in window.color.iter_mut().zip(shifts) {
        for (value, word) in channel.iter_mut().zip(&words) {
            // A number below 256 is one with a sign, which vector instructions convert.
            *value = (word >> shift & 255).cast_signed() as f32;
        }
    }
}

/// Bytes of a pixel of three floats.
const FLOATS: usize = 12;

/// Pixels of three floats, `len` of them at most, all channels at once.
fn read_floats(channels: [&[u8]; 3], len: usize, window: &mut Window) {
    let [red, _, blue] = channels;
    let [first, second, third] = &mut window.color;
    let (pixels, first, third) =
        if red.len() >= blue.len() { (red, first, third) } else { (blue, third, first) };
    let out = first.iter_mut().zip(second).zip(third).take(len);
    for (&[a, b, c, d, e, f, g, h, i, j, k, l], ((first, second), third)) in
        pixels.as_chunks::<FLOATS>().0.iter().zip(out)
    {
        *first = f32::from_ne_bytes([a, b, c, d]);
        *second = f32::from_ne_bytes([e, f, g, h]);
        *third = f32::from_ne_bytes([i, j, k, l]);
    }
}

/// Every `stride` bytes one sample, as many as `out` holds.
fn read_samples<const N: usize>(bytes: &[u8], stride: usize, out: &mut [f32], load: impl Fn([u8; N]) -> f32) {
    let mut rest = bytes;
    for value in out {
        let Some(sample) = rest.first_chunk() else { return };
        *value = load(*sample);
        rest = rest.get(stride..).unwrap_or_default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn a_part_is_what_the_whole_holds_there() {
        let bytes: Vec<u8> = (0..7 * 40).collect::<Vec<usize>>().iter().map(|&i| i as u8).collect();
        let mask: Vec<u8> = (0..70).map(|i| u8::from(i % 3 > 0)).collect();
        let image = Image::interleaved(&bytes, 10, 7, 40, Sample::U8, Order::Bgra)
            .and_then(|image| image.with_mask(&mask, 10))
            .unwrap();
        let part = image.crop([4, 2], [5, 3]).unwrap();
        assert_eq!((part.width(), part.height()), (5, 3));
        let (mut whole, mut own) = (Window::new(), Window::new());
        for row in 0..3 {
            image.read(4, 2 + row, &mut whole);
            part.read(0, row, &mut own);
            assert_eq!((own.len, own.masked), (5, whole.masked & 0b1_1111));
            for i in 0..5 {
                assert_eq!(own.pixel(i), whole.pixel(i));
            }
        }
        for (corner, size) in [
            ([6, 2], [5, 3]),
            ([4, 5], [5, 3]),
            ([4, 2], [0, 3]),
            ([4, 2], [5, 0]),
            ([usize::MAX, 2], [5, 3]),
        ] {
            assert!(image.crop(corner, size).is_none());
        }
        assert!(image.crop([0, 0], [10, 7]).is_some());
    }

    #[test]
    fn rows_apart_are_those_rows() {
        let bytes: Vec<u8> = (0..7 * 40).collect::<Vec<usize>>().iter().map(|&i| i as u8).collect();
        let mask: Vec<u8> = (0..70).map(|i| u8::from(i % 3 > 0)).collect();
        let image = Image::interleaved(&bytes, 10, 7, 40, Sample::U8, Order::Bgra)
            .and_then(|image| image.with_mask(&mask, 10))
            .unwrap();
        let (mut whole, mut own) = (Window::new(), Window::new());
        for (step, height) in [(0, 7), (1, 7), (2, 4), (3, 3), (6, 2), (7, 1), (usize::MAX, 1)] {
            let rows = image.rows_apart(step);
            assert_eq!((rows.width(), rows.height()), (10, height));
            for row in 0..height {
                image.read(0, row * step.clamp(1, 7), &mut whole);
                rows.read(0, row, &mut own);
                assert_eq!(
                    (own.masked, own.pixel(3), own.pixel(9)),
                    (whole.masked, whole.pixel(3), whole.pixel(9))
                );
            }
        }
    }
}
