//! The pixels that obey the model, as a pure function of their color.
//!
//! Both rejections of the paper ask how far rho^T C rho is from where it should be, so each is a band of values; no
//! mask needs to be kept, and the test can be applied to the next frame of a video just as well.
//!
//! # Reference
//! Section 2.2.

use crate::color::ellipsoid::{Coefficients, quadratic_form};
use crate::color::location::Location;
use crate::picture::Pixels;
use crate::picture::{Image, Usable, Window, for_each_bit};
use libm::{fabs, fabsf};

/// Deviations below this are rounding of f32 colors: an exact fit accepts them all.
const EXACT_FIT: f64 = 1e-5;

/// Colors for which `low <= rho^T C rho <= high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// C.
    pub form: Coefficients,
    /// Smallest accepted value.
    pub low: f64,
    /// Largest accepted value.
    pub high: f64,
}

impl Band {
    /// The band that every finite color lies in.
    pub const EVERYTHING: Self = Self { form: [0.0; 6], low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// The band that no color lies in.
    pub const NOTHING: Self = Self { form: [0.0; 6], low: f64::INFINITY, high: f64::NEG_INFINITY };

    /// Colors whose residual rho^T C rho - 1 is within `rejection` dispersions of zero: the first rejection.
    #[must_use]
    pub fn residual(form: Coefficients, dispersion: f64, rejection: f64) -> Self {
        let limit = (rejection * dispersion).max(EXACT_FIT);
        Self { form, low: 1.0 - limit, high: 1.0 + limit }
    }

    /// Colors whose normal, of length sqrt(rho^T C rho), is within `rejection` dispersions of the location of the
    /// lengths: the second rejection.
    #[must_use]
    pub fn norm(form: Coefficients, lengths: &Location, rejection: f64) -> Self {
        let limit = (rejection * lengths.dispersion).max(EXACT_FIT);
        let low = (lengths.location - limit).max(0.0);
        let high = lengths.location + limit;
        Self { form, low: low * low, high: high * high }
    }

    pub(crate) fn contains(&self, [r, g, b]: [f32; 3]) -> bool {
        let value = quadratic_form(&self.form, r, g, b);
        value >= self.low && value <= self.high
    }

    /// Which of the finite colors `among` the window's lie within. Single precision decides where its error cannot matter,
    /// which is nearly everywhere; the answer is that of double precision.
    #[inline(never)]
    pub(crate) fn bits(&self, window: &Window, among: u64) -> u64 {
        if among == 0 {
            return 0;
        }
        if self.form == [0.0; 6] {
            return if self.low <= 0.0 && self.high >= 0.0 { among } else { 0 };
        }
        let (mut inside, unsure) = match SingleBand::new(self) {
            Some(band) => band.bits(window),
            None => (0, u64::MAX),
        };
        for_each_bit(unsure & among, |i| {
            let bit = 1 << i;
            inside = if self.contains(window.pixel(i)) { inside | bit } else { inside & !bit };
        });
        inside & among
    }
}

/// A [`Band`] in single precision, with what its rounding can amount to.
struct SingleBand {
    form: [f32; 6],
    middle: f32,
    half: f32,
    slack: f32,
}

impl SingleBand {
    /// Sixteen roundings: three in each term, one in each coefficient, five in the sum, one in the sum of absolute values,
    /// three in middle and half and the differences with them.
    const RELATIVE: f32 = 1.0 / (1 << 20) as f32;
    /// Terms that are too small to be represented are less than this.
    const ABSOLUTE: f32 = 1e-9;

