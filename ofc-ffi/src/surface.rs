//! The whole surface.

use crate::prelude::*;
use crate::uncertainty::sources;
use ofc_core::color::inliers::Inliers;
use ofc_core::surface::completion::{self, Completion, CompletionParams, DualSource, Light, Outputs};

/// What is known of a pixel: the lowest three bits of its byte, one of OFC_SURFACE_* after `byte & OFC_SURFACE_CLASS`.
pub type ofc_surface_class = u8;
/// The pixel is not in the mask.
pub const OFC_SURFACE_OUTSIDE: u8 = 0;
/// The pixel sees all three lights, and its color determines the normal.
pub const OFC_SURFACE_THREE_LIGHTS: u8 = 1;
/// The pixel sees two lights: its color determines the normal and the normal's mirror image at the plane of both lights, of which
/// integrability chooses one.
pub const OFC_SURFACE_TWO_LIGHTS: u8 = 2;
/// The pixel sees one light: its color determines the angle to it, and the surface around the rest.
pub const OFC_SURFACE_ONE_LIGHT: u8 = 3;
/// Of the color nothing is known, as of black and saturated pixels; the surface is interpolated.
pub const OFC_SURFACE_INTERPOLATED: u8 = 4;
/// The pixel sees all three lights but does not obey the model, for its noise, an interreflection, a soft shadow or a highlight: the
/// normal is that of its color, and the uncertainty holds the misfit.
pub const OFC_SURFACE_REJECTED: u8 = 5;
/// The bits of the class.
pub const OFC_SURFACE_CLASS: u8 = 7;
/// The bit of a pixel that sees light 0 of ofc_surface_result; twice and four times that for lights 1 and 2. A light whose shadow was
/// not found is taken to be seen.
pub const OFC_SURFACE_FIRST_LIGHT: u8 = 16;
/// The bit of a pixel of two lights whose mirror image is the right one with a probability above 0.1.
pub const OFC_SURFACE_DOUBTFUL: u8 = 128;

const _: () = assert!(
    OFC_SURFACE_REJECTED == completion::REJECTED
        && OFC_SURFACE_FIRST_LIGHT == completion::FIRST_LIGHT
        && OFC_SURFACE_DOUBTFUL == completion::DOUBTFUL,
    "the header says what the core does"
);

/// How ofc_surface_complete() works. Set by ofc_surface_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_surface_params {
    /// Width and height of a pixel on the surface, in the unit of the depth: in [1e-30, 1e30]. Default 1.
    pub pixel_pitch: f64,
    /// Determines every random choice. Default 0.
    pub seed: u64,
    /// 1 where each channel is a photograph of its own under one light: the rows of F are these lights then, and none is searched
    /// for. 0 else. Default 0.
    pub channels_are_lights: i32,
    /// Must be zero.
    pub reserved: [u32; 5],
}

/// How ofc_surface_complete() knows what a light's shadow leaves of a color: one of OFC_DUAL_*.
pub type ofc_dual_source = i32;
/// It does not: pixels in the shadow of this light are interpolated.
pub const OFC_DUAL_NONE: i32 = 0;
/// From the directions of all three lights.
pub const OFC_DUAL_DIRECTIONS: i32 = 1;
/// By a search, from what the shadows of one or two lights show: integrable normals that go on across the edges of cast shadows.
pub const OFC_DUAL_SEARCH: i32 = 2;
/// A search found none that the normals in the shadow agree with: pixels in the shadow of this light are interpolated.
pub const OFC_DUAL_REJECTED: i32 = 3;

/// One of the real lights, of which each channel mixes all.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_surface_light {
    /// The unit vector toward the light, x right, y up, z toward the camera; zero where there is no such light.
    pub direction: [f64; 3],
    /// The color r, g, b of a surface that faces the light, in pixel values; zero where it is not known.
    pub color: [f64; 3],
    /// How the color and what its shadow leaves are known, one of OFC_DUAL_*.
    pub dual_source: ofc_dual_source,
    /// Zero.
    pub reserved: u32,
}

/// What ofc_surface_complete() found beside the pictures.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_surface_result {
    /// The lights whose shadows were found.
    pub lights: [ofc_surface_light; 3],
    /// By how much normals differ across the borders of shadows in the median, beyond what they do among lit pixels, in radians: 0
    /// where the model holds; 0, too, where hardly any pixel sees two lights.
    pub border_gap_rad: f64,
    /// How many pixels are of each class, with OFC_SURFACE_* as the index.
    pub class_counts: [i32; 8],
    /// How many lights were found, 0 to 3.
    pub light_count: i32,
    /// How many connected regions the mask has. Each has zero mean depth.
    pub regions: i32,
    /// 1 when the depth reached its tolerance, 0 otherwise.
    pub converged: i32,
    /// Zero.
    pub reserved: u32,
}

plain!(ofc_surface_params, ofc_surface_result);

