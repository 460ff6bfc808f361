//! The equivalent light of each channel: how strong it is, its tilt and its slant (section 3).
//!
//! [`tilt`] holds Pentland's estimator (eqs. 20 and 21) and others. [`constrained_slant`] finds the slants that agree with
//! the tilts and the angles between the lights (eqs. 24 and 25). [`slant`] holds estimators of one channel by itself (eqs. 22
//! and 23), and [`channel_maxima`] estimates the strengths without the ellipsoid.

pub mod channel_maxima;
pub mod constrained_slant;
mod differences;
mod gradient;
pub mod slant;
pub mod tilt;
