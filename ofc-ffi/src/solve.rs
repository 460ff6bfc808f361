//! The whole pipeline.

use crate::prelude::*;
use crate::reason::ofc_reason;
use ofc_core::light::tilt::TiltEstimator;
use ofc_core::orientation::joint::{Evidence, Joint};
use ofc_core::solve::{
    self, Candidate, Choice, Convexity, Finding, NormSource, OrientationMethod, Params, ShadowRejection,
    SlantFallback, SlantSource, Solution,
};

/// Where slants come from: one of OFC_SLANTS_*.
pub type ofc_slant_source = i32;
/// There are no slants.
pub const OFC_SLANTS_NONE: i32 = 0;
/// The slants are a root of eqs. 25, chosen by the integral (15).
pub const OFC_SLANTS_ROOT: i32 = 1;
/// Eqs. 25 have no root: the slants satisfy eqs. 24 best in least squares.
pub const OFC_SLANTS_LEAST_SQUARES: i32 = 2;
/// Eqs. 25 have no root: the slants make the integral (15) smallest.
pub const OFC_SLANTS_TILT_INTEGRABILITY: i32 = 3;
/// Eqs. 25 have no root: the slants are Pentland's, eq. 22.
pub const OFC_SLANTS_PENTLAND: i32 = 4;
/// Eqs. 25 have no root: the slants are Lee and Rosenfeld's, eq. 23.
pub const OFC_SLANTS_LEE_ROSENFELD: i32 = 5;
/// Eqs. 25 have no root: the slants are Zheng and Chellappa's.
pub const OFC_SLANTS_ZHENG_CHELLAPPA: i32 = 6;

/// The joint method found F as a whole, and the slants follow from F.
pub const OFC_SLANTS_JOINT: i32 = 7;

/// How the orthogonal transformation that C leaves open is found: one of OFC_ORIENTATION_*.
pub type ofc_orientation_method = i32;
/// The joint method: integrability on windows of several sizes, and normals that point outward, each weighed by its
/// uncertainty in this picture.
pub const OFC_ORIENTATION_JOINT: i32 = 0;
/// The direct method of the paper: slants from tilts (section 3). It is good on closed convex shapes, and poor on
/// relief that touches the frame.
pub const OFC_ORIENTATION_DIRECT: i32 = 1;

/// Whether colors that one of the lights does not reach are found and left out before the fit: one of
/// OFC_SHADOW_REJECTION_*. The paper has no such step.
pub type ofc_shadow_rejection = i32;
/// On with the joint method, off with the direct method and with given tilts.
pub const OFC_SHADOW_REJECTION_AUTO: i32 = 0;
/// On with every method.
pub const OFC_SHADOW_REJECTION_ON: i32 = 1;
/// Off with every method.
pub const OFC_SHADOW_REJECTION_OFF: i32 = 2;

/// What decided the orientation: one of OFC_EVIDENCE_*.
pub type ofc_evidence = i32;
/// Tilts, by the direct method; how sure they are is not known.
pub const OFC_EVIDENCE_TILTS_ALONE: i32 = 0;
/// Mostly that normals point outward, which tilts rest on too.
pub const OFC_EVIDENCE_OUTWARD: i32 = 1;
/// Mostly integrability.
pub const OFC_EVIDENCE_INTEGRABILITY: i32 = 2;
/// Integrability and outward normals.
pub const OFC_EVIDENCE_BOTH: i32 = 3;

/// What to do where eqs. 25 have no root: one of OFC_FALLBACK_*.
pub type ofc_slant_fallback = i32;
/// Return OFC_STATUS_NO_CONSISTENT_SLANTS.
pub const OFC_FALLBACK_REFUSE: i32 = 0;
/// Take the slants that satisfy eqs. 24 best.
pub const OFC_FALLBACK_LEAST_SQUARES: i32 = 1;
/// Take the slants that minimize the integral (15) among those that eqs. 24 allow.
pub const OFC_FALLBACK_TILT_INTEGRABILITY: i32 = 2;
/// Take Pentland's slants, eq. 22.
pub const OFC_FALLBACK_PENTLAND: i32 = 3;
/// Take Lee and Rosenfeld's slants, eq. 23.
pub const OFC_FALLBACK_LEE_ROSENFELD: i32 = 4;
/// Take Zheng and Chellappa's slants.
pub const OFC_FALLBACK_ZHENG_CHELLAPPA: i32 = 5;

