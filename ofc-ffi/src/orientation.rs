//! From tilts and slants to F and the normals.

use crate::image::{image, ofc_image};
use crate::pointers::{Out, disjoint, extent, input, input_array, output_slice};
use crate::regression::accepted_by;
use crate::solve::ofc_solution;
use crate::status::{
    OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_MISALIGNED, OFC_STATUS_NO_CELLS, OFC_STATUS_NOT_SOLVED,
    OFC_STATUS_OK, OFC_STATUS_RANK_DEFICIENT, of, of_image_error, ofc_status,
};
use crate::types::{finite_matrix, ofc_inliers, ofc_integrability, ofc_orientation};
use ofc_core::color::inliers::Inliers;
use ofc_core::math::mat3::Mat3;
use ofc_core::orientation::integrability;
use ofc_core::orientation::matrix::{Orientation, compose};
use ofc_core::picture::span;
use ofc_core::surface::normals::{self, Length};

/// What becomes of a normal's length: one of OFC_LENGTH_*.
pub type ofc_length = i32;
/// Set to 1.
pub const OFC_LENGTH_UNIT: i32 = 0;
/// As the color gives it: near 1 where the model holds.
pub const OFC_LENGTH_KEPT: i32 = 1;

/// F from the lengths, tilts and slants of its rows, and its inverse through the singular values.
///
/// @param norms           Three lengths in pixel values.
/// @param tilt_rad        Three tilts.
/// @param slant_rad       Three slants.
/// @param rank_threshold  Singular values below this share of the largest are zero, in [0, 1); 1e-3 is what solve uses.
/// @param orientation     Output; where the rank is below 3, f_inverse is the pseudo-inverse.
/// @return OFC_STATUS_OK; OFC_STATUS_RANK_DEFICIENT, `orientation` written; OFC_STATUS_INVALID_PARAMETER; the status of
///         an invalid argument.
///
/// Reference: section 3.4, steps 5 and 6, eq. 19.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_orientation_compose(
    norms: *const f64,
    tilt_rad: *const f64,
    slant_rad: *const f64,
    rank_threshold: f64,
    orientation: *mut ofc_orientation,
) -> ofc_status {
    let body = || {
        let (norms, norms_extent) = input_array::<f64, 3>(norms)?;
        let (tilts, tilts_extent) = input_array::<f64, 3>(tilt_rad)?;
        let (slants, slants_extent) = input_array::<f64, 3>(slant_rad)?;
        let out = Out::new(orientation)?;
        disjoint(&[out.extent], &[norms_extent, tilts_extent, slants_extent])?;
        let finite = [norms, tilts, slants].iter().flatten().all(|value| value.is_finite());
        if !finite || !(0.0..1.0).contains(&rank_threshold) {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        let orientation = Orientation::new(compose(norms, slants, tilts), rank_threshold);
        out.write(orientation.into());
        Ok(if orientation.rank == 3 { OFC_STATUS_OK } else { OFC_STATUS_RANK_DEFICIENT })
    };
    of(body())
}

/// The integral (15), mean of (dp/dy - dq/dx)^2 over cells of four inliers, for the normals that F^-1 makes: how far
/// they are from being those of a surface. Slopes of normals with n3 below 0.05 are taken at 0.05.
///
/// @param image      The picture.
/// @param inliers    The pixels to use; NULL for every usable pixel of the picture.
/// @param f_inverse  F^-1, row-major.
/// @param result     Output.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CELLS; OFC_STATUS_INVALID_PARAMETER; the status of an invalid argument.
///
/// Reference: section 2.3, eq. 15.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_integrability_integral(
    image: *const ofc_image,
    inliers: *const ofc_inliers,
    f_inverse: *const f64,
    result: *mut ofc_integrability,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (test, test_extent) = accepted_by(inliers, &picture)?;
        let (matrix, matrix_extent) = input_array::<f64, 9>(f_inverse)?;
        let out = Out::new(result)?;
        let [a, b, c, d, e] = picture.extents;
        disjoint(&[out.extent], &[a, b, c, d, e, test_extent, matrix_extent])?;
        let matrix = finite_matrix(matrix)?;
        let integral = integrability::integral(&picture.view, test.selector(), &matrix);
        out.write(integral.ok_or(OFC_STATUS_NO_CELLS)?.into());
        Ok(OFC_STATUS_OK)
    };
    of(body())
}

