//! Views over the caller's pixels: checked once when made, then safe to read.
//!
//! Every layout is three strided channels over bytes: interleaved formats are planes whose pixels lie further apart,
//! and BGR differs from RGB only in where its channels begin. Pixels may have any alignment; u16 and f32 are in the
//! machine's byte order.

use crate::pixels::Pixels;
use crate::shadows::Shadows;

/// The largest number of pixels in a picture, 2^31 - 1: sums and indices stay far from their limits.
pub const MAX_PIXELS: usize = i32::MAX as usize;

/// Pixels read at a time, one bit of a [`Window`]'s masks each.
pub const WINDOW: usize = u64::BITS as usize;

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

/// One byte a pixel, zero meaning "leave this pixel out".
#[derive(Clone, Copy, Debug)]
pub struct Mask<'a> {
    bytes: &'a [u8],
    row_stride: usize,
}

impl<'a> Mask<'a> {
    /// A view of `width` x `height` bytes, rows `row_stride` bytes apart.
    ///
    /// # Errors
    /// As [`span`], and [`ImageError::TooShort`].
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

/// A picture: three channels r, g, b over borrowed bytes, and an optional mask.
///
/// # Shape
/// `width` x `height`, row 0 at the top.
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
    /// As [`span`], and [`ImageError::TooShort`] when `bytes` ends before the last pixel.
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
    /// As [`span`], and [`ImageError::TooShort`] when a plane ends before its last pixel.
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
    /// As [`Mask::new`].
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
        for (channel, out) in self.channels.iter().zip(&mut window.color) {
            let bytes = channel.get(start..).unwrap_or_default();
            let out = out.get_mut(..len).unwrap_or_default();
            match (self.sample, self.pixel_stride) {
                (Sample::U8, 3) => read_bytes::<3>(bytes, out),
                (Sample::U8, 4) => read_bytes::<4>(bytes, out),
                (Sample::U8, _) => read_bytes::<1>(bytes, out),
                (Sample::U16, _) => {
                    read_samples(bytes, self.pixel_stride, out, |b| f32::from(u16::from_ne_bytes(b)));
                }
                (Sample::F32, _) => read_samples(bytes, self.pixel_stride, out, f32::from_ne_bytes),
            }
        }
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
}

/// Every `STRIDE`th byte, as many as `out` holds.
fn read_bytes<const STRIDE: usize>(bytes: &[u8], out: &mut [f32]) {
    let (pixels, last) = bytes.as_chunks::<STRIDE>();
    for (pixel, out) in pixels.iter().zip(out.iter_mut()) {
        if let Some(&sample) = pixel.first() {
            *out = f32::from(sample);
        }
    }
    if let (Some(&sample), Some(out)) = (last.first(), out.get_mut(pixels.len())) {
        *out = f32::from(sample);
    }
}

/// Every `stride` bytes one sample, as many as `out` holds.
fn read_samples<const N: usize>(bytes: &[u8], stride: usize, out: &mut [f32], load: impl Fn([u8; N]) -> f32) {
    for (pixel, out) in bytes.chunks(stride.max(1)).zip(out) {
        if let Some(&sample) = pixel.first_chunk::<N>() {
            *out = load(sample);
        }
    }
}

/// Up to [`WINDOW`] neighbouring pixels of one row, channels apart, with a bit a pixel for sets of them.
#[derive(Clone, Debug)]
pub struct Window {
    /// Column of the first pixel.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// How many pixels there are.
    pub len: usize,
    /// The channels r, g, b; values beyond `len` mean nothing.
    pub color: [[f32; WINDOW]; 3],
    /// A bit a pixel: in the picture and its mask.
    pub masked: u64,
}

impl Default for Window {
    fn default() -> Self {
        Self::new()
    }
}

impl Window {
    /// An empty window.
    #[must_use]
    pub const fn new() -> Self {
        Self { x: 0, y: 0, len: 0, color: [[0.0; WINDOW]; 3], masked: 0 }
    }

    /// Pixel `i` as a color, black beyond the window.
    #[must_use]
    #[inline]
    pub fn pixel(&self, i: usize) -> [f32; 3] {
        let [red, green, blue] = &self.color;
        match (red.get(i), green.get(i), blue.get(i)) {
            (Some(&r), Some(&g), Some(&b)) => [r, g, b],
            _ => [0.0; 3],
        }
    }

    /// A bit a pixel, set where `holds` says so of its color; bits beyond `len` mean nothing.
    #[inline]
    pub fn bits(&self, mut holds: impl FnMut(f32, f32, f32) -> bool) -> u64 {
        // Halves, because a bit of 32 is made where a color of 32 bits is compared.
        const HALF: usize = WINDOW / 2;
        let [red, green, blue] = self.color.each_ref().map(|channel| channel.as_chunks::<HALF>().0);
        let mut bits = 0;
        for (k, ((red, green), blue)) in red.iter().zip(green).zip(blue).enumerate() {
            let mut half = 0_u32;
            for (i, ((&r, &g), &b)) in red.iter().zip(green).zip(blue).enumerate() {
                half |= u32::from(holds(r, g, b)) << i;
            }
            bits |= u64::from(half) << (k * HALF);
        }
        bits
    }
}