/// Where the lengths of the rows of F, the strengths of the channels' lights, come from: one of OFC_NORMS_*.
pub type ofc_norm_source = i32;
/// They come from C, eq. 18.
pub const OFC_NORMS_FIT: i32 = 0;
/// They are the largest values of the channels over the inliers, as ofc_channel_maxima() finds them. The slants do not
/// change with it; the lengths of the normals do (section 4).
pub const OFC_NORMS_CHANNEL_MAXIMA: i32 = 1;

/// Whether the surface is convex or hollow: one of OFC_CONVEXITY_*. A surface and its twin, whose depth has the other
/// sign, have the same colors under lights that are turned half about the line of sight, so only the outline of an
/// object that closes within the picture tells them apart.
pub type ofc_convexity = i32;
/// Whichever of the two is more of a dome; `confidence.convexity` says how clear that is.
pub const OFC_CONVEXITY_AUTO: i32 = 0;
/// The same as OFC_CONVEXITY_AUTO, by the caller's word.
pub const OFC_CONVEXITY_CONVEX: i32 = 1;
/// The twin of that: an engraving, a mold, a pit.
pub const OFC_CONVEXITY_HOLLOW: i32 = 2;

/// What ofc_solve() does. Set by ofc_solve_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_solve_params {
    /// The regression in color space, with the seed and the saturation level.
    pub lmeds: ofc_lmeds_params,
    /// Singular values of F below this ratio to the largest are zero, in [0, 1). Default 1e-3.
    pub rank_threshold: f64,
    /// The tilts of the rows of F in radians, for OFC_TILT_GIVEN; ignored with other estimators. Default 0.
    pub tilt_rad: [f64; 3],
    /// Where tilts come from, one of OFC_TILT_*. Default OFC_TILT_PENTLAND.
    pub tilt_estimator: ofc_tilt_estimator,
    /// What to do where eqs. 25 have no root, one of OFC_FALLBACK_*. Default OFC_FALLBACK_LEAST_SQUARES.
    pub slant_fallback: ofc_slant_fallback,
    /// How F is oriented, one of OFC_ORIENTATION_*. Given tilts, and pictures that are too small for the joint method,
    /// take the direct method whatever this is. `tilt_estimator` and `slant_fallback` are for the direct method alone.
    /// Default OFC_ORIENTATION_JOINT.
    pub orientation_method: ofc_orientation_method,
    /// Whether colors that one of the lights does not reach are left out, one of OFC_SHADOW_REJECTION_*. Default
    /// OFC_SHADOW_REJECTION_AUTO.
    pub shadow_rejection: ofc_shadow_rejection,
    /// Where the lengths of the rows of F come from with the direct method, one of OFC_NORMS_*; streams take
    /// OFC_NORMS_FIT alone. Default OFC_NORMS_FIT.
    pub norm_source: ofc_norm_source,
    /// Whether the surface is convex or hollow, one of OFC_CONVEXITY_*. Tilts that are given choose by themselves
    /// whatever this is; streams take OFC_CONVEXITY_AUTO alone. Default OFC_CONVEXITY_AUTO.
    pub convexity: ofc_convexity,
    /// Must be zero.
    pub reserved: [u32; 2],
}

/// How sure the orientation of F is. Errors of C, which turn and bend normals as well, are not part of it. All numbers
/// are NaN, which says that they are not known, with the direct method, for a picture that is too small for the joint
/// method, and without F.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_confidence {
    /// Covariance of the small rotation vector by which all normals may be turned, in the frame of the normals and in
    /// radians^2.
    pub covariance: [f64; 9],
    /// The expected root mean square angle by which a normal is turned, in radians.
    pub error_rad: f64,
    /// How clearly the normals are those of a convex surface, from 0 (as much convex as concave) to 1 (all of it is
    /// convex); negative with OFC_CONVEXITY_HOLLOW.
    pub convexity: f64,
    /// The log likelihood of the orientation minus that of the best other one that is not near it; infinite where there
    /// is no other.
    pub log_likelihood_margin: f64,
    /// What decided, one of OFC_EVIDENCE_*.
    pub evidence: ofc_evidence,
    /// Zero.
    pub reserved: u32,
}

