//! The sums of a rig that need no label.

use crate::math::mat3::Mat3;
use crate::math::mat6::Mat6;
use crate::orientation::relief::{Circulation, Grid, Least, Polynomial};

/// What frames without labels say of a rig.
///
/// A frame counts by the energy of its relative colors, so that a large contact says no more than a small one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rig {
    /// Pixels in a row of a frame.
    pub width: usize,
    /// Rows of a frame.
    pub height: usize,
    /// How many frames with a contact there are.
    pub frames: u32,
    /// Sums of squared circulations around windows, by columns.
    pub circulation: Mat6,
    /// Sums of the energy of the relative colors.
    pub energy: Mat3,
    /// Sums of the relative colors times how far a cell is from the middle of the contact: by W's row, then by channel.
    pub outward: [[f64; 3]; 2],
    /// Sums of the mean squares and products of the relative colors in the contact.
    pub contact: Mat3,
    /// Those means over the squared tilt that the bend of the frame's colors gives, times the weight of that.
    pub bend: Mat3,
    /// Sum of these weights, the reciprocal variances of the scale's logarithm.
    pub bend_weight: f64,
    /// Sums of the squared noise of the channels of a cell.
    pub noise: [f64; 3],
    /// Sum of the polynomials of the plane.
    pub plane: Polynomial,
    /// The Frobenius norm of W that was set; zero where none was.
    pub scale: f64,
    /// The deviation of its logarithm.
    pub scale_deviation: f64,
    /// Cells of contact in each ninth of the frame, row by row.
    pub coverage: [u32; 9],
}

impl Rig {
    /// Without frames; `None` where frames of this size are too small.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Option<Self> {
        Grid::of(width, height).map(|_| Self { width, height, ..Self::default() })
    }

    /// Whether every number is finite and its size is one that frames can have.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let numbers = self.circulation.iter().flatten().chain(self.energy.iter().flatten());
        let numbers = numbers.chain(self.outward.iter().flatten()).chain(self.contact.iter().flatten());
        let numbers = numbers.chain(self.bend.iter().flatten()).chain(&self.noise);
        let numbers = numbers.chain(self.plane.coefficients.iter().flatten());
        let mut numbers = numbers.chain([&self.bend_weight, &self.scale, &self.scale_deviation]);
        numbers.all(|number| number.is_finite())
            && Grid::of(self.width, self.height).is_some()
            && self.bend_weight >= 0.0
            && self.scale >= 0.0
            && self.scale_deviation >= 0.0
    }

    /// Adds the frames of another rig of the same sensor; a scale that was set there counts where none is set here.
    #[must_use]
    pub fn merge(&mut self, other: &Self) -> Option<()> {
        if [self.width, self.height] != [other.width, other.height] {
            return None;
        }
        let scale = if self.scale > 0.0 { *self } else { *other };
        self.frames = self.frames.saturating_add(other.frames);
        add_all(&mut self.circulation, &other.circulation);
        add_all(&mut self.energy, &other.energy);
        add_all(&mut self.outward, &other.outward);
        add_all(&mut self.contact, &other.contact);
        add_all(&mut self.bend, &other.bend);
        self.bend_weight += other.bend_weight;
        for (sum, value) in self.noise.iter_mut().zip(other.noise) {
            *sum += value;
        }
        add_all(&mut self.plane.coefficients, &other.plane.coefficients);
        for (sum, cells) in self.coverage.iter_mut().zip(other.coverage) {
            *sum = sum.saturating_add(cells);
        }
        (self.scale, self.scale_deviation) = (scale.scale, scale.scale_deviation);
        Some(())
    }

    /// The field of the least circulation.
    pub(super) fn least(&self) -> Option<Least> {
        Circulation { squares: self.circulation, energy: self.energy }.least()
    }
}

/// Adds matrices.
fn add_all<const N: usize, const M: usize>(sums: &mut [[f64; N]; M], values: &[[f64; N]; M]) {
    for (sum, value) in sums.iter_mut().flatten().zip(values.iter().flatten()) {
        *sum += value;
    }
}
