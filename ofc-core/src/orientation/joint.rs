//! The orthogonal transformation from all that the normals say about it: how they point outward, and that they are those
//! of one surface. The sums need no second look at the picture, so any number of candidates costs nothing.
//!
//! With N = G0 rho the normals up to a member of O(3), n = (r1.N, r2.N, r3.N), two kinds of evidence are weighed against
//! each other, each by an uncertainty estimated from the picture itself:
//!
//! - *Integrability* (`integrable.rs`). For a surface, `n3 n1_y - n1 n3_y = n3 n2_x - n2 n3_x`, which is linear in the first two
//!   rows, `r1.(N x N_x) + r2.(N x N_y) = 0`. Products of neighbors (`quads.rs`) are summed over windows, without the bias that
//!   curvature gives to planes; noise and an error of the model relative to curvature, which is fitted, say how likely they are, and
//!   that error bounds what all of them together count.
//! - *Outward normals* (`outward.rs`). On the whole a normal points away from the middle of its surface: the slopes of N over
//!   position are to be along x and y. Pentland's tilts ask this of mean gradients, which the border of the surface alone decides;
//!   regression listens to all of it. Both are used. Where the surface looks like a part of a sphere about the middle of all of it,
//!   shaded parts among them (`round.rs`), that decides.
//!
//! (r1, r2) -> -(r1, r2), the convex/concave twin, changes nothing in the first. The sign of `sum (x n1 + y n2) / n3`
//! over the parts of the surface chooses: normals that point outward make a dome. `docs/joint-orientation.md` derives all of
//! this, and says where it fails.
//!
//! # Reference
//! Sections 2.3-2.4 (eqs. 13-15) and 3.2 (eqs. 20-21), which this combines.

mod cells;
mod constants;
mod estimate;
mod grid;
mod information;
mod integrable;
mod mixture;
mod moments;
mod outward;
mod parts;
mod pixels;
mod quads;
mod result;
mod round;
mod search;
mod squares;
mod sums;
mod used;
mod value;
mod window;
mod windows;

pub use constants::APART;
pub use result::{Evidence, Joint};

pub(crate) use sums::{CellSums, STRIP, Strip, least_room};

use crate::color::inliers::Inliers;
use crate::math::mat3::Mat3;
use crate::picture::{Image, WINDOW, Window};

/// How many `f32` [`estimate`] needs for a picture of this size: about one a pixel, and no more than for 2,400 cells and two lines.
#[must_use]
pub const fn workspace_len(width: usize, height: usize) -> usize {
    grid::len(width, height, constants::MOST_CELLS)
}

/// The transformation of the normals `root` rho of the inliers; `None` where they are too few or too scattered to say
/// anything.
///
/// # Units
/// `root` in (pixel value)^-1.
///
/// # Scratch
/// [`workspace_len`] `f32`; what they hold before does not matter. One pass over the picture.
pub fn estimate(image: &Image, inliers: &Inliers, root: &Mat3, workspace: &mut [f32]) -> Option<Joint> {
    let (width, height) = (image.width(), image.height());
    let len = workspace_len(width, height);
    let workspace = workspace.get_mut(..len)?;
    let mut sums = CellSums::begin(width, height, len, workspace)?;
    let mut windows = [const { Window::new() }; STRIP + 1];
    for y in (0..height).step_by(STRIP) {
        for x in (0..width).step_by(WINDOW) {
            let mut strip = Strip::default();
            for (i, window) in windows.iter_mut().enumerate() {
                // The row above the strip comes first.
                let Some(row) = (y + i).checked_sub(1).filter(|&row| row < height) else { continue };
                image.read(x, row, window);
                let exposed = strip.see(i, window, inliers);
                if i > 0 {
                    sums.see(x, row, exposed);
                }
            }
            if y + STRIP <= height {
                let [.., last] = &windows;
                let color = |row: usize, i| windows.get(row).map_or([0.0; 3], |window| window.pixel(i));
                sums.add([x, y], last.len, &strip, root, color, workspace);
            }
        }
    }
    sums.end(workspace)
}
