//! The background from the frames themselves, followed as it drifts.

use crate::orientation::relief::{PixelClass, ReliefError};
use crate::picture::{Image, Usable, WINDOW, Window, for_each_bit};

/// Moves a background by the share `rate` toward each pixel of a frame that shows the untouched plane. A pixel that is not known yet, NaN, takes the
/// frame's color. Where `classes` are none, nothing is touched.
///
/// `background` are rows of three numbers a pixel, red, green, blue, `stride` numbers from one row to the next.
///
/// # Errors
/// [`ReliefError::Size`] where classes or background are too few; [`ReliefError::Params`] where the rate is not in (0, 1].
pub fn follow(
    background: &mut [f32],
    stride: usize,
    image: &Image,
    classes: Option<&[u8]>,
    saturation: Option<f32>,
    rate: f32,
) -> Result<(), ReliefError> {
    let (width, height) = (image.width(), image.height());
    let is_large = height.checked_sub(1).and_then(|rows| rows.checked_mul(stride)?.checked_add(3 * width));
    let fits = is_large.is_some_and(|need| need <= background.len()) && stride >= 3 * width;
    if !fits || classes.is_some_and(|classes| classes.len() != width * height) {
        return Err(ReliefError::Size);
    }
    let is_rate = rate > 0.0 && rate <= 1.0;
    if !is_rate {
        return Err(ReliefError::Params);
    }
    let usable = Usable::below(saturation.unwrap_or(image.sample().saturation()));
    let mut window = Window::new();
    for y in 0..height {
        for x in (0..width).step_by(WINDOW) {
            image.read(x, y, &mut window);
            for_each_bit(usable.exposed(&window), |i| {
                let class = classes.and_then(|classes| classes.get(y * width + x + i));
                if class.is_some_and(|&class| class != PixelClass::Plane as u8) {
                    return;
                }
                let known = background.iter_mut().skip(y * stride + 3 * (x + i));
                for (known, color) in known.zip(window.pixel(i)) {
                    *known = if known.is_finite() { (1.0 - rate) * *known + rate * color } else { color };
                }
            });
        }
    }
    Ok(())
}
