//! From colors to C: the regression, the location of the norms, the inliers and the ellipsoid.

use crate::prelude::*;
use ofc_core::color::inliers::{Band, Inliers};
use ofc_core::color::{ellipsoid, lmeds, location, norms};
use ofc_core::picture::{MAX_PIXELS, Usable};

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_lmeds_params_default(params: *mut ofc_lmeds_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = lmeds::Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Computes the number of random six-pixel subsets of which at least one holds no outlier with a given probability.
/// @param confidence  The probability, in (0, 1).
/// @param outlier_ratio  The ratio of outliers, in [0, 1).
/// @param min_subsets  The smallest number to return, up to 10,000,000.
/// @return The number, at least 1; 0 when a parameter is out of its range or the number exceeds 10,000,000.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_lmeds_subset_count(confidence: f64, outlier_ratio: f64, min_subsets: u32) -> u32 {
    lmeds::subset_count(confidence, outlier_ratio, min_subsets).unwrap_or(0)
}

/// Says how many bytes of workspace ofc_lmeds_fit() needs: 4 for each pixel or 16 for each pixel of the sample,
/// whichever is more.
/// @param width,height  Size of the picture.
/// @param params  The parameters that ofc_lmeds_fit() will be given.
/// @return The size; 0 when an argument is invalid.
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

/// Fits the color-space quadratic form by least median of squares (LMS in the paper), and once more by least squares
/// over its inliers.
/// @param image  The picture. Pixels that are masked out, black, saturated or not finite are left out.
/// @param params  How to search and what to reject.
/// @param workspace  ofc_lmeds_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param fit  Output: the regression.
/// @param inlier_test  Output: the test that accepts pixels within `rejection` dispersions.
/// @return OFC_STATUS_OK; OFC_STATUS_RANK_DEFICIENT, with no output written, when the colors do not determine the six
///     coefficients; OFC_STATUS_TOO_FEW_PIXELS, OFC_STATUS_DARK or OFC_STATUS_SATURATED; an argument status.
///
/// Stack: below 14 KiB. Reference: sections 2.1-2.2, eqs. 10-12.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_lmeds_fit(
    image: *const ofc_image,
    params: *const ofc_lmeds_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    fit: *mut ofc_color_fit,
    inlier_test: *mut ofc_inlier_test,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let (params, saturation): (lmeds::Params, _) = call.params(params)?;
        let need = lmeds::workspace_len(picture.width() * picture.height(), params.sample_size);
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let (fit, inlier_test) = (call.output(fit)?, call.output(inlier_test)?);
        let usable = Usable::below(saturation.unwrap_or(picture.sample().saturation()));
        let found = lmeds::fit(&picture, usable, &params, workspace)?;
        *fit = found.to_c();
        *inlier_test = Inliers { residual: found.band, ..Inliers::all(usable) }.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_location_fit() needs: 8 for each value.
/// @param count  How many values there are.
/// @return The size; 0 when there are no values or too many.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_location_workspace_size(count: usize) -> usize {
    count.checked_mul(2).map_or(0, |singles| bytes(Need::of_singles(singles)))
}

/// Finds the one-dimensional least median of squares: the midpoint of the shortest interval that holds half of the
/// values.
/// @param values  `count` finite floats.
/// @param count  How many values there are, at least 2.
/// @param workspace  ofc_location_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param location  Output: the location.
/// @return OFC_STATUS_OK; an argument status, OFC_STATUS_EMPTY for fewer than two values.
///
/// Reference: section 2.2; P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", section 4.2.
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

/// Says how many bytes of workspace ofc_norm_location() needs: 8 for each pixel.
/// @param width,height  Size of the picture.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_norm_location_workspace_size(width: i32, height: i32) -> usize {
    bytes(Need::of_singles(pixel_count(width, height) * 2))
}

/// Makes the second rejection: finds where the lengths of the normals lie, and accepts the inliers whose normal is that
/// long.
/// @param image  The picture.
/// @param coefficients  C of the reweighted fit: c11, c22, c33, c12, c13, c23.
/// @param inlier_test  Which pixels to use, from ofc_lmeds_fit().
/// @param rejection  Lengths more than this many robust dispersions from the location are outliers; > 0.
/// @param workspace  ofc_norm_location_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param location  Output: location and dispersion of the lengths.
/// @param accepted  Output: `inlier_test` with the band of lengths set.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS for fewer than two inliers; an argument status,
///     OFC_STATUS_INVALID_PARAMETER also for a C that makes most lengths too large for a float.
///
/// Reference: section 2.2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_norm_location(
    image: *const ofc_image,
    coefficients: *const f64,
    inlier_test: *const ofc_inlier_test,
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
        let inliers: Inliers = call.params(inlier_test)?;
        let need = picture.width() * picture.height() * 2;
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let (location, accepted) = (call.output(location)?, call.output(accepted)?);
        let finite = rejection.is_finite() && form.iter().all(|c| c.is_finite());
        ensure(finite && rejection > 0.0, OFC_STATUS_INVALID_PARAMETER)?;
        let found = norms::location(&picture, &inliers, &form, workspace);
        let found = found.ok_or(OFC_STATUS_TOO_FEW_PIXELS)?;
        let is_finite =
            [found.location, found.median_distance, found.dispersion].iter().all(|n| n.is_finite());
        ensure(is_finite, OFC_STATUS_INVALID_PARAMETER)?;
        *location = found.to_c();
        *accepted = Inliers { norm: Band::norm(form, &found, rejection), ..inliers }.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Writes 255 for every pixel that passes the test and 0 for every other pixel.
/// @param image  The picture.
/// @param inlier_test  The test; NULL accepts every usable pixel.
/// @param mask  Output: width x height bytes, rows without gaps; it must not be the picture's own mask.
/// @param count  Output: how many pixels pass; may be NULL.
/// @return OFC_STATUS_OK; an argument status.
///
/// Reference: section 2.2.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_inlier_test_apply(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    mask: *mut u8,
    count: *mut i32,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let mask = call.output_slice(mask, picture.width() * picture.height())?;
        let count = unless_null(count, || call.output(count))?;
        test.mark(&picture, mask);
        if let Some(count) = count {
            *count = test.count(&picture).to_c();
        }
        Ok(OFC_STATUS_OK)
    })
}

/// Computes what follows from C: its eigenvalues, a root, F F^T = C^-1, and the norms and cosines of the rows of F.
/// @param coefficients  C as c11, c22, c33, c12, c13, c23, in (pixel value)^-2.
/// @param ellipsoid  Output: what follows from C.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_POSITIVE_DEFINITE, with no output written; an argument status.
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
