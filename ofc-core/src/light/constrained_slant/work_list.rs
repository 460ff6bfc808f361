//! Boxes that branch and bound has yet to look at, the last one first.

use super::cell::{Cell, Interval};

/// Boxes at most: one for each time the first box is halved in each direction down to the finest (66), and some.
const CAPACITY: usize = 72;
/// `f64` that hold a box: both ends of its three sides.
const ENDS: usize = 6;
/// How many `f64` a list takes.
pub const WORKSPACE_LEN: usize = CAPACITY * ENDS;

/// A stack of boxes in a workspace.
pub(super) struct WorkList<'w> {
    boxes: &'w mut [[f64; ENDS]],
    len: usize,
}

impl<'w> WorkList<'w> {
    /// An empty list; `None` for a workspace shorter than [`WORKSPACE_LEN`].
    pub(super) fn new(workspace: &'w mut [f64]) -> Option<Self> {
        let (boxes, _) = workspace.get_mut(..WORKSPACE_LEN)?.as_chunks_mut();
        Some(Self { boxes, len: 0 })
    }

    /// Puts a box on top; false where there is no room for it.
    pub(super) fn push(&mut self, [a, b, c]: Cell) -> bool {
        let Some(slot) = self.boxes.get_mut(self.len) else { return false };
        let ([a, b], [c, d], [e, f]) = (a.ends(), b.ends(), c.ends());
        *slot = [a, b, c, d, e, f];
        self.len += 1;
        true
    }

    /// Takes the box on top.
    pub(super) fn pop(&mut self) -> Option<Cell> {
        self.len = self.len.checked_sub(1)?;
        let &[a, b, c, d, e, f] = self.boxes.get(self.len)?;
        Some([Interval::between(a, b), Interval::between(c, d), Interval::between(e, f)])
    }

    /// Takes all boxes off.
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use std::vec::Vec;

    #[test]
    fn a_list_is_a_stack_of_its_capacity() {
        let mut workspace = [f64::NAN; WORKSPACE_LEN];
        assert!(WorkList::new(&mut [0.0; WORKSPACE_LEN - 1]).is_none());
        let (mut list, mut stack) = (WorkList::new(&mut workspace).unwrap(), Vec::new());
        let mut rng = Rng::new(8);
        let (mut refused, mut emptied) = (0, 0);
        for step in 0..2000 {
            // Up to the brim, and down to nothing.
            if rng.below(100) < if step % 400 < 200 { 80 } else { 20 } {
                let cell = [(); 3].map(|()| Interval::between(rng.unit(), rng.unit()));
                let has_room = stack.len() < CAPACITY;
                assert_eq!(list.push(cell), has_room);
                if has_room {
                    stack.push(cell.map(Interval::ends));
                } else {
                    refused += 1;
                }
            } else {
                let cell = stack.pop();
                emptied += u32::from(cell.is_none());
                assert_eq!(list.pop().map(|cell| cell.map(Interval::ends)), cell);
            }
        }
        assert!(refused > 0 && emptied > 0, "{refused} {emptied}");
        assert!(list.push([Interval::between(0.0, 1.0); 3]));
        list.clear();
        assert!(list.pop().is_none());
    }
}
