//! Segmentation: pictures with more than one material or light environment.

use crate::check::ofc_rank;
use crate::image::{dimension, image, ofc_image};
use crate::pointers::{Out, Plain, disjoint, extent, input, input_slice, output_slice, workspace};
use crate::regression::pixel_count;
use crate::status::{
    OFC_STATUS_EMPTY, OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_OK, OFC_STATUS_RESERVED_NOT_ZERO,
    OFC_STATUS_TOO_LARGE, OFC_STATUS_WORKSPACE_TOO_SMALL, of, ofc_status,
};
use crate::types::count;
use core::ffi::c_void;
use ofc_core::color::segment::{self, MAX_REGIONS, Params, Region, SegmentError, patches};
use ofc_core::picture::Usable;

/// Regions at most.
pub const OFC_MAX_REGIONS: usize = 16;
const _: () = assert!(OFC_MAX_REGIONS == MAX_REGIONS, "the header says what the core does");

/// How ofc_segment() works. Set by ofc_segment_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_segment_params {
    /// Largest |rho^T C rho - 1| within a region, in (0, 1). Default 0.1: colors within 5 % of the ellipsoid.
    pub tolerance: f64,
    /// A pixel is saturated if a channel is at or above this; 0 as in ofc_lmeds_params. Default 0.
    pub saturation: f64,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
    /// Smaller regions are dropped, pixels, at least 12. Default 200.
    pub min_pixels: u32,
    /// At most this many regions, 1 to OFC_MAX_REGIONS. Default 8.
    pub max_regions: u32,
    /// Blocks of six pixels that are tried for each region, 1 to 1,000,000. Default 300.
    pub blocks: u32,
    /// Distance between the pixels of a block, up to 64; 0 for 1, 2, 4, 8 and 16 in turn. Default 0.
    pub spacing: u32,
    /// How far around a block its C is tried, 1 to 1000 pixels. Default 24.
    pub reach: u32,
    /// Times that a region is fitted and grown again, up to 100. Default 12.
    pub refits: u32,
    /// Must be zero.
    pub reserved: [u32; 4],
}

/// One region of pixels that share a C.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_region {
    /// C over its pixels: c11, c22, c33, c12, c13, c23 in (pixel value)^-2.
    pub coefficients: [f64; 6],
    /// Standard deviation of the residuals.
    pub residual_deviation: f64,
    /// Ranks of its colors and normals.
    pub rank: ofc_rank,
    /// How many pixels.
    pub pixel_count: i32,
    /// Its value in the label map, from 1 on.
    pub label: i32,
    /// Column and row of the top left pixel of the block that it began at.
    pub block: [i32; 2],
    /// Distance between the pixels of that block.
    pub spacing: i32,
    /// Zero.
    pub reserved: u32,
}

// SAFETY: integers and floats.
unsafe impl Plain for ofc_segment_params {}
// SAFETY: as above.
unsafe impl Plain for ofc_region {}
// SAFETY: an integer.
unsafe impl Plain for u16 {}

impl ofc_segment_params {
    fn defaults() -> Self {
        let Params { tolerance, min_pixels, max_regions, blocks, spacing, reach, refits, seed } =
            Params::default();
        let (saturation, reserved) = (0.0, [0; 4]);
        Self {
            tolerance,
            saturation,
            seed,
            min_pixels,
            max_regions,
            blocks,
            spacing,
            reach,
            refits,
            reserved,
        }
    }

    fn check(self) -> Result<(Params, Option<f32>), ofc_status> {
        let Self {
            tolerance,
            saturation,
            seed,
            min_pixels,
            max_regions,
            blocks,
            spacing,
            reach,
            refits,
            reserved,
        } = self;
        if reserved != [0; 4] {
            return Err(OFC_STATUS_RESERVED_NOT_ZERO);
        }
        let params = Params { tolerance, min_pixels, max_regions, blocks, spacing, reach, refits, seed };
        if !params.are_valid() || saturation.is_nan() || saturation < 0.0 {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        Ok((params, (saturation > 0.0).then_some(saturation as f32)))
    }
}

impl From<&Region> for ofc_region {
    fn from(region: &Region) -> Self {
        let Region { label, pixels, coefficients, residual_deviation, rank, block, spacing } = *region;
        Self {
            coefficients,
            residual_deviation,
            rank: rank.map_or(ofc_rank::default(), ofc_rank::from),
            pixel_count: count(pixels),
            label: i32::from(label),
            block: block.map(u32::cast_signed),
            spacing: spacing.cast_signed(),
            reserved: 0,
        }
    }
}

/// Sets every field to its default.
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_segment_params_default(params: *mut ofc_segment_params) -> ofc_status {
    of(Out::new(params).map(|out| {
        out.write(ofc_segment_params::defaults());
        OFC_STATUS_OK
    }))
}

/// Bytes of workspace that ofc_segment() needs: 16 a pixel.
///
/// @return The size, or 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_segment_workspace_size(width: i32, height: i32) -> usize {
    pixel_count(width, height).checked_mul(16).filter(|&bytes| isize::try_from(bytes).is_ok()).unwrap_or(0)
}

