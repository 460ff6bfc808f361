//! Flat-fielding.

use crate::prelude::*;
use ofc_core::picture::flat_field::{self, FlatField};

/// What ofc_flat_field() did.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_flat_field_result {
    /// The mean of each channel of the background, by which the quotients are scaled.
    pub mean: [f64; 3],
    /// How many pixels have a value.
    pub used: i32,
    /// How many pixels are left out because the background is masked out, not finite or dark, with a channel below a
    /// twentieth of its mean.
    pub dark: i32,
    /// How many pixels are left out because the background or the picture is saturated there.
    pub saturated: i32,
    /// Zero.
    pub reserved: u32,
}

plain!(ofc_flat_field_result);

to_c!(FlatField => ofc_flat_field_result { mean, used, dark, saturated } zero { reserved });

/// Divides a picture by a picture of the same flat, uniform surface without the object, and scales it by the mean of
/// the latter. This corrects for near lights that fall off across the picture; ofc_solve() takes the result as
/// OFC_PIXEL_RGB32F.
/// @param image  The picture.
/// @param background  The picture without the object, of the same size and in any format; its mask counts.
/// @param pixels  Output: height rows of width (r, g, b) floats, in the pixel values of `image`; NaN, which ofc_solve()
///     leaves out, where a pixel has no value.
/// @param pixels_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @param result  Output: means and counts.
/// @return OFC_STATUS_OK; OFC_STATUS_DARK for a background without a usable pixel; an argument status,
///     OFC_STATUS_INVALID_PARAMETER for a background of another size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_flat_field(
    image: *const ofc_image,
    background: *const ofc_image,
    pixels: *mut f32,
    pixels_stride_bytes: usize,
    result: *mut ofc_flat_field_result,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let (picture, background) = (call.image(image)?, call.image(background)?);
        let (pixels, stride) = call.output_rows(pixels, size(&picture), 3, pixels_stride_bytes)?;
        let result = call.output(result)?;
        *result = flat_field::divide(&picture, &background, pixels, stride)?.to_c();
        Ok(OFC_STATUS_OK)
    })
}
