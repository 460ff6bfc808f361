//! Segmentation: pictures with more than one material or light environment.

use crate::prelude::*;
use ofc_core::color::rank::{Class, patches};
use ofc_core::color::segment::{self, MAX_REGIONS, Params, Region};
use ofc_core::picture::Usable;

/// The largest number of regions.
pub const OFC_MAX_REGIONS: usize = 16;
const _: () = assert!(OFC_MAX_REGIONS == MAX_REGIONS, "the header says what the core does");

/// How ofc_segment() works. Set by ofc_segment_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_segment_params {
    /// The largest |rho^T C rho - 1| within a region, in (0, 1). Default 0.1: colors lie within 5 % of the ellipsoid.
    pub tolerance: f64,
    /// A pixel with a channel at or above this level is saturated; zero stands for the largest value of the pixel type,
    /// and for no limit with floats. Default 0.
    pub saturation: f64,
    /// Determines every random choice. Default 0.
    pub seed: u64,
    /// Regions with fewer pixels are dropped; at least 12. Default 200.
    pub min_pixels: u32,
    /// At most so many regions are found, 1 to OFC_MAX_REGIONS. Default 8.
    pub max_regions: u32,
    /// How many blocks of six pixels are tried for each region, 1 to 1,000,000. Default 300.
    pub seed_blocks: u32,
    /// The distance between the pixels of a block, up to 64; 0 for 1, 2, 4, 8 and 16 in turn. Default 0.
    pub spacing: u32,
    /// How far around a block its C is tried, 1 to 1000 pixels. Default 24.
    pub search_radius: u32,
    /// How often a region is fitted and grown again, up to 100 times. Default 12.
    pub refits: u32,
    /// Must be zero.
    pub reserved: [u32; 4],
}

/// One region of pixels that share a C.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_region {
    /// C over the region's pixels: c11, c22, c33, c12, c13, c23 in (pixel value)^-2.
    pub coefficients: [f64; 6],
    /// The standard deviation of the residuals.
    pub residual_deviation: f64,
    /// Ranks of the region's colors and normals.
    pub rank: ofc_rank,
    /// How many pixels the region has.
    pub pixel_count: i32,
    /// The region's value in the label map, from 1 on.
    pub label: i32,
    /// Column and row of the top left pixel of the block from which the region was grown.
    pub seed_block: [i32; 2],
    /// The distance between the pixels of that block.
    pub spacing: i32,
    /// Zero.
    pub reserved: u32,
}

/// What lights and surface a patch is of. Its colors say so as far as this table goes, and what they do not say is 0:
///
/// | colors of the patch                                    | light | surface |
/// | three dimensions                                       | 3     | 3       |
/// | two dimensions, filling a part of their plane          | 2     | 3       |
/// | two dimensions, on a conic: the normals lie in a plane | 0     | 2       |
/// | one dimension, of varying brightness                   | 1     | 0       |
/// | one color: the normals are all the same                | 0     | 1       |
/// | fewer than half of the pixels are usable               | 0     | 0       |
///
/// Cylinders and other surfaces that bend in one direction have rank 2, planes rank 1; lights in one plane or of two colors have
/// rank 2, one light or lights of one color rank 1.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_patch_class {
    /// Rank of the light, 1 to 3; 0 where the colors do not say.
    pub light: u8,
    /// Rank of the surface, 1 to 3; 0 where the colors do not say.
    pub surface: u8,
}

plain!(ofc_segment_params, ofc_region, ofc_patch_class);

to_c!(Class => ofc_patch_class { light, surface });

to_c!(Params => ofc_segment_params {
    tolerance, seed, min_pixels, max_regions, spacing, refits; seed_blocks: blocks, search_radius: reach
} zero { saturation, reserved });
from_c!(Params <= ofc_segment_params {
    tolerance, seed, min_pixels, max_regions, spacing, refits; seed_blocks: blocks, search_radius: reach
} without { saturation } zero { reserved } where are_valid);

/// The parameters and the saturation level, if one is set.
impl FromC<ofc_segment_params> for (Params, Option<f32>) {
    fn from_c(value: ofc_segment_params) -> Result<Self, Refusal> {
        Ok((Params::from_c(value)?, saturation(value.saturation)?))
    }
}

to_c!(Region => ofc_region {
    coefficients, residual_deviation, rank, label, spacing; pixel_count: pixels, seed_block: block
} zero { reserved });

/// The workspace of a picture: its colors, and a queue of its pixels.
fn need(pixels: usize) -> Need {
    Need { doubles: 0, singles: segment::colors_len(pixels), integers: pixels }
}

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_segment_params_default(params: *mut ofc_segment_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_segment() needs: 16 for each pixel.
/// @param width,height  Size of the picture.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_segment_workspace_size(width: i32, height: i32) -> usize {
    bytes(need(pixel_count(width, height)))
}

