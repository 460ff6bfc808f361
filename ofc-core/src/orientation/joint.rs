//! The orthogonal transformation from all that the normals say about it: how they point outward, and that they are those
//! of one surface. The sums need no second look at the picture, so any number of candidates costs nothing.
//!
//! With N = G0 rho the normals up to a member of O(3), n = (r1.N, r2.N, r3.N), two kinds of evidence are weighed against
//! each other, each by an uncertainty estimated from the picture itself:
//!
//! - *Integrability* (`integrable.rs`). For a surface, `n3 n1_y - n1 n3_y = n3 n2_x - n2 n3_x`, which is linear in the first two
//!   rows, `r1.(N x N_x) + r2.(N x N_y) = 0`. N and its gradients are fitted to windows of 8 to 64 pixels; what noise adds to the
//!   squares is taken off, and windows in which the condition fails lose weight.
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

mod area;
mod cells;
mod constants;
mod form;
mod grid;
mod information;
mod integrable;
mod moments;
mod noise;
mod outward;
mod record;
mod result;
mod round;
mod scales;
mod search;
mod sums;
mod windows;

pub use constants::APART;
pub use result::{Evidence, Joint};

pub(crate) use sums::{CellSums, STRIP, WindowSums, least_room};

use crate::color::inliers::Inliers;
use crate::math::mat3::Mat3;
use crate::picture::{Image, WINDOW, Window};

/// How many `f32` [`estimate`] needs for a picture of this size: at most two a pixel.
#[must_use]
pub const fn workspace_len(width: usize, height: usize) -> usize {
    grid::count(width, height).saturating_mul(grid::ROOM)
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
    let mut windows = [const { Window::new() }; STRIP];
    for y in (0..height).step_by(STRIP) {
        for x in (0..width).step_by(WINDOW) {
            let mut bits = [0; STRIP];
            for ((y, window), bits) in (y..height).zip(&mut windows).zip(&mut bits) {
                image.read(x, y, window);
                let exposed = inliers.usable.exposed(window);
                sums.see(x, y, exposed);
                *bits = inliers.bits_among(window, exposed);
            }
            if y + STRIP <= height {
                let [first, ..] = &windows;
                let color = |row: usize, i| windows.get(row).map_or([0.0; 3], |window| window.pixel(i));
                sums.add([x, y], first.len, bits, root, color, workspace);
            }
        }
    }
    sums.end(workspace)
}
