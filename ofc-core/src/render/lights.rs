//! The lights of the forward model.
//!
//! # Reference
//! Section 1.1, eqs. 4-7.

use crate::math::mat3::{self, Mat3};
use core::fmt;

/// Lights at most: a bit each in a pixel's mask.
pub const MAX_LIGHTS: usize = u32::BITS as usize;

/// A direction's squared length may be this far from 1.
const UNIT_TOLERANCE: f64 = 1e-6;

/// The largest color: sums and squares of 32 such stay finite, also as f32.
const MAX_COLOR: f64 = 1e30;

/// Why lights are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightsError {
    /// None, or more than [`MAX_LIGHTS`].
    Count,
    /// A matrix does not have three entries a light.
    Size,
    /// A direction is not a unit vector.
    Direction,
    /// An entry of a color is negative, above 1e30 or not a number.
    Color,
}

impl fmt::Display for LightsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count => write!(f, "no light, or more than {MAX_LIGHTS}"),
            Self::Size => f.write_str("a matrix does not have three entries a light"),
            Self::Direction => f.write_str("a direction is not a unit vector"),
            Self::Color => f.write_str("an entry of a color is negative, above 1e30 or not a number"),
        }
    }
}

impl core::error::Error for LightsError {}

/// L distant lights, as views of the matrices A and B.
#[derive(Clone, Copy, Debug)]
pub struct Lights<'a> {
    directions: &'a [[f64; 3]],
    red: &'a [f64],
    green: &'a [f64],
    blue: &'a [f64],
}

impl<'a> Lights<'a> {
    /// Lights from A, L x 3, whose rows are unit vectors toward the lights, and B, 3 x L, whose columns are the colors
    /// that the lights produce when reflected by a surface facing them (eq. 4). Both row-major.
    ///
    /// # Errors
    /// [`LightsError`].
    pub fn new(a: &'a [f64], b: &'a [f64]) -> Result<Self, LightsError> {
        let (directions, rest) = a.as_chunks::<3>();
        let count = directions.len();
        if !rest.is_empty() || b.len() != a.len() {
            return Err(LightsError::Size);
        }
        if count == 0 || count > MAX_LIGHTS {
            return Err(LightsError::Count);
        }
        let is_unit = |&d: &[f64; 3]| (mat3::dot(d, d) - 1.0).abs() <= UNIT_TOLERANCE;
        if !directions.iter().all(is_unit) {
            return Err(LightsError::Direction);
        }
        if !b.iter().all(|color| (0.0..=MAX_COLOR).contains(color)) {
            return Err(LightsError::Color);
        }
        let (red, rest) = b.split_at_checked(count).ok_or(LightsError::Size)?;
        let (green, blue) = rest.split_at_checked(count).ok_or(LightsError::Size)?;
        Ok(Self { directions, red, green, blue })
    }

    /// How many there are.
    #[must_use]
    pub const fn count(&self) -> usize {
        self.directions.len()
    }

    /// Direction and color of each light.
    pub fn iter(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        let colors = self.red.iter().zip(self.green).zip(self.blue);
        self.directions.iter().zip(colors).map(|(&direction, ((&r, &g), &b))| (direction, [r, g, b]))
    }

    /// The color-orientation matrix F = B A of a surface that sees all lights (eq. 7).
    #[must_use]
    pub fn orientation(&self) -> Mat3 {
        let mut f = [[0.0; 3]; 3];
        for (direction, color) in self.iter() {
            for (row, strength) in f.iter_mut().zip(color) {
                for (entry, component) in row.iter_mut().zip(direction) {
                    *entry += strength * component;
                }
            }
        }
        f
    }
}
