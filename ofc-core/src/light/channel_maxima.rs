//! The lengths of F's rows as the brightest value of each channel.
//!
//! A channel is |f| times the cosine of the angle to its equivalent light, so where some normal points there the largest
//! value is |f|. Where none does it is less, and one bright outlier is enough to spoil it.
//!
//! # Reference
//! Section 4 and the last rows of Tables 1 and 2.

use crate::picture::{Image, Window, for_each_bit};

/// The largest value of each channel, in pixel values, over the pixels whose bits `inliers` gives; `None` when there are
/// none.
pub fn norms(image: &Image, inliers: impl Fn(&Window) -> u64) -> Option<[f64; 3]> {
    let mut largest: Option<[f32; 3]> = None;
    image.for_each_window(|window| {
        for_each_bit(inliers(window), |i| {
            let color = window.pixel(i);
            let maxima = largest.get_or_insert(color);
            for (maximum, value) in maxima.iter_mut().zip(color) {
                *maximum = maximum.max(value);
            }
        });
    });
    largest.map(|maxima| maxima.map(f64::from))
}
