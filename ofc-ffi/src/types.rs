//! The structs that results consist of, and what the regression takes.

use crate::pointers::plain;
use crate::status::{OFC_STATUS_INVALID_PARAMETER, Refusal, ensure};
use crate::twin::{FromC, ToC, constants, from_c, to_c};
use ofc_core::color::ellipsoid::Ellipsoid;
use ofc_core::color::inliers::{Band, Inliers};
use ofc_core::color::lmeds::{Fit, Method, Params};
use ofc_core::color::location::Location;
use ofc_core::color::regression::Estimate;
use ofc_core::light::tilt::Tilts;
use ofc_core::orientation::integrability::Integrability;
use ofc_core::orientation::matrix::Orientation;
use ofc_core::picture::{Face, Faces, PixelCounts, Usable};

plain!(
    ofc_lmeds_params,
    ofc_pixel_counts,
    ofc_estimate,
    ofc_inlier_test,
    ofc_shadow_plane,
    ofc_color_fit,
    ofc_location,
    ofc_ellipsoid,
    ofc_tilts,
    ofc_slants,
    ofc_orientation,
    ofc_integrability,
);

/// How C is fitted: one of OFC_FIT_*.
pub type ofc_fit_method = i32;
/// Least median of squares, the paper's.
pub const OFC_FIT_LEAST_MEDIAN: i32 = 0;
/// Least squares over every usable pixel, none rejected: Woodham, Iwahori and Barman's, for pictures without outliers.
pub const OFC_FIT_LEAST_SQUARES: i32 = 1;

constants!(Method = { LeastMedian: OFC_FIT_LEAST_MEDIAN, LeastSquares: OFC_FIT_LEAST_SQUARES });

/// How the regression in color space searches and what it rejects. Set by ofc_lmeds_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_lmeds_params {
    /// Probability that at least one subset is free of outliers, in (0, 1). Default 0.9999.
    pub confidence: f64,
    /// Share of outliers for which that holds, in [0, 1). Default 0.5.
    pub outlier_ratio: f64,
    /// Residuals above this many robust dispersions are outliers, > 0. Default 2.5.
    pub rejection: f64,
    /// Confidence of the limits given with each coefficient, in (0, 1). Default 0.95.
    pub limits_confidence: f64,
    /// A pixel is saturated, and left out, if a channel is at or above this, > 0; 0 stands for the largest value of the
    /// pixel type, and for no limit with floats. Default 0.
    pub saturation: f64,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
    /// At least this many subsets are drawn, up to 10,000,000. Default 500.
    pub min_subsets: u32,
    /// Exactly this many subsets, up to 10,000,000; 0 for as many as confidence and outlier_ratio ask for. Default 0.
    pub subsets: u32,
    /// Pixels that the search looks at, at least 12; the result is evaluated on all. Default 10,000.
    pub sample_size: u32,
    /// OFC_FIT_LEAST_MEDIAN or OFC_FIT_LEAST_SQUARES. Default OFC_FIT_LEAST_MEDIAN.
    pub method: ofc_fit_method,
    /// Must be zero.
    pub reserved: [u32; 4],
}

to_c!(Params => ofc_lmeds_params {
    confidence, rejection, limits_confidence, seed, min_subsets, subsets, sample_size, method; outlier_ratio: outlier_share
} zero { saturation, reserved });
from_c!(Params <= ofc_lmeds_params {
    confidence, rejection, limits_confidence, seed, min_subsets, subsets, sample_size, method; outlier_ratio: outlier_share
} without { saturation } zero { reserved });

/// The regression's parameters and the saturation level, if one is set.
impl FromC<ofc_lmeds_params> for (Params, Option<f32>) {
    fn from_c(value: ofc_lmeds_params) -> Result<Self, Refusal> {
        let params = Params::from_c(value)?;
        ensure(params.subset_count().is_some(), OFC_STATUS_INVALID_PARAMETER)?;
        Ok((params, saturation(value.saturation)?))
    }
}

/// A saturation level, 0 where none is set.
pub(crate) fn saturation(level: f64) -> Result<Option<f32>, Refusal> {
    ensure(level >= 0.0, OFC_STATUS_INVALID_PARAMETER)?;
    Ok((level > 0.0).then_some(level as f32))
}

/// What becomes of the pixels before any fit; the counts add up to width times height.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_pixel_counts {
    /// Pixels that the fit may use.
    pub usable: i32,
    /// Left out by the mask.
    pub masked_out: i32,
    /// Zero (or negative) in all channels.
    pub dark: i32,
    /// At or above the saturation level in a channel.
    pub saturated: i32,
    /// NaN or infinite in a channel.
    pub non_finite: i32,
    /// In the shadow of one of the lights.
    pub shadowed: i32,
    /// Largest absolute channel value of the usable pixels.
    pub largest: f32,
    /// Zero.
    pub reserved: u32,
}

