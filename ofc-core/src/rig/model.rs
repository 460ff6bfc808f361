//! A solved rig: what turns the colors of any of its frames into normals.

use super::row::Row;
use super::terms::{Order, TERMS};
use crate::math::arena::Arena;
use crate::orientation::relief::{
    Grid, Polynomial, Reference, ReliefError, ScaleSource, Slopes, Spread, normals_by, survey,
};
use crate::picture::Image;

/// What would make a rig's answer better, most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Advice {
    /// Nothing that is known.
    Nothing = 0,
    /// More contacts, of things that are round rather than long.
    Contacts = 1,
    /// A ball of known radius, or the scale.
    Scale = 2,
    /// Contacts in the part of the frame that has fewest: [`Model::region`].
    Region = 3,
}

/// What turns colors into normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Model {
    /// Pixels in a row of a frame.
    pub width: usize,
    /// Rows of a frame.
    pub height: usize,
    /// The terms that W has.
    pub order: Order,
    /// W; what is beyond its order is zero.
    pub w: [[f64; TERMS]; 2],
    /// The color of the untouched plane by polynomial. With a background it tells dark spots only.
    pub plane: Polynomial,
    /// The deviation of each channel of a cell of the plane, relative to its color.
    pub noise: [f64; 3],
    /// The level of saturation, where one is set.
    pub saturation: Option<f32>,
    /// How many frames and balls it was made of.
    pub frames: u32,
    /// How many of them are balls.
    pub balls: u32,
    /// The mean squared circulation of the slopes without labels, relative to their energy.
    pub circulation: f64,
    /// That relative to the second best W's.
    pub circulation_ratio: f64,
    /// The correlation between slopes and places in the contacts: which way is out.
    pub outward: f64,
    /// Where the scale comes from.
    pub scale_source: ScaleSource,
    /// The deviation of its logarithm.
    pub scale_deviation: f64,
    /// The share of the slopes' variance that W misses.
    pub disagreement: f64,
    /// The root mean square of the sine of the contacts' slants.
    pub tilt: f64,
    /// What would make it better.
    pub advice: Advice,
    /// The ninth of the frame, row by row, that has fewest contacts.
    pub region: usize,
}

impl Model {
    /// The expected error in radians of normals in a contact.
    #[must_use]
    pub fn expected_error(&self) -> f64 {
        self.spread().of_sine(self.tilt)
    }

    /// The Frobenius norm of the constant terms of W.
    #[must_use]
    pub fn length(&self) -> f64 {
        let constant = self.w.iter().flat_map(|row| row.iter().take(Order::Constant.len()));
        libm::sqrt(constant.fold(0.0, |sum, entry| sum + entry * entry))
    }

    /// Whether its numbers are finite and frames can have its size.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let numbers =
            self.w.iter().flatten().chain(self.plane.coefficients.iter().flatten()).chain(&self.noise);
        let others = [self.circulation, self.scale_deviation, self.disagreement, self.tilt];
        Grid::of(self.width, self.height).is_some()
            && numbers.chain(&others).all(|number| number.is_finite())
            && self.noise.iter().all(|&deviation| deviation >= 0.0)
            && self.saturation.is_none_or(|level| level > 0.0)
    }

    fn grid(&self) -> Option<Grid> {
        Grid::of(self.width, self.height)
    }
}

impl Slopes for Model {
    type Row = Row;

    fn row(&self, y: f64) -> Row {
        Row::of(self.w.each_ref(), self.order, y)
    }

    fn spread(&self) -> Spread {
        Spread::new(self.disagreement, self.tilt, self.scale_deviation)
    }

    fn noise(&self, noise: [f64; 3]) -> f64 {
        // That of the middle of the frame, to first order.
        let terms = self.w.iter().flat_map(|row| row.iter().zip(noise));
        terms.map(|(w, deviation)| w * w * deviation * deviation).sum::<f64>() / 2.0
    }
}

/// Writes what every pixel of a frame is part of, see [`PixelClass`](crate::orientation::relief::PixelClass). A frame that nothing touches
/// is one of the plane alone.
///
/// # Scratch
/// What [`need`](crate::orientation::relief::need) says.
///
/// # Errors
/// [`ReliefError::Size`], [`ReliefError::Workspace`], [`ReliefError::TooFewPixels`].
pub fn classify(
    model: &Model,
    image: &Image,
    background: Option<&Image>,
    workspace: Arena,
    classes: &mut [u8],
) -> Result<(), ReliefError> {
    let (width, height) = (image.width(), image.height());
    if [width, height] != [model.width, model.height] || classes.len() != width * height {
        return Err(ReliefError::Size);
    }
    survey(image, background, model.saturation, Some(&model.plane), workspace)?.write(width, classes);
    Ok(())
}

/// Writes the unit normal of every pixel of a frame and its 1-sigma uncertainty in radians, as
/// [`relief::normals`](crate::orientation::relief::normals()) does.
///
/// # Errors
/// [`ReliefError::Size`] where the frame, the background or the classes are not of the rig's size.
pub fn normals(
    model: &Model,
    image: &Image,
    background: Option<&Image>,
    classes: &[u8],
    write: impl FnMut(usize, usize, [f32; 3], f32),
) -> Result<(), ReliefError> {
    let grid = model.grid().ok_or(ReliefError::Size)?;
    let reference = Reference { grid, plane: &model.plane, noise: model.noise, saturation: model.saturation };
    normals_by(model, image, background, &reference, classes, write)
}
