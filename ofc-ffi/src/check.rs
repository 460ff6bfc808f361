//! Whether to believe an answer: self-checks and ranks.

use crate::prelude::*;
use ofc_core::check::{self, Check, Norms, Turn};
use ofc_core::color::inliers::Inliers;
use ofc_core::color::rank::{self, Rank};
use ofc_core::color::regression::Estimate;
use ofc_core::light::tilt::Tilts;

/// How well a solution explains its own picture. How to read it:
///
/// - `correlation` near 1 says that the linear model holds: channels relit from the recovered normals look like the
///   input. The paper's egg reaches 0.9989; 0.99 is usual for a photograph of a matte surface. It does not see F's
///   orthogonal transformation, which cancels.
/// - `turn_rad` sees every wrong orthogonal transformation. It is the angle by which all normals would have to be
///   turned to agree best with integrability and to point outward; `turn_expected_rad` is the angle to expect of a
///   right F. Normals turned by 10, 25 or 40 degrees about any axis show as 8, 20 and 32 degrees, the convex/concave
///   twin as 110, a mirror image as 71. Several times the expected angle says that F is wrong. A `convexity` near zero
///   says that nothing tells which of the twins is right. `turn_rad` is small by construction where F comes from
///   OFC_ORIENTATION_JOINT.
/// - `tilt_residual_rad` sees a turn about the line of sight as its angle, and the twin as 180 degrees. It is zero by
///   construction where F follows Pentland's tilts of the input, and up to 15 degrees for a right F on a closed shape
///   that is not round. On relief that touches the frame it says nothing.
/// - `tilt_difference_rad` is near zero when setting the normals to unit length changes nothing that tilts depend on.
///   It sees no wrong orthogonal transformation.
/// - `depth_angle_median_rad` is a degree or two when the normals belong to one surface. A turn of 25 degrees about the
///   line of sight adds 6 to 13 degrees; a turn about an axis in the picture adds hardly anything, and the twin is as
///   good a surface.
/// - `depth_tilt_difference_rad` sees a turn about the line of sight as about its angle, and other turns and the twin
///   hardly or not at all.
/// - `norm_median` is near 1, and `norm_min` and `norm_max` are near it, when most of the inliers obey the model.
/// - `largest_p` above 0.05 says that a coefficient of C could as well be zero.
///
/// What is not known is NaN.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_check_result {
    /// The correlation of each channel with the relit channel, over the inliers; 0 where one of them is constant.
    pub correlation: [f64; 3],
    /// The median length of the recovered normals before they are set to 1.
    pub norm_median: f64,
    /// The smallest length of these normals.
    pub norm_min: f64,
    /// The largest length of these normals.
    pub norm_max: f64,
    /// Pentland's tilts of the input; NaN where there are none.
    pub tilts: ofc_tilts,
    /// Pentland's tilts of the relit picture; NaN where there are none.
    pub relit_tilts: ofc_tilts,
    /// Tilts of the relit picture minus tilts of the input, in radians, in (-pi, pi]; NaN where one picture has none.
    pub tilt_difference_rad: [f64; 3],
    /// Tilts of the rows of F minus tilts of the input, in radians, in (-pi, pi]; NaN where the input has none.
    pub tilt_residual_rad: [f64; 3],
    /// The median angle in radians between the normals of the integrated surface and the normals of the colors; NaN
    /// without a surface.
    pub depth_angle_median_rad: f64,
    /// Pentland's tilts of the integrated surface shaded with F; NaN where there are none.
    pub depth_tilts: ofc_tilts,
    /// Tilts of the shaded surface minus tilts of the input, in radians, in (-pi, pi]; NaN where one picture has none.
    pub depth_tilt_difference_rad: [f64; 3],
    /// The largest p value of the six coefficients of C.
    pub largest_p: f64,
    /// The root mean square angle over all directions, in radians, between the normals of F and the normals that agree
    /// best with integrability and outward normals; NaN where the picture does not determine it. Of a solution with
    /// OFC_CONVEXITY_HOLLOW it shows the twin.
    pub turn_rad: f64,
    /// The angle in radians to expect of a right F, as far as the picture tells; NaN where it does not.
    pub turn_expected_rad: f64,
    /// How clear the choice between a surface and its convex/concave twin is, from 0 to 1; NaN where nothing tells.
    pub convexity: f64,
    /// How many pixels were compared.
    pub inlier_count: i32,
    /// 1 when both pictures have tilts, 0 otherwise.
    pub has_tilts: i32,
    /// How many inliers the integrated surface covers; zero without a surface.
    pub depth_pixel_count: i32,
    /// 1 when the shaded surface and the input have tilts, 0 otherwise.
    pub has_depth_tilts: i32,
    /// 1 when the picture determines `turn_rad`, 0 when it is too small or its surface too scattered.
    pub has_turn: i32,
    /// Zero.
    pub reserved: u32,
}

/// Effective ranks of colors and normals, and the singular values behind them. F is determined where both ranks are 3.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_rank {
    /// Root mean square of the colors along their principal axes, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// The noise that `color_deviations` are compared with, in pixel values; DBL_MAX where a given fit makes it larger.
    pub color_noise: f64,
    /// Root mean square of the normals along their principal axes, descending; zero in directions that are not seen.
    pub normal_deviations: [f64; 3],
    /// The noise that `normal_deviations` are compared with.
    pub normal_noise: f64,
    /// The rank of the colors, 1 to 3; 0 where there are no pixels.
    pub colors: i32,
    /// The rank of the normals, 1 to 3; 0 where the colors do not determine it, as under one light or in a gray
    /// picture.
    pub normals: i32,
}

