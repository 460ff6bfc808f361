//! How sure C, F and the normals are, and where the matte model does not hold.

use crate::prelude::*;
use core::ptr;
use ofc_core::color::inliers::Inliers;
use ofc_core::color::regression::whole;
use ofc_core::math::mat3::Mat3;
use ofc_core::surface::uncertainty::{Sources, Uncertainty, of_f, of_f_inverse, of_turn};
use ofc_core::surface::wolff::Dielectric;

/// Expected squares and products of errors, as symmetric matrices. All pixels of a picture share these errors.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_covariance {
    /// The covariance of c11, c22, c33, c12, c13, c23, in (pixel value)^-4.
    pub c: [f64; 36],
    /// The covariance of the nine entries of F, row by row, in (pixel value)^2.
    pub f: [f64; 81],
    /// The covariance of the nine entries of F^-1, row by row, in (pixel value)^-2.
    pub f_inverse: [f64; 81],
    /// The covariance of the small rotation of all normals, in their frame and in radians^2, for the C that was found.
    pub rotation: [f64; 9],
    /// Standard deviation of the noise in each channel in pixel values, with the noise that rounding adds.
    pub pixel_noise: f64,
}

plain!(ofc_covariance);

/// What the uncertainty of a solution comes from, if it is there and finite.
pub(crate) fn sources(solution: &ofc_solution) -> Result<Sources, Refusal> {
    let orientation = solved(solution)?;
    ensure(solution.confidence.evidence != OFC_EVIDENCE_TILTS_ALONE, OFC_STATUS_NO_COVARIANCE)?;
    let (c, noise) = (solution.fit.covariance, solution.fit.pixel_noise);
    let finite = c.iter().all(|entry| entry.is_finite()) && noise.is_finite();
    ensure(finite && noise >= 0.0, OFC_STATUS_INVALID_PARAMETER)?;
    Ok(Sources {
        f: orientation.f,
        f_inverse: orientation.f_inverse,
        c,
        rotation: Mat3::from_c(solution.confidence.covariance)?,
        noise,
    })
}

/// Computes the covariances of C and F, to first order.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param covariance  Output: the covariances.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_NO_COVARIANCE for a solution by the direct method;
///     OFC_STATUS_INVALID_PARAMETER for numbers, as no solution has that ofc_solve() wrote, whose covariances would not be
///     finite; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_solution_covariance(
    solution: *const ofc_solution,
    covariance: *mut ofc_covariance,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let solution = call.input(solution)?;
        let covariance = call.output(covariance)?;
        let Sources { f, f_inverse, c, rotation, noise } = sources(&solution)?;
        let turn = of_turn(&f, &c, &rotation);
        let (of_f, of_f_inverse) = (of_f(&f, &turn), of_f_inverse(&f_inverse, &turn));
        let finite = of_f.iter().chain(&of_f_inverse).flatten().all(|entry| entry.is_finite());
        ensure(finite, OFC_STATUS_INVALID_PARAMETER)?;
        *covariance = ofc_covariance {
            c: row_major(&whole(&c)),
            f: row_major(&of_f),
            f_inverse: row_major(&of_f_inverse),
            rotation: rotation.to_c(),
            pixel_noise: noise,
        };
        Ok(OFC_STATUS_OK)
    })
}

/// The entries row by row.
fn row_major<const N: usize, const SQUARE: usize>(matrix: &[[f64; N]; N]) -> [f64; SQUARE] {
    let mut entries = [0.0; SQUARE];
    for (entry, value) in entries.iter_mut().zip(matrix.iter().flatten()) {
        *entry = *value;
    }
    entries
}

