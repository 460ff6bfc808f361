//! The normals of a relief on a plane, pixel by pixel.

use super::grid::Grid;
use super::reference::Polynomial;
use super::result::{PixelClass, Relief, ReliefError};
use super::spread::Spread;
use super::survey::relative;
use crate::picture::{Image, Usable, WINDOW, Window, first_bits};

/// What turns the colors of pixels into slopes.
pub(crate) trait Slopes {
    /// The slopes along a row.
    type Row: RowSlopes;

    /// Those of the row at this height in [-1, 1], down the picture.
    fn row(&self, y: f64) -> Self::Row;

    /// What the standard deviation of a normal is made of, but for the pixel's noise.
    fn spread(&self) -> Spread;

    /// The variance of each slope that comes from noise in delta with these deviations.
    fn noise(&self, noise: [f64; 3]) -> f64;
}

/// What turns the colors of pixels along a row into slopes.
pub(crate) trait RowSlopes {
    /// (n1, n2) of the pixels at these places in [-1, 1] along the row, whose colors relative to the plane are `delta`.
    fn slopes(&self, x: &[f32; WINDOW], delta: &[[f32; WINDOW]; 3]) -> [[f32; WINDOW]; 2];
}

/// W, the same everywhere.
impl RowSlopes for [[f64; 3]; 2] {
    fn slopes(&self, _: &[f32; WINDOW], delta: &[[f32; WINDOW]; 3]) -> [[f32; WINDOW]; 2] {
        let mut slopes = [[0.0; WINDOW]; 2];
        for (slopes, row) in slopes.iter_mut().zip(self) {
            for (w, delta) in row.iter().zip(delta) {
                let w = *w as f32;
                slopes.iter_mut().zip(delta).for_each(|(slope, delta)| *slope += w * delta);
            }
        }
        slopes
    }
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
    type Row = [[f64; 3]; 2];

    fn row(&self, _: f64) -> Self::Row {
        self.w
    }

    fn spread(&self) -> Spread {
        self.spread()
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
    let spread = slopes.spread().with_noise(noise);
    let plane_normal = ([0.0, 0.0, 1.0], 0.0);
    let nothing = ([f32::NAN; 3], f32::NAN);
    let (mut window, mut other) = (Window::new(), Window::new());
    let (mut places, mut delta) = ([0.0_f32; WINDOW], [[0.0_f32; WINDOW]; 3]);
    for (y, classes) in classes.chunks(width.max(1)).enumerate() {
        let down = place(y, grid.height * grid.side);
        let (row, along) = (slopes.row(down), plane.along(down));
        for (x, classes) in (0..width).step_by(WINDOW).zip(classes.chunks(WINDOW)) {
            let is_plane = classes.iter().all(|&class| class == PixelClass::Plane as u8);
            if is_plane && image.masked(x, y) == first_bits(classes.len()) {
                for i in 0..classes.len() {
                    write(x + i, y, plane_normal.0, plane_normal.1);
                }
                continue;
            }
            image.read(x, y, &mut window);
            let bits = usable.exposed(&window);
            for (i, place) in places.iter_mut().enumerate() {
                *place = self::place(x + i, grid.width * grid.side) as f32;
            }
            if let Some(background) = background {
                background.read(x, y, &mut other);
            } else {
                for (colors, along) in other.color.iter_mut().zip(&along) {
                    for (color, &place) in colors.iter_mut().zip(&places) {
                        *color = along.at(f64::from(place)) as f32;
                    }
                }
            }
            for ((delta, colors), planes) in delta.iter_mut().zip(&window.color).zip(&other.color) {
                for ((delta, &color), &plane) in delta.iter_mut().zip(colors).zip(planes) {
                    *delta = relative(color, plane);
                }
            }
            let [across, up] = row.slopes(&places, &delta);
            for (i, ((&class, &n1), &n2)) in classes.iter().zip(&across).zip(&up).enumerate() {
                let (normal, deviation) = if class == PixelClass::Plane as u8 && window.masked >> i & 1 == 1 {
                    plane_normal
                } else if bits >> i & 1 == 0 || class == PixelClass::None as u8 {
                    nothing
                } else {
                    // A relief that nobody found may hold numbers from which no normal follows.
                    spread.normal([n1, n2]).unwrap_or(nothing)
                };
                write(x + i, y, normal, deviation);
            }
        }
    }
    Ok(())
}

/// The middle of a pixel in [-1, 1] along so many pixels.
fn place(i: usize, count: usize) -> f64 {
    (2 * i + 1) as f64 / count as f64 - 1.0
}
