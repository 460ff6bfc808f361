//! The structs that results consist of, and what the regression takes.

use crate::prelude::*;
use ofc_core::color::ellipsoid::Ellipsoid;
use ofc_core::color::inliers::{Band, Inliers};
use ofc_core::color::lmeds::{Fit, Method, Params, Weighting};
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
/// Least median of squares, as in the paper.
pub const OFC_FIT_LEAST_MEDIAN: i32 = 0;
/// Least squares over every usable pixel, for pictures without outliers.
pub const OFC_FIT_LEAST_SQUARES: i32 = 1;

constants!(Method = { LeastMedian: OFC_FIT_LEAST_MEDIAN, LeastSquares: OFC_FIT_LEAST_SQUARES });

/// How much each pixel counts in the search of the fit: one of OFC_WEIGHTING_*.
pub type ofc_weighting = i32;
/// All pixels alike; but where one color is the majority, as in the picture of a mostly flat surface, and leaves C open, a pixel
/// counts by how rare its color is, if that determines C clearly. Streams take all pixels alike.
pub const OFC_WEIGHTING_AUTO: i32 = 0;
/// All pixels alike, as in the paper.
pub const OFC_WEIGHTING_PIXELS: i32 = 1;

constants!(Weighting = { Auto: OFC_WEIGHTING_AUTO, Pixels: OFC_WEIGHTING_PIXELS });

/// How the regression in color space searches and what it rejects. Set by ofc_lmeds_params_default().
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_lmeds_params {
    /// Probability that at least one subset holds no outlier, in (0, 1). Default 0.9999.
    pub confidence: f64,
    /// Ratio of outliers for which `confidence` holds, in [0, 1). Default 0.5.
    pub outlier_ratio: f64,
    /// Residuals above this many robust dispersions are outliers; > 0. Default 2.5.
    pub rejection: f64,
    /// Confidence level of each coefficient's limits, in (0, 1). Default 0.95.
    pub limits_confidence: f64,
    /// A pixel with a channel at or above this level is saturated and left out; > 0. Zero stands for the largest value
    /// of the pixel type, and for no limit with floats. Default 0.
    pub saturation: f64,
    /// Determines every random choice. Default 0.
    pub seed: u64,
    /// At least this many subsets are drawn, up to 10,000,000. Default 500.
    pub min_subsets: u32,
    /// Exactly this many subsets are drawn, up to 10,000,000; with 0, as many as `confidence` and `outlier_ratio` ask
    /// for. Default 0.
    pub subsets: u32,
    /// How many pixels the search uses, at least 12; of a larger picture up to three times as many decide where it ends, and
    /// the result is evaluated on all pixels. Default 10,000.
    pub sample_size: u32,
    /// One of OFC_FIT_*. Default OFC_FIT_LEAST_MEDIAN.
    pub method: ofc_fit_method,
    /// One of OFC_WEIGHTING_*. Default OFC_WEIGHTING_AUTO.
    pub weighting: ofc_weighting,
    /// Must be zero.
    pub reserved: [u32; 3],
}

to_c!(Params => ofc_lmeds_params {
    confidence, rejection, limits_confidence, seed, min_subsets, subsets, sample_size, method, weighting; outlier_ratio: outlier_share
} zero { saturation, reserved });
from_c!(Params <= ofc_lmeds_params {
    confidence, rejection, limits_confidence, seed, min_subsets, subsets, sample_size, method, weighting; outlier_ratio: outlier_share
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

/// What became of the pixels before any fit. The counts add up to width times height.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_pixel_counts {
    /// How many pixels the fit may use.
    pub usable: i32,
    /// How many pixels the mask leaves out.
    pub masked_out: i32,
    /// How many pixels are zero or negative in all channels.
    pub dark: i32,
    /// How many pixels are at or above the saturation level in a channel.
    pub saturated: i32,
    /// How many pixels are NaN or infinite in a channel.
    pub non_finite: i32,
    /// How many pixels are in the shadow of one of the lights.
    pub shadowed: i32,
    /// The largest absolute channel value of the usable pixels.
    pub largest: f32,
    /// Zero.
    pub reserved: u32,
}

to_c!(PixelCounts => ofc_pixel_counts {
    usable, masked_out, dark, saturated, non_finite, largest; shadowed: shaded
} zero { reserved });

/// A regression coefficient and what the regression knows of it.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_estimate {
    /// The estimate.
    pub value: f64,
    /// The standard error of the estimate.
    pub standard_error: f64,
    /// The estimate divided by its standard error; infinite where that is 0.
    pub t: f64,
    /// The two-sided p value of t: how likely so large a t is if the true value is 0.
    pub p: f64,
    /// The lower confidence limit.
    pub low: f64,
    /// The upper confidence limit.
    pub high: f64,
}

