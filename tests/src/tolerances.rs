//! How close is close: every tolerance of these tests, each with the reason for its size.

/// Numbers that the paper prints with two decimals.
pub const TWO_DECIMALS: f64 = 0.005;
/// The tilts and norms of Table 1: f1's tilt is 36.790 and printed as 36.80, and the norms are printed for a picture
/// scaled by a factor that is only known from them.
pub const LAST_PRINTED_DIGIT: f64 = 0.01;
/// The paper's angles with one decimal.
pub const ONE_DECIMAL: f64 = 0.05;

/// The same formula in f64 in another order of summation, relative: thousands of roundings of 1e-16, some of them
/// canceling.
pub const REORDERED_SUM: f64 = 1e-11;
/// Results stored as f32, relative: half a unit in the last place is 6e-8.
pub const STORED_AS_F32: f64 = 1e-6;
/// Coefficients of C from the normal equations against orthogonalised columns, relative to the largest coefficient:
/// the normal equations square a condition of up to 1e3.
pub const NORMAL_EQUATIONS: f64 = 1e-8;
/// C when the pixels are scaled by a factor that is exact in f32 but no power of two, or channels are permuted: the
/// inliers are the same, and sums are rounded differently.
pub const EQUIVARIANCE: f64 = 1e-9;
/// Student's distribution, relative, against Simpson's rule on 40,000 intervals.
pub const STUDENT: f64 = 1e-7;
/// Confidence limits against the same rule, inverted by bisection, in standard errors.
pub const STUDENT_QUANTILE: f64 = 1e-6;

/// The best objective that any search has found may be smaller than the core's by this share: local minima lie so
/// close together where noise is all that tells them apart.
pub const OBJECTIVE: f64 = 0.05;
/// The same on pictures of a dozen pixels where every subset is tried: the search evaluates in f32.
pub const EXHAUSTIVE_OBJECTIVE: f64 = 1e-4;

/// F and the normals of noise-free f32 pictures with true tilts: the bound. Rounding to f32 is noise of 6e-8,
/// and the weakest of the scenes magnifies it a hundredfold.
pub const NOISE_FREE: f64 = 1e-4;
/// The integral of a true surface from f32 colors, in pixel^-2: rounding, squared.
pub const INTEGRABLE: f64 = 1e-11;
/// Tilts on a surface with the symmetry of the square, in radians: the mean gradient is exact but for f32 colors.
pub const SYMMETRIC_TILT: f64 = 1e-5;
/// What a seed may add to the error on a photograph, in degrees: with each seed other pixels at the border of the contact
/// are inliers, and they turn Pentland's tilts. The default seed and the middle one of five must do without.
pub const PHOTOGRAPH_SEED: f64 = 0.5;
/// Spheres in noise of 0.2 gray values, degrees: noise is rejected more often where the light is far from the normal,
/// and what is left of the cap is no longer symmetric. With Table 1's lights that turns the tilts by up to 20 degrees,
/// however small the noise is.
pub const SPHERE_IN_NOISE: f64 = 5.0;
/// Ellipsoids with axes 1.1 : 1 : 0.9, degrees: Pentland's tilt favors the direction that bends more.
pub const ELLIPSOID_TILT: f64 = 6.0;
/// Spheres without noise from end to end, degrees: colors are f32.
pub const SPHERE: f64 = 0.01;

/// A stream's F from 2048 of a portrait's 29,000 colors against the F of the whole picture: the largest angle between
/// rows, in degrees. Eight seeds come to 0.2-1.3, and to 0.2-1.2 where it is oriented as a whole, from some 600 windows;
/// photographs to 0.6-1.3.
pub const SAMPLED_ANGLE: f64 = 2.0;
/// The same of the rows' lengths, relative. Eight seeds come to 0.0004-0.009.
pub const SAMPLED_STRENGTH: f64 = 0.02;
