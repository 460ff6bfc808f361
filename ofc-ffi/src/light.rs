//! Estimators of the direction and strength of each channel's equivalent light.

use crate::prelude::*;
use ofc_core::color::inliers::Inliers;
use ofc_core::light::channel_maxima;
use ofc_core::light::slant::{self, Estimate, Reach};
use ofc_core::light::tilt::chojnacki::{self, Disc};
use ofc_core::light::tilt::{Tilts, lee_rosenfeld, pentland, zheng_chellappa};
use ofc_core::picture::Image;

/// An estimator of tilts: one of OFC_TILT_*.
pub type ofc_tilt_estimator = i32;
/// Pentland's, along the axes and the diagonals (eqs. 20-21).
pub const OFC_TILT_PENTLAND: i32 = 0;
/// Lee and Rosenfeld's.
pub const OFC_TILT_LEE_ROSENFELD: i32 = 1;
/// Zheng and Chellappa's.
pub const OFC_TILT_ZHENG_CHELLAPPA: i32 = 2;
/// Chojnacki, Brooks and Gibbins', over the largest disc inside the inliers.
pub const OFC_TILT_CHOJNACKI: i32 = 3;
/// None: the caller gives the tilts.
pub const OFC_TILT_GIVEN: i32 = 4;

/// Whether the equation of an estimator of slants has a root: OFC_SLANT_NOT_CLAMPED or one of OFC_SLANT_CLAMPED_*.
pub type ofc_slant_clamping = i32;
/// The slant is the root.
pub const OFC_SLANT_NOT_CLAMPED: i32 = 0;
/// The statistic is beyond its value at slant 0, and the slant is 0, as in Tables 1 and 2.
pub const OFC_SLANT_CLAMPED_TO_ZERO: i32 = 1;
/// The statistic is beyond its value at the largest slant, which is the answer.
pub const OFC_SLANT_CLAMPED_TO_LARGEST: i32 = 2;

/// A disc of pixels.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_disc {
    /// Column of the middle pixel.
    pub x: i32,
    /// Row of the middle pixel.
    pub y: i32,
    /// The disc's pixels are less than the square root of this number of pixels away from the middle one.
    pub radius_squared: u64,
}

/// The slant of one row of F, estimated without the other rows.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_slant_estimate {
    /// The slant in radians.
    pub slant_rad: f64,
    /// What the slant follows from. For Pentland it is the squared sine of the slant by eq. 22, which may exceed 1 and is infinite
    /// where neighboring pixels differ by the same everywhere; for
    /// Lee and Rosenfeld it is root mean square over mean; for Zheng and Chellappa it is mean over root mean square.
    pub statistic: f64,
    /// OFC_SLANT_NOT_CLAMPED or one of OFC_SLANT_CLAMPED_*.
    pub clamping: ofc_slant_clamping,
    /// Zero.
    pub reserved: u32,
}

plain!(ofc_disc, ofc_slant_estimate);

constants!(Reach = {
    Inside: OFC_SLANT_NOT_CLAMPED,
    BelowZero: OFC_SLANT_CLAMPED_TO_ZERO,
    AboveLargest: OFC_SLANT_CLAMPED_TO_LARGEST,
});
to_c!(Estimate => ofc_slant_estimate { statistic; slant_rad: slant, clamping: reach } zero { reserved });
to_c!(Disc => ofc_disc { x, y, radius_squared });

/// The body of the estimators of tilts.
fn estimate_tilts(
    call: &mut Call,
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    tilts: *mut ofc_tilts,
    estimate: impl FnOnce(&Image, &Inliers) -> Option<Tilts>,
) -> Result<ofc_status, Refusal> {
    let picture = call.image(image)?;
    let test = call.inlier_test(inlier_test, &picture)?;
    let tilts = call.output(tilts)?;
    *tilts = estimate(&picture, &test).ok_or(OFC_STATUS_NO_TILT)?.to_c();
    Ok(OFC_STATUS_OK)
}