/// Computes the 1-sigma angle of each normal that ofc_normals_compute() makes: 68.3 % of errors are expected below it,
/// 95.4 to 99.0 % below twice the angle, and 99.7 to 100.0 % below three times the angle.
///
/// The angle comes from the noise in the colors, with the noise that rounding adds, and from the errors of C and of the
/// rotation. All pixels of a picture share these last two, so the percentages hold over many pictures and may be far
/// off on one. Not part of the angle are pixels that pass for inliers without obeying the model, and the choice between
/// convex and concave.
/// @param image  The picture.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param angle_rad  Output: height rows of width floats, in radians: above 0 and at most pi, pi where there is no
///     normal, and 0 for exact colors.
/// @param angle_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_NO_COVARIANCE for a solution by the direct method; an
///     argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_uncertainty(
    image: *const ofc_image,
    solution: *const ofc_solution,
    angle_rad: *mut f32,
    angle_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }
        .call(|call| compute_angles(call, image, solution, angle_rad, angle_stride_bytes, ptr::null()))
}

/// Does what ofc_normals_uncertainty() does, with the same bits, on threads of the caller.
/// @param image  The picture.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param angle_rad  Output: as that of ofc_normals_uncertainty().
/// @param angle_stride_bytes  Bytes from one row to the next, a multiple of 4; nothing between rows is written.
/// @param parallel  What runs the parts; NULL for the thread of the call.
/// @return As ofc_normals_uncertainty(); OFC_STATUS_NULL_POINTER also where `run` is NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_uncertainty_parallel(
    image: *const ofc_image,
    solution: *const ofc_solution,
    angle_rad: *mut f32,
    angle_stride_bytes: usize,
    parallel: *const ofc_parallel,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }
        .call(|call| compute_angles(call, image, solution, angle_rad, angle_stride_bytes, parallel))
}

fn compute_angles(
    call: &mut Call,
    image: *const ofc_image,
    solution: *const ofc_solution,
    angle_rad: *mut f32,
    angle_stride_bytes: usize,
    parallel: *const ofc_parallel,
) -> Result<ofc_status, Refusal> {
    let picture = call.image(image)?;
    let solution = call.input(solution)?;
    let sources = sources(&solution)?;
    let inliers = Inliers::from_c(solution.inlier_test)?;
    let threads = call.threads(parallel)?;
    let (angles, stride) = call.output_rows(angle_rad, size(&picture), 1, angle_stride_bytes)?;
    let inliers = inliers.selector();
    Uncertainty::new(&sources).compute_in_parts(&picture, inliers, angles, stride, &threads)?;
    Ok(OFC_STATUS_OK)
}

/// The matte weight of each normal that ofc_normals_compute() makes, by Wolff's model of smooth dielectrics (plastic, glaze, paint, a
/// gel): how much less light such a surface sends to the camera than a matte one of the linear model, because of the angle at which
/// it is seen. 1 where a normal faces the camera; with a refractive index of 1.5 still 0.95 at 60 degrees, 0.86 at 70, 0.64 at 80
/// and 0 at 90. Where it is small, trust colors the less: fits, depth and shading can count a pixel by it.
///
/// @param image     The picture.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param refractive_index  Of the surface, at least 1: 1.5 for most plastics, glazes and paints, 1.4 for silicone; 1 makes 1 everywhere.
/// @param weight    Output: height rows of width floats, row 0 at the top; 0 to 1, and 0 where there is no normal.
/// @param weight_stride_bytes  Bytes from a row to the next, a multiple of 4; what lies between rows is left alone.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_INVALID_PARAMETER; the status of an invalid argument.
///
/// Reference: section 5; L. B. Wolff, JOSA A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_normals_matte_weight(
    image: *const ofc_image,
    solution: *const ofc_solution,
    refractive_index: f64,
    weight: *mut f32,
    weight_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let solution = call.input(solution)?;
        let orientation = solved(&solution)?;
        let surface = Dielectric::new(refractive_index).ok_or(OFC_STATUS_INVALID_PARAMETER)?;
        let inliers = Inliers::from_c(solution.inlier_test)?;
        let (weights, stride) = call.output_rows(weight, size(&picture), 1, weight_stride_bytes)?;
        surface.compute(&picture, inliers.selector(), &orientation.f_inverse, weights, stride)?;
        Ok(OFC_STATUS_OK)
    })
}
