//! A mask that leaves the background and leaves out the object.

use super::finding::{Finding, MOST, Reason, share};
use super::survey::Survey;
use crate::picture::{Image, Usable, Window, first_bits};

/// What the mask leaves is darker than this share of what it leaves out, or does not bend.
const DARKER: f64 = 0.2;
/// Spread of so many times the noise is of a surface.
const NOISES: f64 = 3.0;

/// That the mask is inverted: it leaves most of the frame and nothing, something dark or something flat, and leaves out colors that
/// span space. `inside` is what it leaves, where that is anything.
///
/// # Scratch
/// One `f32` a pixel.
#[inline(never)]
pub(super) fn inverted(
    image: &Image,
    usable: Usable,
    inside: Option<&Survey>,
    workspace: &mut [f32],
) -> Option<Finding> {
    let frame = Finding::above(Reason::MaskInverted, share_of_frame(image), MOST)?;
    let outside = |window: &Window| {
        let mut window = window.clone();
        window.masked ^= first_bits(window.len);
        usable.exposed(&window)
    };
    let outside = Survey::of(image, outside, workspace)?;
    let is_empty = inside.is_none_or(|inside| {
        let ([brightness, ..], [outer, ..]) = (inside.deviations, outside.deviations);
        brightness < DARKER * outer || inside.largest_spread() < NOISES * inside.noise
    });
    (is_empty && outside.spans_space(NOISES)).then_some(frame)
}

/// The share of the pixels in the first and the last column that the mask leaves.
fn share_of_frame(image: &Image) -> f64 {
    let image = image.sample_rows();
    let (mut left, mut count) = (0, 0);
    let last = image.width().saturating_sub(1);
    image.for_each_window(|window| {
        for x in [0, last] {
            if (window.x..window.x + window.len).contains(&x) {
                count += 1;
                left += usize::from(window.masked >> (x - window.x) & 1 == 1);
            }
        }
    });
    share(left, count)
}
