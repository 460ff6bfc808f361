//! Light that is not the model's.

use crate::prelude::*;
use ofc_core::picture::dark;

/// Subtracts one color from every pixel: room light, or a black level, as ofc_offset_fit() finds it. ofc_solve() takes the
/// result as OFC_PIXEL_RGB32F. A pixel with a saturated channel keeps its color, so it is found again with the largest value
/// of the picture's samples, 255 or 65535, as ofc_lmeds_params.saturation.
/// @param image  The picture; its mask is not looked at.
/// @param offset  r, g, b in pixel values.
/// @param pixels  Output: height rows of width (r, g, b) floats; NaN for a sample that is not finite.
/// @param pixels_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_offset_subtract(
    image: *const ofc_image,
    offset: *const f64,
    pixels: *mut f32,
    pixels_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let offset = call.input_array::<f64, 3>(offset)?;
        let (pixels, stride) = call.output_rows(pixels, size(&picture), 3, pixels_stride_bytes)?;
        dark::subtract_offset(&picture, offset, pixels, stride)?;
        Ok(OFC_STATUS_OK)
    })
}

/// Subtracts a dark frame, a picture of the same scene with the lights of the model off, from a picture. ofc_solve() takes the
/// result as OFC_PIXEL_RGB32F. A pixel that is saturated in a channel of the picture keeps its color, and one that is saturated in
/// the dark frame becomes full scale, so both are found again with the largest value of the picture's samples, 255 or 65535, as
/// ofc_lmeds_params.saturation.
/// @param image  The picture; its mask is not looked at.
/// @param dark  The dark frame, of the same size and with samples of the same type, in any order; its mask is not looked at.
/// @param pixels  Output: height rows of width (r, g, b) floats; NaN for a sample that is not finite in either picture.
/// @param pixels_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; an argument status, OFC_STATUS_INVALID_PARAMETER for a dark frame of another size or type.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_dark_subtract(
    image: *const ofc_image,
    dark: *const ofc_image,
    pixels: *mut f32,
    pixels_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let (picture, dark) = (call.image(image)?, call.image(dark)?);
        let (pixels, stride) = call.output_rows(pixels, size(&picture), 3, pixels_stride_bytes)?;
        dark::subtract_frame(&picture, &dark, pixels, stride)?;
        Ok(OFC_STATUS_OK)
    })
}