constants!(DualSource = { None: OFC_DUAL_NONE, Directions: OFC_DUAL_DIRECTIONS, Search: OFC_DUAL_SEARCH, Rejected: OFC_DUAL_REJECTED });
to_c!(CompletionParams => ofc_surface_params { pixel_pitch, seed, channels_are_lights } zero { reserved });
from_c!(CompletionParams <= ofc_surface_params { pixel_pitch, seed, channels_are_lights } zero { reserved });
to_c!(Light => ofc_surface_light { direction; color: color, dual_source: dual } zero { reserved });

impl ToC<ofc_surface_result> for Completion {
    fn to_c(&self) -> ofc_surface_result {
        let Self { lights, counts, border_gap, regions, converged } = self;
        ofc_surface_result {
            lights: lights.to_c(),
            border_gap_rad: *border_gap,
            class_counts: counts.to_c(),
            light_count: lights.iter().flatten().count().to_c(),
            regions: regions.to_c(),
            converged: converged.to_c(),
            reserved: 0,
        }
    }
}

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_surface_params_default(params: *mut ofc_surface_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = CompletionParams::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_surface_complete() needs: about 27 for each pixel. OFC_SURFACE_WORKSPACE_SIZE() is the same
/// number for static buffers.
/// @param width,height  Size of the picture.
/// @return The size; 0 when an argument is invalid or there are more than 2^29 - 1 pixels.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_surface_workspace_size(width: i32, height: i32) -> usize {
    let (width, height) = (dimension(width), dimension(height));
    if width == 0 || height == 0 {
        return 0;
    }
    completion::need(width, height).map_or(0, bytes)
}

/// Makes the whole surface of a picture: a normal, its uncertainty, a depth and a class for every pixel of the mask.
///
/// ofc_normals_compute() has normals of inliers, which see all three lights. Here shadows are used instead: the colors in the shadow
/// of a light lie in a plane, whose normal is the direction of that light. A pixel that sees two lights has one of two normals then,
/// one that sees a single light a cone of them, and what colors leave open is chosen so that all normals are those of one surface,
/// which bridges pixels without evidence. Lights whose shadows are in no picture cannot be found, and what lies in their shadow is
/// interpolated, as it is under more than three lights: classes say so.
///
/// What was said of the solution's reliability holds here, too. Errors of the orientation that all pixels share are in the
/// uncertainty; a wrong choice of a mirror image is not, but a bit says where it may be.
/// @param image  The picture that was solved, with its mask.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param params  The parameters.
/// @param workspace  ofc_surface_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param normals  Output: height rows of width (x, y, z) floats, unit normals; zero outside of the mask.
/// @param normals_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @param angle_rad  Output: height rows of width floats, the angle in radians below which 68.3 % of the errors of such a normal
///     are expected to lie; pi outside of the mask.
/// @param angle_stride_bytes  The same for this output.
/// @param depth  Output: height rows of width floats, growing toward the camera, in the unit of the pixel pitch; NaN outside of
///     the mask.
/// @param depth_stride_bytes  The same for this output.
/// @param classes  Output: height rows of width bytes, OFC_SURFACE_*.
/// @param classes_stride_bytes  Bytes from one row to the next.
/// @param result  Output: the lights, and how it went.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_CONVERGED, outputs written, when the depth did not reach its tolerance;
///     OFC_STATUS_NOT_SOLVED, also where the solution is that of another picture, as lit pixels that do not fit it tell;
///     OFC_STATUS_NO_COVARIANCE for a solution by the direct method; OFC_STATUS_TOO_FEW_PIXELS when no pixel
///     of the mask is usable; an argument status.
///
/// Stack: below 24 KiB. Reference: section 6, which leaves this open; docs/whole-surface.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_surface_complete(
    image: *const ofc_image,
    solution: *const ofc_solution,
    params: *const ofc_surface_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    normals: *mut f32,
    normals_stride_bytes: usize,
    angle_rad: *mut f32,
    angle_stride_bytes: usize,
    depth: *mut f32,
    depth_stride_bytes: usize,
    classes: *mut ofc_surface_class,
    classes_stride_bytes: usize,
    result: *mut ofc_surface_result,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let solution = call.input(solution)?;
        let sources = sources(&solution)?;
        let saturation = Inliers::from_c(solution.inlier_test)?.usable.saturation;
        let params: CompletionParams = call.params(params)?;
        let size = size(&picture);
        let outputs = Outputs {
            normals: call.output_rows(normals, size, 3, normals_stride_bytes)?,
            angles: call.output_rows(angle_rad, size, 1, angle_stride_bytes)?,
            depths: call.output_rows(depth, size, 1, depth_stride_bytes)?,
            classes: call.output_rows(classes, size, 1, classes_stride_bytes)?,
        };
        let need = completion::need(picture.width(), picture.height()).unwrap_or_default();
        let workspace = call.arena(workspace, workspace_bytes, need)?;
        let result = call.output(result)?;
        let found = completion::complete(&picture, &sources, saturation, &params, workspace, outputs)?;
        *result = found.to_c();
        Ok(if found.converged { OFC_STATUS_OK } else { OFC_STATUS_NOT_CONVERGED })
    })
}
