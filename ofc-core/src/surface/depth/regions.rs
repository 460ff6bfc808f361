//! Connected regions and their means: union-find over the runs of each row, in arrays that the solution no longer needs.

use super::grid::Grid;
use super::operator::at;

/// Set in a root, whose lowest bits are the number of pixels in its sum; a word without it is a parent's index. Both fit, because
/// pictures have fewer than 2^29 pixels, and neither is zero.
const ROOT: u32 = 1 << 31;

/// Set in a root whose region holds a pixel of known depth: then only such pixels are in the sum.
const ANCHORED: u32 = 1 << 29;

/// Pixels of one row without a gap: the first and the one behind the last.
pub(super) type Run = [usize; 2];

/// The first run of a row that begins at `start` or behind: pixels whose word is not zero.
pub(super) fn next_run(row: &[u32], start: usize) -> Option<Run> {
    let rest = row.get(start..)?;
    let gap = rest.iter().position(|&word| word != 0)?;
    let rest = rest.get(gap..)?;
    let len = rest.iter().position(|&word| word == 0).unwrap_or(rest.len());
    Some([start + gap, start + gap + len])
}

/// Regions in the making: arrays in grid layout, of which only the first pixels of runs are used.
pub(super) struct Regions<'a> {
    pub grid: Grid,
    /// The words of pixels; the first one of a run that has been added is an index of a parent, or a root's count.
    pub words: &'a mut [u32],
    /// Sums of depths of roots, rounded.
    pub sums: &'a mut [f32],
    /// What the rounding took off the sums: both together are as good as f64.
    pub rests: &'a mut [f32],
    /// How many there are so far.
    pub count: usize,
}

/// What a run has to say to its region: the pixels whose mean is to be zero, and the sum of what they are now. Where a depth
/// is known that is what depth is beyond it, at all pixels of known depth.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Total {
    pub count: usize,
    pub sum: f64,
    /// Some depth in it is known.
    pub anchored: bool,
}

impl Regions<'_> {
    fn bits(&self, index: usize) -> u32 {
        at(self.words, index)
    }

    fn set_bits(&mut self, index: usize, bits: u32) {
        if let Some(slot) = self.words.get_mut(index) {
            *slot = bits;
        }
    }

    fn root(&mut self, mut index: usize) -> usize {
        for _ in 0..self.grid.len() {
            let parent = self.bits(index);
            if parent & ROOT != 0 {
                break;
            }
            let grandparent = self.bits(parent as usize);
            if grandparent & ROOT != 0 {
                return parent as usize;
            }
            self.set_bits(index, grandparent);
            index = grandparent as usize;
        }
        index
    }

    fn sum(&self, root: usize) -> f64 {
        f64::from(at(self.sums, root)) + f64::from(at(self.rests, root))
    }

    fn set_sum(&mut self, root: usize, sum: f64) {
        let large = sum as f32;
        if let (Some(slot), Some(rest)) = (self.sums.get_mut(root), self.rests.get_mut(root)) {
            *slot = large;
            *rest = (sum - f64::from(large)) as f32;
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        if a == b {
            return;
        }
        let (root, child) = (a.min(b), a.max(b));
        let (bits, child_bits) = (self.bits(root), self.bits(child));
        let (sum, child_sum) = (self.sum(root), self.sum(child));
        let (bits, sum) = match (bits & ANCHORED, child_bits & ANCHORED) {
            (ANCHORED, 0) => (bits, sum),
            (0, ANCHORED) => (child_bits, child_sum),
            _ => (bits + (child_bits & (ANCHORED - 1)), sum + child_sum),
        };
        self.set_bits(root, bits);
        self.set_sum(root, sum);
        // Indices fit: see MAX_PIXELS.
        self.set_bits(child, u32::try_from(root).unwrap_or(0));
        self.count -= 1;
    }

    /// Takes in row `y`, each run with what `total` says of it and of its words.
    pub fn add_row(&mut self, y: usize, total: impl Fn(Run, &[u32]) -> Total) {
        let grid = self.grid;
        let (start, start_above) = (grid.start(y), grid.start(y) - grid.stride());
        let mut above = next_run(grid.row_above(self.words, y), 0);
        let mut end = 0;
        while let Some(run) = next_run(grid.row(self.words, y), end) {
            let [from, to] = run;
            end = to;
            let words = grid.row(self.words, y).get(from..to).unwrap_or_default();
            let Total { count, sum, anchored } = total(run, words);
            let anchored = if anchored { ANCHORED } else { 0 };
            self.set_bits(start + from, ROOT | anchored | u32::try_from(count).unwrap_or(0));
            self.set_sum(start + from, sum);
            self.count += 1;
            while let Some([above_from, above_to]) = above {
                if above_from >= to {
                    break;
                }
                if above_to > from {
                    self.join(start + from, start_above + above_from);
                }
                if above_to > to {
                    break;
                }
                above = next_run(grid.row_above(self.words, y), above_to);
            }
        }
    }

    /// What to take off the run of row `y` that begins in column `x`.
    pub fn offset(&mut self, x: usize, y: usize) -> f64 {
        let root = self.root(self.grid.start(y) + x);
        let bits = self.bits(root);
        let count = bits & (ANCHORED - 1);
        if count == 0 { 0.0 } else { self.sum(root) / f64::from(count) }
    }
}

/// The sum in f64, in four lanes.
pub(super) fn sum(values: &[f32]) -> f64 {
    let mut lanes = [0.0_f64; 4];
    let (chunks, rest) = values.as_chunks::<4>();
    for chunk in chunks {
        for (lane, &value) in lanes.iter_mut().zip(chunk) {
            *lane += f64::from(value);
        }
    }
    for (lane, &value) in lanes.iter_mut().zip(rest) {
        *lane += f64::from(value);
    }
    lanes.iter().sum()
}
