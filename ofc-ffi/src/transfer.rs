//! Transfer curves.

use crate::prelude::*;
use ofc_core::picture::transfer::{self, Transfer};

/// What was stored of light: one of OFC_TRANSFER_*.
pub type ofc_transfer = i32;
/// The curve of sRGB (IEC 61966-2-1), which is that of nearly every JPEG.
pub const OFC_TRANSFER_SRGB: i32 = 1;
/// The light to the power of 1 / gamma.
pub const OFC_TRANSFER_GAMMA: i32 = 2;
/// A table has the light of every number that a sample can be.
pub const OFC_TRANSFER_TABLE: i32 = 3;

/// A curve without a table.
fn curve<'a>(transfer: ofc_transfer, gamma: f64) -> Result<Transfer<'a>, Refusal> {
    match transfer {
        OFC_TRANSFER_SRGB => Ok(Transfer::Srgb),
        OFC_TRANSFER_GAMMA => Ok(Transfer::Gamma(gamma)),
        _ => Err(Refusal(OFC_STATUS_INVALID_PARAMETER)),
    }
}

/// A count as the length of a table; none is longer than that for 16 bits.
fn length(count: i32) -> usize {
    dimension(count).min(1 << 17)
}

/// Writes the light of every number that a sample of 8 or 16 bits can be, in the numbers' own scale: full scale stays full
/// scale. With OFC_TRANSFER_TABLE, such a table is much faster than the curve for pictures of 16 bits.
/// @param transfer  OFC_TRANSFER_SRGB or OFC_TRANSFER_GAMMA.
/// @param gamma  The exponent of OFC_TRANSFER_GAMMA, from 0.1 to 10; else any number.
/// @param count  How many entries there are: 256 or 65,536.
/// @param table  Output: the entries.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_transfer_table(
    transfer: ofc_transfer,
    gamma: f64,
    count: i32,
    table: *mut f32,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let curve = curve(transfer, gamma)?;
        ensure(matches!(count, 256 | 65_536), OFC_STATUS_INVALID_PARAMETER)?;
        transfer::table(&curve, call.output_slice(table, length(count))?)?;
        Ok(OFC_STATUS_OK)
    })
}

/// Makes a picture linear that is stored with a transfer curve, as the model wants it: pixel values that are proportional to light.
/// ofc_solve() takes the result as OFC_PIXEL_RGB32F. Full scale stays full scale, so saturated pixels are found with the
/// largest value of the picture's samples, 255 or 65535, as ofc_lmeds_params.saturation. Floats are taken to have 1 as full
/// scale.
/// @param image  The picture; its mask is not looked at.
/// @param transfer  One of OFC_TRANSFER_*.
/// @param gamma  The exponent of OFC_TRANSFER_GAMMA, from 0.1 to 10; else any number.
/// @param table  For OFC_TRANSFER_TABLE the light of each number from 0 on, finite; else NULL.
/// @param table_length  256 for samples of 8 bits, 65,536 for those of 16; a picture of floats takes no table. 0 without one.
/// @param pixels  Output: height rows of width (r, g, b) floats; NaN, which ofc_solve() leaves out, for a sample that is not
///     finite or whose light is beyond what a float holds.
/// @param pixels_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_transfer_linearize(
    image: *const ofc_image,
    transfer: ofc_transfer,
    gamma: f64,
    table: *const f32,
    table_length: i32,
    pixels: *mut f32,
    pixels_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let transfer = if transfer == OFC_TRANSFER_TABLE {
            Transfer::Table(call.input_slice(table, length(table_length))?)
        } else {
            ensure(table.is_null() && table_length == 0, OFC_STATUS_INVALID_PARAMETER)?;
            curve(transfer, gamma)?
        };
        let (pixels, stride) = call.output_rows(pixels, size(&picture), 3, pixels_stride_bytes)?;
        transfer::linearize(&picture, &transfer, pixels, stride)?;
        Ok(OFC_STATUS_OK)
    })
}
