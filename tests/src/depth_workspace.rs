//! Memory for [`ofc_core::surface::depth::integrate`], filled with what it must not look at.

use ofc_core::math::arena::{Arena, Need};
use ofc_core::surface::depth::need;

/// Numbers and integers for one integration.
pub struct Workspace {
    /// Numbers in single precision.
    pub singles: Vec<f32>,
    /// Integers.
    pub integers: Vec<u32>,
}

impl Workspace {
    /// As much as `need` says, full of the bits of `dirt`.
    #[must_use]
    pub fn of(need: Need, dirt: f32) -> Self {
        Self { singles: vec![dirt; need.singles], integers: vec![dirt.to_bits(); need.integers] }
    }

    /// As much as a picture of this size needs, full of the bits of `dirt`.
    ///
    /// # Panics
    /// When there is no such picture.
    #[must_use]
    pub fn new(width: usize, height: usize, dirt: f32) -> Self {
        Self::of(need(width, height).expect("a picture"), dirt)
    }

    /// Overwrites all of it with the bits of `dirt`.
    pub fn soil(&mut self, dirt: f32) {
        self.singles.fill(dirt);
        self.integers.fill(dirt.to_bits());
    }

    /// All of it, to be cut.
    pub fn arena(&mut self) -> Arena<'_> {
        Arena::new(&mut [], &mut self.singles, &mut self.integers)
    }
}
