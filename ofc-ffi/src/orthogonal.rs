//! The orthogonal transformation by other methods than tilts, and slants from tilts and integrability.

use crate::prelude::*;
use ofc_core::math::mat3::Mat3;
use ofc_core::orientation::orthogonal::annealing::{self, Params};
use ofc_core::orientation::orthogonal::{Found, Transformation, TwinChoice, closed_form, tilts_given};

/// What chose between a surface and its convex/concave twin: one of OFC_TWIN_*.
pub type ofc_twin_choice = i32;
/// No tilts were given, and the convex one was chosen.
pub const OFC_TWIN_CONVEX: i32 = 0;
/// The tilts of the chosen one are nearer to the tilts that were given.
pub const OFC_TWIN_TILTS: i32 = 1;

/// How ofc_orthogonal_annealing() searches. Set by ofc_annealing_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_annealing_params {
    /// Relative temperature at the start and at the end of a chain, > 0. Default 1 and 0.01.
    pub temperatures: [f64; 2],
    /// Largest angle of a proposal at the start and at the end of a chain, in radians, > 0. Default 2 and 0.02.
    pub angles_rad: [f64; 2],
    /// Determines every random choice. Default 0.
    pub seed: u64,
    /// How many proposals all chains make together, 1 to 10,000,000. Default 4000.
    pub proposals: u32,
    /// How many chains there are, at least 1. Default 8.
    pub chains: u32,
    /// How many cells proposals are evaluated on, at least 1. Default 2000.
    pub sample_cells: u32,
    /// How often the local refinement may compute (15) over the whole picture, up to 10,000,000. Default 60.
    pub polish_evaluations: u32,
    /// Must be zero.
    pub reserved: [u32; 4],
}

/// One orthogonal transformation of O(3) and the F that follows from it.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_transformation {
    /// The rows r1, r2, r3 of the transformation, n = rows G0 rho; the determinant is 1 or -1.
    pub rows: [f64; 9],
    /// F = G0^-1 rows^T, in pixel values.
    pub f: [f64; 9],
    /// F^-1 = rows G0.
    pub f_inverse: [f64; 9],
    /// Tilts of the rows of F in radians, in (-pi, pi].
    pub tilt_rad: [f64; 3],
    /// Slants of the rows of F in radians; the paper has no light with a slant above pi/2.
    pub slant_rad: [f64; 3],
}

/// A minimum of the integral (15), and the convex/concave twin, which has the same integral (section 2.4).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_orthogonal {
    /// The transformation that was chosen.
    pub chosen: ofc_transformation,
    /// The other transformation: its rows r1 and r2 have the other sign.
    pub twin: ofc_transformation,
    /// How clear the choice is, from 0 (both are equally good) to 1.
    pub margin: f64,
    /// The integral of both.
    pub integral: ofc_integrability,
    /// The integral of both before the local refinement over the whole picture.
    pub unpolished: ofc_integrability,
    /// What chose, one of OFC_TWIN_*.
    pub choice: ofc_twin_choice,
    /// How often the integral was computed over the whole picture.
    pub evaluations: u32,
}

plain!(ofc_annealing_params, ofc_orthogonal);

constants!(TwinChoice = { Convex: OFC_TWIN_CONVEX, Tilts: OFC_TWIN_TILTS });
to_c!(Params => ofc_annealing_params {
    temperatures, seed, proposals, chains, sample_cells, polish_evaluations; angles_rad: angles
} zero { reserved });
from_c!(Params <= ofc_annealing_params {
    temperatures, seed, proposals, chains, sample_cells, polish_evaluations; angles_rad: angles
} zero { reserved } where are_valid);
to_c!(Transformation => ofc_transformation { rows, f, f_inverse; tilt_rad: tilts, slant_rad: slants });
to_c!(Found => ofc_orthogonal {
    twin, integral, unpolished, choice, evaluations; chosen: transformation, margin: clarity
});

/// Three finite tilts, or none where the pointer is NULL.
fn optional_tilts(call: &mut Call, tilt_rad: *const f64) -> Result<Option<[f64; 3]>, Refusal> {
    let tilts = unless_null(tilt_rad, || call.input_array::<f64, 3>(tilt_rad))?;
    let finite = tilts.iter().flatten().all(|tilt| tilt.is_finite());
    ensure(finite, OFC_STATUS_INVALID_PARAMETER)?;
    Ok(tilts)
}

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_annealing_params_default(params: *mut ofc_annealing_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_orthogonal_annealing() needs: 36 for each cell that proposals are evaluated on.
/// @param width,height  Size of the picture.
/// @param params  The parameters that ofc_orthogonal_annealing() will be given.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_orthogonal_annealing_workspace_size(
    width: i32,
    height: i32,
    params: *const ofc_annealing_params,
) -> usize {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.size(|call| {
        let params: Params = call.params(params)?;
        Ok(Need::of_singles(annealing::workspace_len(pixel_count(width, height), params.sample_cells)))
    })
}

