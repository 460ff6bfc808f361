//! Depth from normals or gradients.

use crate::image::dimension;
use crate::pointers::{Extent, Out, Plain, disjoint, extent, input, input_slice, output_slice, workspace};
use crate::regression::{float_bytes, floats};
use crate::render::{ofc_depth_map, surface};
use crate::status::{
    OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_MISALIGNED, OFC_STATUS_NOT_CONVERGED, OFC_STATUS_NULL_POINTER,
    OFC_STATUS_OK, OFC_STATUS_RESERVED_NOT_ZERO, OFC_STATUS_STRIDE_TOO_SMALL, OFC_STATUS_TOO_FEW_PIXELS,
    OFC_STATUS_TOO_LARGE, OFC_STATUS_WORKSPACE_TOO_SMALL, of, of_image_error, ofc_status,
};
use crate::types::count;
use core::ffi::c_void;
use ofc_core::picture::span;
use ofc_core::render::{Rows, normals_from_depth};
use ofc_core::surface::depth::{
    self, DepthError, DepthInput, DepthParams, DepthResult, Method, Plane, Slopes,
};

/// What to do where a slope is unusable: its normal is not finite or faces away, or its weight is zero.
pub type ofc_depth_method = i32;
/// Least squares over the usable pixels of the mask; there is no depth elsewhere.
pub const OFC_DEPTH_POISSON: i32 = 0;
/// The paper's own choice (section 5): least squares over the whole rectangle, flat (p = q = 0) outside the mask and at
/// unusable pixels. Depth is given in the mask.
pub const OFC_DEPTH_PAPER: i32 = 1;
/// Harris's coupled depth/slope model: smooth slopes are fitted to the usable pixels and span the others, then depth is
/// fitted to these slopes over the whole mask.
pub const OFC_DEPTH_COUPLED: i32 = 2;

/// What is integrated. Initialise all of it: fields not set must be zero. Row 0 is at the top, floats and their strides
/// are aligned to four bytes; the stride of a map that is NULL does not matter.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_input {
    /// (x, y, z) floats a pixel: x right, y up, z toward the camera, of any length. NULL when p and q are given. A normal
    /// that is not finite, zero, or faces away is unusable.
    pub normals: *const f32,
    /// Bytes from a row to the next.
    pub normals_stride_bytes: usize,
    /// dz/dx, a float a pixel; NULL when normals are given.
    pub p: *const f32,
    /// Bytes from a row to the next.
    pub p_stride_bytes: usize,
    /// dz/dy, y up; NULL when normals are given.
    pub q: *const f32,
    /// Bytes from a row to the next.
    pub q_stride_bytes: usize,
    /// NULL, or a byte a pixel: depth is wanted where it is not zero.
    pub mask: *const u8,
    /// Bytes from a row to the next.
    pub mask_stride_bytes: usize,
    /// NULL, or a float a pixel: how far to trust its slope, 1 by default. Zero, negative and non-finite make it unusable;
    /// others are limited to [1e-4, 1e4].
    pub weights: *const f32,
    /// Bytes from a row to the next.
    pub weights_stride_bytes: usize,
    /// NULL, or known depths in the unit of the result, not finite where nothing is known.
    pub prior: *const f32,
    /// Bytes from a row to the next.
    pub prior_stride_bytes: usize,
    /// Pixels in a row, at least 1.
    pub width: i32,
    /// Rows, at least 1.
    pub height: i32,
}

/// How to integrate. Set by ofc_depth_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_params {
    /// Width and height of a pixel on the surface, in the unit that depth is wanted in: in [1e-30, 1e30]. Default 1.
    pub pixel_pitch: f64,
    /// The residual to reach, as a part of the right side's norm: in [1e-6, 1]. Default 1e-4.
    pub tolerance: f64,
    /// Normals with n3 / |n| below this lose weight with its square, and their slope stops growing: in [0.001, 1].
    /// Default 0.05, slopes up to 20.
    pub min_n3: f64,
    /// Weight of a pixel of the prior against the equation of one edge; 0 ignores the prior: in [0, 1e6]. Default 1e-3.
    pub prior_weight: f64,
    /// For OFC_DEPTH_COUPLED, the weight of the squared difference of neighbouring slopes against that of a pixel's slope
    /// from its data: in [1e-3, 1e3]. Default 0.1.
    pub smoothness: f64,
    /// OFC_DEPTH_POISSON by default.
    pub method: ofc_depth_method,
    /// Multigrid cycles at most for each system of equations, at least 1. Default 1000; 4 to 15 are usual.
    pub max_cycles: i32,
    /// Must be zero.
    pub reserved: [u32; 4],
}

