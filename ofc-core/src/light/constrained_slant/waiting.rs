//! Boxes that wait for their turn, the last one first.

use super::cell::{Cell, Interval};

/// Boxes that wait: one for each time the first box is halved in each direction down to the finest (at most 66), and some.
pub(super) const MAX_WAITING: usize = 72;
/// `f32` that hold a box in a caller's room.
const CELL: usize = 3 * 2 * PARTS;
/// `f32` that hold all of them.
pub const ROOM: usize = MAX_WAITING * CELL;

/// Room for [`MAX_WAITING`] boxes.
pub(super) trait Waiting {
    /// Puts a box in; false where there is no room.
    fn put(&mut self, cell: Cell) -> bool;
    /// Takes the last one out.
    fn take(&mut self) -> Option<Cell>;
    /// Forgets all.
    fn forget(&mut self);
}

impl Waiting for heapless::Vec<Cell, MAX_WAITING> {
    fn put(&mut self, cell: Cell) -> bool {
        self.push(cell).is_ok()
    }

    fn take(&mut self) -> Option<Cell> {
        self.pop()
    }

    fn forget(&mut self) {
        self.clear();
    }
}

/// Boxes in room of the caller's, for those who have more of that than of stack.
pub(super) struct Lent<'a> {
    cells: &'a mut [[f32; CELL]],
    count: usize,
}

impl<'a> Lent<'a> {
    /// `None` for less than [`ROOM`].
    pub(super) fn new(room: &'a mut [f32]) -> Option<Self> {
        let (cells, _) = room.get_mut(..ROOM)?.as_chunks_mut::<CELL>();
        Some(Self { cells, count: 0 })
    }
}

impl Waiting for Lent<'_> {
    fn put(&mut self, cell: Cell) -> bool {
        let Some(slot) = self.cells.get_mut(self.count) else { return false };
        let (slot, _) = slot.as_chunks_mut::<PARTS>();
        for (slot, end) in slot.iter_mut().zip(cell.iter().flat_map(|side| side.ends())) {
            *slot = apart(end);
        }
        self.count += 1;
        true
    }

    fn take(&mut self) -> Option<Cell> {
        self.count = self.count.checked_sub(1)?;
        let (slot, _) = self.cells.get(self.count)?.as_chunks::<PARTS>();
        let mut ends = slot.iter().map(together);
        let mut side = || Some(Interval::between(ends.next()?, ends.next()?));
        Some([side()?, side()?, side()?])
    }

    fn forget(&mut self) {
        self.count = 0;
    }
}

/// `f32` that hold an f64.
const PARTS: usize = 3;
/// Bits in each: so many that every value is a whole number that an f32 holds exactly.
const BITS: u32 = 22;

fn apart(value: f64) -> [f32; PARTS] {
    let bits = value.to_bits();
    [0, 1, 2].map(|part| (bits >> (part * BITS) & ((1 << BITS) - 1)) as f32)
}

#[expect(clippy::cast_sign_loss, reason = "whole numbers from 0 on")]
fn together(parts: &[f32; PARTS]) -> f64 {
    let [low, middle, high] = parts.map(|part| part as u64);
    f64::from_bits(low | middle << BITS | high << (2 * BITS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    #[test]
    fn every_bit_comes_back() {
        let mut rng = Rng::new(9);
        for _ in 0..10_000 {
            let bits = rng.next_u64();
            assert_eq!(together(&apart(f64::from_bits(bits))).to_bits(), bits);
        }
    }

    #[test]
    fn both_kinds_of_room_behave_alike() {
        let mut room = [f32::NAN; ROOM];
        assert!(Lent::new(&mut [0.0; ROOM - 1]).is_none());
        let (mut lent, mut own) = (Lent::new(&mut room).unwrap(), heapless::Vec::<Cell, MAX_WAITING>::new());
        let mut rng = Rng::new(8);
        for step in 0..2000 {
            // Up to the brim, and down to nothing.
            if rng.below(100) < if step % 400 < 200 { 80 } else { 20 } {
                let cell = [(); 3].map(|()| Interval::between(rng.unit(), rng.unit()));
                assert_eq!(lent.put(cell), own.put(cell));
            } else {
                let ends = |cell: Option<Cell>| cell.map(|cell| cell.map(Interval::ends));
                assert_eq!(ends(lent.take()), ends(own.take()));
            }
        }
        lent.forget();
        assert!(lent.take().is_none());
    }
}
