//! Depth from normals or gradients.

use crate::prelude::*;
use ofc_core::render::{Rows, normals_from_depth};
use ofc_core::surface::depth::{self, DepthInput, DepthParams, DepthResult, Method, Plane, Slopes};

/// What to do where a slope is unusable because its normal is not finite or faces away, or its weight is zero: one of
/// OFC_DEPTH_*.
pub type ofc_depth_method = i32;
/// Least squares over the usable pixels of the mask; other pixels have no depth.
pub const OFC_DEPTH_POISSON: i32 = 0;
/// The method of the paper (section 5): least squares over the whole rectangle, flat (p = q = 0) outside of the mask
/// and at unusable pixels. The pixels of the mask have a depth.
pub const OFC_DEPTH_PAPER: i32 = 1;
/// Harris's coupled depth/slope model over the whole mask: depth and smooth slopes that fit each other, and the usable
/// pixels, bridge the others. The squared misfit of depth and slopes along an edge weighs 10 times `smoothness`, as does
/// the equation of an edge to which `prior_weight` refers.
pub const OFC_DEPTH_COUPLED: i32 = 2;

/// What ofc_depth_integrate() integrates. Initialize the whole struct: fields that are not set must be zero.
///
/// Row 0 is the top row. Floats and their strides are aligned to four bytes. Strides of maps that are NULL are ignored.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_input {
    /// (x right, y up, z toward the camera) floats of any length, unusable where not finite or z <= 0; NULL with p and
    /// q.
    pub normals: *const f32,
    /// How many bytes lie from one row to the next.
    pub normals_stride_bytes: usize,
    /// dz/dx, a float for each pixel; NULL when normals are given.
    pub p: *const f32,
    /// How many bytes lie from one row to the next.
    pub p_stride_bytes: usize,
    /// dz/dy with y up, a float for each pixel; NULL when normals are given.
    pub q: *const f32,
    /// How many bytes lie from one row to the next.
    pub q_stride_bytes: usize,
    /// A byte for each pixel, which has a depth where the byte is not zero; or NULL.
    pub mask: *const u8,
    /// How many bytes lie from one row to the next.
    pub mask_stride_bytes: usize,
    /// Weights of the slopes, limited to [1e-4, 1e4]; or NULL for 1. A slope is unusable where its weight is not
    /// positive and finite.
    pub weights: *const f32,
    /// How many bytes lie from one row to the next.
    pub weights_stride_bytes: usize,
    /// Known depths in the unit of the result, not finite where unknown; or NULL.
    pub prior: *const f32,
    /// How many bytes lie from one row to the next.
    pub prior_stride_bytes: usize,
    /// How many pixels are in a row, at least 1.
    pub width: i32,
    /// How many rows there are, at least 1.
    pub height: i32,
}

/// How ofc_depth_integrate() works. Set by ofc_depth_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_params {
    /// Width and height of a pixel on the surface, in the unit of the depth: in [1e-30, 1e30]. Default 1.
    pub pixel_pitch: f64,
    /// The residual to reach, relative to the norm of the right-hand side: in [1e-6, 1]. Default 1e-4. For
    /// OFC_DEPTH_COUPLED, also how far the depth may still have to go, relative to depth and slopes.
    pub tolerance: f64,
    /// Normals with n3 / |n| below this lose weight with its square, and their slope stops growing: in [0.001, 1].
    /// Default 0.05, for slopes up to 20.
    pub min_n3: f64,
    /// Weight of a pixel of the prior relative to the equation of one edge, in [0, 1e6]; 0 ignores the prior. With any
    /// other, known depths are right on average in each region, and with the smallest that is all they do. Default 1e-3.
    pub prior_weight: f64,
    /// For OFC_DEPTH_COUPLED: the weight of the squared difference of neighboring slopes relative to the weight of the
    /// squared difference of a pixel's slope from its data, in [1e-3, 1e3]. Default 0.1.
    pub smoothness: f64,
    /// One of OFC_DEPTH_*. Default OFC_DEPTH_POISSON.
    pub method: ofc_depth_method,
    /// At most so many multigrid cycles for each system of equations, at least 1; 4 to 15 are usual, 6 to 25 for
    /// OFC_DEPTH_COUPLED. Default 1000.
    pub max_cycles: i32,
    /// Must be zero.
    pub reserved: [u32; 4],
}

/// How ofc_depth_integrate() went.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_depth_result {
    /// The last residual relative to the norm of the right-hand side, before the depth is rounded to floats. For a
    /// rectangle that is solved directly it is the residual after rounding (1e-3 for a million pixels).
    pub residual: f64,
    /// How many multigrid cycles all systems of equations took together. Zero for a rectangle without gaps, weights and
    /// prior, which is solved directly where one of its sides has no prime factor above 7.
    pub cycles: i32,
    /// How many connected regions there are. Each has zero mean depth unless the prior reaches into it.
    pub regions: i32,
    /// How many pixels have a depth.
    pub pixel_count: i32,
    /// How many pixels of the mask were unusable.
    pub excluded_count: i32,
    /// 1 when the tolerance was reached, or what floats can hold; 0 otherwise. For OFC_DEPTH_COUPLED, the changes of
    /// depth that are still to come, as the last ones tell, are below the tolerance too: gaps are soft, and a residual
    /// would not show them.
    pub converged: i32,
    /// Zero.
    pub reserved: u32,
}

