//! A stratified sample of the usable pixels' colors.

use super::problem::Problem;
use crate::math::rng::Rng;
use crate::picture::{Colors, Image, for_each_bit};

impl Problem<'_, Image<'_>> {
    /// The colors of `len` usable pixels, one from each of equal parts of them, and the room behind; `None` where there is none.
    pub fn colors<'w>(&self, len: usize, workspace: &'w mut [f32]) -> Option<(Colors<'w>, &'w mut [f32])> {
        let (red, rest) = workspace.split_at_mut_checked(len)?;
        let (green, rest) = rest.split_at_mut_checked(len)?;
        let (blue, rest) = rest.split_at_mut_checked(len)?;
        let unscaled = Self { scale: 1.0, ..*self };
        unscaled.draw(&mut Rng::new(self.params.seed), len, [&mut *red, &mut *green, &mut *blue]);
        Some((Colors { channels: [red, green, blue], sample: self.pixels.sample() }, rest))
    }

    /// Writes the scaled color of one pixel from each of equal parts of the usable pixels in picture order, at a random place within it,
    /// as many as the channels hold: one color after the other into each stretch of `stretch` colors, so that each is spread over the
    /// picture; the whole length where there is one.
    pub fn draw(&self, rng: &mut Rng, stretch: usize, channels: [&mut [f32]; 3]) {
        let [red, green, blue] = channels;
        let len = red.len();
        let mut stratum = |i: usize| {
            let border = |i: usize| (self.count as u64 * i as u64).checked_div(len as u64).unwrap_or(0);
            border(i) as usize + rng.below((border(i + 1) - border(i)) as u32) as usize
        };
        let (mut taken, mut slot, mut seen) = (0, 0, 0);
        let mut wanted = stratum(0);
        self.pixels.for_each_window(|window| {
            let bits = self.usable.bits(window);
            let end = seen + bits.count_ones() as usize;
            if wanted < end && taken < len {
                let mut number = seen;
                for_each_bit(bits, |i| {
                    if number == wanted && taken < len {
                        if let (Some(r), Some(g), Some(b)) =
                            (red.get_mut(slot), green.get_mut(slot), blue.get_mut(slot))
                        {
                            [*r, *g, *b] = window.pixel(i).map(|c| (f64::from(c) * self.scale) as f32);
                        }
                        (taken, slot) = (taken + 1, slot + stretch);
                        if slot >= len {
                            slot = slot + 1 - len;
                        }
                        if taken < len {
                            wanted = stratum(taken);
                        }
                    }
                    number += 1;
                });
            }
            seen = end;
        });
    }
}
