//! The picture as C describes it.

use crate::pointers::{Extent, Plain, input, input_slice};
use crate::status::{
    OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_RESERVED_NOT_ZERO, OFC_STATUS_UNKNOWN_FORMAT, of_image_error,
    ofc_status,
};
use core::ffi::c_void;
use ofc_core::picture::{Image, Order, Sample, span};

/// How pixels are stored: one of OFC_PIXEL_*. 16-bit and float samples are in the machine's byte order.
pub type ofc_pixel_format = i32;

/// Interleaved red, green, blue, 8 bits each.
pub const OFC_PIXEL_RGB8: i32 = 1;
/// Interleaved blue, green, red, 8 bits each: OpenCV's CV_8UC3.
pub const OFC_PIXEL_BGR8: i32 = 2;
/// Interleaved red, green, blue, ignored, 8 bits each.
pub const OFC_PIXEL_RGBA8: i32 = 3;
/// Interleaved blue, green, red, ignored, 8 bits each: OpenCV's CV_8UC4.
pub const OFC_PIXEL_BGRA8: i32 = 4;
/// Three planes of 8 bits, such as three grayscale photographs under three lights.
pub const OFC_PIXEL_PLANES8: i32 = 5;
/// As OFC_PIXEL_RGB8 with 16 bits a sample.
pub const OFC_PIXEL_RGB16: i32 = 11;
/// As OFC_PIXEL_BGR8 with 16 bits a sample.
pub const OFC_PIXEL_BGR16: i32 = 12;
/// As OFC_PIXEL_RGBA8 with 16 bits a sample.
pub const OFC_PIXEL_RGBA16: i32 = 13;
/// As OFC_PIXEL_BGRA8 with 16 bits a sample.
pub const OFC_PIXEL_BGRA16: i32 = 14;
/// As OFC_PIXEL_PLANES8 with 16 bits a sample.
pub const OFC_PIXEL_PLANES16: i32 = 15;
/// As OFC_PIXEL_RGB8 with 32-bit floats.
pub const OFC_PIXEL_RGB32F: i32 = 21;
/// As OFC_PIXEL_BGR8 with 32-bit floats.
pub const OFC_PIXEL_BGR32F: i32 = 22;
/// As OFC_PIXEL_RGBA8 with 32-bit floats.
pub const OFC_PIXEL_RGBA32F: i32 = 23;
/// As OFC_PIXEL_BGRA8 with 32-bit floats.
pub const OFC_PIXEL_BGRA32F: i32 = 24;
/// As OFC_PIXEL_PLANES8 with 32-bit floats.
pub const OFC_PIXEL_PLANES32F: i32 = 25;

/// A picture in the caller's memory, row 0 at the top. Initialise all of it: fields not set must be zero.
///
/// Pixels may have any alignment and rows any stride of at least a row. A call reads the bytes from the first pixel to
/// the last, and nobody may write them meanwhile.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_image {
    /// Interleaved pixels, or the red plane.
    pub pixels: *const c_void,
    /// Pixels in a row, at least 1.
    pub width: i32,
    /// Rows, at least 1.
    pub height: i32,
    /// Bytes from a row to the next, as cv::Mat::step.
    pub row_stride_bytes: usize,
    /// One of OFC_PIXEL_*.
    pub format: ofc_pixel_format,
    /// Must be zero.
    pub reserved: u32,
    /// The green plane of an OFC_PIXEL_PLANES* format, with the red plane's stride; otherwise NULL.
    pub green_plane: *const c_void,
    /// The blue plane of an OFC_PIXEL_PLANES* format, with the red plane's stride; otherwise NULL.
    pub blue_plane: *const c_void,
    /// NULL, or a byte a pixel: pixels where it is zero are left out.
    pub mask: *const u8,
    /// Bytes from a row of the mask to the next; without a mask it does not matter.
    pub mask_stride_bytes: usize,
}

// SAFETY: integers and raw pointers.
unsafe impl Plain for ofc_image {}

