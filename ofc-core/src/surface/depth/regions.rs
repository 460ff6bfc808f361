//! Connected regions and their means: union-find over the runs of each row, in arrays that the solution no longer needs.

use super::grid::Grid;
use super::operator::at;

/// A parent's index, or, in a root, the number of pixels behind this bit. Neither can look like a NaN, because
/// pictures have fewer than 2^29 pixels: moving the bits about as a float is safe on every machine.
const ROOT: u32 = 1 << 31;

/// Set in a root whose region holds a pixel of known depth.
const ANCHORED: u32 = 1 << 29;

/// Pixels of one row without a gap: the first and the one behind the last.
pub(super) type Run = [usize; 2];

/// The runs of a row: pixels that are not zero.
#[derive(Clone)]
pub(super) struct Runs<'a> {
    row: &'a [f32],
    end: usize,
}

impl<'a> Runs<'a> {
    pub const fn new(row: &'a [f32]) -> Self {
        Self { row, end: 0 }
    }
}

impl Iterator for Runs<'_> {
    type Item = Run;

    fn next(&mut self) -> Option<Run> {
        let rest = self.row.get(self.end..)?;
        let gap = rest.iter().position(|&v| v != 0.0)?;
        let rest = rest.get(gap..)?;
        let len = rest.iter().position(|&v| v == 0.0).unwrap_or(rest.len());
        let start = self.end + gap;
        self.end = start + len;
        Some([start, self.end])
    }
}

/// Regions in the making: three arrays in grid layout, of which only the first pixels of runs are used.
pub(super) struct Regions<'a> {
    pub grid: Grid,
    /// Indices of parents, or counts of roots, as bits.
    pub parents: &'a mut [f32],
    /// Sums of depths of roots, the large part.
    pub sums: &'a mut [f32],
    /// What the large part rounds away.
    pub rests: &'a mut [f32],
    /// How many there are so far.
    pub count: usize,
}

/// What a run has to say to its region.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Total {
    pub count: usize,
    pub sum: f64,
    /// Some depth in it is known.
    pub anchored: bool,
}

impl Regions<'_> {
    fn bits(&self, index: usize) -> u32 {
        at(self.parents, index).to_bits()
    }

    fn set_bits(&mut self, index: usize, bits: u32) {
        if let Some(slot) = self.parents.get_mut(index) {
            *slot = f32::from_bits(bits);
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
        let anchored = (bits | child_bits) & ANCHORED;
        let count = (bits & (ANCHORED - 1)) + (child_bits & (ANCHORED - 1));
        self.set_bits(root, ROOT | anchored | count);
        self.set_sum(root, self.sum(root) + self.sum(child));
        // Indices fit: see MAX_PIXELS.
        self.set_bits(child, u32::try_from(root).unwrap_or(0));
        self.count -= 1;
    }

    /// Takes in row `y` of `inside`, each run with what `total` says of it.
    pub fn add_row(&mut self, y: usize, inside: &[f32], total: impl Fn(Run) -> Total) {
        let grid = self.grid;
        let (start, start_above) = (grid.start(y), grid.start(y) - grid.stride());
        let mut above_runs = Runs::new(grid.row_above(inside, y));
        let mut above = above_runs.next();
        for run in Runs::new(grid.row(inside, y)) {
            let [from, to] = run;
            let Total { count, sum, anchored } = total(run);
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
                above = above_runs.next();
            }
        }
    }

    /// What to take off the run of row `y` that begins in column `x`.
    pub fn offset(&mut self, x: usize, y: usize) -> f64 {
        let root = self.root(self.grid.start(y) + x);
        let bits = self.bits(root);
        let count = bits & (ANCHORED - 1);
        if bits & ANCHORED != 0 || count == 0 { 0.0 } else { self.sum(root) / f64::from(count) }
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