to_c!(PixelCounts => ofc_pixel_counts {
    usable, masked_out, dark, saturated, non_finite, largest; shadowed: shaded
} zero { reserved });

/// A regression coefficient with what the regression knows of it.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_estimate {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Value over standard error.
    pub t: f64,
    /// Two-sided p value of t: how likely so large a t is if the true value is 0.
    pub p: f64,
    /// Lower confidence limit.
    pub low: f64,
    /// Upper confidence limit.
    pub high: f64,
}

to_c!(Estimate => ofc_estimate { value, standard_error, t, p, low, high });

impl From<ofc_estimate> for Estimate {
    fn from(estimate: ofc_estimate) -> Self {
        let ofc_estimate { value, standard_error, t, p, low, high } = estimate;
        Self { value, standard_error, t, p, low, high }
    }
}

/// A face of the cone of colors that three lights make: where one of them is shaded, colors lie in a plane through black.
/// Those near it, or beyond, with normal . rho below `least`, are no inliers.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_shadow_plane {
    /// Of unit length, inward.
    pub normal: [f32; 3],
    /// In pixel values.
    pub threshold: f32,
}

to_c!(Face => ofc_shadow_plane { normal; threshold: least });

impl From<ofc_shadow_plane> for Face {
    fn from(face: ofc_shadow_plane) -> Self {
        let ofc_shadow_plane { normal, threshold } = face;
        Self { normal, least: threshold }
    }
}

/// The pixels that obey the model, as a test of a pixel's color rho alone: finite, not black, below the saturation
/// level, and rho^T C rho within both bands. It can be applied to another frame under the same lights.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_inlier_test {
    /// Channels at or above this are saturated.
    pub saturation: f64,
    /// C of the first rejection, by residual: c11, c22, c33, c12, c13, c23.
    pub residual_form: [f64; 6],
    /// Smallest accepted rho^T C rho.
    pub residual_low: f64,
    /// Largest accepted rho^T C rho.
    pub residual_high: f64,
    /// C of the second rejection, by the length of the normal.
    pub norm_form: [f64; 6],
    /// Smallest accepted rho^T C rho.
    pub norm_low: f64,
    /// Largest accepted rho^T C rho.
    pub norm_high: f64,
    /// Up to three faces of the cone of colors; those that are not there are zero.
    pub shadow_planes: [ofc_shadow_plane; 3],
}

impl ToC<ofc_inlier_test> for Inliers {
    fn to_c(&self) -> ofc_inlier_test {
        let Self { usable: Usable { saturation, shadow_faces: Faces { faces } }, residual, norm } = self;
        ofc_inlier_test {
            saturation: f64::from(*saturation),
            residual_form: residual.form,
            residual_low: residual.low,
            residual_high: residual.high,
            norm_form: norm.form,
            norm_low: norm.low,
            norm_high: norm.high,
            shadow_planes: faces.to_c(),
        }
    }
}

/// Any numbers are a valid test: comparisons with NaN hold for no pixel.
impl FromC<ofc_inlier_test> for Inliers {
    fn from_c(value: ofc_inlier_test) -> Result<Self, Refusal> {
        let faces = Faces { faces: value.shadow_planes.map(Face::from) };
        Ok(Self {
            usable: Usable { saturation: value.saturation as f32, shadow_faces: faces },
            residual: Band { form: value.residual_form, low: value.residual_low, high: value.residual_high },
            norm: Band { form: value.norm_form, low: value.norm_low, high: value.norm_high },
        })
    }
}

/// The color-space quadratic form rho^T C rho = 1 (eqs. 9-12). Coefficients are in the order c11, c22, c33, c12, c13,
/// c23 and in (pixel value)^-2.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_color_fit {
    /// The C that minimizes the median squared residual.
    pub robust: [f64; 6],
    /// Square root of that median, over all usable pixels.
    pub median_residual: f64,
    /// Robust dispersion s0 of eq. 12.
    pub dispersion: f64,
    /// Robust coefficient of determination, 1 - median_residual^2.
    pub r_squared: f64,
    /// The reweighted fit: least squares over the inliers.
    pub coefficients: [ofc_estimate; 6],
    /// What squares and products of the errors of these coefficients are expected to be, the upper triangle row by row:
    /// the covariance of least squares, the square of the bias that noise makes, and that of the difference from `robust`.
    pub covariance: [f64; 21],
    /// Standard deviation of the inliers' residuals under the reweighted fit.
    pub residual_deviation: f64,
    /// Root mean square of the inliers' colors along their principal axes, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// Noise in each channel that explains the inliers' residuals, as a standard deviation in pixel values.
    pub noise_deviation: f64,
    /// The same from the median of the residuals, with regard to what the rejection cuts off: what to expect of single
    /// pixels. In a stream without the feature `full-streams` only what rounding makes.
    pub pixel_noise: f64,
    /// Noise in each channel with which colors that do not determine C could look like these. solve refuses where it
    /// is below 1.15 times noise_deviation; C is biased by about the inverse square of that ratio.
    pub degenerate_noise_deviation: f64,
    /// Pixels within residual_form's band.
    pub inlier_count: i32,
    /// Subsets drawn.
    pub subsets: u32,
}