plain!(ofc_depth_input, ofc_depth_params, ofc_depth_result);

constants!(Method = { Poisson: OFC_DEPTH_POISSON, Paper: OFC_DEPTH_PAPER, Coupled: OFC_DEPTH_COUPLED });
to_c!(DepthParams => ofc_depth_params {
    pixel_pitch, tolerance, min_n3, prior_weight, smoothness, method, max_cycles
} zero { reserved });
from_c!(DepthParams <= ofc_depth_params {
    pixel_pitch, tolerance, min_n3, prior_weight, smoothness, method, max_cycles
} zero { reserved });
to_c!(DepthResult => ofc_depth_result {
    residual, cycles, regions, converged; pixel_count: pixels, excluded_count: excluded
} zero { reserved });

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_depth_params_default(params: *mut ofc_depth_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = DepthParams::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_depth_integrate() needs: about 23 for each pixel, with every method.
/// @param width,height  Size of the input.
/// @return The size; 0 when an argument is invalid or there are more than 2^29 - 1 pixels.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_depth_workspace_size(width: i32, height: i32) -> usize {
    let (width, height) = (dimension(width), dimension(height));
    if width == 0 || height == 0 {
        return 0;
    }
    depth::need(width, height).map_or(0, bytes)
}

/// A map of `channels` numbers a pixel, or none where the pointer is NULL.
fn plane<'a, T: Plain>(
    call: &mut Call<'a>,
    pointer: *const T,
    [width, height]: [usize; 2],
    channels: usize,
    stride_bytes: usize,
) -> Result<Option<Plane<'a, T>>, Refusal> {
    unless_null(pointer, || {
        let (values, stride) = call.input_rows(pointer, [width, height], channels, stride_bytes)?;
        Ok(Plane::new(values, width, height, channels, stride)?)
    })
}

/// Integrates normals or gradients into depth, which grows toward the camera.
///
/// The depths of neighboring pixels should differ by the mean of their slopes times the pixel pitch. These equations
/// are solved in least squares with natural boundaries, by conjugate gradients with multigrid. Each connected region
/// has zero mean.
/// @param input  What to integrate: normals, or p and q, but not both.
/// @param params  The parameters.
/// @param workspace  ofc_depth_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param depth  Output: height rows of width floats; NaN where there is no depth.
/// @param depth_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @param result  Output: how it went.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_CONVERGED, outputs written, when max_cycles were not enough;
///     OFC_STATUS_TOO_FEW_PIXELS when no pixel of the mask is usable; an argument status, OFC_STATUS_INVALID_PARAMETER
///     also for normals with p or q.
///
/// Stack: below 6 KiB. Reference: section 5; J. G. Harris, "A new approach to surface reconstruction: the coupled
/// depth/slope model", ICCV 1987.
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
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let own = call.input(input)?;
        let size = size_of_map(own.width, own.height)?;
        let gradients = !own.p.is_null() || !own.q.is_null();
        ensure(own.normals.is_null() || !gradients, OFC_STATUS_INVALID_PARAMETER)?;
        let normals = plane(call, own.normals, size, 3, own.normals_stride_bytes)?;
        let p = plane(call, own.p, size, 1, own.p_stride_bytes)?;
        let q = plane(call, own.q, size, 1, own.q_stride_bytes)?;
        let slopes = match (normals, p, q) {
            (Some(normals), ..) => Slopes::Normals(normals),
            (None, Some(p), Some(q)) => Slopes::Gradients { p, q },
            _ => return Err(Refusal(OFC_STATUS_NULL_POINTER)),
        };
        let task = DepthInput {
            slopes,
            mask: plane(call, own.mask, size, 1, own.mask_stride_bytes)?,
            weights: plane(call, own.weights, size, 1, own.weights_stride_bytes)?,
            prior: plane(call, own.prior, size, 1, own.prior_stride_bytes)?,
        };
        let params: DepthParams = call.params(params)?;
        let (depths, stride) = call.output_rows(depth, size, 1, depth_stride_bytes)?;
        let [width, height] = size;
        let need = depth::need(width, height).unwrap_or_default();
        let workspace = call.arena(workspace, workspace_bytes, need)?;
        let result = call.output(result)?;
        let found = depth::integrate(&task, &params, workspace, depths, stride)?;
        *result = found.to_c();
        Ok(if found.converged { OFC_STATUS_OK } else { OFC_STATUS_NOT_CONVERGED })
    })
}

/// Computes the unit normals of a depth map, from central differences of its depths, one-sided at the borders of
/// picture, mask and surface.
/// @param depth  The surface. There is none where the depth is not finite.
/// @param normals  Output: height rows of width (x, y, z) floats, x right, y up, z toward the camera; zero where there
///     is no surface.
/// @param normals_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_depth_normals(
    depth: *const ofc_depth_map,
    normals: *mut f32,
    normals_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let surface = call.surface(depth)?;
        let size = [surface.width(), surface.height()];
        let (values, row_stride) = call.output_rows(normals, size, 3, normals_stride_bytes)?;
        let written = normals_from_depth(&surface, &mut Rows { values, row_stride });
        written.map_err(|_| OFC_STATUS_STRIDE_TOO_SMALL)?;
        Ok(OFC_STATUS_OK)
    })
}