/// What ofc_solve() found. On a positive status the fields of stages that were not reached are zero, but for
/// `confidence`, which then is NaN.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_solution {
    /// The status that ofc_solve() returned with this solution.
    pub outcome: ofc_status,
    /// Where the slants come from, one of OFC_SLANTS_*.
    pub slant_source: ofc_slant_source,
    /// How many candidates there are.
    pub candidate_count: i32,
    /// The index of the candidate that was chosen; -1 for none.
    pub chosen: i32,
    /// How many pixels pass `inlier_test`.
    pub inlier_count: i32,
    /// Bit i, 1 << i, is set where `slant_rad[i]` is above pi/2: the light that channel i is equivalent to shines from
    /// behind the surface, and reaches only parts that are turned toward it and away from the camera. Zero with the
    /// direct method, as in the paper. With the joint method such a light is rare in a picture and common in a wrong
    /// answer.
    pub lights_from_behind: u32,
    /// What a refusal or a doubt comes from, one of OFC_REASON_*; OFC_REASON_NONE where there is nothing to doubt.
    pub reason: ofc_reason,
    /// The channel that `reason` is about, 0 to 2; -1 for none.
    pub reason_channel: i32,
    /// What was measured, as the documentation of `reason` says.
    pub reason_value: f64,
    /// What it was compared with.
    pub reason_limit: f64,
    /// What became of the pixels before the fit.
    pub pixel_counts: ofc_pixel_counts,
    /// The regression: C with its errors, its dispersion, and the first rejection.
    pub fit: ofc_color_fit,
    /// Effective ranks of the inliers' colors and normals; F is determined where both are 3.
    pub rank: ofc_rank,
    /// The location of the normals' lengths, for the second rejection.
    pub norm_location: ofc_location,
    /// The test for inliers after both rejections.
    pub inlier_test: ofc_inlier_test,
    /// C, its root, and the norms and cosines of the rows of F.
    pub ellipsoid: ofc_ellipsoid,
    /// The tilts of the rows of F.
    pub tilts: ofc_tilts,
    /// The slants of the rows of F in radians: in [0, pi/2] with the direct method, in [0, pi] with the joint method.
    pub slant_rad: [f64; 3],
    /// How sure the orientation is.
    pub confidence: ofc_confidence,
    /// With the direct method, all slants that are consistent with the tilts, by ascending first slant.
    pub candidates: [ofc_slants; OFC_MAX_CANDIDATES],
    /// F and its inverse.
    pub orientation: ofc_orientation,
}

plain!(ofc_solve_params, ofc_confidence, ofc_solution);

constants!(SlantSource = {
    Root: OFC_SLANTS_ROOT,
    LeastSquares: OFC_SLANTS_LEAST_SQUARES,
    TiltIntegrability: OFC_SLANTS_TILT_INTEGRABILITY,
    Pentland: OFC_SLANTS_PENTLAND,
    LeeRosenfeld: OFC_SLANTS_LEE_ROSENFELD,
    ZhengChellappa: OFC_SLANTS_ZHENG_CHELLAPPA,
    Joint: OFC_SLANTS_JOINT,
});
constants!(OrientationMethod = { Joint: OFC_ORIENTATION_JOINT, Direct: OFC_ORIENTATION_DIRECT });
constants!(ShadowRejection = {
    Auto: OFC_SHADOW_REJECTION_AUTO,
    On: OFC_SHADOW_REJECTION_ON,
    Off: OFC_SHADOW_REJECTION_OFF,
});
constants!(Evidence = {
    Outward: OFC_EVIDENCE_OUTWARD,
    Integrability: OFC_EVIDENCE_INTEGRABILITY,
    Both: OFC_EVIDENCE_BOTH,
});
constants!(NormSource = { Fit: OFC_NORMS_FIT, ChannelMaxima: OFC_NORMS_CHANNEL_MAXIMA });
constants!(Convexity = {
    Auto: OFC_CONVEXITY_AUTO,
    Convex: OFC_CONVEXITY_CONVEX,
    Hollow: OFC_CONVEXITY_HOLLOW,
});
constants!(SlantFallback = {
    Refuse: OFC_FALLBACK_REFUSE,
    LeastSquares: OFC_FALLBACK_LEAST_SQUARES,
    TiltIntegrability: OFC_FALLBACK_TILT_INTEGRABILITY,
    PentlandSlant: OFC_FALLBACK_PENTLAND,
    LeeRosenfeldSlant: OFC_FALLBACK_LEE_ROSENFELD,
    ZhengChellappaSlant: OFC_FALLBACK_ZHENG_CHELLAPPA,
});

