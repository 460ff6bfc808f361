//! How to search, and what to reject.
//!
//! # Reference
//! The number of subsets: P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", Wiley 1987, chapter 5.

use libm::{ceil, log, log1p};

/// Fewer usable pixels than this are refused: half of them must still hold the six of a subset.
pub const MIN_PIXELS: usize = 12;

/// Proposals are never more than this, whatever the parameters ask for.
pub const MAX_SUBSETS: u32 = 10_000_000;

/// What fits the form to the pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Least median of squares, rejection, and least squares over what is left.
    #[default]
    LeastMedian,
    /// Least squares over all usable pixels, none rejected: photometric stereo with unknown lights as R. J. Woodham, Y.
    /// Iwahori and R. A. Barman (TR 91-18, 1991) have it. For pictures in which every pixel obeys the model.
    LeastSquares,
}

/// How much each pixel counts in the search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Weighting {
    /// All pixels alike; but where one color is the majority and leaves the form open, a pixel counts by how rare its color is,
    /// if that determines the form clearly. Not in streams.
    #[default]
    Auto,
    /// All pixels alike: the paper's.
    Pixels,
}

/// How to search, and what to reject.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// What fits. Default [`Method::LeastMedian`]; the search's parameters mean nothing to the other.
    pub method: Method,
    /// How much each pixel counts. Default [`Weighting::Auto`].
    pub weighting: Weighting,
    /// The probability that at least one subset is free of outliers, in (0, 1). Default 0.9999.
    pub confidence: f64,
    /// The share of outliers for which that holds, in [0, 1). Default 0.5.
    pub outlier_share: f64,
    /// At least this many subsets are drawn. Default 500.
    pub min_subsets: u32,
    /// Exactly this many subsets, or 0 for the number that `confidence` and `outlier_share` ask for. Default 0.
    pub subsets: u32,
    /// Pixels that the search looks at; all are looked at when there are fewer. Of more, up to three times as many decide where it
    /// ends, as the workspace holds them. Default 10,000.
    pub sample_size: u32,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
    /// Residuals above this many dispersions are outliers. Default 2.5.
    pub rejection: f64,
    /// The confidence of the limits given with each coefficient, in (0, 1). Default 0.95.
    pub limits_confidence: f64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            method: Method::LeastMedian,
            weighting: Weighting::Auto,
            confidence: 0.9999,
            outlier_share: 0.5,
            min_subsets: 500,
            subsets: 0,
            sample_size: 10_000,
            seed: 0,
            rejection: 2.5,
            limits_confidence: 0.95,
        }
    }
}

impl Params {
    /// How many subsets these parameters ask for, or `None` when one of them is out of its range.
    #[must_use]
    pub fn subset_count(&self) -> Option<u32> {
        let in_range = self.rejection > 0.0
            && self.rejection.is_finite()
            && self.limits_confidence > 0.0
            && self.limits_confidence < 1.0
            && self.sample_size as usize >= MIN_PIXELS
            && self.subsets <= MAX_SUBSETS;
        let count = subset_count(self.confidence, self.outlier_share, self.min_subsets)?;
        in_range.then_some(if self.subsets > 0 { self.subsets } else { count })
    }
}

/// The number of random six-pixel subsets of which, with probability `confidence`, at least one holds no outlier when
/// the share of outliers is `outlier_share`; at least `min_subsets` and at least 1.
///
/// `None` when a parameter is out of range (see [`Params`]) or the answer is above [`MAX_SUBSETS`].
#[must_use]
#[expect(clippy::cast_sign_loss, reason = "a count of at least 1")]
pub fn subset_count(confidence: f64, outlier_share: f64, min_subsets: u32) -> Option<u32> {
    let in_range = confidence > 0.0
        && confidence < 1.0
        && (0.0..1.0).contains(&outlier_share)
        && min_subsets <= MAX_SUBSETS;
    if !in_range {
        return None;
    }
    let share = 1.0 - outlier_share;
    let good = (share * share * share) * (share * share * share);
    // log1p(-1) is -infinity when every subset is good, and then the quotient is 0.
    let count = ceil(log(1.0 - confidence) / log1p(-good)).max(1.0).max(f64::from(min_subsets));
    (count <= f64::from(MAX_SUBSETS)).then_some(count as u32)
}
