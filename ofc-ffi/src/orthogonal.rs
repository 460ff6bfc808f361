//! The orthogonal transformation by other methods than tilts, and slants from tilts and integrability.

use crate::image::{ofc_image, pixel_count};
use crate::pointers::{Call, Contract, bytes, plain, unless_null};
use crate::status::{OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_OK, Refusal, ensure, ofc_status};
use crate::twin::{FromC, ToC, constants, from_c, to_c};
use crate::types::{ofc_inlier_test, ofc_integrability, ofc_slants};
use core::ffi::c_void;
use ofc_core::math::arena::Need;
use ofc_core::math::mat3::Mat3;
use ofc_core::orientation::orthogonal::annealing::{self, Params};
use ofc_core::orientation::orthogonal::{Found, Transformation, TwinChoice, closed_form, tilts_given};

/// What chose between the convex/concave twins: one of OFC_TWIN_*.
pub type ofc_twin_choice = i32;
/// No tilts were given: the convex one.
pub const OFC_TWIN_CONVEX: i32 = 0;
/// The tilts of the rows of F that are nearer to those given.
pub const OFC_TWIN_TILTS: i32 = 1;

/// How ofc_orthogonal_annealing() searches. Set by ofc_annealing_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_annealing_params {
    /// Temperature at the start and at the end of a chain, relative, > 0. Default 1 and 0.01.
    pub temperatures: [f64; 2],
    /// Largest angle of a proposal at the start and at the end of a chain, radians, > 0. Default 2 and 0.02.
    pub angles_rad: [f64; 2],
    /// Fixes every random choice. Default 0.
    pub seed: u64,
    /// Proposals in all, 1 to 10,000,000. Default 4000.
    pub proposals: u32,
    /// Chains that share them, at least 1. Default 8.
    pub chains: u32,
    /// Cells that proposals are evaluated on, at least 1. Default 2000.
    pub sample_cells: u32,
    /// Times that the polish may compute (15) over the whole picture, up to 10,000,000. Default 60.
    pub polish_evaluations: u32,
    /// Must be zero.
    pub reserved: [u32; 4],
}

/// One member of O(3) and the F that follows from it. Matrices are row-major.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_transformation {
    /// r1, r2, r3: n = rows G0 rho; the determinant is 1 or -1.
    pub rows: [f64; 9],
    /// F = G0^-1 rows^T, in pixel values.
    pub f: [f64; 9],
    /// F^-1 = rows G0.
    pub f_inverse: [f64; 9],
    /// Tilts of the rows of F in (-pi, pi].
    pub tilt_rad: [f64; 3],
    /// Slants of the rows of F; one above pi/2 is no light of the paper's.
    pub slant_rad: [f64; 3],
}

