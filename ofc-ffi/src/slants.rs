//! Slants from tilts and angles.

use crate::prelude::*;
use core::f64::consts::FRAC_PI_2;
use ofc_core::light::constrained_slant::{self, CurvePoint, MAX_CANDIDATES, SlantRoot};

/// The largest number of slants that are consistent with three tilts and three cosines.
pub const OFC_MAX_CANDIDATES: usize = 8;
const _: () = assert!(OFC_MAX_CANDIDATES == MAX_CANDIDATES, "the header says what the core does");

to_c!(SlantRoot => ofc_slants { residual, branch; slant_rad: slants } zero { integral, reserved });

impl Call<'_> {
    /// Three tilts, which are any angles of finite differences, and three cosines in [-1, 1].
    pub(crate) fn tilts_and_cosines(
        &mut self,
        tilt_rad: *const f64,
        cosines: *const f64,
    ) -> Result<([f64; 3], [f64; 3]), Refusal> {
        let tilts = self.input_array::<f64, 3>(tilt_rad)?;
        let cosines = self.input_array::<f64, 3>(cosines)?;
        let [a, b, c] = tilts;
        ensure([a - b, a - c, b - c].iter().all(|turn| turn.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        ensure(cosines.iter().all(|h| (-1.0..=1.0).contains(h)), OFC_STATUS_INVALID_PARAMETER)?;
        Ok((tilts, cosines))
    }
}

/// Finds all slants in [0, pi/2] that are consistent with three tilts and the angles between the rows of F: every
/// solution of eqs. 24, on all eight branches of eqs. 25.
/// @param tilt_rad  Three tilts in radians, of finite differences.
/// @param cosines  The cosines h12, h13, h23, each in [-1, 1].
/// @param candidates  Output: OFC_MAX_CANDIDATES structs, of which the first `count` are written, by ascending first
///     slant; their `integral` is 0.
/// @param count  Output: how many candidates there are.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CONSISTENT_SLANTS, with a count of 0; an argument status.
///
/// Reference: sections 3.2-3.3, eqs. 24-25.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_constrained_slants_find(
    tilt_rad: *const f64,
    cosines: *const f64,
    candidates: *mut ofc_slants,
    count: *mut i32,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let (tilts, cosines) = call.tilts_and_cosines(tilt_rad, cosines)?;
        let candidates = call.output_slice(candidates, OFC_MAX_CANDIDATES)?;
        let count = call.output(count)?;
        let roots = constrained_slant::roots(tilts, cosines);
        for (slot, root) in candidates.iter_mut().zip(&roots) {
            *slot = root.to_c();
        }
        *count = roots.len().to_c();
        Ok(if roots.is_empty() { OFC_STATUS_NO_CONSISTENT_SLANTS } else { OFC_STATUS_OK })
    })
}

/// Finds the slants in [0, pi/2] that satisfy eqs. 24 best in least squares; ofc_solve() falls back on them where eqs.
/// 24 have no solution.
/// @param tilt_rad  Three tilts in radians, of finite differences.
/// @param cosines  The cosines h12, h13, h23, each in [-1, 1].
/// @param slants  Output: the slants; `branch` and `integral` are 0.
/// @return OFC_STATUS_OK; an argument status.
///
/// Reference: eqs. 24.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_constrained_slants_least_squares(
    tilt_rad: *const f64,
    cosines: *const f64,
    slants: *mut ofc_slants,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let (tilts, cosines) = call.tilts_and_cosines(tilt_rad, cosines)?;
        let slants = call.output(slants)?;
        let nearest = constrained_slant::least_squares(tilts, cosines);
        *slants = ofc_slants {
            slant_rad: nearest.slants,
            residual: nearest.residuals.iter().fold(0.0, |largest, residual| residual.abs().max(largest)),
            ..ofc_slants::default()
        };
        Ok(OFC_STATUS_OK)
    })
}

/// Samples f(sigma1) on one branch of eqs. 25, the curve of Figures 2 and 4(a). Where f(sigma1) equals sigma1 is a
/// solution, if the other slants are in their range.
/// @param tilt_rad  Three tilts in radians, of finite differences.
/// @param cosines  The cosines h12, h13, h23, each in [-1, 1].
/// @param branch  The branch, from 1 for the signs (+,+,+) of the square roots to 8 for (-,-,-).
/// @param count  How many samples to take evenly over [0, pi/2] with both ends, at least 2.
/// @param slant_rad  Output: `count` triples in radians: sigma1, and the slants 2 and 3 that follow from it by eqs. 25.
///     These are not confined to [0, pi/2], and are NaN where a square root has no real value.
/// @param f_rad  Output: `count` values in radians, NaN where a square root has no real value.
/// @return OFC_STATUS_OK; an argument status, OFC_STATUS_EMPTY for fewer than two samples.
///
/// Reference: section 3.3, eqs. 25.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_slant_curve_sample(
    tilt_rad: *const f64,
    cosines: *const f64,
    branch: i32,
    count: i32,
    slant_rad: *mut f64,
    f_rad: *mut f64,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let (tilts, cosines) = call.tilts_and_cosines(tilt_rad, cosines)?;
        let samples = dimension(count);
        let slants = call.output_slice(slant_rad, samples.checked_mul(3).ok_or(OFC_STATUS_TOO_LARGE)?)?;
        let values = call.output_slice(f_rad, samples)?;
        ensure(samples >= 2, OFC_STATUS_EMPTY)?;
        let branch = u8::try_from(branch).ok().filter(|b| (1..=8).contains(b));
        let branch = branch.ok_or(OFC_STATUS_INVALID_PARAMETER)?;
        for (i, (slants, value)) in slants.as_chunks_mut::<3>().0.iter_mut().zip(values).enumerate() {
            let sigma1 = FRAC_PI_2 * i as f64 / (samples - 1) as f64;
            let nothing = CurvePoint { slants: [sigma1, f64::NAN, f64::NAN], f: f64::NAN };
            let point = constrained_slant::curve(branch, sigma1, tilts, cosines).unwrap_or(nothing);
            (*slants, *value) = (point.slants, point.f);
        }
        Ok(OFC_STATUS_OK)
    })
}
