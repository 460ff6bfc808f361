//! Uneven paint.

use crate::prelude::*;
use ofc_core::color::ellipsoid::is_positive_definite;
use ofc_core::color::paint::albedo;
use ofc_core::color::paint::{self, Paint, Params, Verdict};
use ofc_core::picture::{Image, Usable};

/// At how many distances ofc_paint_estimate() compares pixels.
pub const OFC_PAINT_DISTANCES: usize = 3;
const _: () = assert!(OFC_PAINT_DISTANCES == paint::DISTANCES, "the header says what the core does");

/// How ofc_paint_estimate() and what follows it work. Set by ofc_paint_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_paint_params {
    /// A pixel with a channel at or above this level is saturated; zero stands for the largest value of the pixel type,
    /// and for no limit with floats. Default 0.
    pub saturation: f64,
    /// Determines every random choice. Default 0.
    pub seed: u64,
    /// Must be zero.
    pub reserved: [u32; 4],
}

/// What the paint is like, or why it cannot be told from the shape: one of OFC_PAINT_*.
pub type ofc_paint_verdict = i32;
/// The paint is smooth against the shape: C is about as good as if the paint were known.
pub const OFC_PAINT_SMOOTH: i32 = 1;
/// The paint is nearly as rough as the shape: C may be twice as wrong as if the paint were known.
pub const OFC_PAINT_ROUGH: i32 = 2;
/// The paint is as rough as the shape, and C may be wrong.
pub const OFC_PAINT_BUSY: i32 = 3;
/// The paint has two hues or more, or hard shadows look so, and C is wrong: solve regions of one paint each.
pub const OFC_PAINT_TWO_HUES: i32 = 4;
/// The colors, whatever their paint, do not determine C: normals or lights span too little.
pub const OFC_PAINT_UNDETERMINED: i32 = 5;
/// The pixels agree on no ellipsoid, or too few differ from their neighbors.
pub const OFC_PAINT_NO_ELLIPSOID: i32 = 6;

/// What ofc_paint_estimate() found.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_paint {
    /// C for the median albedo: c11, c22, c33, c12, c13, c23 in (pixel value)^-2; zeros where there is none.
    pub coefficients: [f64; 6],
    /// The noise that would explain the colors by a scene that does not determine C, over the noise across the colors' direction.
    /// Paint is in neither. Degenerate scenes reach 1.2; below 2 the verdict is OFC_PAINT_UNDETERMINED.
    pub margin: f64,
    /// The noise of a channel across the direction of the color, in pixel values.
    pub direction_noise: f64,
    /// How much worse the next best C explains the pixels: above 4 the paint is smooth, below 1.7 busy. NaN without a C.
    pub ratio: f64,
    /// How much the C of two halves of the compared pixels differ: a sphere for the one is an ellipsoid for the other, and this is the
    /// ratio of its longest to its shortest semi-axis. Above 1.5 C is not determined. Infinite where a half has no C, NaN without
    /// a C.
    pub disagreement: f64,
    /// By how many deviations steps of one hue stand out among all steps of the colors' direction; from 8 on there are two hues.
    pub hue_excess: f64,
    /// The gradient of the logarithm of the albedo across the whole picture, a pixel: x, y.
    pub gradient: [f64; 2],
    /// The variogram of the paint: the deviation of the difference of log albedo^2 between pixels of each distance, beyond noise and
    /// gradient. Smooth paint is below 0.1 at the shortest distance and rises, busy paint is above 0.3. NaN where too few pixels
    /// were compared.
    pub variogram: [f64; OFC_PAINT_DISTANCES],
    /// What became of the pixels.
    pub pixel_counts: ofc_pixel_counts,
    /// The distances, in pixels.
    pub distances: [i32; OFC_PAINT_DISTANCES],
    /// How many pairs of pixels were compared at each distance.
    pub pair_counts: [i32; OFC_PAINT_DISTANCES],
    /// What to make of these numbers.
    pub verdict: ofc_paint_verdict,
    /// Zero.
    pub reserved: u32,
}

plain!(ofc_paint_params, ofc_paint);

to_c!(Params => ofc_paint_params { seed } zero { saturation, reserved });
from_c!(Params <= ofc_paint_params { seed } without { saturation } zero { reserved });

constants!(Verdict = {
    Smooth: OFC_PAINT_SMOOTH,
    Rough: OFC_PAINT_ROUGH,
    Busy: OFC_PAINT_BUSY,
    TwoHues: OFC_PAINT_TWO_HUES,
    Undetermined: OFC_PAINT_UNDETERMINED,
    NoEllipsoid: OFC_PAINT_NO_ELLIPSOID,
});

to_c!(Paint => ofc_paint {
    margin, direction_noise, ratio, disagreement, hue_excess, gradient, variogram, pixel_counts, distances, verdict;
    coefficients: form, pair_counts: pairs
} zero { reserved });

/// The parameters, and the pixels that they leave.
impl FromC<ofc_paint_params> for (Params, Option<f32>) {
    fn from_c(value: ofc_paint_params) -> Result<Self, Refusal> {
        Ok((Params::from_c(value)?, saturation(value.saturation)?))
    }
}

fn usable(picture: &Image, saturation: Option<f32>) -> Usable {
    Usable::below(saturation.unwrap_or(picture.sample().saturation()))
}

