//! The normals of a relief on a plane, pixel by pixel.

use super::grid::Grid;
use super::reference::Polynomial;
use super::result::{PixelClass, Relief, ReliefError};
use super::scale::unit;
use super::survey::relative;
use crate::math::mat3;
use crate::picture::{Image, Usable, WINDOW, Window};
use libm::sqrt;

/// What turns the colors of pixels into slopes.
pub(crate) trait Slopes {
    /// (n1, n2) of a pixel whose color relative to the plane is `delta`, at a place in [-1, 1] across and down the picture.
    fn slopes(&self, place: [f64; 2], delta: [f64; 3]) -> [f64; 2];

    /// The standard deviation in radians of a normal whose slant has this sine, but for the pixel's noise.
    fn model_deviation(&self, sine: f64) -> f64;

    /// The variance of each slope that comes from noise in delta with these deviations.
    fn noise(&self, noise: [f64; 3]) -> f64;
}

/// The plane that the slopes are relative to.
pub(crate) struct Reference<'a> {
    pub grid: Grid,
    pub plane: &'a Polynomial,
    /// The deviation of each channel of a cell of the plane, relative to its color.
    pub noise: [f64; 3],
    pub saturation: Option<f32>,
}

impl Slopes for Relief {
    fn slopes(&self, _: [f64; 2], delta: [f64; 3]) -> [f64; 2] {
        self.w.map(|row| mat3::dot(row, delta))
    }

    fn model_deviation(&self, sine: f64) -> f64 {
        self.model_deviation(sine)
    }

    fn noise(&self, noise: [f64; 3]) -> f64 {
        let terms = self.w.iter().flatten().zip(noise.iter().cycle());
        terms.map(|(w, deviation)| w * w * deviation * deviation).sum::<f64>() / 2.0
    }
}

/// Writes the unit normal of every pixel, and its 1-sigma angular uncertainty in radians, as `write(x, y, normal, uncertainty)` says;
/// both are NaN where the pixel is masked out or of the class [`PixelClass::None`], or has no usable color and is not on the plane.
///
/// The uncertainty holds the noise of the pixel, that of the scale, and the disagreement between both models of the colors.
///
/// # Errors
/// [`ReliefError::Size`] where background or classes are not of the picture's size, or a background is missing or superfluous.
pub fn normals(
    image: &Image,
    background: Option<&Image>,
    found: &Relief,
    classes: &[u8],
    write: impl FnMut(usize, usize, [f32; 3], f32),
) -> Result<(), ReliefError> {
    if background.is_some() != found.has_background {
        return Err(ReliefError::Size);
    }
    let Relief { grid, plane, noise, saturation, .. } = found;
    let reference = Reference { grid: *grid, plane, noise: *noise, saturation: *saturation };
    normals_by(found, image, background, &reference, classes, write)
}

/// [`normals`] by any slopes.
pub(crate) fn normals_by(
    slopes: &impl Slopes,
    image: &Image,
    background: Option<&Image>,
    reference: &Reference,
    classes: &[u8],
    mut write: impl FnMut(usize, usize, [f32; 3], f32),
) -> Result<(), ReliefError> {
    let (width, height) = (image.width(), image.height());
    let Reference { grid, plane, .. } = reference;
    let fits = background.is_none_or(|b| [b.width(), b.height()] == [width, height])
        && classes.len() == width * height
        && Grid::of(width, height) == Some(*grid);
    if !fits {
        return Err(ReliefError::Size);
    }
    let usable = Usable::below(reference.saturation.unwrap_or(image.sample().saturation()));
    // The noise of a pixel from that of a cell, an average of as many as it has.
    let noise = slopes.noise(reference.noise.map(|deviation| deviation * grid.side as f64));
    let nothing = ([f64::NAN; 3], f64::NAN);
    let (mut window, mut other) = (Window::new(), Window::new());
    for y in 0..height {
        let down = place(y, grid.height * grid.side);
        for x in (0..width).step_by(WINDOW) {
            image.read(x, y, &mut window);
            let bits = usable.exposed(&window);
            if let Some(background) = background {
                background.read(x, y, &mut other);
            }
            for i in 0..window.len {
                let class = classes.get(y * width + x + i).copied().unwrap_or(0);
                let is_usable = bits >> i & 1 == 1 && class != PixelClass::None as u8;
                let (normal, deviation) = if class == PixelClass::Plane as u8 && window.masked >> i & 1 == 1 {
                    ([0.0, 0.0, 1.0], 0.0)
                } else if !is_usable {
                    nothing
                } else {
                    let at = [place(x + i, grid.width * grid.side), down];
                    let plane = match background {
                        Some(_) => other.pixel(i).map(f64::from),
                        None => plane.at(at),
                    };
                    let mut delta = [0.0; 3];
                    for ((delta, color), plane) in delta.iter_mut().zip(window.pixel(i)).zip(plane) {
                        *delta = relative(f64::from(color), plane);
                    }
                    let (normal, _) = unit(slopes.slopes(at, delta));
                    let [n1, n2, n3] = normal;
                    let model = slopes.model_deviation(sqrt(n1 * n1 + n2 * n2));
                    let deviation = sqrt(model * model + noise / (n3 * n3)).min(f64::from(f32::MAX));
                    // A relief that nobody found may hold numbers from which no normal follows.
                    if normal.iter().all(|n| n.is_finite()) { (normal, deviation) } else { nothing }
                };
                write(x + i, y, normal.map(|n| n as f32), deviation as f32);
            }
        }
    }
    Ok(())
}

/// The middle of a pixel in [-1, 1] along so many pixels.
fn place(i: usize, count: usize) -> f64 {
    (2 * i + 1) as f64 / count as f64 - 1.0
}