/// The first `count` bits of a window.
pub(crate) const fn first_bits(count: usize) -> u64 {
    if count < WINDOW { (1 << count) - 1 } else { u64::MAX }
}

/// Visits the set bits of `bits`, lowest first.
#[inline]
pub fn for_each_bit(mut bits: u64, mut visit: impl FnMut(usize)) {
    while bits != 0 {
        visit(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

/// Which pixels of a picture a method may use at all: in the mask, finite, not black, not saturated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Usable {
    /// A pixel is saturated if any of its channels is at or above this.
    pub saturation: f32,
    /// Colors that a light does not reach.
    pub shadows: Shadows,
}

impl Usable {
    /// Without shadows.
    #[must_use]
    pub const fn below(saturation: f32) -> Self {
        Self { saturation, shadows: Shadows::NONE }
    }

    /// The bits of `window`'s usable pixels.
    #[must_use]
    pub fn bits(&self, window: &Window) -> u64 {
        self.shadows.lit(window, self.exposed(window))
    }

    /// Those with shaded ones among them.
    #[must_use]
    #[inline(never)]
    pub fn exposed(&self, window: &Window) -> u64 {
        // Floats are in the order of their bits as integers with a sign, but for negative ones, and what is not finite
        // has the largest bits of its sign.
        const NEGATIVE_INFINITY: u32 = f32::NEG_INFINITY.to_bits();
        let limit = if self.saturation > 0.0 { self.saturation.to_bits() } else { 0 };
        window.masked
            & window.bits(|r, g, b| {
                let colors = [r, g, b].map(f32::to_bits);
                let [r, g, b] = colors.map(u32::cast_signed);
                let largest = r.max(g).max(b);
                let [r, g, b] = colors;
                (largest > 0) & (largest < limit.cast_signed()) & (r.max(g).max(b) < NEGATIVE_INFINITY)
            })
    }

    /// Counts the pixels of a picture by what becomes of them.
    #[must_use]
    pub fn count(&self, image: &Image) -> Census {
        let mut census = Census::default();
        image.for_each_window(|window| {
            self.count_window(window, &mut census);
        });
        census
    }

    /// Adds the pixels of one window to a census, and returns the bits of the usable ones.
    pub fn count_window(&self, window: &Window, census: &mut Census) -> u64 {
        let usable = self.bits(window);
        census.usable += usable.count_ones() as usize;
        census.masked_out += window.len - window.masked.count_ones() as usize;
        for_each_bit(window.masked & !usable, |i| {
            let [r, g, b] = window.pixel(i);
            let brightest = r.max(g).max(b);
            if !(r.is_finite() && g.is_finite() && b.is_finite()) {
                census.non_finite += 1;
            } else if brightest <= 0.0 {
                census.dark += 1;
            } else if brightest >= self.saturation {
                census.saturated += 1;
            } else {
                census.shaded += 1;
            }
        });
        let mut largest = census.largest.to_bits();
        for_each_bit(usable, |i| {
            let [r, g, b] = window.pixel(i);
            // Finite floats without a sign are in the order of their bits.
            let [r, g, b] = [r.abs().to_bits(), g.abs().to_bits(), b.abs().to_bits()];
            largest = largest.max(r).max(g).max(b);
        });
        census.largest = f32::from_bits(largest);
        usable
    }
}

/// What becomes of the pixels of a picture before any fit; the counts add up to all its pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Census {
    /// Pixels that a method may use.
    pub usable: usize,
    /// Left out by the mask.
    pub masked_out: usize,
    /// NaN or infinite in a channel.
    pub non_finite: usize,
    /// Zero (or negative) in all channels.
    pub dark: usize,
    /// At or above the saturation threshold in a channel.
    pub saturated: usize,
    /// In the shadow of one of the lights, see [`crate::shadows`].
    pub shaded: usize,
    /// The largest absolute channel value of the usable pixels.
    pub largest: f32,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    #[test]
    fn usable_is_what_the_comparisons_say() {
        let special =
            [0.0, -0.0, 1e-45, -1e-45, 1.0, -1.0, 254.9, 255.0, f32::MAX, f32::MIN, f32::NAN, -f32::NAN];
        let infinite =
            [f32::INFINITY, f32::NEG_INFINITY, f32::from_bits(0x7f80_0001), f32::from_bits(0xff80_0001)];
        let values: std::vec::Vec<f32> = special.into_iter().chain(infinite).collect();
        let mut rng = Rng::new(2);
        for saturation in [255.0, 1e-45, f32::MAX, f32::INFINITY, 0.0, -1.0, f32::NAN] {
            for _ in 0..200 {
                let mut window = Window::new();
                window.masked = rng.next_u64() | rng.next_u64();
                for channel in &mut window.color {
                    channel.fill_with(|| values[rng.below(values.len() as u32) as usize]);
                }
                let bits = Usable::below(saturation).bits(&window);
                for i in 0..WINDOW {
                    let color = window.pixel(i);
                    let expected = window.masked >> i & 1 == 1
                        && color.iter().all(|c| c.is_finite() && *c < saturation)
                        && color.iter().any(|&c| c > 0.0);
                    assert_eq!(bits >> i & 1 == 1, expected, "{color:?} below {saturation}");
                }
            }
        }
    }
}
