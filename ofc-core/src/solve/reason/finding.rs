//! A reason, and the numbers behind it.

/// What a refusal or a doubt comes from. `docs/reasons.md` says for each what its numbers are and what to try.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reason {
    /// There is nothing to doubt, or nobody looked for a reason, as in a stream.
    #[default]
    None,
    /// No cause was found for a refusal.
    Unknown,
    /// The mask leaves no pixels, or too few.
    MaskEmpty,
    /// The mask leaves the background, and leaves out what looks like the object.
    MaskInverted,
    /// There are too few pixels for a fit, or to say how sure the orientation is.
    TooFewPixels,
    /// Most pixels are NaN or infinite.
    NotFinite,
    /// Most of the object is saturated.
    Saturated,
    /// The picture is black, or has little light for its noise and its steps.
    Dark,
    /// A channel is the same everywhere.
    ChannelDead,
    /// The channels are equal or proportional: a gray picture, or lights of one color.
    Gray,
    /// The colors span two dimensions although the surface bends in both directions: there are two lights, or all of them lie
    /// in a plane.
    TooFewLights,
    /// The lights, or their colors, lie nearly in a plane: noise turns the normals too much.
    LightsCoplanar,
    /// The surface is a plane.
    Flat,
    /// The surface bends in one direction only, or nearly so.
    Cylinder,
    /// There are two paints.
    TwoPaints,
    /// A background of one color was counted as object.
    Background,
    /// The surface is a plane whose brightness falls off from the middle of the picture.
    Vignette,
    /// Most pixels do not obey the model.
    Outliers,
    /// The surface looks as much hollow as convex.
    ConvexOrHollow,
}

/// A reason, and the numbers behind it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Finding {
    /// The reason.
    pub reason: Reason,
    /// The channel that it is about, 0 to 2.
    pub channel: Option<usize>,
    /// What was measured.
    pub value: f64,
    /// What it was compared with.
    pub limit: f64,
}

impl Finding {
    /// Nothing to say.
    pub(crate) const NONE: Self = Self::of(Reason::None, 0.0, 0.0);

    /// A reason with these numbers. A ratio to nothing is the largest number.
    pub(super) const fn of(reason: Reason, value: f64, limit: f64) -> Self {
        Self { reason, channel: None, value: value.min(f64::MAX), limit }
    }

    /// This reason where the value is above its limit.
    pub(super) fn above(reason: Reason, value: f64, limit: f64) -> Option<Self> {
        (value > limit).then_some(Self::of(reason, value, limit))
    }

    /// This reason where the value is below its limit.
    pub(super) fn below(reason: Reason, value: f64, limit: f64) -> Option<Self> {
        (value < limit).then_some(Self::of(reason, value, limit))
    }

    /// About this channel.
    pub(super) const fn about(self, channel: Option<usize>) -> Self {
        Self { channel, ..self }
    }
}

/// Most of the pixels.
pub(super) const MOST: f64 = 0.5;

/// A part of a number of pixels.
pub(super) fn share(part: usize, of: usize) -> f64 {
    part as f64 / of.max(1) as f64
}
