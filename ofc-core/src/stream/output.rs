//! Normals and inliers of one row.

use super::pass::StreamError;
use super::state::State;
use crate::orientation::matrix::Orientation;
use crate::picture::{Image, for_each_bit};
use crate::solve::Outcome;
use crate::surface::normals::{self, Length};

impl State {
    /// F, where there is one.
    #[must_use]
    pub fn orientation(&self) -> Option<&Orientation> {
        let choice = self.solution.choice.as_ref()?;
        (self.solution.outcome == Outcome::Solved).then_some(&choice.orientation)
    }

    /// The unit normals of a row's inliers, zeros everywhere else.
    ///
    /// # Shape
    /// `normals` is width times (x, y, z). Frame: x right, y up, z toward the camera.
    ///
    /// # Errors
    /// [`StreamError::NotSolved`] where there is no F, [`StreamError::Row`], [`StreamError::TooShort`].
    pub fn normals(&self, row: &Image, normals: &mut [f32]) -> Result<(), StreamError> {
        let orientation = self.orientation().ok_or(StreamError::NotSolved)?;
        self.check(row)?;
        let inliers = &self.solution.inliers;
        let (f_inverse, width) = (&orientation.f_inverse, self.width);
        normals::compute_each(row, |window| inliers.bits(window), f_inverse, normals, 3 * width)
            .map_err(|_| StreamError::TooShort)
    }

    /// The unit normals of a row's inliers in 8 bits, (n + 1) / 2 of 255 rounded; zeros, which is no normal's, everywhere
    /// else.
    ///
    /// # Shape
    /// `normals` is width times (x, y, z). Frame: x right, y up, z toward the camera.
    ///
    /// # Errors
    /// The errors of [`Self::normals`].
    pub fn packed_normals(&self, row: &Image, packed: &mut [u8]) -> Result<(), StreamError> {
        let orientation = self.orientation().ok_or(StreamError::NotSolved)?;
        self.check(row)?;
        let packed = packed.get_mut(..3 * self.width).ok_or(StreamError::TooShort)?;
        packed.fill(0);
        let (packed, _) = packed.as_chunks_mut::<3>();
        row.for_each_window(|window| {
            let out = packed.get_mut(window.x..).unwrap_or_default();
            for_each_bit(self.solution.inliers.bits(window), |i| {
                if let Some(slot) = out.get_mut(i) {
                    let normal = normals::normal(&orientation.f_inverse, window.pixel(i), Length::Unit);
                    *slot = normal.map(pack);
                }
            });
        });
        Ok(())
    }

    /// 255 for a row's inliers, 0 for all others.
    ///
    /// # Shape
    /// `flags` is one byte a pixel.
    ///
    /// # Errors
    /// The errors of [`Self::normals`].
    pub fn inliers(&self, row: &Image, flags: &mut [u8]) -> Result<(), StreamError> {
        self.orientation().ok_or(StreamError::NotSolved)?;
        self.check(row)?;
        let flags = flags.get_mut(..self.width).ok_or(StreamError::TooShort)?;
        self.solution.inliers.mark(row, flags);
        Ok(())
    }
}

/// A component in [-1, 1] as a byte.
#[expect(clippy::cast_sign_loss, reason = "from 0 to 255")]
fn pack(component: f64) -> u8 {
    libm::floor((component + 1.0) * 127.5 + 0.5) as u8
}