/// The defaults, in which no tilts are given and no saturation level is set.
impl ToC<ofc_solve_params> for Params {
    fn to_c(&self) -> ofc_solve_params {
        ofc_solve_params {
            lmeds: self.lmeds.to_c(),
            rank_threshold: self.rank_threshold,
            tilt_rad: [0.0; 3],
            tilt_estimator: OFC_TILT_PENTLAND,
            slant_fallback: self.fallback.to_c(),
            orientation_method: self.orientation_method.to_c(),
            shadow_rejection: self.shadow_rejection.to_c(),
            norm_source: self.norms.to_c(),
            convexity: self.convexity.to_c(),
            reserved: [0; 2],
        }
    }
}

impl FromC<ofc_solve_params> for Params {
    fn from_c(value: ofc_solve_params) -> Result<Self, Refusal> {
        ensure(value.reserved == [0; 2], OFC_STATUS_RESERVED_NOT_ZERO)?;
        let (lmeds, saturation) = FromC::from_c(value.lmeds)?;
        let params = Self {
            lmeds,
            saturation,
            shadow_rejection: FromC::from_c(value.shadow_rejection)?,
            orientation_method: FromC::from_c(value.orientation_method)?,
            tilts: match value.tilt_estimator {
                OFC_TILT_PENTLAND => TiltEstimator::Pentland,
                OFC_TILT_LEE_ROSENFELD => TiltEstimator::LeeRosenfeld,
                OFC_TILT_ZHENG_CHELLAPPA => TiltEstimator::ZhengChellappa,
                OFC_TILT_CHOJNACKI => TiltEstimator::Chojnacki,
                OFC_TILT_GIVEN => TiltEstimator::Given(value.tilt_rad),
                _ => return Err(Refusal(OFC_STATUS_INVALID_PARAMETER)),
            },
            rank_threshold: value.rank_threshold,
            fallback: FromC::from_c(value.slant_fallback)?,
            norms: FromC::from_c(value.norm_source)?,
            convexity: FromC::from_c(value.convexity)?,
        };
        ensure(params.are_valid(), OFC_STATUS_INVALID_PARAMETER)?;
        Ok(params)
    }
}

/// Nothing is known.
impl Default for ofc_confidence {
    fn default() -> Self {
        Self {
            covariance: [f64::NAN; 9],
            error_rad: f64::NAN,
            convexity: f64::NAN,
            log_likelihood_margin: f64::NAN,
            evidence: OFC_EVIDENCE_TILTS_ALONE,
            reserved: 0,
        }
    }
}

impl ToC<ofc_confidence> for Joint {
    fn to_c(&self) -> ofc_confidence {
        let Self { rows: _, covariance, evidence, convexity, second_best } = self;
        ofc_confidence {
            covariance: covariance.to_c(),
            error_rad: self.expected_error(),
            convexity: *convexity,
            log_likelihood_margin: *second_best,
            evidence: evidence.to_c(),
            reserved: 0,
        }
    }
}

to_c!(Candidate => ofc_slants { residual, integral, branch; slant_rad: slants } zero { reserved });

impl ofc_solution {
    /// Sets every field, one after the other: together they would lie on the stack twice.
    #[inline(never)]
    pub(crate) fn set(&mut self, solution: &Solution) {
        let Solution {
            outcome,
            pixel_counts,
            color_deviations,
            rank,
            fit,
            norm_location,
            inliers,
            inlier_count,
            ellipsoid,
            tilts,
            joint,
            choice,
            finding: Finding { reason, channel, value, limit },
        } = solution;
        self.outcome = outcome.to_c();
        self.inlier_count = inlier_count.to_c();
        self.reason = reason.to_c();
        self.reason_channel = channel.as_ref().map_or(-1, ToC::to_c);
        (self.reason_value, self.reason_limit) = (*value, *limit);
        self.pixel_counts = pixel_counts.to_c();
        self.fit = fit.to_c();
        self.fit.color_deviations = fit.as_ref().map_or(*color_deviations, |fit| fit.color_deviations);
        self.rank = rank.to_c();
        self.norm_location = norm_location.to_c();
        self.inlier_test = inliers.to_c();
        self.ellipsoid = ellipsoid.to_c();
        self.tilts = tilts.to_c();
        self.confidence = joint.to_c();
        self.set_choice(choice.as_ref());
    }

