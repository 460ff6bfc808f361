//! The equivalent light of each channel: how strong it is, its tilt and its slant.
//!
//! | of the paper | here |
//! | --- | --- |
//! | strength, "channel maxima", Tables 1 and 2 | [`channel_maxima`] |
//! | eq. 20, mean gradients | `gradient.rs`, over sums in `differences.rs` |
//! | eq. 21, Pentland's tilt | [`tilt::pentland`] |
//! | the other tilt estimators of section 3.1 | [`tilt::lee_rosenfeld`], [`tilt::zheng_chellappa`], [`tilt::chojnacki`] |
//! | eq. 22, Pentland's slant | [`slant::pentland`] |
//! | eq. 23, Lee and Rosenfeld's slant and strength | [`slant::lee_rosenfeld`] |
//! | eqs. 24, slants from tilts and angles | [`constrained_slant`], its solutions [`constrained_slant::roots()`] |
//! | eqs. 25, the curves, and how their eight cases are numbered | [`constrained_slant::curve()`], [`constrained_slant::SlantRoot::branch`] |
//!
//! Tilts come from the gradients of a channel alone. Slants that come from one channel alone are not reliable (section 4); those
//! of the pipeline follow from the tilts and from the angles between the rows of F, which the fit of the colors gives.

pub mod channel_maxima;
pub mod constrained_slant;
mod differences;
mod gradient;
pub mod slant;
pub mod tilt;
