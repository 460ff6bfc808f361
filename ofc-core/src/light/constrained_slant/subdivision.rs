//! Branch and bound: boxes are narrowed and halved until they hold no solution of eqs. 24 or are small.

use super::Constraints;
use super::cell::{Cell, Frame, Interval, half_width, halves};
use super::work_list::WorkList;
use crate::math::mat3;

/// Boxes looked at. Random lights need 120 on average; it is thousands when lights are nearly in one plane.
pub(super) const MAX_BOXES: usize = 30_000;

/// The boxes of one search.
pub(super) struct Subdivision<'s, 'w> {
    frame: Frame<'s>,
    smallest: f64,
    work_list: &'s mut WorkList<'w>,
    next: Option<Cell>,
    seen: usize,
    is_complete: bool,
}

impl<'s, 'w> Subdivision<'s, 'w> {
    /// Of all slants, into boxes of half-width `smallest` at least.
    pub(super) fn new(constraints: &'s Constraints, smallest: f64, work_list: &'s mut WorkList<'w>) -> Self {
        let frame = Frame::new(constraints);
        work_list.clear();
        let next = Some(frame.everything());
        Self { frame, smallest, work_list, next, seen: 0, is_complete: false }
    }

    /// The slants in the middle of the next box that is not divided further; `None` when there is none, or boxes are too many.
    // The stack it takes is given back before Newton's method starts from a leaf.
    #[inline(never)]
    pub(super) fn next_leaf(&mut self) -> Option<[f64; 3]> {
        while self.seen < MAX_BOXES {
            self.seen += 1;
            let Some(cell) = self.next else {
                self.is_complete = true;
                return None;
            };
            self.next = match self.frame.narrow(cell) {
                None => self.work_list.pop(),
                Some(narrowed) if half_width(narrowed) <= self.smallest => {
                    self.next = self.work_list.pop();
                    return Some(mat3::apply(&self.frame.axes, narrowed.map(Interval::middle)));
                }
                Some(narrowed) if half_width(narrowed) <= 0.5 * half_width(cell) => Some(narrowed),
                Some(narrowed) => {
                    let (low, high) = halves(narrowed);
                    if !self.work_list.push(high) {
                        return None;
                    }
                    Some(low)
                }
            };
        }
        None
    }

    /// Whether all slants have been looked at.
    pub(super) const fn is_complete(&self) -> bool {
        self.is_complete
    }
}