    /// `None` for bands of which the bound on the rounding does not hold. With such diagonals a color is either so small
    /// that no term overflows, or makes one infinite, and then nothing is certain.
    fn new(band: &Band) -> Option<Self> {
        let [c11, c22, c33, c12, c13, c23] = band.form;
        let is_in_range = |c: f64| (1e-30..1e30).contains(&fabs(c));
        let form = [c11, c22, c33, 2.0 * c12, 2.0 * c13, 2.0 * c23].map(|c| c as f32);
        let (middle, half) = (0.5 * (band.low + band.high), 0.5 * (band.high - band.low));
        let holds = c11.min(c22).min(c33) > 0.0
            && band.form.into_iter().all(|c| c == 0.0 || is_in_range(c))
            && fabs(middle) + half < 1e30;
        let (middle, half) = (middle as f32, half as f32);
        let slack = Self::RELATIVE * (fabsf(middle) + half) + Self::ABSOLUTE;
        holds.then_some(Self { form, middle, half, slack })
    }

    /// The colors that certainly lie within, and those of which nothing is certain.
    fn bits(&self, window: &Window) -> (u64, u64) {
        let [c11, c22, c33, c12, c13, c23] = self.form;
        let mut certain = true;
        let inside = window.bits(|r, g, b| {
            let squares = c11 * r * r + c22 * g * g + c33 * b * b;
            let (rg, rb, gb) = (c12 * r * g, c13 * r * b, c23 * g * b);
            let size = squares + (fabsf(rg) + fabsf(rb) + fabsf(gb));
            let error = size * Self::RELATIVE + self.slack;
            let beyond = fabsf(squares + (rg + rb + gb) - self.middle) - self.half;
            certain &= fabsf(beyond) > error;
            beyond < 0.0
        });
        (inside, if certain { 0 } else { u64::MAX })
    }
}

/// Usable colors inside the bands of both rejections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inliers {
    /// Which pixels can be used at all.
    pub usable: Usable,
    /// The rejection by residual, under the C that the least median of squares found.
    pub residual: Band,
    /// The rejection by the length of the normal, under the C of the reweighted fit.
    pub norm: Band,
}

impl Inliers {
    /// Every usable pixel.
    #[must_use]
    pub const fn all(usable: Usable) -> Self {
        Self { usable, residual: Band::EVERYTHING, norm: Band::EVERYTHING }
    }

    /// No pixel.
    #[must_use]
    pub const fn none(usable: Usable) -> Self {
        Self { usable, residual: Band::NOTHING, norm: Band::NOTHING }
    }

    /// [`Self::bits`], of one and the same type wherever pixels are selected: what takes it is compiled once.
    pub fn selector(&self) -> impl Fn(&Window) -> u64 + Copy {
        |window| self.bits(window)
    }

    /// The bits of `window`'s inliers.
    #[must_use]
    #[inline(never)]
    pub fn bits(&self, window: &Window) -> u64 {
        self.bits_among(window, self.usable.exposed(window))
    }

    /// [`Self::bits`], of those that [`Usable::exposed`] has found.
    pub(crate) fn bits_among(&self, window: &Window, exposed: u64) -> u64 {
        self.norm.bits(window, self.residual.bits(window, self.usable.shadow_faces.lit(window, exposed)))
    }

    /// How many inliers `pixels` hold.
    #[must_use]
    pub fn count(&self, pixels: &impl Pixels) -> usize {
        let mut count = 0;
        pixels.for_each_window(|window| count += self.bits(window).count_ones() as usize);
        count
    }

