//! How a model changes from frame to frame.

/// What a frame says of the model from before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// The share of usable pixels that the old model's residuals accept.
    pub inlier_share: f64,
    /// What changed; `None` where there is no new model, and the next pass is over colors.
    pub change: Option<Change>,
}

/// From one model to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// The angles between the old and the new rows of F, in radians.
    pub angles: [f64; 3],
    /// The lengths of the new rows of F over those of the old.
    pub strengths: [f64; 3],
    /// The dispersion of the new residuals over that of the old.
    pub dispersion: f64,
}
