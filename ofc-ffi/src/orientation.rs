//! From tilts and slants to F and the normals.

use crate::prelude::*;
use core::ptr;
use ofc_core::color::inliers::Inliers;
use ofc_core::math::mat3::{Mat3, max_abs};
use ofc_core::orientation::integrability;
use ofc_core::orientation::matrix::{Orientation, compose};
use ofc_core::surface::normals::{self, Length};

/// How a normal is normalized: one of OFC_NORMALIZATION_*.
pub type ofc_normalization = i32;
/// To length 1.
pub const OFC_NORMALIZATION_UNIT: i32 = 0;
/// Not at all: the length follows from the color, and is near 1 where the model holds.
pub const OFC_NORMALIZATION_NONE: i32 = 1;

constants!(Length = { Unit: OFC_NORMALIZATION_UNIT, Kept: OFC_NORMALIZATION_NONE });

/// The largest entry that F and F^-1 may have, in absolute value: with larger ones the square of a normal or of a slope could be
/// larger than any number. Colors that are finite floats make F and F^-1
/// of less than 1e70.
const LARGEST_ENTRY: f64 = 1e100;

/// This matrix, F or F^-1, if no entry is too large to make finite numbers of any pixel.
fn bounded(matrix: Mat3) -> Result<Mat3, Refusal> {
    ensure(max_abs(&matrix) <= LARGEST_ENTRY, OFC_STATUS_INVALID_PARAMETER)?;
    Ok(matrix)
}

/// The orientation in a solution that has one which can be inverted, of finite numbers that are not too large.
pub(crate) fn solved(solution: &ofc_solution) -> Result<Orientation, Refusal> {
    let whole = solution.outcome == OFC_STATUS_OK && solution.orientation.rank == 3;
    ensure(whole, OFC_STATUS_NOT_SOLVED)?;
    let orientation = Orientation::from_c(solution.orientation)?;
    bounded(orientation.f)?;
    bounded(orientation.f_inverse)?;
    Ok(orientation)
}

/// Composes F from the lengths, tilts and slants of its rows, and inverts it through its singular values.
/// @param norms  Three lengths in pixel values.
/// @param tilt_rad  Three tilts in radians.
/// @param slant_rad  Three slants in radians.
/// @param rank_threshold  Singular values below this ratio to the largest are zero, in [0, 1); ofc_solve() uses 1e-3.
/// @param orientation  Output: F and its inverse. The inverse is the pseudo-inverse where the rank is below 3.
/// @return OFC_STATUS_OK; OFC_STATUS_RANK_DEFICIENT when the rank is below 3, with `orientation` written; an argument
///     status, OFC_STATUS_INVALID_PARAMETER also for lengths so large or small that a number of `orientation` would not be finite.
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
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let norms = call.input_array::<f64, 3>(norms)?;
        let tilts = call.input_array::<f64, 3>(tilt_rad)?;
        let slants = call.input_array::<f64, 3>(slant_rad)?;
        let result = call.output(orientation)?;
        let finite = [norms, tilts, slants].iter().flatten().all(|value| value.is_finite());
        ensure(finite && (0.0..1.0).contains(&rank_threshold), OFC_STATUS_INVALID_PARAMETER)?;
        let orientation = Orientation::new(compose(norms, slants, tilts), rank_threshold);
        let Orientation { f, f_inverse, singular_values, .. } = &orientation;
        let mut numbers = f.iter().chain(f_inverse).flatten().chain(singular_values);
        ensure(numbers.all(|number| number.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        *result = orientation.to_c();
        Ok(if orientation.rank == 3 { OFC_STATUS_OK } else { OFC_STATUS_RANK_DEFICIENT })
    })
}

