//! The orthogonal transformation by other methods than tilts, and slants from tilts and integrability.

use crate::image::{image, ofc_image};
use crate::pointers::{Extent, Out, Plain, disjoint, extent, input, input_array, workspace};
use crate::regression::{accepted_by, float_bytes, floats, pixel_count};
use crate::status::{
    OFC_STATUS_INVALID_PARAMETER, OFC_STATUS_NO_CELLS, OFC_STATUS_OK, OFC_STATUS_RESERVED_NOT_ZERO,
    OFC_STATUS_WORKSPACE_TOO_SMALL, of, ofc_status,
};
use crate::types::{finite_matrix, flat, ofc_inliers, ofc_integrability, ofc_slants};
use core::ffi::c_void;
use ofc_core::orientation::orthogonal::annealing::{self, Params};
use ofc_core::orientation::orthogonal::{
    Found, OrthogonalError, Transformation, TwinChoice, closed_form, tilts_given,
};

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
    pub clarity: f64,
    /// The integral of both.
    pub integral: ofc_integrability,
    /// The same before the polish on the whole picture.
    pub unpolished: ofc_integrability,
    /// What chose, one of OFC_TWIN_*.
    pub choice: ofc_twin_choice,
    /// Times the integral was computed over the whole picture.
    pub evaluations: u32,
}

// SAFETY: integers and floats.
unsafe impl Plain for ofc_annealing_params {}
// SAFETY: as above.
unsafe impl Plain for ofc_orthogonal {}

impl ofc_annealing_params {
    fn defaults() -> Self {
        let Params { proposals, chains, sample_cells, temperatures, angles, polish_evaluations, seed } =
            Params::default();
        Self {
            temperatures,
            angles_rad: angles,
            seed,
            proposals,
            chains,
            sample_cells,
            polish_evaluations,
            reserved: [0; 4],
        }
    }

    fn check(self) -> Result<Params, ofc_status> {
        let Self {
            temperatures,
            angles_rad,
            seed,
            proposals,
            chains,
            sample_cells,
            polish_evaluations,
            reserved,
        } = self;
        if reserved != [0; 4] {
            return Err(OFC_STATUS_RESERVED_NOT_ZERO);
        }
        let angles = angles_rad;
        let params =
            Params { proposals, chains, sample_cells, temperatures, angles, polish_evaluations, seed };
        if params.are_valid() { Ok(params) } else { Err(OFC_STATUS_INVALID_PARAMETER) }
    }
}

impl From<Transformation> for ofc_transformation {
    fn from(transformation: Transformation) -> Self {
        let Transformation { rows, f, f_inverse, tilts, slants } = transformation;
        Self {
            rows: flat(&rows),
            f: flat(&f),
            f_inverse: flat(&f_inverse),
            tilt_rad: tilts,
            slant_rad: slants,
        }
    }
}

impl From<Found> for ofc_orthogonal {
    fn from(found: Found) -> Self {
        let Found { transformation, twin, choice, clarity, integral, unpolished, evaluations } = found;
        let choice = match choice {
            TwinChoice::Convex => OFC_TWIN_CONVEX,
            TwinChoice::Tilts => OFC_TWIN_TILTS,
        };
        Self {
            chosen: transformation.into(),
            twin: twin.into(),
            clarity,
            integral: integral.into(),
            unpolished: unpolished.into(),
            choice,
            evaluations,
        }
    }
}

const fn of_orthogonal_error(error: OrthogonalError) -> ofc_status {
    match error {
        OrthogonalError::Params | OrthogonalError::SingularRoot => OFC_STATUS_INVALID_PARAMETER,
        OrthogonalError::WorkspaceTooShort => OFC_STATUS_WORKSPACE_TOO_SMALL,
        OrthogonalError::NoCells => OFC_STATUS_NO_CELLS,
    }
}

/// Three tilts, or none where the pointer is NULL.
fn optional_tilts(tilt_rad: *const f64) -> Result<(Option<[f64; 3]>, Extent), ofc_status> {
    if tilt_rad.is_null() {
        return Ok((None, Extent::NOTHING));
    }
    let (tilts, extent) = input_array::<f64, 3>(tilt_rad)?;
    if tilts.iter().all(|tilt| tilt.is_finite()) {
        Ok((Some(tilts), extent))
    } else {
        Err(OFC_STATUS_INVALID_PARAMETER)
    }
}

/// Sets every field to its default.
///
/// @param params  Output.
/// @return OFC_STATUS_OK, OFC_STATUS_NULL_POINTER, OFC_STATUS_MISALIGNED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_annealing_params_default(params: *mut ofc_annealing_params) -> ofc_status {
    of(Out::new(params).map(|out| {
        out.write(ofc_annealing_params::defaults());
        OFC_STATUS_OK
    }))
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
    let Ok(params) = input(params).and_then(|(params, _)| params.check()) else { return 0 };
    float_bytes(annealing::workspace_len(pixel_count(width, height), params.sample_cells))
}

