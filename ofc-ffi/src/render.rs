//! The forward model.

use crate::prelude::*;
use ofc_core::math::mat3::scale;
use ofc_core::picture::span;
use ofc_core::render::{self, Canvas, DepthMap, Lights, Outputs, Params, Rows};

/// The largest number of lights.
pub const OFC_MAX_LIGHTS: usize = 32;
const _: () = assert!(OFC_MAX_LIGHTS == render::MAX_LIGHTS, "the header says what the core does");

/// A depth map in the caller's memory; depth grows toward the camera. Initialize the whole struct: fields that are not
/// set must be zero. Row 0 is the top row.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_map {
    /// A float for each pixel, its depth in the unit of `pixel_pitch`; finite inside the mask.
    pub depth: *const f32,
    /// How many pixels are in a row, at least 1.
    pub width: i32,
    /// How many rows there are, at least 1.
    pub height: i32,
    /// How many bytes lie from one row to the next, a multiple of 4.
    pub row_stride_bytes: usize,
    /// The distance between neighboring pixels, in [1e-30, 1e30].
    pub pixel_pitch: f64,
    /// A byte for each pixel, which has no surface where the byte is zero; or NULL.
    pub mask: *const u8,
    /// How many bytes lie from one row of the mask to the next; any number without a mask.
    pub mask_stride_bytes: usize,
}

/// Distant lights, L of them.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_lights {
    /// A, L x 3 and row-major: unit vectors toward the lights.
    pub directions: *const f64,
    /// B, 3 x L and row-major: row c holds what each light gives to channel c of a surface that faces it, in [0, 1e30].
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
    /// All colors are scaled by one factor, so that the largest modulus is this, in [0, 1e30]; 0 for no scaling.
    /// Default 255.
    pub peak: f64,
    /// Standard deviation of Gaussian noise that is added after scaling, in pixel values, in [0, 1e30]. Default 0.
    pub noise: f64,
    /// Determines the noise. Default 0.
    pub seed: u64,
    /// 1 when the surface casts shadows on itself, 0 when only what faces away from a light is dark. Default 1.
    pub cast_shadows: i32,
    /// Must be zero.
    pub reserved: [u32; 5],
}

/// What ofc_render() made.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_rendering {
    /// The largest modulus of a color before scaling; 0 when all is dark.
    pub largest_modulus: f64,
    /// The factor that colors were scaled by.
    pub scale: f64,
    /// The true F of pixels that all lights reach: scale times B A.
    pub f: [f64; 9],
}

plain!(ofc_depth_map, ofc_lights, ofc_render_params, ofc_rendering);

to_c!(Params => ofc_render_params { peak, noise, seed, cast_shadows } zero { reserved });
from_c!(Params <= ofc_render_params { peak, noise, seed, cast_shadows } zero { reserved });

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_render_params_default(params: *mut ofc_render_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Renders a depth map under colored lights by eq. 5, with attached and cast shadows, scaling, noise and quantization.
///
/// Light i reaches a pixel if a_i . n > 0 and, with cast shadows, no part of the surface is in the way. Normals are
/// central differences of the depth, one-sided at the borders of the picture and the mask.
/// @param depth  The surface.
/// @param lights  The lights.
/// @param params  The parameters.
/// @param pixels  Output: the picture, as large as the depth map and black outside of the mask; integers are rounded
///     and limited to their range.
/// @param format  One of OFC_PIXEL_* that is not planar.
/// @param pixels_stride_bytes  How many bytes lie from one row of the picture to the next.
/// @param visible_lights  Output: a word for each pixel, whose bit i is set where light i reaches the pixel; may be
///     NULL.
/// @param visible_lights_stride_bytes  How many bytes lie from one row of words to the next, a multiple of 4.
/// @param normals  Output: (x, y, z) floats for each pixel, zero outside of the mask; may be NULL.
/// @param normals_stride_bytes  How many bytes lie from one row of normals to the next, a multiple of 4.
/// @param rendering  Output: scale and true F.
/// @return OFC_STATUS_OK; an argument status.
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
    visible_lights: *mut u32,
    visible_lights_stride_bytes: usize,
    normals: *mut f32,
    normals_stride_bytes: usize,
    rendering: *mut ofc_rendering,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let surface = call.surface(depth)?;
        let lights = call.lights(lights)?;
        let params: Params = call.params(params)?;
        let (sample, order) = interleaved_layout(format)?;
        let (width, height) = (surface.width(), surface.height());
        let bytes = span(width, height, order.samples() * sample.bytes(), pixels_stride_bytes)?;
        let pixels = call.output_bytes(pixels, bytes)?;
        let picture = Canvas::new(pixels, width, height, pixels_stride_bytes, sample, order)?;
        let size = [width, height];
        let seen = unless_null(visible_lights, || {
            call.output_rows(visible_lights, size, 1, visible_lights_stride_bytes)
        })?;
        let seen = seen.map(|(values, row_stride)| Rows { values, row_stride });
        let normals = unless_null(normals, || call.output_rows(normals, size, 3, normals_stride_bytes))?;
        let normals = normals.map(|(values, row_stride)| Rows { values, row_stride });
        let rendering = call.output(rendering)?;
        let found = render::render(&surface, &lights, &params, Outputs { picture, seen, normals })?;
        let f = lights.orientation().map(|row| scale(row, found.scale));
        *rendering = ofc_rendering { largest_modulus: found.largest, scale: found.scale, f: f.to_c() };
        Ok(OFC_STATUS_OK)
    })
}

impl<'a> Call<'a> {
    /// A depth map.
    pub(crate) fn surface(&mut self, pointer: *const ofc_depth_map) -> Result<DepthMap<'a>, Refusal> {
        let map = self.input(pointer)?;
        let (width, height, stride) = (dimension(map.width), dimension(map.height), map.row_stride_bytes);
        let bytes = span(width, height, size_of::<f32>(), stride)?;
        ensure(stride.is_multiple_of(size_of::<f32>()), OFC_STATUS_MISALIGNED)?;
        let depths = self.input_bytes(map.depth, bytes)?;
        let view = DepthMap::new(depths, width, height, stride, map.pixel_pitch)?;
        if map.mask.is_null() {
            return Ok(view);
        }
        let mask = self.input_slice(map.mask, span(width, height, 1, map.mask_stride_bytes)?)?;
        Ok(view.with_mask(mask, map.mask_stride_bytes)?)
    }

    /// Lights.
    fn lights(&mut self, pointer: *const ofc_lights) -> Result<Lights<'a>, Refusal> {
        let lights = self.input(pointer)?;
        ensure(lights.reserved == 0, OFC_STATUS_RESERVED_NOT_ZERO)?;
        let count = dimension(lights.count);
        ensure((1..=OFC_MAX_LIGHTS).contains(&count), OFC_STATUS_INVALID_PARAMETER)?;
        let directions = self.input_slice(lights.directions, count * 3)?;
        let colors = self.input_slice(lights.colors, count * 3)?;
        Ok(Lights::new(directions, colors).map_err(|_| OFC_STATUS_INVALID_PARAMETER)?)
    }
}
