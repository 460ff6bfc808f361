//! A set of cells, a bit each, that shrinks and grows by whole rows.

use super::grid::MOST_ALONG;

/// The words of a row.
const WORDS: usize = MOST_ALONG.div_ceil(u32::BITS as usize);

/// The bits of a row of cells.
pub type Row = [u32; WORDS];

/// Whether the bit of the cell in this column is set.
pub(crate) fn is_set(row: &Row, x: usize) -> bool {
    row.get(x / 32).is_some_and(|word| word >> (x % 32) & 1 == 1)
}

/// The bits of these cells.
fn row(mut cells: impl Iterator<Item = bool>) -> Row {
    [0; WORDS].map(|_: u32| {
        let bits = cells.by_ref().take(32).enumerate();
        bits.fold(0, |word, (i, cell)| word | u32::from(cell) << i)
    })
}

/// A row, and the cells beside those that are set.
pub(crate) fn wider(row: &Row) -> Row {
    with_both_beside(row, |here, left, right| here | left | right)
}

/// The cells of a row that are set together with both beside them.
pub(crate) fn narrower(row: &Row) -> Row {
    with_both_beside(row, |here, left, right| here & left & right)
}

/// What becomes of each word, and the words that hold its cells' neighbors.
fn with_both_beside(row: &Row, of: impl Fn(u32, u32, u32) -> u32) -> Row {
    let mut changed = *row;
    let (mut before, mut after) = (0, row.iter().skip(1));
    for word in &mut changed {
        let here = *word;
        let next = after.next().copied().unwrap_or(0);
        *word = of(here, here << 1 | before >> 31, here >> 1 | next << 31);
        before = here;
    }
    changed
}

/// The set, in memory of one word a cell: three rows of bits to a row of cells, which are what the set is, what it becomes, and what is kept.
pub(super) struct BitRows<'m> {
    memory: &'m mut [u32],
    width: usize,
    height: usize,
    /// The cells of a row.
    all: Row,
}

impl<'m> BitRows<'m> {
    pub fn new(memory: &'m mut [u32], width: usize, height: usize) -> Self {
        memory.fill(0);
        Self { memory, width, height, all: row((0..width).map(|_| true)) }
    }

    fn read(&self, place: usize, y: usize) -> Row {
        let words = self.memory.get(y * self.width + place * WORDS..).and_then(<[u32]>::first_chunk);
        words.copied().unwrap_or_default()
    }

    fn write(&mut self, place: usize, y: usize, row: Row) {
        let words = self.memory.get_mut(y * self.width + place * WORDS..);
        if let Some(words) = words.and_then(<[u32]>::first_chunk_mut) {
            *words = row;
        }
    }

    /// Sets a row, cell by cell.
    pub fn set(&mut self, y: usize, cells: impl Iterator<Item = bool>) {
        self.write(0, y, row(cells));
    }

    /// A row of the set.
    pub fn get(&self, y: usize) -> Row {
        self.read(0, y)
    }

    /// Keeps the set as it is.
    pub fn keep(&mut self) {
        for y in 0..self.height {
            let row = self.get(y);
            self.write(2, y, row);
        }
    }

    /// A row of the set that was kept.
    pub fn kept(&self, y: usize) -> Row {
        self.read(2, y)
    }

    /// Adds the cells within so many rows and columns.
    pub fn grow(&mut self, radius: usize) {
        for y in 0..self.height {
            let row = (0..radius).fold(self.get(y), |row, _| wider(&row));
            self.write(1, y, row);
        }
        for y in 0..self.height {
            let mut sum = [0; WORDS];
            for near in y.saturating_sub(radius)..(y + radius + 1).min(self.height) {
                sum.iter_mut().zip(self.read(1, near)).for_each(|(sum, word)| *sum |= word);
            }
            sum.iter_mut().zip(self.all).for_each(|(sum, all)| *sum &= all);
            self.write(0, y, sum);
        }
    }

    /// Takes away the cells within so many rows and columns of one that is not set.
    pub fn shrink(&mut self, radius: usize) {
        self.invert();
        self.grow(radius);
        self.invert();
    }

    fn invert(&mut self) {
        for y in 0..self.height {
            let mut row = self.get(y);
            row.iter_mut().zip(self.all).for_each(|(word, all)| *word = !*word & all);
            self.write(0, y, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use std::vec::Vec;

    #[test]
    fn cells_within_a_radius_are_added_or_taken_away() {
        for (width, height) in [(32, 40), (70, 33), (239, 35)] {
            let mut rng = Rng::new(width as u64);
            for (radius, grows) in [(1, true), (5, true), (1, false), (2, false)] {
                let rare = if grows { 40 } else { 10 };
                let set: Vec<bool> = (0..width * height).map(|_| (rng.below(rare) == 0) == grows).collect();
                let mut memory: Vec<u32> = (0..width * height).map(|_| 7).collect();
                let mut rows = BitRows::new(&mut memory, width, height);
                for y in 0..height {
                    rows.set(y, set[y * width..(y + 1) * width].iter().copied());
                }
                rows.keep();
                if grows {
                    rows.grow(radius);
                } else {
                    rows.shrink(radius);
                }
                for y in 0..height {
                    for x in 0..width {
                        let mut near =
                            (y.saturating_sub(radius)..(y + radius + 1).min(height)).flat_map(|y| {
                                (x.saturating_sub(radius)..(x + radius + 1).min(width))
                                    .map(move |x| y * width + x)
                            });
                        let expected = if grows { near.any(|i| set[i]) } else { near.all(|i| set[i]) };
                        assert_eq!(is_set(&rows.get(y), x), expected, "{width} {radius} {grows} {x} {y}");
                        assert_eq!(is_set(&rows.kept(y), x), set[y * width + x]);
                    }
                }
            }
        }
    }
}
