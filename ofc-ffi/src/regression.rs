//! From colors to C: the regression, the location of the norms, the inliers and the ellipsoid.

use crate::image::{dimension, image, ofc_image};
use crate::pointers::{
    Extent, Out, disjoint, extent, input, input_array, input_slice, output_slice, workspace,
};
use crate::status::{
    OFC_STATUS_EMPTY, OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_NOT_POSITIVE_DEFINITE, OFC_STATUS_OK,
    OFC_STATUS_TOO_FEW_PIXELS, OFC_STATUS_TOO_LARGE, of, of_fit_error, ofc_status,
};
use crate::types::{ofc_color_fit, ofc_ellipsoid, ofc_inliers, ofc_lmeds_params, ofc_location};
use core::ffi::c_void;
use ofc_core::color::inliers::{Band, Inliers};
use ofc_core::color::{ellipsoid, lmeds, location, norms};
use ofc_core::picture::{MAX_PIXELS, Usable};

/// Bytes of so many floats, 0 where there are none or too many.
pub(crate) fn float_bytes(count: usize) -> usize {
    count.checked_mul(size_of::<f32>()).filter(|&bytes| isize::try_from(bytes).is_ok()).unwrap_or(0)
}

/// Pixels of a picture, 0 where there are none or too many.
pub(crate) fn pixel_count(width: i32, height: i32) -> usize {
    dimension(width).checked_mul(dimension(height)).filter(|&pixels| pixels <= MAX_PIXELS).unwrap_or(0)
}

/// A workspace as floats.
///
/// # Safety
/// As [`output_slice`]; the extent comes from [`workspace`].
pub(crate) unsafe fn floats<'a>(pointer: *mut c_void, bytes: usize) -> &'a mut [f32] {
    // SAFETY: eight-byte alignment is enough for floats; `bytes` have been checked.
    unsafe { output_slice(pointer.cast::<f32>(), bytes / size_of::<f32>()) }
}

/// Sets every field to its default.
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_lmeds_params_default(params: *mut ofc_lmeds_params) -> ofc_status {
    of(Out::new(params).map(|out| {
        out.write(ofc_lmeds_params::defaults());
        OFC_STATUS_OK
    }))
}

/// The number of random six-pixel subsets of which, with probability `confidence`, at least one holds no outlier when
/// the share of outliers is `outlier_share`; at least `min_subsets` and 1. Pure.
///
/// @param confidence     In (0, 1).
/// @param outlier_share  In [0, 1).
/// @param min_subsets    Up to 10,000,000.
/// @return The number, or 0 when a parameter is out of range or the number is above 10,000,000.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_lmeds_subset_count(confidence: f64, outlier_share: f64, min_subsets: u32) -> u32 {
    lmeds::subset_count(confidence, outlier_share, min_subsets).unwrap_or(0)
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
    let Ok((params, _)) = input(params).and_then(|(params, _)| params.check()) else { return 0 };
    match pixel_count(width, height) {
        0 => 0,
        pixels => float_bytes(lmeds::workspace_len(pixels, params.sample_size)),
    }
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
    inliers: *mut ofc_inliers,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (own, params_extent) = input(params)?;
        let (params, saturation) = own.check()?;
        let view = &picture.view;
        let need = float_bytes(lmeds::workspace_len(view.width() * view.height(), params.sample_size));
        let scratch = self::workspace(workspace.cast(), workspace_bytes, need)?;
        let (fit, inliers) = (Out::new(fit)?, Out::new(inliers)?);
        let [a, b, c, d, e] = picture.extents;
        disjoint(&[scratch, fit.extent, inliers.extent], &[a, b, c, d, e, params_extent])?;
        let usable = Usable::below(saturation.unwrap_or(view.sample().saturation()));
        // SAFETY: checked and disjoint.
        let result =
            lmeds::fit(view, usable, &params, unsafe { floats(workspace, need) }).map_err(of_fit_error)?;
        fit.write((&result).into());
        inliers.write(Inliers { residual: result.band, ..Inliers::all(usable) }.into());
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