/// Tilts of an estimator that knows no gradients.
fn alone(tilts: [f64; 3]) -> Tilts {
    Tilts { tilts, gradients: [[0.0; 2]; 3] }
}

/// Estimates tilts by Pentland's method, from mean differences between neighboring inliers along the axes and the
/// diagonals. The surface should be closed and convex.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param tilts  Output: the tilts of the rows of F.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_TILT; an argument status.
///
/// Reference: section 3.2, eqs. 20-21; A. P. Pentland, "Finding the illuminant direction", JOSA 72, 1982.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_tilt_pentland(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    tilts: *mut ofc_tilts,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        estimate_tilts(call, image, inlier_test, tilts, |image, test| pentland::tilts(image, test.selector()))
    })
}

/// Estimates tilts by Pentland's method along any set of directions.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param steps  `count` pairs (right, up): the steps from one pixel to another, up to 1024 either way.
/// @param count  How many steps, 2 to 64, not all parallel.
/// @param tilts  Output: the tilts of the rows of F.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_TILT, also for steps that are zero, too long or parallel; an argument status.
///
/// Reference: section 3.2, eqs. 20-21.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_tilt_pentland_along(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    steps: *const i32,
    count: i32,
    tilts: *mut ofc_tilts,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let in_range = (2..=64).contains(&count);
        ensure(steps.is_null() || in_range, OFC_STATUS_INVALID_PARAMETER)?;
        let (steps, _) = call.input_slice(steps, dimension(count) * 2)?.as_chunks::<2>();
        estimate_tilts(call, image, inlier_test, tilts, |image, test| {
            pentland::tilts_along(image, test.selector(), steps)
        })
    })
}

/// Estimates tilts by Lee and Rosenfeld's method: as Pentland's, along the axes alone.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param tilts  Output: the tilts of the rows of F.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_TILT; an argument status.
///
/// Reference: section 3.2; C.-H. Lee, A. Rosenfeld, Artificial Intelligence 26, 1985.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_tilt_lee_rosenfeld(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    tilts: *mut ofc_tilts,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        estimate_tilts(call, image, inlier_test, tilts, |image, test| {
            lee_rosenfeld::tilts(image, test.selector()).map(alone)
        })
    })
}

/// Estimates tilts by Zheng and Chellappa's method: every neighborhood votes with the direction of its gradient.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param tilts  Output: the tilts of the rows of F.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_TILT; an argument status.
///
/// Reference: Q. Zheng, R. Chellappa, "Estimation of illuminant direction, albedo, and shape from shading", PAMI 13,
/// 1991.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_tilt_zheng_chellappa(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    tilts: *mut ofc_tilts,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        estimate_tilts(call, image, inlier_test, tilts, |image, test| {
            zheng_chellappa::tilts(image, test.selector()).map(alone)
        })
    })
}

/// Estimates tilts by Chojnacki, Brooks and Gibbins' method: mean derivatives over a disc that is free of shadows.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param disc  The disc, from ofc_largest_disc() or the caller. Its middle has no negative coordinate.
/// @param tilts  Output: the tilts of the rows of F.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_TILT; an argument status.
///
/// Reference: W. Chojnacki, M. J. Brooks, D. Gibbins, "Revisiting Pentland's estimator of light source direction", JOSA
/// A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_tilt_chojnacki(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    disc: *const ofc_disc,
    tilts: *mut ofc_tilts,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let ofc_disc { x, y, radius_squared } = call.input(disc)?;
        ensure(x >= 0 && y >= 0, OFC_STATUS_INVALID_PARAMETER)?;
        let disc = Disc { x: dimension(x), y: dimension(y), radius_squared };
        estimate_tilts(call, image, inlier_test, tilts, |image, test| {
            chojnacki::tilts(image, test.selector(), &disc).map(alone)
        })
    })
}

/// Says how many bytes of workspace ofc_largest_disc() needs: 4 for each pixel.
/// @param width,height  Size of the picture.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_largest_disc_workspace_size(width: i32, height: i32) -> usize {
    bytes(Need::of_singles(chojnacki::workspace_len(pixel_count(width, height))))
}