/// What the status of a verdict is.
const fn status(verdict: Verdict) -> ofc_status {
    match verdict {
        Verdict::Smooth | Verdict::Rough => OFC_STATUS_OK,
        Verdict::Busy | Verdict::TwoHues => OFC_STATUS_PAINT_UNKNOWN,
        Verdict::Undetermined => OFC_STATUS_RANK_DEFICIENT,
        Verdict::NoEllipsoid => OFC_STATUS_NOT_POSITIVE_DEFINITE,
    }
}

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_paint_params_default(params: *mut ofc_paint_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_paint_estimate() needs, whatever the size of the picture.
/// @return The size, OFC_PAINT_WORKSPACE_SIZE.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_paint_workspace_size() -> usize {
    bytes(Need::of_singles(paint::WORKSPACE_LEN))
}

/// Estimates C where the paint is uneven, from pairs of neighboring pixels: they share their paint, whatever it is.
///
/// ofc_solve() takes the length of a color for that of its normal. Where the albedo varies by more than some percent it refuses
/// the picture or bends C. Here it may vary from pixel to pixel, as long as it changes more slowly than the surface's direction and
/// keeps its hue. C comes up to its scale. What follows is ofc_paint_albedo(), ofc_paint_divide(), and ofc_solve() with what
/// that makes:
///
///     ofc_paint_estimate(&image, &params, workspace, bytes, &paint);
///     ofc_paint_albedo(&image, &params, paint.coefficients, workspace, bytes, albedo, stride);
///     ofc_paint_divide(&image, &params, albedo, stride, pixels, 3 * stride);
///     ofc_image even = {.pixels = pixels, .width = w, .height = h, .row_stride_bytes = 3 * stride, .format = OFC_PIXEL_RGB32F};
/// @param image  The picture.
/// @param params  The parameters.
/// @param workspace  ofc_paint_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param paint  Output: what was found.
/// @return OFC_STATUS_OK for a smooth or a rough paint. OFC_STATUS_PAINT_UNKNOWN for a busy one or two hues,
///     OFC_STATUS_RANK_DEFICIENT where C is not determined, OFC_STATUS_NOT_POSITIVE_DEFINITE where there is none: `paint` is written
///     all the same. OFC_STATUS_TOO_FEW_PIXELS, OFC_STATUS_DARK or OFC_STATUS_SATURATED for fewer than 100 usable pixels; an argument
///     status.
///
/// Stack: below 16 KiB.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_paint_estimate(
    image: *const ofc_image,
    params: *const ofc_paint_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    paint: *mut ofc_paint,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let (params, saturation): (Params, _) = call.params(params)?;
        let workspace = call.floats(workspace, workspace_bytes, paint::WORKSPACE_LEN)?;
        let paint = call.output(paint)?;
        let found = paint::estimate(&picture, usable(&picture, saturation), &params, workspace)?;
        *paint = found.to_c();
        Ok(status(found.verdict))
    })
}

/// Says how many bytes of workspace ofc_paint_albedo() needs: 8 for each pixel, and a little more.
/// @param width,height  Size of the picture.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_paint_albedo_workspace_size(width: i32, height: i32) -> usize {
    let is_size = pixel_count(width, height) > 0;
    let need = albedo::workspace_len(dimension(width), dimension(height));
    bytes(Need::of_singles(if is_size { need } else { 0 }))
}

/// Makes a picture of the paint: the length of the normal that C makes of each color, averaged over a small neighborhood.
/// @param image  The picture.
/// @param params  The parameters.
/// @param coefficients  C up to its scale, six numbers as ofc_paint has them.
/// @param workspace  ofc_paint_albedo_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param albedo  Output: height rows of width floats with the median 1; NaN where a pixel is not usable.
/// @param albedo_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS where no pixel is usable; an argument status, OFC_STATUS_INVALID_PARAMETER
///     for a C that is not finite or not positive definite.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_paint_albedo(
    image: *const ofc_image,
    params: *const ofc_paint_params,
    coefficients: *const f64,
    workspace: *mut c_void,
    workspace_bytes: usize,
    albedo: *mut f32,
    albedo_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let (_, saturation): (Params, _) = call.params(params)?;
        let form: [f64; 6] = call.input_array(coefficients)?;
        let is_form = form.iter().all(|c| c.is_finite()) && is_positive_definite(&form);
        ensure(is_form, OFC_STATUS_INVALID_PARAMETER)?;
        let need = albedo::workspace_len(picture.width(), picture.height());
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let (albedo, stride) = call.output_rows(albedo, size(&picture), 1, albedo_stride_bytes)?;
        albedo::albedo(&picture, usable(&picture, saturation), &form, albedo, stride, workspace)?;
        Ok(OFC_STATUS_OK)
    })
}

/// Divides a picture by its albedo, as if its paint were even: for ofc_solve(), as OFC_PIXEL_RGB32F.
/// @param image  The picture.
/// @param params  The parameters.
/// @param albedo  Height rows of width floats, as ofc_paint_albedo() makes them.
/// @param albedo_stride_bytes  Bytes from one row to the next, a multiple of 4.
/// @param pixels  Output: height rows of width (r, g, b) floats; NaN, which ofc_solve() leaves out, where a pixel is not usable,
///     its albedo not above zero and finite, or the quotient too large for a float.
/// @param pixels_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_paint_divide(
    image: *const ofc_image,
    params: *const ofc_paint_params,
    albedo: *const f32,
    albedo_stride_bytes: usize,
    pixels: *mut f32,
    pixels_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let (_, saturation): (Params, _) = call.params(params)?;
        let (albedo, albedo_stride) = call.input_rows(albedo, size(&picture), 1, albedo_stride_bytes)?;
        let (pixels, stride) = call.output_rows(pixels, size(&picture), 3, pixels_stride_bytes)?;
        albedo::divide(&picture, usable(&picture, saturation), albedo, albedo_stride, pixels, stride)?;
        Ok(OFC_STATUS_OK)
    })
}
