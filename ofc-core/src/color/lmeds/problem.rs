//! Which pixels are to be fitted, and how.

use super::params::Params;
use crate::picture::Usable;

/// The pixels that one quadratic form is sought for.
pub(crate) struct Problem<'a, P> {
    pub pixels: &'a P,
    pub usable: Usable,
    /// How many of the pixels are usable.
    pub count: usize,
    /// What colors are multiplied with before they are fitted, so that they are about 1: a power of two.
    pub scale: f64,
    pub params: &'a Params,
}
