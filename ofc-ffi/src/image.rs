//! The picture as C describes it.

use crate::prelude::*;
use ofc_core::color::inliers::Inliers;
use ofc_core::picture::{Image, MAX_PIXELS, Order, Sample, Usable, span};

/// How a picture stores its pixels: one of OFC_PIXEL_*. Samples of 16 bits and floats are in the machine's byte order.
pub type ofc_pixel_format = i32;

/// Interleaved red, green, blue of 8 bits each.
pub const OFC_PIXEL_RGB8: i32 = 1;
/// Interleaved blue, green, red of 8 bits each: OpenCV's CV_8UC3.
pub const OFC_PIXEL_BGR8: i32 = 2;
/// Interleaved red, green, blue and a sample that is ignored, of 8 bits each.
pub const OFC_PIXEL_RGBA8: i32 = 3;
/// Interleaved blue, green, red and a sample that is ignored, of 8 bits each: CV_8UC4.
pub const OFC_PIXEL_BGRA8: i32 = 4;
/// Three planes of 8 bits, such as three grayscale photographs under three lights.
pub const OFC_PIXEL_PLANES8: i32 = 5;
/// Interleaved red, green, blue of 16 bits each.
pub const OFC_PIXEL_RGB16: i32 = 11;
/// Interleaved blue, green, red of 16 bits each: CV_16UC3.
pub const OFC_PIXEL_BGR16: i32 = 12;
/// Interleaved red, green, blue and a sample that is ignored, of 16 bits each.
pub const OFC_PIXEL_RGBA16: i32 = 13;
/// Interleaved blue, green, red and a sample that is ignored, of 16 bits each: CV_16UC4.
pub const OFC_PIXEL_BGRA16: i32 = 14;
/// Three planes of 16 bits.
pub const OFC_PIXEL_PLANES16: i32 = 15;
/// Interleaved red, green, blue, each a 32-bit float.
pub const OFC_PIXEL_RGB32F: i32 = 21;
/// Interleaved blue, green, red, each a 32-bit float: CV_32FC3.
pub const OFC_PIXEL_BGR32F: i32 = 22;
/// Interleaved red, green, blue and a sample that is ignored, each a 32-bit float.
pub const OFC_PIXEL_RGBA32F: i32 = 23;
/// Interleaved blue, green, red and a sample that is ignored, each a 32-bit float.
pub const OFC_PIXEL_BGRA32F: i32 = 24;
/// Three planes of 32-bit floats.
pub const OFC_PIXEL_PLANES32F: i32 = 25;

/// A picture in the caller's memory. Initialize the whole struct: fields that are not set must be zero.
///
/// Row 0 is the top row. Pixels may have any alignment, and rows any stride that holds a row. Nobody may write the
/// bytes from the first pixel to the last during a call.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_image {
    /// The first pixel of interleaved pixels, or of the red plane.
    pub pixels: *const c_void,
    /// How many pixels are in a row, at least 1.
    pub width: i32,
    /// How many rows there are, at least 1.
    pub height: i32,
    /// How many bytes lie from one row to the next, as in cv::Mat::step.
    pub row_stride_bytes: usize,
    /// One of OFC_PIXEL_*.
    pub format: ofc_pixel_format,
    /// Must be zero.
    pub reserved: u32,
    /// The green plane of OFC_PIXEL_PLANES*, with the red plane's stride; else NULL.
    pub green_plane: *const c_void,
    /// The blue plane of OFC_PIXEL_PLANES*, with the red plane's stride; else NULL.
    pub blue_plane: *const c_void,
    /// A byte for each pixel, which is left out where the byte is zero; or NULL.
    pub mask: *const u8,
    /// How many bytes lie from one row of the mask to the next; any number without a mask.
    pub mask_stride_bytes: usize,
}

plain!(ofc_image);

enum Layout {
    Interleaved(Order),
    Planes,
}

fn layout(format: ofc_pixel_format) -> Result<(Sample, Layout), Refusal> {
    let sample = match format {
        OFC_PIXEL_RGB8..=OFC_PIXEL_PLANES8 => Sample::U8,
        OFC_PIXEL_RGB16..=OFC_PIXEL_PLANES16 => Sample::U16,
        OFC_PIXEL_RGB32F..=OFC_PIXEL_PLANES32F => Sample::F32,
        _ => return Err(Refusal(OFC_STATUS_UNKNOWN_FORMAT)),
    };
    let layout = match format % 10 {
        OFC_PIXEL_RGB8 => Layout::Interleaved(Order::Rgb),
        OFC_PIXEL_BGR8 => Layout::Interleaved(Order::Bgr),
        OFC_PIXEL_RGBA8 => Layout::Interleaved(Order::Rgba),
        OFC_PIXEL_BGRA8 => Layout::Interleaved(Order::Bgra),
        _ => Layout::Planes,
    };
    Ok((sample, layout))
}