to_c!(Estimate => ofc_estimate { value, standard_error, t, p, low, high });

impl From<ofc_estimate> for Estimate {
    fn from(estimate: ofc_estimate) -> Self {
        let ofc_estimate { value, standard_error, t, p, low, high } = estimate;
        Self { value, standard_error, t, p, low, high }
    }
}

/// A plane through black that bounds the cone of colors under three lights. Colors lie in it where one of the lights is
/// in shadow. A color rho is rejected where normal . rho is below the threshold.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_shadow_plane {
    /// The unit normal of the plane, toward the colors that all lights reach.
    pub normal: [f32; 3],
    /// The distance from the plane below which colors are rejected, in pixel values.
    pub threshold: f32,
}

to_c!(Face => ofc_shadow_plane { normal; threshold: least });

impl From<ofc_shadow_plane> for Face {
    fn from(face: ofc_shadow_plane) -> Self {
        let ofc_shadow_plane { normal, threshold } = face;
        Self { normal, least: threshold }
    }
}

/// A test of a pixel's color rho that says whether the pixel obeys the model. A color passes that is finite, not black
/// and below the saturation level, whose rho^T C rho lies within both bands, and that no shadow plane rejects. The test
/// can be applied to other frames under the same lights.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_inlier_test {
    /// Channels at or above this level are saturated; infinite where none is.
    pub saturation: f64,
    /// C of the first rejection, by residual: c11, c22, c33, c12, c13, c23.
    pub residual_form: [f64; 6],
    /// The smallest accepted rho^T C rho with `residual_form` as C.
    pub residual_low: f64,
    /// The largest accepted rho^T C rho with `residual_form` as C.
    pub residual_high: f64,
    /// C of the second rejection, by the length of the normal: c11, c22, c33, c12, c13, c23.
    pub norm_form: [f64; 6],
    /// The smallest accepted rho^T C rho with `norm_form` as C.
    pub norm_low: f64,
    /// The largest accepted rho^T C rho with `norm_form` as C.
    pub norm_high: f64,
    /// Up to three planes; a plane that is not there is zero.
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
/// c23 and in (pixel value)^-2. Numbers that are known are finite: median_residual, dispersion, r_squared and pixel_noise are DBL_MAX or
/// -DBL_MAX where the residuals of most pixels are above 3.4e38, as of colors whose values differ by a factor of 1e19.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_color_fit {
    /// The coefficients that minimize the median squared residual.
    pub robust: [f64; 6],
    /// The square root of that median, over all usable pixels.
    pub median_residual: f64,
    /// The robust dispersion s0 of eq. 12.
    pub dispersion: f64,
    /// The robust coefficient of determination, 1 - median_residual^2.
    pub r_squared: f64,
    /// The reweighted fit: least squares over the inliers.
    pub coefficients: [ofc_estimate; 6],
    /// Expected squares and products of the errors of `coefficients`, the upper triangle row by row: the covariance of
    /// least squares, plus the square of the bias that noise causes, plus the square of the difference from `robust`.
    pub covariance: [f64; 21],
    /// The standard deviation of the inliers' residuals under the reweighted fit.
    pub residual_deviation: f64,
    /// Root mean square of the inliers' colors along their principal axes, descending, in pixel values.
    pub color_deviations: [f64; 3],
    /// Standard deviation of the noise in each channel that explains the inliers' residuals, in pixel values.
    pub noise_deviation: f64,
    /// Standard deviation of the noise to expect in each channel of a single pixel, in pixel values, from the median
    /// residual and with regard to what the rejection cuts off. In a stream without the feature `full-streams` it is
    /// the noise that rounding causes.
    pub pixel_noise: f64,
    /// Standard deviation of the noise with which colors that do not determine C could look like these colors, in pixel
    /// values. ofc_solve() returns OFC_STATUS_RANK_DEFICIENT where it is below 1.15 times `noise_deviation`. The
    /// relative bias of C is about the inverse square of the quotient of both.
    pub degenerate_noise_deviation: f64,
    /// How many pixels have a residual that is accepted.
    pub inlier_count: i32,
    /// How many subsets were drawn.
    pub subsets: u32,
    /// 1 where pixels counted by how rare their colors are, see OFC_WEIGHTING_AUTO: all but the count of inliers is then of a sample
    /// that is so weighted. 0 otherwise.
    pub by_colors: i32,
    /// Zero.
    pub reserved: u32,
}

