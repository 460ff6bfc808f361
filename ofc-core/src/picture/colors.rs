//! Colors of pixels from anywhere, as pixels without neighbors.

use super::layout::Sample;
use super::pixels::Pixels;
use super::window::{WINDOW, Window, first_bits};

/// Colors, channels apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Colors<'a> {
    /// The channels r, g, b, of one length.
    pub channels: [&'a [f32]; 3],
    /// How samples were stored.
    pub sample: Sample,
}

/// Channels in stretches as long as a window, and last what is left of them. (Chunks of any length, side by side, would leave a
/// division by it, which panics.)
pub(crate) fn stretches(channels: [&[f32]; 3]) -> impl Iterator<Item = [&[f32]; 3]> {
    let [(red, red_rest), (green, green_rest), (blue, blue_rest)] =
        channels.map(|channel| channel.as_chunks::<WINDOW>());
    let whole = red.iter().zip(green).zip(blue).map(|((r, g), b)| [r.as_slice(), g.as_slice(), b.as_slice()]);
    whole.chain(core::iter::once([red_rest, green_rest, blue_rest]))
}

impl Pixels for Colors<'_> {
    fn for_each_window(&self, mut visit: impl FnMut(&Window)) {
        let mut window = Window::new();
        for start in (0..self.len()).step_by(WINDOW) {
            window.len = (self.len() - start).min(WINDOW);
            window.x = start;
            window.masked = first_bits(window.len);
            for (out, channel) in window.color.iter_mut().zip(self.channels) {
                for (out, value) in out.iter_mut().zip(channel.get(start..).unwrap_or_default()) {
                    *out = *value;
                }
            }
            visit(&window);
        }
    }

    fn sample(&self) -> Sample {
        self.sample
    }

    fn len(&self) -> usize {
        self.channels.first().map_or(0, |channel| channel.len())
    }
}
