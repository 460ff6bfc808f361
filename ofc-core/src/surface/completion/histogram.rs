//! Medians of many numbers, to a few thousandths of their range.

const BINS: usize = 512;

/// How many numbers lie in each part of a range.
#[derive(Debug)]
pub(super) struct Histogram {
    counts: [u32; BINS],
    low: f32,
    scale: f32,
    count: u32,
}

impl Histogram {
    /// Of no numbers yet.
    pub fn over(low: f32, high: f32) -> Self {
        Self { counts: [0; BINS], low, scale: BINS as f32 / (high - low), count: 0 }
    }

    /// Numbers beyond the range are counted at its ends.
    pub fn add(&mut self, value: f32) {
        let bin = ((value - self.low) * self.scale).clamp(0.0, BINS as f32 - 1.0);
        #[expect(clippy::cast_sign_loss, reason = "limited to 0 and more")]
        if let Some(count) = self.counts.get_mut(bin as usize) {
            *count = count.saturating_add(1);
            self.count = self.count.saturating_add(1);
        }
    }

    pub const fn count(&self) -> u32 {
        self.count
    }

    /// `None` of no numbers.
    pub fn median(&self) -> Option<f32> {
        let mut before = 0;
        for (bin, &count) in self.counts.iter().enumerate() {
            before += count;
            if 2 * u64::from(before) > u64::from(self.count) {
                return Some(self.low + (bin as f32 + 0.5) / self.scale);
            }
        }
        None
    }
}