    #[inline(never)]
    fn set_choice(&mut self, choice: Option<&Choice>) {
        (self.slant_source, self.candidate_count, self.chosen) = (OFC_SLANTS_NONE, 0, -1);
        (self.slant_rad, self.lights_from_behind) = ([0.0; 3], 0);
        self.candidates = [ofc_slants::default(); OFC_MAX_CANDIDATES];
        self.orientation = ofc_orientation::default();
        let Some(choice) = choice else { return };
        self.slant_rad = choice.slants;
        for (i, is_behind) in choice.lights_from_behind().into_iter().enumerate() {
            self.lights_from_behind |= u32::from(is_behind) << i;
        }
        self.slant_source = choice.source.to_c();
        self.candidate_count = choice.candidates.len().to_c();
        for (slot, candidate) in self.candidates.iter_mut().zip(&choice.candidates) {
            *slot = candidate.to_c();
        }
        if choice.source == SlantSource::Root {
            self.chosen = choice.chosen.to_c();
        }
        self.orientation = choice.orientation.to_c();
    }
}

/// Sets every field to its default.
/// @param params  Output: the parameters.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_solve_params_default(params: *mut ofc_solve_params) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        *call.output(params)? = Params::default().to_c();
        Ok(OFC_STATUS_OK)
    })
}

/// Says how many bytes of workspace ofc_solve() needs: 8 for each pixel, or where that is more, 16 for each of the
/// first `sample_size` pixels. OFC_SOLVE_WORKSPACE_SIZE() is the same number for static buffers.
/// @param width,height  Size of the picture.
/// @param params  The parameters that ofc_solve() will be given.
/// @return The size; 0 when an argument is invalid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_solve_workspace_size(
    width: i32,
    height: i32,
    params: *const ofc_solve_params,
) -> usize {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.size(|call| {
        let params: Params = call.params(params)?;
        let pixels = checked_pixel_count(width, height)?;
        Ok(Need::of_singles(solve::workspace_len(pixels, params.lmeds.sample_size)))
    })
}

/// Finds the color-orientation matrix F of a picture: by regression, rejection of outliers, and orientation.
/// @param image  The picture. Pixels that are masked out, black, saturated or not finite are left out.
/// @param params  The parameters.
/// @param workspace  ofc_solve_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param inlier_mask  Output: width x height bytes without gaps, 255 for an inlier, else 0; may be NULL.
/// @param solution  Output: F in `orientation`, and what every stage found.
/// @return OFC_STATUS_OK; an argument status. OFC_STATUS_RANK_DEFICIENT, OFC_STATUS_UNDETERMINED,
///     OFC_STATUS_NOT_POSITIVE_DEFINITE, OFC_STATUS_NO_TILT or OFC_STATUS_NO_CONSISTENT_SLANTS when there is no F; the
///     solution then holds what was found on the way, and `reason` why. OFC_STATUS_TOO_FEW_PIXELS, OFC_STATUS_DARK or
///     OFC_STATUS_SATURATED when there is nothing to fit: ofc_pixel_counts_compute() says why.
///
/// Stack: below 40 KiB. Reference: section 3.4.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_solve(
    image: *const ofc_image,
    params: *const ofc_solve_params,
    workspace: *mut c_void,
    workspace_bytes: usize,
    inlier_mask: *mut u8,
    solution: *mut ofc_solution,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let picture = call.image(image)?;
        let params: Params = call.params(params)?;
        let pixels = picture.width() * picture.height();
        let need = solve::workspace_len(pixels, params.lmeds.sample_size);
        let workspace = call.floats(workspace, workspace_bytes, need)?;
        let solution = call.output(solution)?;
        let mask = unless_null(inlier_mask, || call.output_slice(inlier_mask, pixels))?;
        let found = solve::solve(&picture, &params, workspace)?;
        if let Some(mask) = mask {
            found.inliers.mark(&picture, mask);
        }
        solution.set(&found);
        Ok(found.outcome.to_c())
    })
}