to_c!(Fit => ofc_color_fit {
    robust, coefficients, covariance, residual_deviation, color_deviations, noise_deviation, degenerate_noise_deviation, subsets,
    by_colors; inlier_count: inliers
} finite { median_residual, dispersion, r_squared, pixel_noise } without { band, usable } zero { reserved });

/// Where most of a set of numbers lies: the one-dimensional least median of squares.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_location {
    /// The midpoint of the shortest interval that holds half of the numbers.
    pub location: f64,
    /// Half the length of that interval, which is the median distance from the location.
    pub median_distance: f64,
    /// The robust dispersion 1.4826 (1 + 5 / (n - 1)) median_distance of n numbers.
    pub dispersion: f64,
}

to_c!(Location => ofc_location { location, median_distance, dispersion });

/// What C says of F before the orthogonal transformation is known (eq. 18).
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_ellipsoid {
    /// C, in (pixel value)^-2.
    pub c: [f64; 9],
    /// Eigenvalues of C, descending: the squared inverse semi-axes of the ellipsoid.
    pub eigenvalues: [f64; 3],
    /// G0 = sqrt(Lambda) U^T with C = G0^T G0; G0 rho is the normal up to an orthogonal transformation.
    pub root: [f64; 9],
    /// F F^T = C^-1, in (pixel value)^2.
    pub f_f_transposed: [f64; 9],
    /// Lengths of the rows f1, f2, f3 of F, in pixel values.
    pub norms: [f64; 3],
    /// Cosines h12, h13, h23 of the angles between the rows of F.
    pub cosines: [f64; 3],
}

to_c!(Ellipsoid => ofc_ellipsoid { c, eigenvalues, root, f_f_transposed, norms, cosines });

/// Tilts of the rows of F, each the tilt of the light that one channel is equivalent to.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_tilts {
    /// Tilts in radians, in (-pi, pi], for a convex surface.
    pub tilt_rad: [f64; 3],
    /// The mean gradients (Ix, Iy) of r, g, b over the inliers, in pixel values per pixel, y up; zero where the
    /// estimator has none.
    pub mean_gradient: [f64; 6],
}

to_c!(Tilts => ofc_tilts { ; tilt_rad: tilts, mean_gradient: gradients });

/// Slants of the rows of F that are consistent with their tilts and with the angles between them.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_slants {
    /// Slants in radians, in [0, pi/2].
    pub slant_rad: [f64; 3],
    /// The largest residual of eqs. 24.
    pub residual: f64,
    /// The integral (15) as a mean over cells of inliers, per pixel^2; infinite where F is rank-deficient, 0 where no
    /// picture is involved.
    pub integral: f64,
    /// The branch of eqs. 25, from 1 for the signs (+,+,+) of the square roots to 8 for (-,-,-); 0 for least squares.
    pub branch: i32,
    /// Zero.
    pub reserved: u32,
}

/// The color-orientation matrix F with rho = F n.
#[repr(C)]
#[derive(Clone, Copy, Default)]
pub struct ofc_orientation {
    /// F in pixel values. Row i is the one light that channel i could have been lit by: strength times direction.
    pub f: [f64; 9],
    /// The inverse of F over the singular values above the threshold, so that n = f_inverse rho.
    pub f_inverse: [f64; 9],
    /// Singular values of F, descending.
    pub singular_values: [f64; 3],
    /// How many singular values are above the threshold: 3 where F can be inverted.
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
    /// The mean of (dp/dy - dq/dx)^2, per pixel^2.
    pub mean: f64,
    /// How many cells there are.
    pub cells: i32,
    /// Zero.
    pub reserved: u32,
}

to_c!(Integrability => ofc_integrability { mean, cells } zero { reserved });
