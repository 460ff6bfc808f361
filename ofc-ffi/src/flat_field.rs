//! Flat-fielding.

use crate::image::{ofc_image, size};
use crate::pointers::{Contract, plain};
use crate::status::{OFC_STATUS_OK, ofc_status};
use crate::twin::{ToC, to_c};
use ofc_core::picture::flat_field::{self, FlatField};

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

plain!(ofc_flat_field_result);

to_c!(FlatField => ofc_flat_field_result { mean, used, dark, saturated } zero { reserved });

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
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let (picture, background) = (call.image(image)?, call.image(background)?);
        let (pixels, stride) = call.output_rows(pixels, size(&picture), 3, pixels_stride_bytes)?;
        let result = call.output(result)?;
        *result = flat_field::divide(&picture, &background, pixels, stride)?.to_c();
        Ok(OFC_STATUS_OK)
    })
}