/// A checked picture and the bytes it lies in.
pub(crate) struct CheckedImage<'a> {
    /// The view.
    pub view: Image<'a>,
    /// The struct, the planes and the mask.
    pub extents: [Extent; 5],
}

enum Layout {
    Interleaved(Order),
    Planes,
}

fn layout(format: ofc_pixel_format) -> Result<(Sample, Layout), ofc_status> {
    let sample = match format {
        OFC_PIXEL_RGB8..=OFC_PIXEL_PLANES8 => Sample::U8,
        OFC_PIXEL_RGB16..=OFC_PIXEL_PLANES16 => Sample::U16,
        OFC_PIXEL_RGB32F..=OFC_PIXEL_PLANES32F => Sample::F32,
        _ => return Err(OFC_STATUS_UNKNOWN_FORMAT),
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
pub(crate) fn interleaved_layout(format: ofc_pixel_format) -> Result<(Sample, Order), ofc_status> {
    match layout(format)? {
        (sample, Layout::Interleaved(order)) => Ok((sample, order)),
        (_, Layout::Planes) => Err(OFC_STATUS_UNKNOWN_FORMAT),
    }
}

/// How a format stores samples.
pub(crate) fn sample_type(format: ofc_pixel_format) -> Result<Sample, ofc_status> {
    layout(format).map(|(sample, _)| sample)
}

fn checked_span(width: usize, height: usize, pixel_bytes: usize, stride: usize) -> Result<usize, ofc_status> {
    span(width, height, pixel_bytes, stride).map_err(of_image_error)
}

/// Width and height as sizes, 0 for what is negative.
pub(crate) fn dimension(size: i32) -> usize {
    usize::try_from(size).unwrap_or(0)
}

/// Checks a picture.
///
/// # Safety
/// The pixels and the mask can be read and are not written during the call.
pub(crate) unsafe fn image<'a>(pointer: *const ofc_image) -> Result<CheckedImage<'a>, ofc_status> {
    let (image, own) = input(pointer)?;
    if image.reserved != 0 {
        return Err(OFC_STATUS_RESERVED_NOT_ZERO);
    }
    let (sample, layout) = layout(image.format)?;
    let (width, height, stride) = (dimension(image.width), dimension(image.height), image.row_stride_bytes);
    let view = match layout {
        Layout::Interleaved(order) => {
            if !image.green_plane.is_null() || !image.blue_plane.is_null() {
                return Err(OFC_STATUS_INVALID_PARAMETER);
            }
            let bytes = checked_span(width, height, order.samples() * sample.bytes(), stride)?;
            // SAFETY: the caller's promise.
            let (pixels, extent) = unsafe { input_slice(image.pixels.cast::<u8>(), bytes) }?;
            (Image::interleaved(pixels, width, height, stride, sample, order), [extent; 3])
        }
        Layout::Planes => {
            let bytes = checked_span(width, height, sample.bytes(), stride)?;
            // SAFETY: the caller's promise.
            let ((red, r), (green, g), (blue, b)) = unsafe {
                (
                    input_slice(image.pixels.cast::<u8>(), bytes)?,
                    input_slice(image.green_plane.cast::<u8>(), bytes)?,
                    input_slice(image.blue_plane.cast::<u8>(), bytes)?,
                )
            };
            (Image::planes([red, green, blue], width, height, stride, sample), [r, g, b])
        }
    };
    let (view, [r, g, b]) = (view.0.map_err(of_image_error)?, view.1);
    if image.mask.is_null() {
        return Ok(CheckedImage { view, extents: [own, r, g, b, own] });
    }
    let bytes = checked_span(width, height, 1, image.mask_stride_bytes)?;
    // SAFETY: the caller's promise.
    let (mask, extent) = unsafe { input_slice(image.mask, bytes) }?;
    let view = view.with_mask(mask, image.mask_stride_bytes).map_err(of_image_error)?;
    Ok(CheckedImage { view, extents: [own, r, g, b, extent] })
}
