//! What is known of the relief beforehand.

/// What is known of the relief beforehand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReliefParams {
    /// A pixel is saturated if a channel is at or above this; `None` for the largest value of the pixel type, and no
    /// limit for f32. Default `None`.
    pub saturation: Option<f32>,
    /// The radius in pixels of the one ball that is pressed in, which gives the scale of the slopes; `None` where there is none.
    /// Positive. Default `None`.
    pub ball_radius: Option<f64>,
    /// Whether the relief goes down from the plane, as a dent or an engraving, rather than rises toward the camera, as a gel does where
    /// something is pressed into it. Default `false`.
    pub hollow: bool,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
}

impl ReliefParams {
    /// Whether every parameter is in its range.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        self.saturation.is_none_or(|level| level > 0.0)
            && self.ball_radius.is_none_or(|radius| radius.is_finite() && radius > 0.0)
    }
}
