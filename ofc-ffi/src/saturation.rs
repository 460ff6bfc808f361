//! Saturation below full scale.

use crate::prelude::*;
use ofc_core::picture::saturation;

/// Finds the level at which a picture saturates where that is below the largest value of its samples, as with 12 bits in 16 or
/// floats that were clipped at 1: pixels pile up at the largest value that there is. The parameters' `saturation` takes it.
/// @param image  The picture; pixels outside its mask count for nothing.
/// @param level  Output: the level; 0 where nothing piles up, and where the largest value of the samples is reached, which
///     saturates anyway.
/// @param count  Output: how many pixels are at that level in a channel, 0 without one; may be NULL.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_saturation_find(
    image: *const ofc_image,
    level: *mut f64,
    count: *mut i32,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let level = call.output(level)?;
        let count = unless_null(count, || call.output(count))?;
        let found = saturation::find(&picture).unwrap_or_default();
        *level = f64::from(found.level);
        if let Some(count) = count {
            *count = found.pixels.to_c();
        }
        Ok(OFC_STATUS_OK)
    })
}
