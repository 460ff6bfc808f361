//! Connected regions and their means: union-find over the runs of each row, in arrays that the solution no longer needs.

use super::grid::Grid;
use super::operator::at;

/// A parent's index, or, in a root, the number of pixels behind this bit. Neither can look like a NaN, because
/// pictures have fewer than 2^29 pixels: moving the bits about as a float is safe on every machine.
const ROOT: u32 = 1 << 31;

/// Set in a root whose region holds a pixel of known depth.
const ANCHORED: u32 = 1 << 29;

/// Regions in the making: three arrays in grid layout.
pub(super) struct Regions<'a> {
    pub grid: Grid,
    /// Indices of parents, or counts of roots, as bits.
    pub parents: &'a mut [f32],
    /// Sums of depths of roots, the large part.
    pub sums: &'a mut [f32],
    /// What the large part rounds away.
    pub rests: &'a mut [f32],
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

    fn add(&mut self, root: usize, count: u32, anchored: u32, value: f64) {
        let bits = self.bits(root);
        self.set_bits(root, (bits + count) | anchored);
        let sum = self.sum(root) + value;
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
        let bits = self.bits(child);
        let sum = self.sum(child);
        self.add(root, bits & (ANCHORED - 1), bits & ANCHORED, sum);
        // Indices fit: see MAX_PIXELS.
        self.set_bits(child, child_bits(root));
    }

    /// Takes in row `y`: `inside` says which pixels there are, `counted` which of them make up the mean, `anchored`
    /// which of them have a known depth.
    pub fn add_row(
        &mut self,
        y: usize,
        inside: &[f32],
        depth: &[f32],
        counted: impl Iterator<Item = bool>,
        anchored: impl Fn(f32) -> bool,
    ) {
        let start = self.grid.start(y);
        let (width, stride) = (self.grid.width, self.grid.stride());
        let (mut run, mut run_above, mut joined) = (None, None, false);
        let mut total = Total::default();
        for (x, counted) in counted.take(width).chain(core::iter::once(false)).enumerate() {
            let index = start + x;
            let here = at(inside, index);
            if here == 0.0 || x == width {
                if let Some(first) = run.take() {
                    let root = self.root(first);
                    self.add(root, total.count, total.anchored, total.sum());
                    total = Total::default();
                }
                joined = false;
            } else if run.is_none() {
                run = Some(index);
                self.set_bits(index, ROOT);
            }
            if at(inside, index - stride) == 0.0 {
                run_above = None;
                joined = false;
            } else if run_above.is_none() {
                run_above = Some(index - stride);
            }
            if let (Some(first), Some(above)) = (run, run_above)
                && !joined
            {
                self.join(first, above);
                joined = true;
            }
            if run.is_some() && counted {
                total.add(x, at(depth, x));
            }
            if run.is_some() && anchored(here) {
                total.anchored = ANCHORED;
            }
        }
    }

    /// The number of regions.
    pub fn count(&self) -> usize {
        (0..self.grid.height)
            .map(|y| self.grid.row(self.parents, y).iter().filter(|v| v.to_bits() & ROOT != 0).count())
            .sum()
    }

    /// What to take off the run that begins at `index`.
    pub fn offset(&mut self, index: usize) -> f64 {
        let root = self.root(index);
        let bits = self.bits(root);
        let count = bits & (ANCHORED - 1);
        if bits & ANCHORED != 0 || count == 0 { 0.0 } else { self.sum(root) / f64::from(count) }
    }
}

fn child_bits(root: usize) -> u32 {
    u32::try_from(root).unwrap_or(0) & !ROOT
}

/// The pixels of a run.
#[derive(Default)]
struct Total {
    lanes: [f64; 4],
    count: u32,
    anchored: u32,
}

impl Total {
    fn add(&mut self, x: usize, value: f32) {
        if let Some(lane) = self.lanes.get_mut(x % 4) {
            *lane += f64::from(value);
        }
        self.count += 1;
    }

    fn sum(&self) -> f64 {
        self.lanes.iter().sum()
    }
}
