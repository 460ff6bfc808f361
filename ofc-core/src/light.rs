//! The equivalent light of each channel: how strong it is, its tilt and its slant.

pub mod channel_maxima;
pub mod constrained_slant;
pub mod slant;
pub mod tilt;
