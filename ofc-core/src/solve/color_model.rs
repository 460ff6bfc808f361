//! What the colors say of F before its orthogonal transformation is known, or why they say nothing.

use crate::color::ellipsoid::{self, Ellipsoid};
use crate::color::inliers::Inliers;
use crate::color::lmeds::{Fit, Method};
use crate::color::rank::{self, Rank};
use crate::picture::Pixels;

/// The noise that would make a degenerate scene look like this one must be so many times the noise there is. Degenerate
/// scenes (cylinders, planes, cones, ramps, mixtures of colors, with and without noise) come to 0.2-1.1, photographs
/// that give good normals to 1.19-6.7; at the limit a coefficient of C can be mostly bias.
pub(crate) const SMALLEST_NOISE_MARGIN: f64 = 1.15;

/// Why there is no model of the colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoModel {
    /// The colors, or the normals, span less than three dimensions.
    RankDeficient,
    /// They span three, but by hardly more than the noise.
    Undetermined,
    /// The colors do not lie on an ellipsoid.
    NotPositiveDefinite,
}

/// C, its root, and the lengths and angles of the rows of F (step 2), where fit and rank say that the colors determine them.
///
/// # Errors
/// [`NoModel`], also without a fit.
pub(super) fn ellipsoid(fit: Option<&Fit>, rank: Option<Rank>, method: Method) -> Result<Ellipsoid, NoModel> {
    let fit = fit.ok_or(NoModel::RankDeficient)?;
    if rank.is_some_and(|rank| rank.colors < 3) {
        return Err(NoModel::RankDeficient);
    }
    if !is_determined(fit, method) {
        let is_full = rank.is_some_and(|rank| rank.is_full());
        return Err(if is_full { NoModel::Undetermined } else { NoModel::RankDeficient });
    }
    ellipsoid::decompose(&fit.z()).map_err(|_| NoModel::NotPositiveDefinite)
}

/// The ranks of the inliers' colors and normals; `None` where there are no inliers.
pub(super) fn ranks(
    pixels: &impl Pixels,
    fit: Option<&Fit>,
    inliers: &Inliers,
    method: Method,
) -> Option<Rank> {
    let form = fit.map(|fit| (fit.z(), deviation(fit, method)));
    pixels.of_part(|part| rank::rank(part, inliers.selector(), form))
}

/// The deviation of the residuals. Outliers that least squares keeps are no noise: the robust dispersion leaves them out.
fn deviation(fit: &Fit, method: Method) -> f64 {
    match method {
        Method::LeastMedian => fit.residual_deviation,
        Method::LeastSquares => fit.residual_deviation.min(fit.dispersion),
    }
}

/// Whether there is so little noise that colors which do not determine C could not look like these.
fn is_determined(fit: &Fit, method: Method) -> bool {
    let deviation = deviation(fit, method);
    let share = if deviation < fit.residual_deviation { deviation / fit.residual_deviation } else { 1.0 };
    fit.degenerate_noise_deviation > SMALLEST_NOISE_MARGIN * (fit.noise_deviation * share)
}
