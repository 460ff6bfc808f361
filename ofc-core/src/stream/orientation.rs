//! The last pass of a cold start with the joint method, and what a frame makes of its answer.

use super::kept_row::{keep_window, kept_window};
use super::memory::{Memory, rows_len};
use super::pass::Pass;
use super::state::{Held, State};
use crate::math::mat3::{self, Mat3};
use crate::orientation::joint::{CellSums, Joint, STRIP, Strip};
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
        let width = self.width;
        // The row above a strip comes first.
        let slot = (y + 1) % STRIP;
        let mut above = Window::new();
        row.for_each_window(|window| {
            let mut strip = Strip::default();
            let exposed = inliers.usable.exposed(window);
            self.inlier_count += inliers.bits_among(window, exposed).count_ones() as usize;
            let Held::CellSums(sums) = &mut self.held else { return };
            sums.see(window.x, y, exposed);
            if slot == 0
                && let Some(ellipsoid) = &self.solution.ellipsoid
            {
                for (i, row) in rows.chunks_exact((3 * width).max(1)).enumerate().skip(usize::from(y < STRIP))
                {
                    kept_window(window.x, width, row, &mut above);
                    strip.see(i, &above, inliers);
                }
                strip.see(STRIP, window, inliers);
                let color = |row, i| color(rows, width, window, row, i);
                sums.add([window.x, y + 1 - STRIP], window.len, &strip, &ellipsoid.root, color, numbers);
            }
            keep_window(width, window, window.masked, rows.get_mut(slot * 3 * width..).unwrap_or_default());
        });
    }

    #[inline(never)]
    pub(super) fn end_outward(&mut self, memory: &mut Memory) {
        self.solution.inlier_count = self.inlier_count;
        let joint = if let Held::CellSums(sums) = &self.held { sums.end(memory.values) } else { None };
        let is_oriented = self.orient_jointly(joint);
        self.go_on(!is_oriented, Pass::Tilts);
    }

    /// Ends with this transformation, if there is one; whether there is.
    fn orient_jointly(&mut self, joint: Option<Joint>) -> bool {
        let (Some(joint), Some(ellipsoid)) = (joint, &self.solution.ellipsoid) else { return false };
        let oriented = Oriented::jointly(joint, ellipsoid, self.params.solve.rank_threshold);
        self.solution.take_orientation(Ok(oriented));
        true
    }
}

/// A color of a strip: of the row above it and its first three, which are kept, or of its last.
fn color(kept: &[f32], width: usize, last: &Window, row: usize, i: usize) -> [f32; 3] {
    if row == STRIP {
        return last.pixel(i);
    }
    [0, 1, 2].map(|channel| {
        let at = (3 * row + channel) * width + last.x + i;
        kept.get(at).copied().unwrap_or(f32::NAN)
    })
}

/// The transformation of the normals under another root of C, whose inverse is given, that makes F nearest to an old one: of
/// all orthogonal ones that which turns the new normals least from the old ones, where these look in all directions alike.
#[inline(never)]
pub(super) fn nearest_rows(f_inverse: &Mat3, root_inverse: &Mat3) -> Mat3 {
    let svd = mat3::svd(&mat3::multiply(f_inverse, root_inverse));
    mat3::multiply(&mat3::transpose(&svd.left), &svd.right)
}
