//! The forward model.

use crate::image::{dimension, interleaved_layout, ofc_pixel_format};
use crate::pointers::{Extent, Out, Plain, disjoint, extent, input, input_slice, output_slice};
use crate::status::{
    OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_MISALIGNED, OFC_STATUS_OK, OFC_STATUS_RESERVED_NOT_ZERO, of,
    of_image_error, ofc_status,
};
use crate::types::flat;
use core::ffi::c_void;
use ofc_core::math::mat3::scale;
use ofc_core::picture::span;
use ofc_core::render::{self, Canvas, DepthMap, DepthMapError, Lights, Outputs, Params, RenderError, Rows};

/// Lights at most.
pub const OFC_MAX_LIGHTS: usize = 32;
const _: () = assert!(OFC_MAX_LIGHTS == render::MAX_LIGHTS, "the header says what the core does");

/// A depth map in the caller's memory, row 0 at the top, depth growing toward the camera. Initialise all of it: fields
/// not set must be zero.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_map {
    /// A depth a pixel, in the unit of pixel_pitch; finite inside the mask.
    pub depth: *const f32,
    /// Pixels in a row, at least 1.
    pub width: i32,
    /// Rows, at least 1.
    pub height: i32,
    /// Bytes from a row to the next, a multiple of 4.
    pub row_stride_bytes: usize,
    /// Distance between neighbouring pixels, in [1e-30, 1e30].
    pub pixel_pitch: f64,
    /// NULL, or a byte a pixel: there is no surface where it is zero.
    pub mask: *const u8,
    /// Bytes from a row of the mask to the next; without a mask it does not matter.
    pub mask_stride_bytes: usize,
}

/// L distant lights.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_lights {
    /// A, L x 3 row-major: unit vectors toward the lights.
    pub directions: *const f64,
    /// B, 3 x L row-major: row c holds what each light gives to channel c of a surface that faces it, in [0, 1e30].
    pub colors: *const f64,
    /// L, 1 to OFC_MAX_LIGHTS.
    pub count: i32,
    /// Must be zero.
    pub reserved: u32,
}

/// What ofc_render() adds to eq. 5. Set by ofc_render_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_render_params {
    /// Colors are scaled by one factor so that the largest modulus is this, in [0, 1e30]; 0 for no scaling. Default 255.
    pub peak: f64,
    /// Standard deviation of Gaussian noise in pixel values, added after scaling, in [0, 1e30]. Default 0.
    pub noise: f64,
    /// Fixes the noise. Default 0.
    pub seed: u64,
    /// 1: the surface casts shadows on itself; 0: only what faces away from a light is dark. Default 1.
    pub cast_shadows: i32,
    /// Must be zero.
    pub reserved: [u32; 5],
}

/// What was rendered.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_rendering {
    /// Largest modulus of a color before scaling; 0 when all is dark.
    pub largest: f64,
    /// The factor applied.
    pub scale: f64,
    /// The picture's true F where all lights are seen: scale times B A, row-major.
    pub f: [f64; 9],
}

// SAFETY: integers, floats and raw pointers.
unsafe impl Plain for ofc_depth_map {}
// SAFETY: as above.
unsafe impl Plain for ofc_lights {}
// SAFETY: as above.
unsafe impl Plain for ofc_render_params {}
// SAFETY: as above.
unsafe impl Plain for ofc_rendering {}

impl ofc_render_params {
    fn check(self) -> Result<Params, ofc_status> {
        let Self { peak, noise, seed, cast_shadows, reserved } = self;
        if reserved != [0; 5] {
            return Err(OFC_STATUS_RESERVED_NOT_ZERO);
        }
        let cast_shadows = match cast_shadows {
            0 => false,
            1 => true,
            _ => return Err(OFC_STATUS_INVALID_PARAMETER),
        };
        Ok(Params { cast_shadows, peak, noise, seed })
    }
}

/// Sets every field to its default.
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_render_params_default(params: *mut ofc_render_params) -> ofc_status {
    of(Out::new(params).map(|out| {
        let Params { cast_shadows, peak, noise, seed } = Params::default();
        let cast_shadows = i32::from(cast_shadows);
        out.write(ofc_render_params { peak, noise, seed, cast_shadows, reserved: [0; 5] });
        OFC_STATUS_OK
    }))
}

/// The rows of an output of so many four-byte values a pixel, or none where the pointer is NULL.
fn output_rows<T>(
    pointer: *mut T,
    values: usize,
    width: usize,
    height: usize,
    stride_bytes: usize,
) -> Result<Option<Extent>, ofc_status> {
    if pointer.is_null() {
        return Ok(None);
    }
    if !stride_bytes.is_multiple_of(size_of::<T>()) {
        return Err(OFC_STATUS_MISALIGNED);
    }
    let bytes = span(width, height, values * size_of::<T>(), stride_bytes).map_err(of_image_error)?;
    extent(pointer.cast_const(), bytes / size_of::<T>()).map(Some)
}