/// Finds regions that share a C: each starts from six contiguous pixels and grows as far as the tolerance allows.
///
/// Call it before ofc_solve() where a picture holds several materials or light environments. ofc_segment_mark() turns
/// one region into a mask.
/// @param image  The picture.
/// @param params  The parameters.
/// @param workspace  ofc_segment_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param labels  Output: width x height labels, rows without gaps: the label of the pixel's region, or 0.
/// @param regions  Output: OFC_MAX_REGIONS structs, of which the first `count` are written, in the order found.
/// @param count  Output: how many regions were found, perhaps none.
/// @return OFC_STATUS_OK; an argument status.
///
/// Stack: below 16 KiB. Reference: section 1.2; L. L. Kontsevich, A. P. Petrov, I. S. Vergelskaya, JOSA A 11, 1994.
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
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let (params, saturation): (Params, _) = call.params(params)?;
        let pixels = picture.width() * picture.height();
        let mut workspace = call.arena(workspace, workspace_bytes, need(pixels))?;
        let colors = workspace.singles(segment::colors_len(pixels)).unwrap_or_default();
        let queue = workspace.integers(pixels).unwrap_or_default();
        let labels = call.output_slice(labels, pixels)?;
        let regions = call.output_slice(regions, OFC_MAX_REGIONS)?;
        let count = call.output(count)?;
        let usable = Usable::below(saturation.unwrap_or(picture.sample().saturation()));
        let found = segment::segment(&picture, usable, &params, labels, colors, queue)?;
        for (slot, region) in regions.iter_mut().zip(&found) {
            *slot = region.to_c();
        }
        *count = found.len().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Turns one label into a mask for ofc_image: 255 where a pixel has the label, 0 elsewhere.
/// @param labels  width x height labels, rows without gaps.
/// @param width  How many pixels are in a row.
/// @param height  How many rows there are.
/// @param label  The label, 1 to 65535.
/// @param mask  Output: width x height bytes, rows without gaps.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_segment_mark(
    labels: *const u16,
    width: i32,
    height: i32,
    label: i32,
    mask: *mut u8,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let pixels = checked_pixel_count(width, height)?;
        let labels = call.input_slice(labels, pixels)?;
        let mask = call.output_slice(mask, pixels)?;
        let label = u16::try_from(label).ok().filter(|&label| label > 0);
        segment::mark(labels, label.ok_or(OFC_STATUS_INVALID_PARAMETER)?, mask);
        Ok(OFC_STATUS_OK)
    })
}

/// Computes how many patches are in a row of a picture, or in a column: width over side, rounded up.
/// @param width  Width of the picture, or its height.
/// @param side  Side of a patch.
/// @return The number; 0 for a width or side that is not positive.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_rank_patches_count(width: i32, side: i32) -> i32 {
    let [across, _] = patches::shape(dimension(width), 1, dimension(side));
    across.to_c()
}

/// Classifies the patches of a picture by the rank of their light and the rank of their surface.
/// @param image  The picture.
/// @param side  Side of a patch, 3 to 64 pixels; patches at the right and lower edges may be smaller. The larger it is, the
///     less a surface must bend for that to be seen.
/// @param noise  Standard deviation of a channel in pixel values, > 0; ofc_rank has it.
/// @param light  Rank of the light that all patches share, 1 to 3, where it is known: it fills in what a patch does not say, and
///     a patch that says another rank keeps it. ofc_rank says 3 where its `colors` are 3, 2 where `colors` are 2 and `normals`
///     3, and 1 where `colors` are 1 and `normals` 0. 0 where it is not known.
/// @param classes  Output: ofc_rank_patches_count() in a row and in a column, rows without gaps.
/// @return OFC_STATUS_OK; OFC_STATUS_INVALID_PARAMETER; an argument status.
///
/// Reference: section 1.2; A. P. Petrov, L. L. Kontsevich, JOSA A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rank_patches(
    image: *const ofc_image,
    side: i32,
    noise: f64,
    light: i32,
    classes: *mut ofc_patch_class,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let side = dimension(side);
        let [across, down] = patches::shape(picture.width(), picture.height(), side.max(patches::MIN_SIDE));
        let classes = call.output_slice(classes, across * down)?;
        let light = u8::try_from(light).ok().filter(|&light| light <= 3);
        let light = light.ok_or(OFC_STATUS_INVALID_PARAMETER)?;
        let usable = Usable::below(picture.sample().saturation());
        let found =
            patches::patches(&picture, usable, side, noise).map_err(|_| OFC_STATUS_INVALID_PARAMETER)?;
        for (slot, class) in classes.iter_mut().zip(found) {
            *slot = class.under(light).to_c();
        }
        Ok(OFC_STATUS_OK)
    })
}
