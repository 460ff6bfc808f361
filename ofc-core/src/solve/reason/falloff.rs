//! A vignette: the brightness of a picture of one hue falls off from its middle as a quadratic function of the place.

use crate::math::mat6::{self, Mat6};
use crate::picture::{Image, Window, for_each_bit};
use libm::sqrt;

/// 1, x, y and x^2 + y^2, two numbers unused.
const TERMS: usize = 4;

/// How brightness changes over the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Falloff {
    /// The share of the variance of the brightness that a quadratic function of the place explains, noise taken off.
    pub explained: f64,
    /// The share of the brightness in the middle that is left at the corners.
    pub left_at_corners: f64,
}

impl Falloff {
    /// Of the pixels that `selected` gives the bits of; `None` without any, or where all are in one place.
    #[inline(never)]
    pub fn of(image: &Image, selected: impl Fn(&Window) -> u64, noise: f64) -> Option<Self> {
        let (width, height) = (image.width() as f64, image.height() as f64);
        let diagonal = sqrt(width * width + height * height);
        let mut normal: Mat6 = [[0.0; 6]; 6];
        let (mut right, mut count, mut squares) = ([0.0; 6], 0.0, 0.0);
        image.for_each_window(|window| {
            for_each_bit(selected(window), |i| {
                let x = (2.0 * (window.x + i) as f64 + 1.0 - width) / diagonal;
                let y = (height - 2.0 * window.y as f64 - 1.0) / diagonal;
                let terms = [1.0, x, y, x * x + y * y, 0.0, 0.0];
                let [r, g, b] = window.pixel(i).map(f64::from);
                let brightness = sqrt(r * r + g * g + b * b);
                count += 1.0;
                squares += brightness * brightness;
                for ((row, right), a) in normal.iter_mut().zip(&mut right).zip(terms) {
                    *right += a * brightness;
                    for (entry, b) in row.iter_mut().zip(terms) {
                        *entry += a * b;
                    }
                }
            });
        });
        for (i, row) in normal.iter_mut().enumerate().skip(TERMS) {
            if let Some(entry) = row.get_mut(i) {
                *entry = 1.0;
            }
        }
        let coefficients = mat6::solve(&normal, &right)?;
        let [middle, .., quadratic, _, _] = coefficients;
        let mean = right[0] / f64::max(count, 1.0);
        let total = squares - count * mean * mean - count * noise * noise;
        let left = squares - mat6::dot(&coefficients, &right) - count * noise * noise;
        (total > 0.0 && middle > 0.0).then(|| Self {
            explained: 1.0 - left.max(0.0) / total,
            left_at_corners: (middle + quadratic) / middle,
        })
    }
}