/// Renders a depth map under coloured lights: eq. 5 with attached and cast shadows, scaling, noise and quantisation.
///
/// A pixel sees light i if a_i . n > 0 and, with cast shadows, no part of the surface is in the way. Normals are central
/// differences of the depth, one-sided at the borders of the picture and the mask.
///
/// @param depth   The surface.
/// @param lights  The lights.
/// @param params  See the struct.
/// @param pixels  Output: the picture, depth->width x depth->height, black outside the mask; integers are rounded and
///                limited to their range.
/// @param format  An OFC_PIXEL_* format that is not planar.
/// @param pixels_stride_bytes  Bytes from a row to the next.
/// @param seen    Output: a word a pixel, bit i set where the surface sees light i; may be NULL.
/// @param seen_stride_bytes  Bytes from a row to the next, a multiple of 4.
/// @param normals Output: (x, y, z) floats a pixel, zero outside the mask; may be NULL.
/// @param normals_stride_bytes  Bytes from a row to the next, a multiple of 4.
/// @param rendering  Output: scale and true F.
/// @return OFC_STATUS_OK; OFC_STATUS_INVALID_PARAMETER for a depth, direction, color or parameter out of its range; the
///         status of an invalid argument.
///
/// Reference: sections 1.1 and 4, eqs. 1-7.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_render(
    depth: *const ofc_depth_map,
    lights: *const ofc_lights,
    params: *const ofc_render_params,
    pixels: *mut c_void,
    format: ofc_pixel_format,
    pixels_stride_bytes: usize,
    seen: *mut u32,
    seen_stride_bytes: usize,
    normals: *mut f32,
    normals_stride_bytes: usize,
    rendering: *mut ofc_rendering,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let (surface, [depth_own, depth_extent, mask_extent]) = unsafe { surface(depth) }?;
        let (own, lights_extent) = input(lights)?;
        if own.reserved != 0 {
            return Err(OFC_STATUS_RESERVED_NOT_ZERO);
        }
        let count = dimension(own.count);
        if count == 0 || count > OFC_MAX_LIGHTS {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        // SAFETY: the contract of this function.
        let ((a, a_extent), (b, b_extent)) =
            unsafe { (input_slice(own.directions, count * 3)?, input_slice(own.colors, count * 3)?) };
        let (params, params_extent) = input(params)?;
        let params = params.check()?;
        let (sample, order) = interleaved_layout(format)?;
        let (width, height) = (surface.width(), surface.height());
        let picture_bytes = span(width, height, order.samples() * sample.bytes(), pixels_stride_bytes)
            .map_err(of_image_error)?;
        let picture_extent = extent(pixels.cast::<u8>().cast_const(), picture_bytes)?;
        let seen_extent = output_rows(seen, 1, width, height, seen_stride_bytes)?;
        let normals_extent = output_rows(normals, 3, width, height, normals_stride_bytes)?;
        let out = Out::new(rendering)?;
        let nothing = Extent::NOTHING;
        disjoint(
            &[picture_extent, seen_extent.unwrap_or(nothing), normals_extent.unwrap_or(nothing), out.extent],
            &[depth_own, depth_extent, mask_extent, lights_extent, a_extent, b_extent, params_extent],
        )?;
        let lights = Lights::new(a, b).map_err(|_| OFC_STATUS_INVALID_PARAMETER)?;
        // SAFETY: checked and disjoint.
        let outputs = unsafe {
            Outputs {
                picture: Canvas::new(
                    output_slice(pixels.cast::<u8>(), picture_bytes),
                    width,
                    height,
                    pixels_stride_bytes,
                    sample,
                    order,
                )
                .map_err(of_image_error)?,
                seen: seen_extent.map(|extent| Rows {
                    values: output_slice(seen, extent.bytes() / size_of::<u32>()),
                    row_stride: seen_stride_bytes / size_of::<u32>(),
                }),
                normals: normals_extent.map(|extent| Rows {
                    values: output_slice(normals, extent.bytes() / size_of::<f32>()),
                    row_stride: normals_stride_bytes / size_of::<f32>(),
                }),
            }
        };
        let found = render::render(&surface, &lights, &params, outputs).map_err(of_render_error)?;
        let f = lights.orientation().map(|row| scale(row, found.scale));
        out.write(ofc_rendering { largest: found.largest, scale: found.scale, f: flat(&f) });
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

const fn of_render_error(error: RenderError) -> ofc_status {
    match error {
        RenderError::NonFiniteDepth | RenderError::Peak | RenderError::Noise | RenderError::Size => {
            OFC_STATUS_INVALID_PARAMETER
        }
    }
}

/// Checks a depth map.
///
/// # Safety
/// The depths and the mask can be read and are not written during the call.
pub(crate) unsafe fn surface<'a>(
    pointer: *const ofc_depth_map,
) -> Result<(DepthMap<'a>, [Extent; 3]), ofc_status> {
    let (map, own) = input(pointer)?;
    let (width, height) = (dimension(map.width), dimension(map.height));
    let bytes = span(width, height, size_of::<f32>(), map.row_stride_bytes).map_err(of_image_error)?;
    if !map.row_stride_bytes.is_multiple_of(size_of::<f32>()) {
        return Err(OFC_STATUS_MISALIGNED);
    }
    extent(map.depth, bytes / size_of::<f32>())?;
    // SAFETY: the caller's promise.
    let (depths, depth_extent) = unsafe { input_slice(map.depth.cast::<u8>(), bytes) }?;
    let view =
        DepthMap::new(depths, width, height, map.row_stride_bytes, map.pixel_pitch).map_err(|error| {
            match error {
                DepthMapError::Image(error) => of_image_error(error),
                DepthMapError::Pitch => OFC_STATUS_INVALID_PARAMETER,
            }
        })?;
    if map.mask.is_null() {
        return Ok((view, [own, depth_extent, own]));
    }
    let bytes = span(width, height, 1, map.mask_stride_bytes).map_err(of_image_error)?;
    // SAFETY: the caller's promise.
    let (mask, mask_extent) = unsafe { input_slice(map.mask, bytes) }?;
    let view = view.with_mask(mask, map.mask_stride_bytes).map_err(of_image_error)?;
    Ok((view, [own, depth_extent, mask_extent]))
}