to_c!(Fit => ofc_color_fit {
    robust, median_residual, dispersion, r_squared, coefficients, covariance, residual_deviation, color_deviations,
    noise_deviation, pixel_noise, degenerate_noise_deviation, subsets; inlier_count: inliers
} without { band, usable });

/// Where most of a set of numbers lies: the one-dimensional least median of squares.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_location {
    /// Midpoint of the shortest interval that holds half of the numbers.
    pub location: f64,
    /// Half the length of that interval: the median distance from location.
    pub median_distance: f64,
    /// Robust dispersion: 1.4826 (1 + 5 / (n - 1)) median_distance.
    pub dispersion: f64,
}

to_c!(Location => ofc_location { location, median_distance, dispersion });

/// What C says of the color-orientation matrix F before its orthogonal transformation is known (eq. 18). Matrices are
/// row-major.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_ellipsoid {
    /// C, in (pixel value)^-2.
    pub c: [f64; 9],
    /// Eigenvalues of C, descending: the squared inverse semi-axes of the ellipsoid.
    pub eigenvalues: [f64; 3],
    /// The root G0 = sqrt(Lambda) U^T of C = G0^T G0; G0 rho is the normal up to an orthogonal transformation.
    pub root: [f64; 9],
    /// F F^T = C^-1, in (pixel value)^2.
    pub f_f_transposed: [f64; 9],
    /// Lengths of the rows f1, f2, f3 of F, in pixel values.
    pub norms: [f64; 3],
    /// Cosines (h12, h13, h23) of the angles between the rows of F.
    pub cosines: [f64; 3],
}

to_c!(Ellipsoid => ofc_ellipsoid { c, eigenvalues, root, f_f_transposed, norms, cosines });

/// Tilts of the three channels' equivalent lights.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_tilts {
    /// Counter-clockwise from x in (-pi, pi], for a convex surface.
    pub tilt_rad: [f64; 3],
    /// Mean gradient (Ix, Iy) of each channel over the inliers, pixel values a pixel, y up: r, g, b; zero where the
    /// estimator has none.
    pub mean_gradient: [f64; 6],
}

to_c!(Tilts => ofc_tilts { ; tilt_rad: tilts, mean_gradient: gradients });

/// Slants of the three channels' equivalent lights that are consistent with their tilts and angles.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_slants {
    /// From +z, in [0, pi/2].
    pub slant_rad: [f64; 3],
    /// Largest residual of eqs. 24.
    pub residual: f64,
    /// Mean of the integral (15) over cells of inliers, per pixel^2; infinite where F is rank-deficient, 0 where no
    /// picture is involved.
    pub integral: f64,
    /// The branch of eqs. 25, 1 to 8: the signs of their square roots, 1 for (+,+,+) and 8 for (-,-,-); 0 for least
    /// squares.
    pub branch: i32,
    /// Zero.
    pub reserved: u32,
}

/// The color-orientation matrix F, rho = F n, row-major.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_orientation {
    /// Row i is f_i: strength and direction of the one light that channel i could have been lit by, in pixel values.
    pub f: [f64; 9],
    /// The inverse, n = f_inverse rho, over the singular values above the threshold.
    pub f_inverse: [f64; 9],
    /// Singular values of F, descending.
    pub singular_values: [f64; 3],
    /// How many of them are above the threshold: 3 where F can be inverted.
    pub rank: i32,
    /// Zero.
    pub reserved: u32,
}

to_c!(Orientation => ofc_orientation { f, f_inverse, singular_values, rank } zero { reserved });
from_c!(Orientation <= ofc_orientation { f, f_inverse, singular_values, rank } without { reserved });

/// The integral (15) of normals, as a mean over cells of four inliers.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_integrability {
    /// Mean of (dp/dy - dq/dx)^2, per pixel^2.
    pub mean: f64,
    /// How many cells.
    pub cells: i32,
    /// Zero.
    pub reserved: u32,
}

to_c!(Integrability => ofc_integrability { mean, cells } zero { reserved });