/// Computes the integral (15), the mean of (dp/dy - dq/dx)^2 over cells of four inliers, for the normals F^-1 rho: how
/// far they are from being the normals of a surface. Slopes of normals with n3 below 0.05 are taken at 0.05.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param f_inverse  F^-1, of finite entries of at most 1e100 in absolute value: then the integral is finite.
/// @param result  Output: the integral.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CELLS; OFC_STATUS_INVALID_PARAMETER for other entries; an argument status.
///
/// Reference: section 2.3, eq. 15.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_integrability_integral(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    f_inverse: *const f64,
    result: *mut ofc_integrability,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let matrix = call.input_array::<f64, 9>(f_inverse)?;
        let result = call.output(result)?;
        let integral = integrability::integral(&picture, test.selector(), &bounded(Mat3::from_c(matrix)?)?);
        *result = integral.ok_or(OFC_STATUS_NO_CELLS)?.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Computes normals n = F^-1 rho with any F.
/// @param image  The picture.
/// @param inlier_test  Which pixels have a normal; NULL for every usable pixel.
/// @param f_inverse  F^-1, of finite entries of at most 1e100 in absolute value: then every normal is finite. With
///     OFC_NORMALIZATION_NONE a component too large for a float is FLT_MAX or -FLT_MAX.
/// @param normalization  One of OFC_NORMALIZATION_*.
/// @param normals  Output: height rows of width (x right, y up, z toward the camera) floats; zero for no normal.
/// @param normals_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; OFC_STATUS_INVALID_PARAMETER for other entries; an argument status.
///
/// Reference: eq. 8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_from_matrix(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    f_inverse: *const f64,
    normalization: ofc_normalization,
    normals: *mut f32,
    normals_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let matrix = bounded(Mat3::from_c(call.input_array(f_inverse)?)?)?;
        let length = Length::from_c(normalization)?;
        let (normals, stride) = call.output_rows(normals, size(&picture), 3, normals_stride_bytes)?;
        let one = &Threads::one();
        normals::compute_in_parts(&picture, test.selector(), &matrix, length, normals, stride, one)?;
        Ok(OFC_STATUS_OK)
    })
}

/// Computes the unit normals of the inliers of a solved picture, or of another frame under the same lights.
/// @param image  The picture.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param normals  Output: height rows of width (x right, y up, z toward the camera) floats; zero for no normal. Computed in single
///     precision where that is enough: a component errs by less than 5e-5 by it, and mostly by 1e-7.
/// @param normals_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_INVALID_PARAMETER where F or F^-1 has an entry that is not
///     finite or above 1e100 in absolute value, as no solution has that ofc_solve() wrote; an argument status.
///
/// Reference: eq. 8.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_compute(
    image: *const ofc_image,
    solution: *const ofc_solution,
    normals: *mut f32,
    normals_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }
        .call(|call| compute_normals(call, image, solution, normals, normals_stride_bytes, ptr::null()))
}

/// Does what ofc_normals_compute() does, with the same bits, on threads of the caller.
/// @param image  The picture.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param normals  Output: as that of ofc_normals_compute().
/// @param normals_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @param parallel  What runs the parts; NULL for the thread of the call.
/// @return As ofc_normals_compute(); OFC_STATUS_NULL_POINTER also where `run` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_compute_parallel(
    image: *const ofc_image,
    solution: *const ofc_solution,
    normals: *mut f32,
    normals_stride_bytes: usize,
    parallel: *const ofc_parallel,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }
        .call(|call| compute_normals(call, image, solution, normals, normals_stride_bytes, parallel))
}

fn compute_normals(
    call: &mut Call,
    image: *const ofc_image,
    solution: *const ofc_solution,
    normals: *mut f32,
    normals_stride_bytes: usize,
    parallel: *const ofc_parallel,
) -> Result<ofc_status, Refusal> {
    let picture = call.image(image)?;
    let solution = call.input(solution)?;
    let orientation = solved(&solution)?;
    let test = Inliers::from_c(solution.inlier_test)?;
    let threads = call.threads(parallel)?;
    let (normals, stride) = call.output_rows(normals, size(&picture), 3, normals_stride_bytes)?;
    let (inliers, matrix) = (test.selector(), &orientation.f_inverse);
    normals::compute_in_parts(&picture, inliers, matrix, Length::Unit, normals, stride, &threads)?;
    Ok(OFC_STATUS_OK)
}