/// Bytes of workspace that ofc_location_fit() needs for so many values: 8 each.
///
/// @return The size, or 0 when there are no or too many values.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_location_workspace_size(count: usize) -> usize {
    count.checked_mul(2).map_or(0, float_bytes)
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
    let body = || {
        extent(values, 1)?;
        if count < 2 {
            return Err(OFC_STATUS_EMPTY);
        }
        if count > MAX_PIXELS {
            return Err(OFC_STATUS_TOO_LARGE);
        }
        // SAFETY: the contract of this function.
        let (values, values_extent) = unsafe { input_slice(values, count) }?;
        let need = ofc_location_workspace_size(count);
        let scratch = self::workspace(workspace.cast(), workspace_bytes, need)?;
        let out = Out::new(location)?;
        disjoint(&[scratch, out.extent], &[values_extent])?;
        if !values.iter().all(|value| value.is_finite()) {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        // SAFETY: checked and disjoint.
        let (sorted, rest) =
            unsafe { floats(workspace, need) }.split_at_mut_checked(count).unwrap_or_default();
        for (slot, &value) in sorted.iter_mut().zip(values) {
            *slot = value;
        }
        out.write(location::shortest_half(sorted, rest).ok_or(OFC_STATUS_EMPTY)?.into());
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

/// Bytes of workspace that ofc_norm_location() needs: 8 a pixel.
///
/// @return The size, or 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_norm_location_workspace_size(width: i32, height: i32) -> usize {
    float_bytes(pixel_count(width, height) * 2)
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
    inliers: *const ofc_inliers,
    rejection: f64,
    workspace: *mut c_void,
    workspace_bytes: usize,
    location: *mut ofc_location,
    accepted: *mut ofc_inliers,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (form, form_extent) = input_array::<f64, 6>(coefficients)?;
        let (inliers, inliers_extent) = input(inliers)?;
        let need = ofc_norm_location_workspace_size(
            crate::types::count(picture.view.width()),
            crate::types::count(picture.view.height()),
        );
        let scratch = self::workspace(workspace.cast(), workspace_bytes, need)?;
        let (location, accepted) = (Out::new(location)?, Out::new(accepted)?);
        let [a, b, c, d, e] = picture.extents;
        disjoint(
            &[scratch, location.extent, accepted.extent],
            &[a, b, c, d, e, form_extent, inliers_extent],
        )?;
        if !(rejection > 0.0 && rejection.is_finite() && form.iter().all(|c| c.is_finite())) {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        let inliers = inliers.into_core();
        // SAFETY: checked and disjoint.
        let scratch = unsafe { floats(workspace, need) };
        let found =
            norms::location(&picture.view, &inliers, &form, scratch).ok_or(OFC_STATUS_TOO_FEW_PIXELS)?;
        location.write(found.into());
        accepted.write(Inliers { norm: Band::norm(form, &found, rejection), ..inliers }.into());
        Ok(OFC_STATUS_OK)
    };
    of(body())
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
pub unsafe extern "C" fn ofc_inliers_mark(
    image: *const ofc_image,
    inliers: *const ofc_inliers,
    mask: *mut u8,
    count: *mut i32,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (test, test_extent) = accepted_by(inliers, &picture)?;
        let pixels = picture.view.width() * picture.view.height();
        let mask_extent = extent(mask.cast_const(), pixels)?;
        let count = if count.is_null() { None } else { Some(Out::new(count)?) };
        let [a, b, c, d, e] = picture.extents;
        let count_extent = count.as_ref().map_or(Extent::NOTHING, |count| count.extent);
        disjoint(&[mask_extent, count_extent], &[a, b, c, d, e, test_extent])?;
        // SAFETY: checked and disjoint.
        test.mark(&picture.view, unsafe { output_slice(mask, pixels) });
        if let Some(count) = count {
            count.write(crate::types::count(test.count(&picture.view)));
        }
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

/// The test at `inliers`, or every usable pixel of the picture where it is NULL, and the bytes it was read from.
pub(crate) fn accepted_by(
    inliers: *const ofc_inliers,
    picture: &crate::image::CheckedImage,
) -> Result<(Inliers, Extent), ofc_status> {
    if inliers.is_null() {
        let [own, ..] = picture.extents;
        return Ok((Inliers::all(Usable::below(picture.view.sample().saturation())), own));
    }
    input(inliers).map(|(test, extent)| (test.into_core(), extent))
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
    let body = || {
        let (form, form_extent) = input_array::<f64, 6>(coefficients)?;
        let out = Out::new(ellipsoid)?;
        disjoint(&[out.extent], &[form_extent])?;
        if !form.iter().all(|c| c.is_finite()) {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        out.write(ellipsoid::decompose(&form).map_err(|_| OFC_STATUS_NOT_POSITIVE_DEFINITE)?.into());
        Ok(OFC_STATUS_OK)
    };
    of(body())
}
