//! The ellipsoid with a center.

use crate::prelude::*;
use ofc_core::color::offset::{self, Offset};

/// What ofc_offset_fit() found.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_offset {
    /// The center of the ellipsoid r, g, b in pixel values: the light that is not the model's.
    pub offset: [f64; 3],
    /// The covariance of `offset`, row-major.
    pub covariance: [f64; 9],
    /// C around that center: c11, c22, c33, c12, c13, c23.
    pub coefficients: [f64; 6],
    /// The robust deviation of the colors from the ellipsoid around its center, in pixel values.
    pub deviation: f64,
    /// The robust deviation of the colors from the best ellipsoid around black, in pixel values.
    pub deviation_around_black: f64,
    /// The noise of a channel by differences of neighbors, in pixel values: where the model holds, `deviation` is about as much.
    pub noise: f64,
    /// The square of `offset` by its covariance. Without an offset, and where the model holds, it is about 3.
    pub chi_squared: f64,
    /// How many colors were fitted.
    pub count: i32,
    /// From how many parts of the picture they are, whose errors are taken to be independent.
    pub blocks: i32,
}

plain!(ofc_offset);

impl ToC<ofc_offset> for Offset {
    fn to_c(&self) -> ofc_offset {
        let Self {
            centered,
            covariance,
            deviation,
            deviation_around_black,
            noise,
            chi_squared,
            count,
            blocks,
        } = self;
        ofc_offset {
            offset: centered.center,
            covariance: covariance.to_c(),
            coefficients: centered.form,
            deviation: *deviation,
            deviation_around_black: *deviation_around_black,
            noise: *noise,
            chi_squared: *chi_squared,
            count: count.to_c(),
            blocks: blocks.to_c(),
        }
    }
}

/// Says how many bytes of workspace ofc_offset_fit() needs: 20 for each color.
/// @param sample_size  The parameter of the call.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_offset_workspace_size(sample_size: i32) -> usize {
    bytes(Need::of_singles(offset::workspace_len(dimension(sample_size))))
}

/// Finds light that is not the model's and the same everywhere, such as room light or a black level, as the center of the
/// colors' ellipsoid: (rho - a)^T C (rho - a) = 1.
///
/// Take the inliers of ofc_solve() and its C, subtract what is found with ofc_offset_subtract(), and do it again with the picture
/// that is left; three times are enough. Near lights, interreflection and a transfer curve look like an offset too: believe one only where
/// `chi_squared` is above 40, `deviation` is down to the noise, and no channel's offset is above the darkest pixels.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use, from ofc_solve(), in its solution: those that all lights reach; NULL for every
///     usable pixel.
/// @param coefficients  C around black, where the fit starts: c11, c22, c33, c12, c13, c23.
/// @param sample_size  How many colors are fitted at most, at least 60; 8192 is a good number, and more is slower.
/// @param workspace  ofc_offset_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param found  Output: the offset.
/// @return OFC_STATUS_OK; OFC_STATUS_UNDETERMINED where the colors do not determine a center, with nothing written;
///     OFC_STATUS_NOT_POSITIVE_DEFINITE for a C that is no ellipsoid, with nothing written; OFC_STATUS_TOO_FEW_PIXELS for fewer
///     than 60 inliers; an argument status.
///
/// Reference: S. J. Ahn, W. Rauh, H.-J. Warnecke, Pattern Recognition 34, 2001.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_offset_fit(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    coefficients: *const f64,
    sample_size: i32,
    workspace: *mut c_void,
    workspace_bytes: usize,
    found: *mut ofc_offset,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let inliers = call.inlier_test(inlier_test, &picture)?;
        let form = call.input_array::<f64, 6>(coefficients)?;
        ensure(form.iter().all(|c| c.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        let sample_size = dimension(sample_size);
        ensure(sample_size >= offset::LEAST, OFC_STATUS_INVALID_PARAMETER)?;
        let workspace = call.floats(workspace, workspace_bytes, offset::workspace_len(sample_size))?;
        let found = call.output(found)?;
        let fit: ofc_offset = offset::fit(&picture, &inliers, &form, sample_size, workspace)?.to_c();
        // Colors or a C of extreme size determine nothing that floats hold.
        let deviations = [fit.deviation, fit.deviation_around_black, fit.noise, fit.chi_squared];
        let mut numbers =
            fit.offset.iter().chain(&fit.covariance).chain(&fit.coefficients).chain(&deviations);
        if !numbers.all(|number| number.is_finite()) {
            return Ok(OFC_STATUS_UNDETERMINED);
        }
        *found = fit;
        Ok(OFC_STATUS_OK)
    })
}