/// Finds the orthogonal transformation that minimizes the integral (15) over O(3), by simulated annealing on a sample
/// of cells and a local refinement over the whole picture.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param root  G0 of ofc_ellipsoid.
/// @param tilt_rad  Three tilts in radians that choose between the convex/concave twins; NULL for the convex one.
/// @param params  The parameters.
/// @param workspace  ofc_orthogonal_annealing_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param found  Output: the minimum.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CELLS; an argument status, OFC_STATUS_INVALID_PARAMETER also for a root without
///     an inverse.
///
/// Reference: section 2.3, eqs. 13-15; L. L. Kontsevich, A. P. Petrov, I. S. Vergelskaya, JOSA A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_orthogonal_annealing(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    root: *const f64,
    tilt_rad: *const f64,
    params: *const ofc_annealing_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    found: *mut ofc_orthogonal,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let root = Mat3::from_c(call.input_array(root)?)?;
        let tilts = optional_tilts(call, tilt_rad)?;
        let params: Params = call.params(params)?;
        let need = annealing::workspace_len(picture.width() * picture.height(), params.sample_cells);
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let result = call.output(found)?;
        let found = annealing::annealing(&picture, test.selector(), &root, tilts, &params, workspace)?;
        *result = found.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Finds the orthogonal transformation in closed form: the smoothness condition (16) gives r3 as an eigenvector, and
/// the angle that is left follows from (15). A local refinement of (15) comes after it.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param root  G0 of ofc_ellipsoid.
/// @param tilt_rad  Three tilts in radians that choose between the convex/concave twins; NULL for the convex one.
/// @param polish_evaluations  How often the local refinement may compute (15) over the picture, up to 10,000,000: 0 for
///     the closed form alone; ofc_orthogonal_annealing() uses 60 by default.
/// @param found  Output: the minimum.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CELLS; an argument status, OFC_STATUS_INVALID_PARAMETER also for a root without
///     an inverse.
///
/// Reference: section 2.3, eq. 16; M. S. Drew, L. L. Kontsevich, "Closed-form attitude determination under spectrally
/// varying illumination", CVPR 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_orthogonal_closed_form(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    root: *const f64,
    tilt_rad: *const f64,
    polish_evaluations: u32,
    found: *mut ofc_orthogonal,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let root = Mat3::from_c(call.input_array(root)?)?;
        let tilts = optional_tilts(call, tilt_rad)?;
        let result = call.output(found)?;
        ensure(polish_evaluations <= annealing::MAX_EVALUATIONS, OFC_STATUS_INVALID_PARAMETER)?;
        let found = closed_form::closed_form(&picture, test.selector(), &root, tilts, polish_evaluations)?;
        *result = found.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_constrained_slants_integrable() needs: 36 for each cell that slants are
/// evaluated on.
/// @param width,height  Size of the picture.
/// @param sample_cells  The number of cells that ofc_constrained_slants_integrable() will be given.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_constrained_slants_integrable_workspace_size(
    width: i32,
    height: i32,
    sample_cells: u32,
) -> usize {
    bytes(Need::of_singles(tilts_given::workspace_len(pixel_count(width, height), sample_cells)))
}

/// Finds the slants that minimize the integral (15) among those that eqs. 24 allow, given the tilts and norms of the
/// rows of F. Section 3.3 proposes it where eqs. 25 have no root.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param norms  Three lengths of the rows of F, > 0.
/// @param tilt_rad  Three tilts of the rows of F in radians, of finite differences.
/// @param cosines  The cosines h12, h13, h23, each in [-1, 1].
/// @param slack  How far the root mean square residual of eqs. 24 may exceed the smallest one, >= 0; ofc_solve() uses
///     0.05.
/// @param sample_cells  How many cells slants are evaluated on, at least 1; ofc_solve() uses 2000.
/// @param workspace  ofc_constrained_slants_integrable_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param slants  Output: the slants. `residual` is the root mean square residual of eqs. 24, `branch` is 0.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CELLS; an argument status.
///
/// Reference: section 3.3.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_constrained_slants_integrable(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    norms: *const f64,
    tilt_rad: *const f64,
    cosines: *const f64,
    slack: f64,
    sample_cells: u32,
    workspace: *mut c_void,
    workspace_bytes: usize,
    slants: *mut ofc_slants,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let norms = call.input_array(norms)?;
        let (tilts, cosines) = call.tilts_and_cosines(tilt_rad, cosines)?;
        ensure(sample_cells > 0, OFC_STATUS_INVALID_PARAMETER)?;
        let need = tilts_given::workspace_len(picture.width() * picture.height(), sample_cells);
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let slants = call.output(slants)?;
        let params = tilts_given::Params { slack, sample_cells };
        let bits = |window: &_| test.bits(window);
        let found = tilts_given::tilts_given(&picture, bits, norms, cosines, tilts, &params, workspace)?;
        *slants = ofc_slants {
            slant_rad: found.slants,
            residual: found.residual_rms,
            integral: found.integral.mean,
            branch: 0,
            reserved: 0,
        };
        Ok(OFC_STATUS_OK)
    })
}