/// Finds regions that share a C: each begins at six contiguous pixels and grows as far as the tolerance allows. Where a
/// picture holds more than one material or light environment, this comes before ofc_solve(), which is pointed at one
/// region by ofc_segment_mark() and the picture's mask.
///
/// @param image      The picture.
/// @param params     See the struct.
/// @param workspace  ofc_segment_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT; contents do not matter.
/// @param workspace_bytes  Its size.
/// @param labels     Output: width x height labels, rows without gaps: 0, or that of the pixel's region.
/// @param regions    Output: OFC_MAX_REGIONS structs, of which the first `count` are written, in the order found.
/// @param count      Output; no region is no error.
/// @return OFC_STATUS_OK or the status of an invalid argument.
///
/// Stack: below 24 KiB. Reference: section 1.2; L. L. Kontsevich, A. P. Petrov, I. S. Vergelskaya, JOSA A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_segment(
    image: *const ofc_image,
    params: *const ofc_segment_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    labels: *mut u16,
    regions: *mut ofc_region,
    count: *mut i32,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (params, params_extent) = input(params)?;
        let (params, saturation) = params.check()?;
        let view = &picture.view;
        let pixels = view.width() * view.height();
        let need = pixels
            .checked_mul(16)
            .filter(|&bytes| isize::try_from(bytes).is_ok())
            .ok_or(OFC_STATUS_TOO_LARGE)?;
        let scratch = self::workspace(workspace.cast(), workspace_bytes, need)?;
        let labels_extent = extent(labels.cast_const(), pixels)?;
        let regions_extent = extent(regions.cast_const(), OFC_MAX_REGIONS)?;
        let out = Out::new(count)?;
        let [a, b, c, d, e] = picture.extents;
        disjoint(&[scratch, labels_extent, regions_extent, out.extent], &[a, b, c, d, e, params_extent])?;
        let usable = Usable::below(saturation.unwrap_or(view.sample().saturation()));
        let colors_len = segment::colors_len(pixels);
        // SAFETY: checked and disjoint; the workspace holds three floats a pixel and then one integer a pixel.
        let (colors, queue, labels, regions) = unsafe {
            (
                output_slice(workspace.cast::<f32>(), colors_len),
                output_slice(workspace.cast::<u32>().add(colors_len), pixels),
                output_slice(labels, pixels),
                output_slice(regions, OFC_MAX_REGIONS),
            )
        };
        let found =
            segment::segment(view, usable, &params, labels, colors, queue).map_err(of_segment_error)?;
        for (slot, region) in regions.iter_mut().zip(&found) {
            *slot = region.into();
        }
        out.write(crate::types::count(found.len()));
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

const fn of_segment_error(error: SegmentError) -> ofc_status {
    match error {
        SegmentError::Params => OFC_STATUS_INVALID_PARAMETER,
        SegmentError::LabelsTooShort | SegmentError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
    }
}

/// Turns one label into a mask for ofc_image: 255 where a pixel has it, 0 elsewhere.
///
/// @param labels  width x height labels, rows without gaps.
/// @param width   Pixels in a row.
/// @param height  Rows.
/// @param label   1 to 65535.
/// @param mask    Output: width x height bytes, rows without gaps.
/// @return OFC_STATUS_OK; OFC_STATUS_INVALID_PARAMETER for a label out of range; the status of an invalid argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_segment_mark(
    labels: *const u16,
    width: i32,
    height: i32,
    label: i32,
    mask: *mut u8,
) -> ofc_status {
    let body = || {
        let pixels = pixel_count(width, height);
        if dimension(width) == 0 || dimension(height) == 0 {
            return Err(OFC_STATUS_EMPTY);
        }
        if pixels == 0 {
            return Err(OFC_STATUS_TOO_LARGE);
        }
        // SAFETY: the contract of this function.
        let (labels, labels_extent) = unsafe { input_slice(labels, pixels) }?;
        disjoint(&[extent(mask.cast_const(), pixels)?], &[labels_extent])?;
        let label = u16::try_from(label).ok().filter(|&label| label > 0);
        let label = label.ok_or(OFC_STATUS_INVALID_PARAMETER)?;
        // SAFETY: checked and disjoint.
        segment::mark(labels, label, unsafe { output_slice(mask, pixels) });
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

/// Patches in a row (and, with height for width, in a column) of a picture: width over side, rounded up; 0 for a width
/// or side that is not positive.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_rank_patches_count(width: i32, side: i32) -> i32 {
    let [across, _] = patches::shape(dimension(width), 1, dimension(side));
    count(across)
}

/// Classifies a picture's patches by the rank of their colors.
///
/// @param image  The picture.
/// @param side   Side of a patch, 3 to 64 pixels; patches at the right and lower edges may be smaller.
/// @param noise  Standard deviation of a channel in pixel values, > 0; ofc_rank has it.
/// @param ranks  Output: ofc_rank_patches_count() a row and a column, rows without gaps: 1 to 3, or 0 where fewer than
///               half of the pixels are usable.
/// @return OFC_STATUS_OK; OFC_STATUS_INVALID_PARAMETER; the status of an invalid argument.
///
/// Reference: section 1.2; A. P. Petrov, L. L. Kontsevich, JOSA A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rank_patches(
    image: *const ofc_image,
    side: i32,
    noise: f64,
    ranks: *mut u8,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (view, side) = (&picture.view, dimension(side));
        let [across, down] = patches::shape(view.width(), view.height(), side.max(patches::MIN_SIDE));
        let ranks_extent = extent(ranks.cast_const(), across * down)?;
        let [a, b, c, d, e] = picture.extents;
        disjoint(&[ranks_extent], &[a, b, c, d, e])?;
        let valid =
            (patches::MIN_SIDE..=patches::MAX_SIDE).contains(&side) && noise > 0.0 && noise.is_finite();
        if !valid {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        let usable = Usable::below(view.sample().saturation());
        // SAFETY: checked and disjoint.
        let ranks = unsafe { output_slice(ranks, across * down) };
        patches::patches(view, usable, side, noise, ranks).map_err(|_| OFC_STATUS_INVALID_PARAMETER)?;
        Ok(OFC_STATUS_OK)
    };
    of(body())
}