/// How the integration went.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_result {
    /// The last residual, as a part of the right side's norm, before the depth is rounded to float; of a rectangle that was
    /// solved directly that of the floats, which rounding alone leaves (1e-3 for a million pixels).
    pub residual: f64,
    /// Multigrid cycles, of all systems of equations together; 0 for a rectangle without gaps, weights and prior, which is
    /// solved directly where one of its sides has no prime factor above 7.
    pub cycles: i32,
    /// Connected regions. Each has zero mean depth unless the prior reaches into it.
    pub regions: i32,
    /// Pixels that have a depth.
    pub pixel_count: i32,
    /// Pixels of the mask that were unusable.
    pub excluded_count: i32,
    /// 1 when the tolerance was reached, or what floats can hold; 0 otherwise.
    pub converged: i32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: integers, floats and raw pointers.
unsafe impl Plain for ofc_depth_input {}
// SAFETY: as above.
unsafe impl Plain for ofc_depth_params {}
// SAFETY: as above.
unsafe impl Plain for ofc_depth_result {}

impl ofc_depth_params {
    fn check(self) -> Result<DepthParams, ofc_status> {
        let Self { pixel_pitch, tolerance, min_n3, prior_weight, smoothness, method, max_cycles, reserved } =
            self;
        if reserved != [0; 4] {
            return Err(OFC_STATUS_RESERVED_NOT_ZERO);
        }
        let method = match method {
            OFC_DEPTH_POISSON => Method::Poisson,
            OFC_DEPTH_PAPER => Method::Paper,
            OFC_DEPTH_COUPLED => Method::Coupled,
            _ => return Err(OFC_STATUS_INVALID_PARAMETER),
        };
        let max_cycles = u32::try_from(max_cycles).unwrap_or(0);
        if max_cycles == 0 {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        Ok(DepthParams { method, pixel_pitch, tolerance, max_cycles, min_n3, prior_weight, smoothness })
    }
}

/// Sets every field to its default.
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_depth_params_default(params: *mut ofc_depth_params) -> ofc_status {
    of(Out::new(params).map(|out| {
        let DepthParams { method: _, pixel_pitch, tolerance, max_cycles, min_n3, prior_weight, smoothness } =
            DepthParams::default();
        out.write(ofc_depth_params {
            pixel_pitch,
            tolerance,
            min_n3,
            prior_weight,
            smoothness,
            method: OFC_DEPTH_POISSON,
            max_cycles: max_cycles.cast_signed(),
            reserved: [0; 4],
        });
        OFC_STATUS_OK
    }))
}

/// Bytes of workspace that ofc_depth_integrate() needs: about 23 a pixel, for every method.
///
/// @return The size, or 0 when an argument is invalid or there are more than 2^29 - 1 pixels.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_depth_workspace_size(width: i32, height: i32) -> usize {
    let (width, height) = (dimension(width), dimension(height));
    if width == 0 || height == 0 {
        return 0;
    }
    depth::workspace_len(width, height).map_or(0, float_bytes)
}

/// A map of `channels` numbers a pixel, or none where the pointer is NULL.
///
/// # Safety
/// It can be read and is not written during the call.
unsafe fn plane<'a, T: Plain>(
    pointer: *const T,
    [width, height]: [usize; 2],
    channels: usize,
    stride_bytes: usize,
) -> Result<(Option<Plane<'a, T>>, Extent), ofc_status> {
    if pointer.is_null() {
        return Ok((None, Extent::NOTHING));
    }
    if !stride_bytes.is_multiple_of(size_of::<T>()) {
        return Err(OFC_STATUS_MISALIGNED);
    }
    let stride = stride_bytes / size_of::<T>();
    let need = span(width, height, channels, stride).map_err(of_image_error)?;
    // SAFETY: the caller's promise.
    let (values, extent) = unsafe { input_slice(pointer, need) }?;
    Ok((Some(Plane::new(values, width, height, channels, stride).map_err(of_image_error)?), extent))
}

