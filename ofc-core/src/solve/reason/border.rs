//! A background that was taken for the object: what lies along the border of the pixels that are looked at has one color.

use super::finding::{Finding, Reason, share};
use super::survey::{SMOOTH, Survey};
use crate::math::select::{kth_smallest, median_rank};
use crate::picture::{Image, WINDOW, Window, for_each_bit};
use libm::sqrt;

/// Colors this near to the background's, as a share of it, are the background's: light falls off over a table.
const TOLERANCE: f64 = 0.08;
/// And those this many times the noise away.
const NOISES: f64 = 5.0;

/// The share of the border that has one color.
const BORDER: f64 = 0.7;
/// Colors that deviate by so many times the noise span space.
const SPAN: f64 = 3.0;

/// That a background of one color is counted as object: it makes the border, and what is left without it spans space.
///
/// # Scratch
/// One `f32` a pixel.
#[inline(never)]
pub(super) fn background(
    image: &Image,
    selected: impl Fn(&Window) -> u64,
    survey: &Survey,
    workspace: &mut [f32],
) -> Option<Finding> {
    let [brightness, ..] = survey.deviations;
    let background = Background::of(image, &selected, survey.noise, workspace)?;
    if survey.noise > SMOOTH * brightness || background.share_of_border < BORDER {
        return None;
    }
    let object = Survey::of(image, |window| background.others(window, selected(window)), workspace)?;
    let part = 1.0 - share(object.count, survey.count);
    object.spans_space(SPAN).then_some(Finding::of(Reason::Background, part, 0.0))
}

/// A color, and how far from it its pixels are at most.
#[derive(Clone, Copy, Debug)]
struct Background {
    color: [f64; 3],
    largest_distance: f64,
    /// The share of the pixels along the border that have it.
    pub share_of_border: f64,
}

impl Background {
    /// Of the first and the last selected pixel of each row of a sample of them; `None` without any.
    ///
    /// # Scratch
    /// As many `f32` as there are rows, twice.
    #[inline(never)]
    pub fn of(
        image: &Image,
        selected: impl Fn(&Window) -> u64,
        noise: f64,
        workspace: &mut [f32],
    ) -> Option<Self> {
        let image = &image.sample_rows();
        let mut color = [0.0; 3];
        for (channel, slot) in color.iter_mut().enumerate() {
            let mut count = 0;
            for_each_end(image, &selected, |pixel| {
                if let (Some(slot), Some(&value)) = (workspace.get_mut(count), pixel.get(channel)) {
                    *slot = value;
                    count += 1;
                }
            });
            let values = workspace.get_mut(..count).unwrap_or_default();
            *slot = f64::from(kth_smallest(values, median_rank(count))?);
        }
        let length = sqrt(color.iter().map(|value| value * value).sum());
        let largest_distance = TOLERANCE * length + NOISES * noise;
        let mut found = Self { color, largest_distance, share_of_border: 0.0 };
        let (mut count, mut inside) = (0_u32, 0_u32);
        for_each_end(image, &selected, |pixel| {
            count += 1;
            inside += u32::from(found.has(pixel));
        });
        found.share_of_border = f64::from(inside) / f64::from(count.max(1));
        Some(found)
    }

    /// Whether a color is the background's.
    pub fn has(&self, pixel: [f32; 3]) -> bool {
        let mut square = 0.0;
        for (value, own) in pixel.into_iter().zip(self.color) {
            square += (f64::from(value) - own) * (f64::from(value) - own);
        }
        square <= self.largest_distance * self.largest_distance
    }

    /// The bits of a window's pixels among `bits` that have another color.
    pub fn others(&self, window: &Window, mut bits: u64) -> u64 {
        for_each_bit(bits, |i| {
            if self.has(window.pixel(i)) {
                bits &= !(1 << i);
            }
        });
        bits
    }
}

/// The first and the last selected pixel of each row.
fn for_each_end(image: &Image, selected: &impl Fn(&Window) -> u64, mut visit: impl FnMut([f32; 3])) {
    let mut ends = None;
    let mut row = 0;
    let mut end = |ends: &mut Option<[[f32; 3]; 2]>| {
        for pixel in ends.take().into_iter().flatten() {
            visit(pixel);
        }
    };
    image.for_each_window(|window| {
        if window.y != row {
            end(&mut ends);
            row = window.y;
        }
        let bits = selected(window);
        if bits != 0 {
            let last = window.pixel(WINDOW - 1 - bits.leading_zeros() as usize);
            let first = ends.map_or_else(|| window.pixel(bits.trailing_zeros() as usize), |[first, _]| first);
            ends = Some([first, last]);
        }
    });
    end(&mut ends);
}
