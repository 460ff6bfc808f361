//! Views over the caller's pixels: how they lie in memory, which of them a method may use, and how neighbors differ.
//!
//! An [`Image`] is checked once when it is made, and read [`WINDOW`] pixels at a time. [`Usable`] says which of them are
//! finite, not black, not saturated and not shaded; sets of pixels are bits of a [`Window`]. [`cells`] are squares of four
//! neighbors, the stencil of every finite difference. A picture that is not linear, or holds light that is not the model's, becomes
//! one that it is about by [`transfer`], [`dark`] and [`flat_field`]; [`saturation`] finds where it was clipped.

pub mod cells;
mod colors;
pub mod dark;
mod faces;
pub mod flat_field;
mod image;
mod layout;
mod mask;
mod pixels;
pub(crate) mod rows;
pub mod saturation;
pub mod transfer;
mod usable;
mod window;

pub use faces::{Face, Faces, MAX_FACES};
pub use image::Image;
pub use layout::{ImageError, MAX_PIXELS, Order, Sample, span};
pub use mask::Mask;
pub use pixels::Pixels;
pub use usable::{PixelCounts, Usable};
pub use window::{WINDOW, Window, for_each_bit};

pub(crate) use colors::{Colors, stretches};
pub(crate) use faces::distance;
pub(crate) use pixels::{second_differences, sum_second_differences};
pub(crate) use window::{first_bits, packed};