/// The layout of a format that is not planar.
pub(crate) fn interleaved_layout(format: ofc_pixel_format) -> Result<(Sample, Order), Refusal> {
    match layout(format)? {
        (sample, Layout::Interleaved(order)) => Ok((sample, order)),
        (_, Layout::Planes) => Err(Refusal(OFC_STATUS_UNKNOWN_FORMAT)),
    }
}

/// How a format stores samples.
pub(crate) fn sample_type(format: ofc_pixel_format) -> Result<Sample, Refusal> {
    layout(format).map(|(sample, _)| sample)
}

/// A width, height or count as a size, 0 for what is negative.
pub(crate) fn dimension(size: i32) -> usize {
    usize::try_from(size).unwrap_or(0)
}

/// Width and height of a map, which must have pixels.
pub(crate) fn size_of_map(width: i32, height: i32) -> Result<[usize; 2], Refusal> {
    ensure(width > 0 && height > 0, OFC_STATUS_EMPTY)?;
    Ok([dimension(width), dimension(height)])
}

/// Pixels of a picture, 0 where there are none or too many.
pub(crate) fn pixel_count(width: i32, height: i32) -> usize {
    dimension(width).checked_mul(dimension(height)).filter(|&pixels| pixels <= MAX_PIXELS).unwrap_or(0)
}

/// Pixels of a picture, of which there must be some and not too many.
pub(crate) fn checked_pixel_count(width: i32, height: i32) -> Result<usize, Refusal> {
    size_of_map(width, height)?;
    let pixels = pixel_count(width, height);
    ensure(pixels > 0, OFC_STATUS_TOO_LARGE)?;
    Ok(pixels)
}

/// How many values of `T` the rows of a map take, and how many lie from a row to the next.
fn rows<T>(
    [width, height]: [usize; 2],
    values: usize,
    stride_bytes: usize,
) -> Result<(usize, usize), Refusal> {
    ensure(stride_bytes.is_multiple_of(size_of::<T>()), OFC_STATUS_MISALIGNED)?;
    let stride = stride_bytes / size_of::<T>();
    Ok((span(width, height, values, stride)?, stride))
}

impl<'a> Call<'a> {
    /// A picture.
    #[inline(never)]
    pub(crate) fn image(&mut self, pointer: *const ofc_image) -> Result<Image<'a>, Refusal> {
        let image = self.input(pointer)?;
        ensure(image.reserved == 0, OFC_STATUS_RESERVED_NOT_ZERO)?;
        let (sample, layout) = layout(image.format)?;
        let (width, height, stride) =
            (dimension(image.width), dimension(image.height), image.row_stride_bytes);
        let view = match layout {
            Layout::Interleaved(order) => {
                let others = [image.green_plane, image.blue_plane];
                ensure(others.iter().all(|plane| plane.is_null()), OFC_STATUS_INVALID_PARAMETER)?;
                let bytes = span(width, height, order.samples() * sample.bytes(), stride)?;
                let pixels = self.input_bytes(image.pixels, bytes)?;
                Image::interleaved(pixels, width, height, stride, sample, order)?
            }
            Layout::Planes => {
                let bytes = span(width, height, sample.bytes(), stride)?;
                let red = self.input_bytes(image.pixels, bytes)?;
                let green = self.input_bytes(image.green_plane, bytes)?;
                let blue = self.input_bytes(image.blue_plane, bytes)?;
                Image::planes([red, green, blue], width, height, stride, sample)?
            }
        };
        if image.mask.is_null() {
            return Ok(view);
        }
        let mask = self.input_slice(image.mask, span(width, height, 1, image.mask_stride_bytes)?)?;
        Ok(view.with_mask(mask, image.mask_stride_bytes)?)
    }

    /// The test at an address, or every usable pixel of the picture where it is NULL.
    pub(crate) fn inlier_test(
        &mut self,
        inlier_test: *const ofc_inlier_test,
        picture: &Image,
    ) -> Result<Inliers, Refusal> {
        let given = unless_null(inlier_test, || self.params(inlier_test))?;
        Ok(given.unwrap_or_else(|| Inliers::all(Usable::below(picture.sample().saturation()))))
    }

    /// Rows of so many values a pixel that the call reads, and how many values lie from a row to the next.
    pub(crate) fn input_rows<T: Plain>(
        &mut self,
        pointer: *const T,
        size: [usize; 2],
        values: usize,
        stride_bytes: usize,
    ) -> Result<(&'a [T], usize), Refusal> {
        let (count, stride) = rows::<T>(size, values, stride_bytes)?;
        Ok((self.input_slice(pointer, count)?, stride))
    }

    /// Rows of so many values a pixel that the call writes, and how many values lie from a row to the next.
    pub(crate) fn output_rows<T: Plain>(
        &mut self,
        pointer: *mut T,
        size: [usize; 2],
        values: usize,
        stride_bytes: usize,
    ) -> Result<(&'a mut [T], usize), Refusal> {
        let (count, stride) = rows::<T>(size, values, stride_bytes)?;
        Ok((self.output_slice(pointer, count)?, stride))
    }
}

/// Width and height of a picture.
pub(crate) fn size(view: &Image) -> [usize; 2] {
    [view.width(), view.height()]
}
