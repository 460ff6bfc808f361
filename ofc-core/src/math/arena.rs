//! Typed slices cut out of the memory that a caller lends.
//!
//! A stage says what it takes as [`Need`]; whoever owns the bytes makes an [`Arena`] of them, doubles first, and the stage
//! cuts its slices off. What a slice holds before it is written does not matter.

/// How many numbers of each type a stage takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Need {
    /// `f64`.
    pub doubles: usize,
    /// `f32`.
    pub singles: usize,
    /// `u32`.
    pub integers: usize,
}

impl Need {
    /// Single-precision numbers alone.
    #[must_use]
    pub const fn of_singles(singles: usize) -> Self {
        Self { doubles: 0, singles, integers: 0 }
    }

    /// Bytes of all of them, in the order doubles, singles, integers without gaps; `usize::MAX` where that does not fit.
    #[must_use]
    pub const fn bytes(self) -> usize {
        let words = self.singles.saturating_add(self.integers);
        words.saturating_mul(size_of::<f32>()).saturating_add(self.doubles.saturating_mul(size_of::<f64>()))
    }
}

/// Memory that has not been cut off yet.
#[derive(Debug, Default)]
pub struct Arena<'w> {
    doubles: &'w mut [f64],
    singles: &'w mut [f32],
    integers: &'w mut [u32],
}

impl<'w> Arena<'w> {
    /// Of these slices.
    #[must_use]
    pub const fn new(doubles: &'w mut [f64], singles: &'w mut [f32], integers: &'w mut [u32]) -> Self {
        Self { doubles, singles, integers }
    }

    /// Whether so much is left.
    #[must_use]
    pub const fn holds(&self, need: Need) -> bool {
        self.doubles.len() >= need.doubles
            && self.singles.len() >= need.singles
            && self.integers.len() >= need.integers
    }

    /// Cuts off `count` doubles; `None` where fewer are left.
    pub fn doubles(&mut self, count: usize) -> Option<&'w mut [f64]> {
        cut(&mut self.doubles, count)
    }

    /// Cuts off `count` single-precision numbers; `None` where fewer are left.
    pub fn singles(&mut self, count: usize) -> Option<&'w mut [f32]> {
        cut(&mut self.singles, count)
    }

    /// Cuts off `count` integers; `None` where fewer are left.
    pub fn integers(&mut self, count: usize) -> Option<&'w mut [u32]> {
        cut(&mut self.integers, count)
    }
}

#[expect(clippy::mut_mut, reason = "what is left goes back to where it came from")]
fn cut<'w, T>(rest: &mut &'w mut [T], count: usize) -> Option<&'w mut [T]> {
    rest.split_off_mut(..count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_do_not_overlap_and_end_where_the_memory_does() {
        let (mut doubles, mut singles, mut integers) = ([0.0; 3], [0.0; 4], [0; 2]);
        let mut arena = Arena::new(&mut doubles, &mut singles, &mut integers);
        assert!(arena.holds(Need { doubles: 3, singles: 4, integers: 2 }));
        assert!(!arena.holds(Need { doubles: 3, singles: 5, integers: 2 }));
        let (first, second) = (arena.singles(1).unwrap(), arena.singles(3).unwrap());
        first.fill(1.0);
        second.fill(2.0);
        assert_eq!((arena.singles(1), arena.singles(0).map(|s| s.len())), (None, Some(0)));
        arena.integers(2).unwrap().fill(7);
        arena.doubles(3).unwrap().fill(3.0);
        assert_eq!((doubles, singles, integers), ([3.0; 3], [1.0, 2.0, 2.0, 2.0], [7; 2]));
    }

    #[test]
    fn bytes_never_wrap_around() {
        assert_eq!(Need { doubles: 1, singles: 2, integers: 3 }.bytes(), 28);
        assert_eq!(Need::of_singles(usize::MAX).bytes(), usize::MAX);
    }
}
