//! What is pressed into a rig, and the background that it is seen against.

use crate::prelude::*;
use crate::relief::ofc_relief_class;
use crate::rig::rig_refusal;
use ofc_core::rig::{self, Contact};

/// What is pressed in. Places are in pixels from the middle of the top left one, y downward; lengths are in the unit of the pixel size.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_rig_contact {
    /// Its area.
    pub area: f64,
    /// The mean place of its pixels: x, y.
    pub center: [f64; 2],
    /// How high its highest point is above the plane; negative for a hollow.
    pub peak: f64,
    /// The volume above the plane.
    pub volume: f64,
    /// Where the highest point is: x, y.
    pub peak_place: [i32; 2],
    /// Its first and last column and row: left, top, right, bottom.
    pub bounds: [i32; 4],
}

plain!(ofc_rig_contact);

to_c!(Contact => ofc_rig_contact { area, center, peak, volume, peak_place, bounds });

/// Measures what is pressed in: the pixels of the contact that are at least 0.16 of the highest point away from the plane, which lies where the
/// untouched pixels are in the mean.
/// @param classes  width x height bytes from ofc_rig_classify().
/// @param width,height  Size of the frame.
/// @param depth  height rows of width floats from ofc_depth_integrate(), in pixels; NaN where there is none.
/// @param depth_stride_bytes  Bytes from one row to the next, a multiple of 4.
/// @param pixel_size  The length of a pixel on the gel, positive: in millimeters, the contact is in millimeters, too.
/// @param mask  Output: width x height bytes, rows without gaps: 255 in the contact, 0 elsewhere. NULL where it is not wanted.
/// @param contact  Output: the contact.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_RELIEF, with nothing written, where there is no contact or no plane; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_contact_measure(
    classes: *const ofc_relief_class,
    width: i32,
    height: i32,
    depth: *const f32,
    depth_stride_bytes: usize,
    pixel_size: f64,
    mask: *mut u8,
    contact: *mut ofc_rig_contact,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let pixels = checked_pixel_count(width, height)?;
        let size = size_of_map(width, height)?;
        let [width, _] = size;
        let classes = call.input_slice(classes, pixels)?;
        let (depths, stride) = call.input_rows(depth, size, 1, depth_stride_bytes)?;
        let mut mask = unless_null(mask, || call.output_slice(mask, pixels))?;
        let contact = call.output(contact)?;
        ensure(pixel_size > 0.0 && pixel_size < LARGEST_PIXEL, OFC_STATUS_INVALID_PARAMETER)?;
        let depth = |x: usize, y: usize| depths.get(y * stride + x).copied().unwrap_or(f32::NAN);
        let write = |x: usize, y: usize, is_in: bool| {
            if let Some(slot) = mask.as_mut().and_then(|mask| mask.get_mut(y * width + x)) {
                *slot = if is_in { u8::MAX } else { 0 };
            }
        };
        let Some(found) = rig::contact(classes, width, pixel_size, depth, write) else {
            return Ok(OFC_STATUS_NO_RELIEF);
        };
        *contact = found.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Lengths and volumes stay finite.
pub(crate) const LARGEST_PIXEL: f64 = 1e30;

/// Moves a background toward a frame where the frame shows the untouched plane: a slow drift of the light and of the gel is followed, and the frames of
/// a rig make their background themselves. A pixel that is NaN in the background takes the frame's color: begin with NaNs.
/// @param image  The frame.
/// @param classes  width x height bytes from ofc_rig_add() or ofc_rig_classify(): pixels of OFC_RELIEF_PLANE count; NULL where nothing is pressed in.
/// @param saturation  As in ofc_relief_params.
/// @param rate  The share by which the background moves, in (0, 1]: 0.01 to 0.05 follow a drift over minutes.
/// @param background  In and out: height rows of width (r, g, b) floats. OFC_PIXEL_RGB32F describes it as a picture.
/// @param background_stride_bytes  Bytes from one row to the next, a multiple of 4.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_background_follow(
    image: *const ofc_image,
    classes: *const ofc_relief_class,
    saturation: f64,
    rate: f64,
    background: *mut f32,
    background_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let image = call.image(image)?;
        let size = size(&image);
        let classes = unless_null(classes, || call.input_slice(classes, size[0] * size[1]))?;
        let level = crate::types::saturation(saturation)?;
        let (background, stride) = call.output_rows(background, size, 3, background_stride_bytes)?;
        rig::follow(background, stride, &image, classes, level, rate as f32).map_err(rig_refusal)?;
        Ok(OFC_STATUS_OK)
    })
}
