//! The picture while it is being divided: a label and a color for every pixel, and a queue of pixels.

/// Labels while the work is going on: a pixel that can still be taken, one that no region may begin at again, and one
/// that cannot be used at all. The last two are above every region's label, and zero in the end.
pub(super) const FREE: u16 = 0;
pub(super) const TRIED: u16 = u16::MAX;
pub(super) const UNUSABLE: u16 = u16::MAX - 1;

/// The picture while it is being divided.
pub(super) struct Field<'a> {
    pub(super) width: usize,
    pub(super) labels: &'a mut [u16],
    /// Scaled so that the largest value is about 1; those of unusable pixels mean nothing.
    pub(super) colors: &'a [[f32; 3]],
    /// Room for every pixel once.
    pub(super) queue: &'a mut [u32],
}

impl Field<'_> {
    /// Label and color of a pixel; `None` outside the picture.
    pub(super) fn at(&self, x: usize, y: usize) -> Option<(u16, [f32; 3])> {
        if x >= self.width {
            return None;
        }
        let index = y.checked_mul(self.width)?.checked_add(x)?;
        Some((*self.labels.get(index)?, *self.colors.get(index)?))
    }

    /// Fills the queue with the free pixels, and returns how many there are.
    pub(super) fn gather_free(&mut self) -> usize {
        let mut count = 0;
        for (index, &label) in self.labels.iter().enumerate() {
            if label == FREE {
                if let Some(slot) = self.queue.get_mut(count) {
                    *slot = index as u32;
                }
                count += 1;
            }
        }
        count
    }

    /// Gives the pixels of a region, the first `pixels` of the queue, another label.
    pub(super) fn relabel(&mut self, pixels: usize, label: u16) {
        for &index in self.queue.iter().take(pixels) {
            if let Some(slot) = self.labels.get_mut(index as usize) {
                *slot = label;
            }
        }
    }
}