plain!(ofc_check_result, ofc_rank);

to_c!(Rank => ofc_rank { color_deviations, color_noise, normal_deviations, normal_noise, colors, normals });

impl ToC<ofc_check_result> for Check {
    fn to_c(&self) -> ofc_check_result {
        let Self {
            inliers,
            correlations,
            norms: Norms { median, min, max },
            tilts,
            relit_tilts,
            tilt_differences,
            tilt_residuals,
            turn,
            depth,
            largest_p,
        } = self;
        let depth = depth.unwrap_or_default();
        let nothing = Turn { angle: f64::NAN, expected: f64::NAN, convexity: f64::NAN };
        let Turn { angle, expected, convexity } = turn.unwrap_or(nothing);
        let unknown = Tilts { tilts: [f64::NAN; 3], gradients: [[f64::NAN; 2]; 3] };
        let known = |tilts: Option<Tilts>| tilts.unwrap_or(unknown).to_c();
        let angles = |angles: Option<[f64; 3]>| angles.unwrap_or([f64::NAN; 3]);
        ofc_check_result {
            correlation: *correlations,
            norm_median: *median,
            norm_min: *min,
            norm_max: *max,
            tilts: known(*tilts),
            relit_tilts: known(*relit_tilts),
            tilt_difference_rad: angles(*tilt_differences),
            tilt_residual_rad: angles(*tilt_residuals),
            depth_angle_median_rad: depth.median_angle.unwrap_or(f64::NAN),
            depth_tilts: known(depth.tilts),
            depth_tilt_difference_rad: angles(depth.tilt_differences),
            largest_p: *largest_p,
            turn_rad: angle,
            turn_expected_rad: expected,
            convexity,
            inlier_count: inliers.to_c(),
            has_tilts: (tilts.is_some() && relit_tilts.is_some()).to_c(),
            depth_pixel_count: depth.pixels.to_c(),
            has_depth_tilts: depth.tilt_differences.is_some().to_c(),
            has_turn: turn.is_some().to_c(),
            reserved: 0,
        }
    }
}

/// Says how many bytes of workspace ofc_check() needs: 8 for each pixel.
/// @param width,height  Size of the picture.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub extern "C" fn ofc_check_workspace_size(width: i32, height: i32) -> usize {
    bytes(Need::of_singles(check::workspace_len(pixel_count(width, height))))
}

/// Checks a solution against its own picture. The documentation of ofc_check_result says how to read the result.
/// @param image  The picture that was solved, or another frame under the same lights.
/// @param solution  What ofc_solve() wrote with OFC_STATUS_OK.
/// @param depth  The surface that ofc_depth_integrate() made of the normals, as large as the picture; may be NULL.
///     There is no surface where its depth is not finite.
/// @param workspace  ofc_check_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param result  Output: the checks.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_TOO_FEW_PIXELS when there are no inliers; an argument
///     status, OFC_STATUS_INVALID_PARAMETER for a surface of another size.
///
/// Stack: below 32 KiB. Reference: sections 4-6.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_check(
    image: *const ofc_image,
    solution: *const ofc_solution,
    depth: *const ofc_depth_map,
    workspace: *mut c_void,
    workspace_bytes: usize,
    result: *mut ofc_check_result,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let solution = call.input(solution)?;
        let surface = unless_null(depth, || call.surface(depth))?;
        let need = check::workspace_len(picture.width() * picture.height());
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let result = call.output(result)?;
        let orientation = solved(&solution)?;
        let test = Inliers::from_c(solution.inlier_test)?;
        let coefficients = solution.fit.coefficients.map(Estimate::from);
        let found = check::check(&picture, &test, &orientation, &coefficients, surface.as_ref(), workspace)?;
        *result = found.to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Computes the effective ranks of a picture's colors and normals.
/// @param image  The picture.
/// @param inlier_test  Which pixels to use; NULL for every usable pixel.
/// @param fit  The regression over these pixels, from ofc_lmeds_fit(); NULL where there is none.
/// @param rank  Output: the ranks.
/// @return OFC_STATUS_OK; OFC_STATUS_TOO_FEW_PIXELS when there is no inlier; an argument status.
///
/// Reference: sections 2 and 6; A. P. Petrov, L. L. Kontsevich, JOSA A 11, 1994.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rank_compute(
    image: *const ofc_image,
    inlier_test: *const ofc_inlier_test,
    fit: *const ofc_color_fit,
    rank: *mut ofc_rank,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let test = call.inlier_test(inlier_test, &picture)?;
        let fit = unless_null(fit, || call.input(fit))?;
        let fit = fit.map(|fit| (fit.coefficients.map(|c| c.value), fit.residual_deviation));
        let rank = call.output(rank)?;
        let finite = fit.is_none_or(|(z, deviation)| z.iter().all(|c| c.is_finite()) && deviation >= 0.0);
        ensure(finite, OFC_STATUS_INVALID_PARAMETER)?;
        let mut found = rank::rank(&picture, test.selector(), fit).ok_or(OFC_STATUS_TOO_FEW_PIXELS)?;
        // Any number may be given for the deviation of the residuals.
        found.color_noise = found.color_noise.min(f64::MAX);
        *rank = found.to_c();
        Ok(OFC_STATUS_OK)
    })
}
