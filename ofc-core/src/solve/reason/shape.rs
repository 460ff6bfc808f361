//! Lights and surfaces that span less than space.

use super::falloff::Falloff;
use super::finding::{Finding, Reason, share};
use super::survey::{SMOOTH, Survey};
use crate::picture::{Image, Window};

/// Deviations of so many times the noise are none.
const NOISES: f64 = 2.0;
/// Of the change of the colors in the picture, at most so much is across the direction in which they change most.
const ACROSS: f64 = 0.05;
/// A vignette explains so much of the variance of the brightness,
const EXPLAINED: f64 = 0.9;
/// and lies over this much of the picture.
const WHOLE: f64 = 0.95;

/// That the surface is flat, all colors are of one hue, the surface bends in one direction, or there are two lights.
pub(super) fn degenerate(
    image: &Image,
    selected: impl Fn(&Window) -> u64,
    survey: &Survey,
) -> Option<Finding> {
    let [brightness, second, third] = survey.deviations.map(|deviation| deviation / survey.noise);
    if SMOOTH * brightness < 1.0 {
        return None;
    }
    if let Some(flat) = Finding::below(Reason::Flat, survey.largest_spread() / survey.noise, NOISES) {
        return Some(flat);
    }
    if let Some(gray) = Finding::below(Reason::Gray, second, NOISES) {
        let is_whole = share(survey.count, image.width() * image.height()) > WHOLE;
        let falloff = if is_whole { Falloff::of(image, selected, survey.noise) } else { None };
        let vignette = falloff
            .filter(|falloff| falloff.left_at_corners < 1.0)
            .and_then(|falloff| Finding::above(Reason::Vignette, falloff.explained, EXPLAINED));
        return vignette.or(Some(gray));
    }
    let [along, across] = survey.change;
    let bends = along > survey.noise * survey.noise;
    Finding::below(Reason::Cylinder, across / along.max(f64::MIN_POSITIVE), ACROSS)
        .filter(|_| bends)
        .or_else(|| Finding::below(Reason::TooFewLights, third, NOISES))
}
