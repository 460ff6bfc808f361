//! How far a normal may be off, from its slopes.

use libm::{sqrt, sqrtf};

/// The largest squared sine that a normal can have.
pub(super) const LARGEST_SQUARE: f64 = 0.95;

/// What the standard deviation of a normal is made of.
#[derive(Clone, Copy)]
pub(crate) struct Spread {
    /// The variance of the slopes that the model misses.
    slopes: f32,
    /// The variance of the scale's logarithm.
    scale: f32,
}

impl Spread {
    /// Where the slopes, whose root mean square is `tilt`, miss this share of their variance, and the logarithm of their scale has this deviation.
    pub fn new(share: f64, tilt: f64, scale_deviation: f64) -> Self {
        let slopes = share.min(1.0) * tilt * tilt;
        Self { slopes: slopes as f32, scale: (scale_deviation * scale_deviation) as f32 }
    }

    /// With noise of this variance in each slope.
    pub fn with_noise(self, variance: f64) -> Self {
        Self { slopes: self.slopes + variance as f32, ..self }
    }

    /// The deviation in radians of a normal whose slant has this sine.
    pub fn of_sine(self, sine: f64) -> f64 {
        let square = (sine * sine).min(LARGEST_SQUARE);
        sqrt((f64::from(self.slopes) + f64::from(self.scale) * square) / (1.0 - square))
    }

    /// The [unit vector](unit) of these first two components and its deviation; `None` where it is not finite.
    pub fn normal(self, slopes: [f32; 2]) -> Option<([f32; 3], f32)> {
        let normal = unit(slopes)?;
        let [n1, n2, n3] = normal;
        let deviation = sqrtf(self.slopes + self.scale * (n1 * n1 + n2 * n2)) / n3;
        Some((normal, deviation.min(f32::MAX)))
    }
}

/// The unit vector of these first two components, shortened where they are too long; `None` where they are not finite.
pub(crate) fn unit([n1, n2]: [f32; 2]) -> Option<[f32; 3]> {
    const LARGEST: f32 = LARGEST_SQUARE as f32;
    let square = n1 * n1 + n2 * n2;
    if !square.is_finite() {
        return None;
    }
    let shorter = if square > LARGEST { sqrtf(LARGEST / square) } else { 1.0 };
    Some([n1 * shorter, n2 * shorter, sqrtf(1.0 - square.min(LARGEST))])
}
