//! From colors to C: the regression, the location of the norms, the inliers and the ellipsoid.

use crate::image::{checked_pixel_count, ofc_image, pixel_count};
use crate::pointers::{Contract, bytes, unless_null};
use crate::status::{
    OFC_STATUS_EMPTY, OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_OK, OFC_STATUS_TOO_FEW_PIXELS,
    OFC_STATUS_TOO_LARGE, ensure, ofc_status,
};
use crate::twin::ToC;
use crate::types::{ofc_color_fit, ofc_ellipsoid, ofc_inlier_test, ofc_lmeds_params, ofc_location};
use core::ffi::c_void;
use ofc_core::color::inliers::{Band, Inliers};
use ofc_core::color::{ellipsoid, lmeds, location, norms};
use ofc_core::math::arena::Need;
use ofc_core::picture::{MAX_PIXELS, Usable};

/// Sets every field to its default.
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_lmeds_params_default(params: *mut ofc_lmeds_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = lmeds::Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// The number of random six-pixel subsets of which, with probability `confidence`, at least one holds no outlier when
/// the share of outliers is `outlier_ratio`; at least `min_subsets` and 1. Pure.
///
/// @param confidence     In (0, 1).
/// @param outlier_ratio  In [0, 1).
/// @param min_subsets    Up to 10,000,000.
/// @return The number, or 0 when a parameter is out of range or the number is above 10,000,000.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_lmeds_subset_count(confidence: f64, outlier_ratio: f64, min_subsets: u32) -> u32 {
    lmeds::subset_count(confidence, outlier_ratio, min_subsets).unwrap_or(0)
}

/// Bytes of workspace that ofc_lmeds_fit() needs: at most 4 a pixel or 16 a sample, whichever is more.
///
/// @return The size, or 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_lmeds_workspace_size(
    width: i32,
    height: i32,
    params: *const ofc_lmeds_params,
) -> usize {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.size(|call| {
        let (params, _): (lmeds::Params, _) = call.params(params)?;
        let pixels = checked_pixel_count(width, height)?;
        Ok(Need::of_singles(lmeds::workspace_len(pixels, params.sample_size)))
    })
}

/// Least median of squares (LMS in the paper) for the color-space quadratic form, and the reweighted fit over its
/// inliers.
///
/// @param image      The picture; its mask, black and saturated pixels are left out.
/// @param params     Search and rejection; see the struct.
/// @param workspace  ofc_lmeds_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT; contents do not matter.
/// @param workspace_bytes  Its size.
/// @param fit        Output: the regression.
/// @param inliers    Output: the test that accepts the pixels within `rejection` dispersions.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS, _DARK or _SATURATED; OFC_STATUS_RANK_DEFICIENT when the colors do
///         not determine the six coefficients (outputs untouched here); the status of an invalid argument.
///
/// Stack: below 12 KiB. Reference: sections 2.1-2.2, eqs. 10-12.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_lmeds_fit(
    image: *const ofc_image,
    params: *const ofc_lmeds_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    fit: *mut ofc_color_fit,
    inliers: *mut ofc_inlier_test,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let (params, saturation): (lmeds::Params, _) = call.params(params)?;
        let need = lmeds::workspace_len(picture.width() * picture.height(), params.sample_size);
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let (fit, inliers) = (call.output(fit)?, call.output(inliers)?);
        let usable = Usable::below(saturation.unwrap_or(picture.sample().saturation()));
        let found = lmeds::fit(&picture, usable, &params, workspace)?;
        *fit = found.to_c();
        *inliers = Inliers { residual: found.band, ..Inliers::all(usable) }.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Bytes of workspace that ofc_location_fit() needs for so many values: 8 each.
///
/// @return The size, or 0 when there are no or too many values.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_location_workspace_size(count: usize) -> usize {
    count.checked_mul(2).map_or(0, |singles| bytes(Need::of_singles(singles)))
}

