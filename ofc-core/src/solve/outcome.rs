//! How far the pipeline came.

/// How far the pipeline came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// To F.
    Solved,
    /// The colors, or the normals, span less than three dimensions: C is not determined.
    RankDeficient,
    /// Colors and normals span space, but by so little more than the noise, or than what does not obey the model, that C is not
    /// determined.
    Undetermined,
    /// The colors do not lie on an ellipsoid: C is not positive definite.
    NotPositiveDefinite,
    /// A channel's mean gradient over the inliers is zero, or there are no neighboring inliers: no tilts.
    NoTilt,
    /// No slants agree with the tilts and the angles between the rows of F, and there was to be no fallback.
    NoConsistentSlants,
    /// Only in a stream: the passes of its cold start are not at their end.
    Unfinished,
}
