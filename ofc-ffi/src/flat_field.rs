//! Flat-fielding.

use crate::image::{image, ofc_image};
use crate::pointers::{Out, Plain, disjoint, extent, output_slice};
use crate::status::{
    OFC_STATUS_DARK, OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_MISALIGNED, OFC_STATUS_OK,
    OFC_STATUS_STRIDE_TOO_SMALL, of, of_image_error, ofc_status,
};
use crate::types::count;
use ofc_core::picture::flat_field::{self, FlatField, FlatFieldError};
use ofc_core::picture::span;

/// What flat-fielding did.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_flat_field_result {
    /// The mean of each channel of the background, that the quotients are scaled by.
    pub mean: [f64; 3],
    /// Pixels that have a value.
    pub used: i32,
    /// Pixels left out because the background is dark (a channel below a twentieth of its mean), masked out or not finite.
    pub dark: i32,
    /// Pixels left out because the background, or else the picture, is saturated there.
    pub saturated: i32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: integers and floats.
unsafe impl Plain for ofc_flat_field_result {}

/// Divides a picture by that of the same flat, uniform surface without the object, and scales it by the mean of that: what
/// near lights that fall off across the field need before ofc_solve(), which then takes the result as OFC_PIXEL_RGB32F.
///
/// @param image       The picture.
/// @param background  The same surface without the object, of the same size; any format, its mask counts.
/// @param pixels      Output: height rows of width times (r, g, b) floats, in the pixel values of `image`; NaN, which
///                    ofc_solve() leaves out, where background or picture say nothing.
/// @param pixels_stride_bytes  Bytes from a row to the next, a multiple of 4; what lies between rows is left alone.
/// @param result      Output.
/// @return OFC_STATUS_OK; OFC_STATUS_INVALID_PARAMETER for a background of another size; OFC_STATUS_DARK for one without a
///         usable pixel; the status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_flat_field(
    image: *const ofc_image,
    background: *const ofc_image,
    pixels: *mut f32,
    pixels_stride_bytes: usize,
    result: *mut ofc_flat_field_result,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let (picture, flat) = unsafe { (self::image(image)?, self::image(background)?) };
        if !pixels_stride_bytes.is_multiple_of(size_of::<f32>()) {
            return Err(OFC_STATUS_MISALIGNED);
        }
        let stride = pixels_stride_bytes / size_of::<f32>();
        let need = span(picture.view.width(), picture.view.height(), 3, stride).map_err(of_image_error)?;
        let written = extent(pixels.cast_const(), need)?;
        let out = Out::new(result)?;
        let ([a, b, c, d, e], [f, g, h, i, j]) = (picture.extents, flat.extents);
        disjoint(&[written, out.extent], &[a, b, c, d, e, f, g, h, i, j])?;
        // SAFETY: checked and disjoint.
        let pixels = unsafe { output_slice(pixels, need) };
        let FlatField { mean, used, dark, saturated } =
            flat_field::divide(&picture.view, &flat.view, pixels, stride).map_err(of_flat_field_error)?;
        out.write(ofc_flat_field_result {
            mean,
            used: count(used),
            dark: count(dark),
            saturated: count(saturated),
            reserved: 0,
        });
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

const fn of_flat_field_error(error: FlatFieldError) -> ofc_status {
    match error {
        FlatFieldError::Size => OFC_STATUS_INVALID_PARAMETER,
        FlatFieldError::Output => OFC_STATUS_STRIDE_TOO_SMALL,
        FlatFieldError::Background => OFC_STATUS_DARK,
    }
}