/// A minimum of the integral (15), and its convex/concave twin, whose integral is the same (section 2.4).
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_orthogonal {
    /// The one of the two that was chosen.
    pub chosen: ofc_transformation,
    /// The other: rows r1 and r2 with the other sign.
    pub twin: ofc_transformation,
    /// How clear the choice is, from 0 (equally good) to 1.
    pub margin: f64,
    /// The integral of both.
    pub integral: ofc_integrability,
    /// The same before the polish on the whole picture.
    pub unpolished: ofc_integrability,
    /// What chose, one of OFC_TWIN_*.
    pub choice: ofc_twin_choice,
    /// Times the integral was computed over the whole picture.
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
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_annealing_params_default(params: *mut ofc_annealing_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Bytes of workspace that ofc_orthogonal_annealing() needs: 36 for each cell that proposals are evaluated on.
///
/// @return The size, or 0 when an argument is invalid.
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

/// The orthogonal transformation that minimizes the integral (15) over O(3), by seeded simulated annealing on a sample of
/// cells and a polish on the whole picture.
///
/// @param image      The picture.
/// @param inliers    The pixels to use; NULL for every usable pixel of the picture.
/// @param root       G0 of ofc_ellipsoid, row-major.
/// @param tilt_rad   Three tilts that choose between the convex and the concave twin; NULL for the convex one.
/// @param params     See the struct.
/// @param workspace  ofc_orthogonal_annealing_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT; contents do
///                   not matter.
/// @param workspace_bytes  Its size.
/// @param found      Output.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CELLS; OFC_STATUS_INVALID_PARAMETER, also for a root without an inverse; the
///         status of an invalid argument.
///
/// Reference: section 2.3, eqs. 13-15; L. L. Kontsevich, A. P. Petrov, I. S. Vergelskaya, JOSA A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_orthogonal_annealing(
    image: *const ofc_image,
    inliers: *const ofc_inlier_test,
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
        let test = call.inliers(inliers, &picture)?;
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

/// The orthogonal transformation in closed form: the smoothness condition (16) gives r3 as an eigenvector, and the one
/// angle that is left follows from (15); then a polish on (15).
///
/// @param image      The picture.
/// @param inliers    The pixels to use; NULL for every usable pixel of the picture.
/// @param root       G0 of ofc_ellipsoid, row-major.
/// @param tilt_rad   Three tilts that choose between the convex and the concave twin; NULL for the convex one.
/// @param polish_evaluations  Times that the polish may compute (15) over the picture, up to 10,000,000: 0 for the bare
///                   closed form, 60 for what solve and annealing do.
/// @param found      Output.
/// @return As ofc_orthogonal_annealing().
///
/// Reference: section 2.3, eq. 16; M. S. Drew, L. L. Kontsevich, "Closed-form attitude determination under spectrally
/// varying illumination", CVPR 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_orthogonal_closed_form(
    image: *const ofc_image,
    inliers: *const ofc_inlier_test,
    root: *const f64,
    tilt_rad: *const f64,
    polish_evaluations: u32,
    found: *mut ofc_orthogonal,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inliers(inliers, &picture)?;
        let root = Mat3::from_c(call.input_array(root)?)?;
        let tilts = optional_tilts(call, tilt_rad)?;
        let result = call.output(found)?;
        ensure(polish_evaluations <= annealing::MAX_EVALUATIONS, OFC_STATUS_INVALID_PARAMETER)?;
        let found = closed_form::closed_form(&picture, test.selector(), &root, tilts, polish_evaluations)?;
        *result = found.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Bytes of workspace that ofc_constrained_slants_integrable() needs: 36 for each cell.
///
/// @return The size, or 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_constrained_slants_integrable_workspace_size(
    width: i32,
    height: i32,
    sample_cells: u32,
) -> usize {
    bytes(Need::of_singles(tilts_given::workspace_len(pixel_count(width, height), sample_cells)))
}

/// The slants that make the integral (15) smallest, given the tilts and norms of the rows of F, among those that eqs. 24
/// do not rule out: section 3.3's other answer where eqs. 25 have no root.
///
/// @param image         The picture.
/// @param inliers       The pixels to use; NULL for every usable pixel of the picture.
/// @param norms         Lengths of the rows of F, > 0.
/// @param tilt_rad      Their tilts.
/// @param cosines       (h12, h13, h23), each in [-1, 1].
/// @param slack         How far the root mean square residual of eqs. 24 may be above the smallest, >= 0; 0.05 is what
///                      solve uses.
/// @param sample_cells  Cells that slants are evaluated on, at least 1; 2000 is what solve uses.
/// @param workspace     ofc_constrained_slants_integrable_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT;
///                      contents do not matter.
/// @param workspace_bytes  Its size.
/// @param slants        Output: `residual` is the root mean square residual of eqs. 24, the branch is 0.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_CELLS; OFC_STATUS_INVALID_PARAMETER; the status of an invalid argument.
///
/// Reference: section 3.3.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_constrained_slants_integrable(
    image: *const ofc_image,
    inliers: *const ofc_inlier_test,
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
        let test = call.inliers(inliers, &picture)?;
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
