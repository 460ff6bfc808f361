//! The last passes of a cold start with the joint method, and what a frame makes of its answer.

use super::kept_row::keep_window;
use super::memory::{Memory, rows_len};
use super::pass::Pass;
use super::state::{Held, State};
use crate::math::mat3::{self, Mat3};
use crate::orientation::joint::{CellSums, Joint, STRIP};
use crate::picture::{Image, Window};
use crate::solve::Oriented;

impl State {
    pub(super) fn begin_outward(&mut self, memory: &mut Memory) {
        let room = memory.values.len().saturating_sub(rows_len(self.width));
        let sums = CellSums::begin(self.width, self.height, room, memory.values);
        self.held = sums.map_or(Held::Nothing, Held::CellSums);
        self.inlier_count = 0;
    }

    #[inline(never)]
    pub(super) fn row_outward(&mut self, y: usize, row: &Image, memory: &mut Memory) {
        let inliers = &self.solution.inliers;
        let kept = memory.values.len().saturating_sub(rows_len(self.width));
        let Some((numbers, rows)) = memory.values.split_at_mut_checked(kept) else { return };
        let above = y % STRIP;
        row.for_each_window(|window| {
            let exposed = inliers.usable.exposed(window);
            let bits = inliers.bits_among(window, exposed);
            self.inlier_count += bits.count_ones() as usize;
            let Held::CellSums(sums) = &mut self.held else { return };
            sums.see(window.x, y, exposed);
            if above + 1 < STRIP {
                let row = rows.get_mut(above * 3 * self.width..).unwrap_or_default();
                keep_window(self.width, window, bits, row);
            } else if let Some(ellipsoid) = &self.solution.ellipsoid {
                let strip = Strip { width: self.width, above: rows, last: window };
                let at = [window.x, y - above];
                let color = |row, i| strip.color(row, i);
                sums.add(at, window.len, strip.bits(bits), &ellipsoid.root, color, numbers);
            }
        });
    }

    #[inline(never)]
    pub(super) fn end_outward(&mut self, memory: &mut Memory) {
        self.solution.inlier_count = self.inlier_count;
        let Held::CellSums(sums) = self.held else { return self.go_on(true, Pass::Tilts) };
        let joint = sums.end(memory.values);
        if self.orient_jointly(joint) {
            return self.go_on(false, Pass::Tilts);
        }
        let window_sums = sums.window_sums(memory.values);
        let next = if window_sums.is_some() { Pass::Integrability } else { Pass::Tilts };
        self.held = window_sums.map_or(Held::Nothing, Held::WindowSums);
        self.go_on(true, next);
    }

    /// Ends with this transformation, if there is one; whether there is.
    fn orient_jointly(&mut self, joint: Option<Joint>) -> bool {
        let (Some(joint), Some(ellipsoid)) = (joint, &self.solution.ellipsoid) else { return false };
        let oriented = Oriented::jointly(joint, ellipsoid, self.params.solve.rank_threshold);
        self.solution.take_orientation(Ok(oriented));
        true
    }

    pub(super) fn begin_integrability(&mut self, memory: &mut Memory) {
        if let Held::WindowSums(window_sums) = &self.held {
            window_sums.begin(memory.values);
        }
    }

    #[inline(never)]
    pub(super) fn row_integrability(&mut self, y: usize, row: &Image, memory: &mut Memory) {
        let inliers = &self.solution.inliers;
        if let (Held::WindowSums(window_sums), Some(ellipsoid)) = (&self.held, &self.solution.ellipsoid) {
            window_sums.add(y, row, inliers, &ellipsoid.root, memory.values);
        }
    }

    #[inline(never)]
    pub(super) fn end_integrability(&mut self, memory: &mut Memory) {
        let joint = match &self.held {
            Held::WindowSums(window_sums) => window_sums.end(memory.values),
            _ => None,
        };
        let is_oriented = self.orient_jointly(joint);
        self.go_on(!is_oriented, Pass::Tilts);
    }
}

/// The windows of four rows, one below the other: three that are kept, and the last.
struct Strip<'a> {
    width: usize,
    above: &'a [f32],
    last: &'a Window,
}

impl Strip<'_> {
    fn color(&self, row: usize, i: usize) -> [f32; 3] {
        if row + 1 == STRIP {
            return self.last.pixel(i);
        }
        let x = self.last.x + i;
        [0, 1, 2].map(|channel| {
            let at = (3 * row + channel) * self.width + x;
            self.above.get(at).copied().unwrap_or(f32::NAN)
        })
    }

    /// Which pixels of the rows above are inliers, and those of the last one.
    fn bits(&self, last: u64) -> [u64; STRIP] {
        let mut bits = [last; STRIP];
        for (row, bits) in bits.iter_mut().enumerate().take(STRIP - 1) {
            *bits = 0;
            for i in 0..self.last.len {
                let [red, ..] = self.color(row, i);
                *bits |= u64::from(!red.is_nan()) << i;
            }
        }
        bits
    }
}

/// The transformation of the normals under another root of C, whose inverse is given, that makes F nearest to an old one: of
/// all orthogonal ones that which turns the new normals least from the old ones, where these look in all directions alike.
#[inline(never)]
pub(super) fn nearest_rows(f_inverse: &Mat3, root_inverse: &Mat3) -> Mat3 {
    let svd = mat3::svd(&mat3::multiply(f_inverse, root_inverse));
    mat3::multiply(&mat3::transpose(&svd.left), &svd.right)
}