/// Normals n = F^-1 rho of the pixels that a test accepts, with any F.
///
/// @param image      The picture.
/// @param inliers    The pixels to use; NULL for every usable pixel of the picture.
/// @param f_inverse  F^-1, row-major.
/// @param length     OFC_LENGTH_UNIT or OFC_LENGTH_KEPT.
/// @param normals    Output: height rows of width times (x, y, z) floats, row 0 at the top, zero where there is no
///                   normal. Frame: x right, y up, z toward the camera.
/// @param normals_stride_bytes  Bytes from a row to the next, a multiple of 4; what lies between rows is left alone.
/// @return OFC_STATUS_OK; OFC_STATUS_INVALID_PARAMETER; the status of an invalid argument.
///
/// Reference: eq. 8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_from_matrix(
    image: *const ofc_image,
    inliers: *const ofc_inliers,
    f_inverse: *const f64,
    length: ofc_length,
    normals: *mut f32,
    normals_stride_bytes: usize,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (test, test_extent) = accepted_by(inliers, &picture)?;
        let (matrix, matrix_extent) = input_array::<f64, 9>(f_inverse)?;
        let length = match length {
            OFC_LENGTH_UNIT => Length::Unit,
            OFC_LENGTH_KEPT => Length::Kept,
            _ => return Err(OFC_STATUS_INVALID_PARAMETER),
        };
        let [a, b, c, d, e] = picture.extents;
        let read = [a, b, c, d, e, test_extent, matrix_extent];
        let matrix = finite_matrix(matrix)?;
        // SAFETY: the contract of this function.
        unsafe { write_normals(&picture, &read, &test, &matrix, length, normals, normals_stride_bytes) }
    };
    of(body())
}

/// Unit normals of the inliers of a solved picture. The test for inliers is in the solution, so the picture may also be
/// another frame under the same lights.
///
/// @param image     The picture.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param normals   Output: height rows of width times (x, y, z) floats, row 0 at the top, zero where there is no
///                  normal. Frame: x right, y up, z toward the camera.
/// @param normals_stride_bytes  Bytes from a row to the next, a multiple of 4; what lies between rows is left alone.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; the status of an invalid argument.
///
/// Reference: eq. 8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_compute(
    image: *const ofc_image,
    solution: *const ofc_solution,
    normals: *mut f32,
    normals_stride_bytes: usize,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (solution, solution_extent) = input(solution)?;
        let [a, b, c, d, e] = picture.extents;
        let read = [a, b, c, d, e, solution_extent];
        if solution.outcome != OFC_STATUS_OK || solution.orientation.rank != 3 {
            return Err(OFC_STATUS_NOT_SOLVED);
        }
        let matrix = finite_matrix(solution.orientation.f_inverse)?;
        let test = solution.inliers.into_core();
        // SAFETY: the contract of this function.
        unsafe { write_normals(&picture, &read, &test, &matrix, Length::Unit, normals, normals_stride_bytes) }
    };
    of(body())
}

/// The common end of both calls: checks the output and writes it.
///
/// # Safety
/// The output can be written and nobody else uses it.
unsafe fn write_normals(
    picture: &crate::image::CheckedImage,
    read: &[crate::pointers::Extent],
    test: &Inliers,
    matrix: &Mat3,
    length: Length,
    out: *mut f32,
    stride_bytes: usize,
) -> Result<ofc_status, ofc_status> {
    let view = &picture.view;
    let bytes =
        span(view.width(), view.height(), 3 * size_of::<f32>(), stride_bytes).map_err(of_image_error)?;
    if !stride_bytes.is_multiple_of(size_of::<f32>()) {
        return Err(OFC_STATUS_MISALIGNED);
    }
    let floats = bytes / size_of::<f32>();
    disjoint(&[extent(out.cast_const(), floats)?], read)?;
    // SAFETY: checked and disjoint.
    let out = unsafe { output_slice(out, floats) };
    let stride = stride_bytes / size_of::<f32>();
    match normals::compute(view, test.selector(), matrix, length, out, stride) {
        Ok(()) => Ok(OFC_STATUS_OK),
        Err(normals::TooShort) => Err(OFC_STATUS_INVALID_PARAMETER),
    }
}