/// The orthogonal transformation that minimises the integral (15) over O(3), by seeded simulated annealing on a sample of
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
    inliers: *const ofc_inliers,
    root: *const f64,
    tilt_rad: *const f64,
    params: *const ofc_annealing_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    found: *mut ofc_orthogonal,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (test, test_extent) = accepted_by(inliers, &picture)?;
        let (root, root_extent) = input_array::<f64, 9>(root)?;
        let (tilts, tilts_extent) = optional_tilts(tilt_rad)?;
        let (params, params_extent) = input(params)?;
        let params = params.check()?;
        let view = &picture.view;
        let need = float_bytes(annealing::workspace_len(view.width() * view.height(), params.sample_cells));
        let scratch = self::workspace(workspace.cast(), workspace_bytes, need)?;
        let out = Out::new(found)?;
        let [a, b, c, d, e] = picture.extents;
        disjoint(
            &[scratch, out.extent],
            &[a, b, c, d, e, test_extent, root_extent, tilts_extent, params_extent],
        )?;
        let root = finite_matrix(root)?;
        // SAFETY: checked and disjoint.
        let scratch = unsafe { floats(workspace, need) };
        let result = annealing::annealing(view, test.selector(), &root, tilts, &params, scratch);
        out.write(result.map_err(of_orthogonal_error)?.into());
        Ok(OFC_STATUS_OK)
    };
    of(body())
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
    inliers: *const ofc_inliers,
    root: *const f64,
    tilt_rad: *const f64,
    polish_evaluations: u32,
    found: *mut ofc_orthogonal,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (test, test_extent) = accepted_by(inliers, &picture)?;
        let (root, root_extent) = input_array::<f64, 9>(root)?;
        let (tilts, tilts_extent) = optional_tilts(tilt_rad)?;
        let out = Out::new(found)?;
        let [a, b, c, d, e] = picture.extents;
        disjoint(&[out.extent], &[a, b, c, d, e, test_extent, root_extent, tilts_extent])?;
        let root = finite_matrix(root)?;
        if polish_evaluations > annealing::MAX_EVALUATIONS {
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        let result =
            closed_form::closed_form(&picture.view, test.selector(), &root, tilts, polish_evaluations);
        out.write(result.map_err(of_orthogonal_error)?.into());
        Ok(OFC_STATUS_OK)
    };
    of(body())
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
    float_bytes(tilts_given::workspace_len(pixel_count(width, height), sample_cells))
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
    inliers: *const ofc_inliers,
    norms: *const f64,
    tilt_rad: *const f64,
    cosines: *const f64,
    slack: f64,
    sample_cells: u32,
    workspace: *mut c_void,
    workspace_bytes: usize,
    slants: *mut ofc_slants,
) -> ofc_status {
    let body = || {
        // SAFETY: the contract of this function.
        let picture = unsafe { self::image(image) }?;
        let (test, test_extent) = accepted_by(inliers, &picture)?;
        let (norms, norms_extent) = input_array::<f64, 3>(norms)?;
        let (tilts, tilts_extent) = input_array::<f64, 3>(tilt_rad)?;
        let (cosines, cosines_extent) = input_array::<f64, 3>(cosines)?;
        if sample_cells == 0 {
            extent(workspace.cast_const().cast::<f64>(), 1)?;
            return Err(OFC_STATUS_INVALID_PARAMETER);
        }
        let view = &picture.view;
        let need = float_bytes(tilts_given::workspace_len(view.width() * view.height(), sample_cells));
        let scratch = self::workspace(workspace.cast(), workspace_bytes, need)?;
        let out = Out::new(slants)?;
        let [a, b, c, d, e] = picture.extents;
        disjoint(
            &[scratch, out.extent],
            &[a, b, c, d, e, test_extent, norms_extent, tilts_extent, cosines_extent],
        )?;
        crate::slants::are_valid(tilts, cosines)?;
        let params = tilts_given::Params { slack, sample_cells };
        // SAFETY: checked and disjoint.
        let scratch = unsafe { floats(workspace, need) };
        let bits = |window: &_| test.bits(window);
        let found = tilts_given::tilts_given(view, bits, norms, cosines, tilts, &params, scratch)
            .map_err(of_orthogonal_error)?;
        out.write(ofc_slants {
            slant_rad: found.slants,
            residual: found.residual_rms,
            integral: found.integral.mean,
            branch: 0,
            reserved: 0,
        });
        Ok(OFC_STATUS_OK)
    };
    of(body())
}