    /// Writes 255 for every inlier of `image` and 0 for every other pixel.
    ///
    /// # Shape
    /// `mask` is width x height, rows without gaps; what lies behind is left alone.
    pub fn mark(&self, image: &Image, mask: &mut [u8]) {
        image.for_each_window(|window| {
            let bits = self.bits(window);
            let row = mask.get_mut(window.y * image.width() + window.x..).unwrap_or_default();
            for (i, byte) in row.iter_mut().take(window.len).enumerate() {
                *byte = if bits >> i & 1 == 1 { u8::MAX } else { 0 };
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::picture::WINDOW;

    /// Compares the bits of random colors with what double precision says of each, and returns how many are inside.
    fn agree(band: &Band, scale: f32, rng: &mut Rng) -> u32 {
        let mut window = Window::new();
        for channel in &mut window.color {
            channel.fill_with(|| scale * (rng.unit() as f32 - 0.1));
        }
        // Onto both limits and a few roundings beside them.
        for i in 0..WINDOW {
            let [r, g, b] = window.pixel(i);
            let value = quadratic_form(&band.form, r, g, b);
            let limit = if i % 2 == 0 { band.low } else { band.high };
            let factor = libm::sqrt(limit / value) * (1.0 + (rng.unit() - 0.5) * 1e-6);
            if i % 4 < 2 && factor.is_finite() {
                for channel in &mut window.color {
                    channel[i] = (f64::from(channel[i]) * factor) as f32;
                }
            }
        }
        let among = rng.next_u64() | rng.next_u64();
        let bits = band.bits(&window, among);
        for i in 0..WINDOW {
            let expected = among >> i & 1 == 1 && band.contains(window.pixel(i));
            assert_eq!(bits >> i & 1 == 1, expected, "{:?} {band:?}", window.pixel(i));
        }
        bits.count_ones()
    }

    #[test]
    fn single_precision_changes_no_answer() {
        let mut rng = Rng::new(6);
        let mut inside = 0;
        for n in 0..4000 {
            // From well conditioned to nearly singular or indefinite; pixel values of every size.
            let scale = libm::pow(10.0, 30.0 * rng.unit() - 15.0);
            let form = [1.0, 1.0, 1.0, 0.0, 0.0, 0.0].map(|diagonal: f64| {
                (diagonal * (0.2 + rng.unit()) + 1.6 * rng.unit() - 0.8) / (scale * scale)
            });
            let width = if n % 3 == 0 { 1e-6 } else { rng.unit() };
            let middle = if n % 5 == 0 { width } else { 1.0 };
            let band = Band { form, low: middle - width, high: middle + width };
            inside += agree(&band, scale as f32, &mut rng);
        }
        assert!(inside > 10_000, "{inside}");
    }

    #[test]
    fn bands_hold_residuals_and_lengths_within_so_many_dispersions() {
        let form = [4.0, 1.0, 1.0, 0.0, 0.0, 0.0];
        // The color (x, 0, 0) has the residual 4 x^2 - 1 and the length 2 x.
        let residual = Band::residual(form, 0.02, 2.5);
        assert!((residual.low - 0.95).abs() < 1e-15 && (residual.high - 1.05).abs() < 1e-15);
        let lengths = Location { location: 0.9, median_distance: 0.02, dispersion: 0.04 };
        let norm = Band::norm(form, &lengths, 2.5);
        let holds = |band: &Band, x: f32| band.contains([x, 0.0, 0.0]);
        assert!(holds(&norm, 0.401) && holds(&norm, 0.499) && !holds(&norm, 0.399) && !holds(&norm, 0.501));
        // Lengths are not negative, and an exact fit has room for rounding.
        let wide = Band::norm(form, &Location { dispersion: 1.0, ..lengths }, 2.5);
        assert!(wide.low == 0.0 && holds(&wide, 0.0) && holds(&wide, 1.69) && !holds(&wide, 1.71));
        let exact = Band::residual(form, 0.0, 2.5);
        assert!(holds(&exact, 0.5) && holds(&exact, 0.500_001) && !holds(&exact, 0.500_01));
    }

    #[test]
    fn bands_without_an_end_or_a_form() {
        let mut rng = Rng::new(7);
        for form in [[0.0; 6], [1.0, 2.0, 3.0, 0.0, -0.5, 0.5], [1e-40, 1.0, 1.0, 0.0, 0.0, 0.0]] {
            for (low, high) in
                [(f64::NEG_INFINITY, f64::INFINITY), (f64::INFINITY, f64::NEG_INFINITY), (0.0, 1e308)]
            {
                agree(&Band { form, low, high }, 1.0, &mut rng);
                agree(&Band { form, low, high }, 1e19, &mut rng);
            }
        }
    }
}