/// Integrates normals or gradients into depth, which grows toward the camera.
///
/// The depths of two neighbouring pixels should differ by the mean of their slopes times the pixel pitch; depth is the
/// least-squares solution of these equations, with natural boundaries, found by conjugate gradients with geometric
/// multigrid as preconditioner. Unconnected regions have zero mean each.
///
/// @param input   What is integrated: normals, or p and q; not both.
/// @param params  See the struct.
/// @param workspace  ofc_depth_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT; contents do not matter.
/// @param workspace_bytes  Its size.
/// @param depth   Output: a float a pixel; NaN where there is no depth. Bytes between the rows stay as they are.
/// @param depth_stride_bytes  Bytes from a row to the next, a multiple of 4.
/// @param result  Output.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_CONVERGED with depth and result written when max_cycles were not enough;
///         OFC_STATUS_TOO_FEW_PIXELS when no pixel of the mask is usable; OFC_STATUS_INVALID_PARAMETER for a parameter out
///         of its range and for both normals and gradients; the status of an invalid argument.
///
/// Stack: less than 4 KiB.
///
/// Reference: section 5; J. G. Harris, "A new approach to surface reconstruction: the coupled depth/slope model", ICCV 1987.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_depth_integrate(
    input: *const ofc_depth_input,
    params: *const ofc_depth_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    depth: *mut f32,
    depth_stride_bytes: usize,
    result: *mut ofc_depth_result,
) -> ofc_status {
    let body = || {
        let (own, own_extent) = self::input(input)?;
        let (width, height) = (dimension(own.width), dimension(own.height));
        let size = [width, height];
        // What is given at all first: a picture without a pixel is refused before its pointers are.
        let span = span(width, height, 1, depth_stride_bytes / size_of::<f32>()).map_err(of_image_error)?;
        let gradients = !own.p.is_null() || !own.q.is_null();
        if gradients && !own.normals.is_null() {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        // SAFETY: the contract of this function.
        let ((normals, a), (p, b), (q, c), (mask, d), (weights, e), (prior, f)) = unsafe {
            (
                plane(own.normals, size, 3, own.normals_stride_bytes)?,
                plane(own.p, size, 1, own.p_stride_bytes)?,
                plane(own.q, size, 1, own.q_stride_bytes)?,
                plane(own.mask, size, 1, own.mask_stride_bytes)?,
                plane(own.weights, size, 1, own.weights_stride_bytes)?,
                plane(own.prior, size, 1, own.prior_stride_bytes)?,
            )
        };
        let slopes = match (normals, p, q) {
            (Some(normals), ..) => Slopes::Normals(normals),
            (None, Some(p), Some(q)) => Slopes::Gradients { p, q },
            _ => return Err(OFC_STATUS_NULL_POINTER),
        };
        let (params, params_extent) = self::input(params)?;
        let params = params.check()?;
        if !depth_stride_bytes.is_multiple_of(size_of::<f32>()) {
            return Err(OFC_STATUS_MISALIGNED);
        }
        let depth_extent = extent(depth.cast_const(), span)?;
        let need = depth::workspace_len(width, height).map_or(0, float_bytes);
        let scratch = self::workspace(workspace.cast(), workspace_bytes, need)?;
        let out = Out::new(result)?;
        disjoint(&[scratch, depth_extent, out.extent], &[own_extent, params_extent, a, b, c, d, e, f])?;
        let task = DepthInput { slopes, mask, weights, prior };
        // SAFETY: checked and disjoint.
        let (scratch, depths) = unsafe { (floats(workspace, need), output_slice(depth, span)) };
        let DepthResult { converged, cycles, residual, regions, pixels, excluded } =
            depth::integrate(&task, &params, scratch, depths, depth_stride_bytes / size_of::<f32>())
                .map_err(of_depth_error)?;
        out.write(ofc_depth_result {
            residual,
            cycles: i32::try_from(cycles).unwrap_or(i32::MAX),
            regions: count(regions),
            pixel_count: count(pixels),
            excluded_count: count(excluded),
            converged: i32::from(converged),
            reserved: 0,
        });
        Ok(if converged { OFC_STATUS_OK } else { OFC_STATUS_NOT_CONVERGED })
    };
    of(body())
}

/// Unit normals of a depth map: of central differences of its depths, one-sided at the borders of picture, mask and surface.
///
/// @param depth    The surface; there is none where the depth is not finite.
/// @param normals  Output: height rows of width times (x, y, z) floats, zero where there is no surface.
/// @param normals_stride_bytes  Bytes from a row to the next, a multiple of 4; what lies between rows is left alone.
/// @return OFC_STATUS_OK or the status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_depth_normals(
    depth: *const ofc_depth_map,
    normals: *mut f32,
    normals_stride_bytes: usize,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let (surface, [own, depths, mask]) = unsafe { surface(depth) }?;
        if !normals_stride_bytes.is_multiple_of(size_of::<f32>()) {
            return Err(OFC_STATUS_MISALIGNED);
        }
        let stride = normals_stride_bytes / size_of::<f32>();
        let need = span(surface.width(), surface.height(), 3, stride).map_err(of_image_error)?;
        let written = extent(normals.cast_const(), need)?;
        disjoint(&[written], &[own, depths, mask])?;
        // SAFETY: checked and disjoint.
        let mut rows = Rows { values: unsafe { output_slice(normals, need) }, row_stride: stride };
        normals_from_depth(&surface, &mut rows).map_err(|_| OFC_STATUS_STRIDE_TOO_SMALL)?;
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

const fn of_depth_error(error: DepthError) -> ofc_status {
    match error {
        DepthError::Size => OFC_STATUS_TOO_LARGE,
        DepthError::Parameter => OFC_STATUS_INVALID_PARAMETER,
        DepthError::Workspace(_) => OFC_STATUS_WORKSPACE_TOO_SMALL,
        DepthError::Output => OFC_STATUS_STRIDE_TOO_SMALL,
        DepthError::Empty => OFC_STATUS_TOO_FEW_PIXELS,
    }
}