/// The one-dimensional least median of squares: the midpoint of the shortest interval that holds half of the values.
///
/// @param values     `count` finite floats, at least 2.
/// @param count      How many.
/// @param workspace  ofc_location_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT; contents do not matter.
/// @param workspace_bytes  Its size.
/// @param location   Output.
/// @return OFC_STATUS_OK; OFC_STATUS_EMPTY for fewer than two values; OFC_STATUS_INVALID_PARAMETER when one is not
///         finite; the status of an invalid argument.
///
/// Reference: section 2.2; Rousseeuw and Leroy, "Robust Regression and Outlier Detection", section 4.2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_location_fit(
    values: *const f32,
    count: usize,
    workspace: *mut c_void,
    workspace_bytes: usize,
    location: *mut ofc_location,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        ensure(values.is_null() || count >= 2, OFC_STATUS_EMPTY)?;
        ensure(count <= MAX_PIXELS, OFC_STATUS_TOO_LARGE)?;
        let values = call.input_slice(values, count)?;
        let workspace = call.floats(workspace, workspace_bytes, count * 2)?;
        let location = call.output(location)?;
        ensure(values.iter().all(|value| value.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        let (sorted, rest) = workspace.split_at_mut_checked(count).unwrap_or_default();
        for (slot, &value) in sorted.iter_mut().zip(values) {
            *slot = value;
        }
        *location = location::shortest_half(sorted, rest).ok_or(OFC_STATUS_EMPTY)?.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Bytes of workspace that ofc_norm_location() needs: 8 a pixel.
///
/// @return The size, or 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_norm_location_workspace_size(width: i32, height: i32) -> usize {
    bytes(Need::of_singles(pixel_count(width, height) * 2))
}

/// The second rejection: where the lengths of the normals lie, and the inliers whose normal is that long.
///
/// @param image        The picture.
/// @param coefficients C of the reweighted fit: c11, c22, c33, c12, c13, c23.
/// @param inliers      The pixels to look at, as ofc_lmeds_fit() made them.
/// @param rejection    Lengths above this many robust dispersions from the location are outliers, > 0.
/// @param workspace    ofc_norm_location_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT; contents do not
///                     matter.
/// @param workspace_bytes  Its size.
/// @param location     Output: the location and dispersion of the lengths.
/// @param accepted     Output: `inliers` with the band of lengths set.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS for fewer than two inliers; the status of an invalid argument.
///
/// Reference: section 2.2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_norm_location(
    image: *const ofc_image,
    coefficients: *const f64,
    inliers: *const ofc_inlier_test,
    rejection: f64,
    workspace: *mut c_void,
    workspace_bytes: usize,
    location: *mut ofc_location,
    accepted: *mut ofc_inlier_test,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let form = call.input_array::<f64, 6>(coefficients)?;
        let inliers: Inliers = call.params(inliers)?;
        let need = picture.width() * picture.height() * 2;
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let (location, accepted) = (call.output(location)?, call.output(accepted)?);
        let finite = rejection.is_finite() && form.iter().all(|c| c.is_finite());
        ensure(finite && rejection > 0.0, OFC_STATUS_INVALID_PARAMETER)?;
        let found = norms::location(&picture, &inliers, &form, workspace);
        let found = found.ok_or(OFC_STATUS_TOO_FEW_PIXELS)?;
        *location = found.to_c();
        *accepted = Inliers { norm: Band::norm(form, &found, rejection), ..inliers }.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Writes 255 for every pixel that the test accepts and 0 for every other.
///
/// @param image    The picture.
/// @param inliers  The test; NULL for every usable pixel of the picture.
/// @param mask     Output: width x height bytes, rows without gaps, row 0 at the top; it must not be the picture's own
///                 mask.
/// @param count    Output: how many were accepted; may be NULL.
/// @return OFC_STATUS_OK or the status of an invalid argument.
///
/// Reference: section 2.2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_inlier_test_apply(
    image: *const ofc_image,
    inliers: *const ofc_inlier_test,
    mask: *mut u8,
    count: *mut i32,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inliers(inliers, &picture)?;
        let mask = call.output_slice(mask, picture.width() * picture.height())?;
        let count = unless_null(count, || call.output(count))?;
        test.mark(&picture, mask);
        if let Some(count) = count {
            *count = test.count(&picture).to_c();
        }
        Ok(OFC_STATUS_OK)
    })
}

/// C and what follows from it: its eigenvalues, a root, F F^T = C^-1, and the norms and cosines of the rows of F.
///
/// @param coefficients  c11, c22, c33, c12, c13, c23 in (pixel value)^-2.
/// @param ellipsoid     Output.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_POSITIVE_DEFINITE, `ellipsoid` untouched; OFC_STATUS_INVALID_PARAMETER when a
///         coefficient is not finite; the status of an invalid argument.
///
/// Reference: section 2.1, eqs. 9 and 18.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_ellipsoid_decompose(
    coefficients: *const f64,
    ellipsoid: *mut ofc_ellipsoid,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let form = call.input_array::<f64, 6>(coefficients)?;
        let ellipsoid = call.output(ellipsoid)?;
        ensure(form.iter().all(|c| c.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        *ellipsoid = ellipsoid::decompose(&form)?.to_c();
        Ok(OFC_STATUS_OK)
    })
}