/// Finds the largest disc inside the inliers. Outliers that are not part of a square of four do not count.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param workspace  ofc_largest_disc_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param disc  Output: the disc.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS when there is no inlier; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_largest_disc(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    workspace: *mut c_void,
    workspace_bytes: usize,
    disc: *mut ofc_disc,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let need = chojnacki::workspace_len(picture.width() * picture.height());
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let disc = call.output(disc)?;
        let found = chojnacki::largest_disc(&picture, test.selector(), workspace);
        *disc = found.ok_or(OFC_STATUS_TOO_FEW_PIXELS)?.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// The body of the estimators of slants.
fn estimate_slants(
    call: &mut Call,
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    slants: *mut ofc_slant_estimate,
    estimate: impl FnOnce(&Image, &Inliers) -> Option<[Estimate; 3]>,
) -> Result<ofc_status, Refusal> {
    let picture = call.image(image)?;
    let test = call.inlier_test(inlier_test, &picture)?;
    let slants = call.output_array(slants)?;
    *slants = estimate(&picture, &test).ok_or(OFC_STATUS_TOO_FEW_PIXELS)?.to_c();
    Ok(OFC_STATUS_OK)
}

/// Estimates slants by Pentland's method, each channel by itself. The Tables of the paper show how unreliable these
/// slants are.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param slants  Output: three structs, for r, g, b.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS; an argument status.
///
/// Reference: section 3.2, eq. 22.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_slant_pentland(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    slants: *mut ofc_slant_estimate,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        estimate_slants(call, image, inlier_test, slants, |image, test| {
            slant::pentland::slants(image, test.selector())
        })
    })
}

/// Estimates slants in [0, pi) by Lee and Rosenfeld's method, from the ratio of root mean square to mean. A ratio below
/// 3 / (2 sqrt 2) = 1.0607 gives 0 with OFC_SLANT_CLAMPED_TO_ZERO. Slants and means give the strengths of the lights,
/// which are as wrong as the slants where these are clamped.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param slants  Output: three structs, for r, g, b.
/// @param strengths  Output: three numbers in pixel values, for r, g, b; may be NULL.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS; an argument status.
///
/// Reference: section 3.2, eq. 23.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_slant_lee_rosenfeld(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    slants: *mut ofc_slant_estimate,
    strengths: *mut f64,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let slants = call.output_array::<_, 3>(slants)?;
        let strengths = unless_null(strengths, || call.output_array::<f64, 3>(strengths))?;
        let found = slant::lee_rosenfeld::slants(&picture, test.selector());
        let (estimates, found_strengths) = found.ok_or(OFC_STATUS_TOO_FEW_PIXELS)?;
        *slants = estimates.to_c();
        if let Some(strengths) = strengths {
            *strengths = found_strengths;
        }
        Ok(OFC_STATUS_OK)
    })
}

/// Estimates slants by Zheng and Chellappa's method, which takes shadows into account: it uses black pixels too.
/// @param image  The picture. Its mask is the object.
/// @param slants  Output: three structs, for r, g, b.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS; an argument status.
///
/// Reference: Q. Zheng, R. Chellappa, PAMI 13, 1991.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_slant_zheng_chellappa(
    image: *const ofc_image,
    slants: *mut ofc_slant_estimate,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        estimate_slants(call, image, core::ptr::null(), slants, |image, _| {
            slant::zheng_chellappa::slants(image, |window| {
                window.masked & window.bits(|r, g, b| r.is_finite() & g.is_finite() & b.is_finite())
            })
        })
    })
}

/// Finds the largest value of each channel: the length of that row of F where some normal faces that light.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param norms  Output: three numbers in pixel values, for r, g, b.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS when there is no inlier; an argument status.
///
/// Reference: section 4, last rows of Tables 1 and 2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_channel_maxima(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    norms: *mut f64,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let norms = call.output_array(norms)?;
        *norms = channel_maxima::norms(&picture, test.selector()).ok_or(OFC_STATUS_TOO_FEW_PIXELS)?;
        Ok(OFC_STATUS_OK)
    })
}
