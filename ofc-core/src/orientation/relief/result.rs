//! What was found of a relief on a plane, or why nothing was.

use super::grid::Grid;
use super::reference::Polynomial;
use super::spread::Spread;
use crate::math::arena::Need;
use core::fmt;

/// What a pixel, or a cell, is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PixelClass {
    /// It is masked out or has no usable color: there is no normal.
    None = 0,
    /// The untouched plane: its normal is (0, 0, 1).
    Plane = 1,
    /// Around the contact, where the relief comes up from the plane.
    Skirt = 2,
    /// It differs from the plane by more than noise.
    Contact = 3,
}

/// Where the scale of the slopes comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScaleSource {
    /// It is unknown: slopes and depths are right up to a factor, and a usual one is taken.
    Unknown = 0,
    /// From the bend of the colors of the inner contact.
    Colors = 1,
    /// From the radius of the ball that was given.
    Ball = 2,
    /// It was set.
    Given = 3,
}

/// A relief on a plane: what turns colors into its normals, and how far to trust them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    /// W, which turns the relative color delta into (n1, n2), scale and sign included.
    pub w: [[f64; 3]; 2],
    /// The color of the plane where no picture of it was given, and otherwise what its dark spots are told by.
    pub plane: Polynomial,
    /// Whether a picture of the plane was given.
    pub has_background: bool,
    /// The level of saturation, where [`ReliefParams`](super::ReliefParams) set one.
    pub saturation: Option<f32>,
    /// The cells that the evidence was taken from.
    pub grid: Grid,
    /// The deviation of each channel of a cell of the plane, relative to its color: noise, and what the reference misses.
    pub noise: [f64; 3],
    /// Cells of each [`PixelClass`].
    pub cells: [usize; 4],
    /// The mean squared circulation that W leaves, relative to the energy of the slopes: 0 for a perfect relief; paint, spots and
    /// shadows leave 0.3 and more.
    pub circulation: f64,
    /// That number relative to the second best W's: near 1 where the picture does not determine W, as for a groove.
    pub circulation_ratio: f64,
    /// The slopes across the relief relative to those along it, as a ratio of their variances: 0 for a groove.
    pub anisotropy: f64,
    /// The smaller of both deviations of the slopes in the contact, relative to noise.
    pub signal_to_noise: f64,
    /// The root mean square of the step of the slopes across the border of the contact relative to the slopes in it: a relief comes up from the plane
    /// smoothly, and what lies on a plane has an edge.
    pub border: f64,
    /// How surely the normals point outward, from 0, where nothing is known, to 1.
    pub outward: f64,
    /// Where the scale comes from.
    pub scale_source: ScaleSource,
    /// The standard deviation of the scale's logarithm.
    pub scale_deviation: f64,
    /// How far the normals disagree with the ellipsoid of the contact's colors, as a share of their variance; `None` where there is
    /// no ellipsoid.
    pub disagreement: Option<f64>,
    /// The root mean square of the sine of the contact's slant.
    pub tilt: f64,
}

impl Relief {
    /// What the deviation of a normal is made of: of the scale, which grows with the slope, and of W, which does not.
    pub(crate) fn spread(&self) -> Spread {
        let share = self.disagreement.unwrap_or(self.circulation);
        Spread::new(share, self.tilt, self.scale_deviation)
    }

    /// The expected error in radians of the normals in the contact.
    #[must_use]
    pub fn expected_error(&self) -> f64 {
        self.spread().of_sine(self.tilt)
    }
}

/// Why there is no relief on a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReliefError {
    /// A parameter is out of its range.
    Params,
    /// The background, or the map of classes, has another size than the picture.
    Size,
    /// The picture has too few pixels along one side.
    TooSmall,
    /// The workspace holds less than this.
    Workspace(Need),
    /// Too few pixels are usable to find the plane.
    TooFewPixels,
    /// Nothing differs from the plane.
    NothingTouched,
    /// More than half of the picture differs from the plane.
    NoMajority,
    /// The slopes of the relief have one direction, or do not stand out of the noise: a groove, paint of one other hue.
    NotDetermined,
    /// What differs from the plane is not integrable: paint, spots, highlights or shadows rather than a relief.
    NotIntegrable,
    /// What differs from the plane has an edge: an object that lies on it, or paint.
    HasEdge,
}

impl fmt::Display for ReliefError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Params => "a parameter is out of its range",
            Self::Size => "the background or the map of classes has another size than the picture",
            Self::TooSmall => "the picture has too few pixels along one side",
            Self::Workspace(_) => "the workspace is too short",
            Self::TooFewPixels => "too few pixels are usable to find the plane",
            Self::NothingTouched => "nothing differs from the plane",
            Self::NoMajority => "more than half of the picture differs from the plane",
            Self::NotDetermined => {
                "the slopes of the relief have one direction, or do not stand out of the noise"
            }
            Self::NotIntegrable => {
                "what differs from the plane is paint, spots or shadows rather than a relief"
            }
            Self::HasEdge => {
                "what differs from the plane has an edge: it lies on the plane rather than rises from it"
            }
        })
    }
}

impl core::error::Error for ReliefError {}
