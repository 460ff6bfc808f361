//! Depth from normals or gradients, over any mask, in memory that the caller gives.
//!
//! The depths of two neighboring pixels should differ by the mean of their slopes times the pixel pitch; depth is the
//! least-squares solution of these equations, one for every edge between pixels of the mask, with natural boundaries.
//! [`Method`] says what becomes of pixels whose slope is not to be trusted.
//!
//! Masks, weights and priors are solved for by multigrid. A whole rectangle without weights and prior is solved directly, in
//! no cycles, by [`Method::Poisson`] and [`Method::Paper`], if its height or width has no prime factor above 7.
//!
//! # Shape
//! Pictures of up to [`MAX_PIXELS`] pixels, row 0 at the top, rows any stride apart.
//!
//! # Frame and units
//! x right, y up, z toward the camera; p = dz/dx = -n1/n3 and q = dz/dy = -n2/n3; depth grows toward the camera and has
//! the unit of [`DepthParams::pixel_pitch`].
//!
//! # Scratch
//! [`need`] says how many numbers and integers, about 17/3 a pixel together (23 bytes). What they hold before changes
//! nothing.
//!
//! # Example
//! ```
//! use ofc_core::math::arena::Arena;
//! use ofc_core::surface::depth::{DepthInput, DepthParams, Plane, Slopes, integrate, need};
//! let normals = [[0.6_f32, 0.0, 0.8]; 12].as_flattened().to_vec();
//! let slopes = Slopes::Normals(Plane::new(&normals, 4, 3, 3, 12).unwrap());
//! let input = DepthInput { slopes, mask: None, weights: None, prior: None };
//! let need = need(4, 3).unwrap();
//! let (mut singles, mut integers) = (vec![0.0; need.singles], vec![0; need.integers]);
//! let arena = Arena::new(&mut [], &mut singles, &mut integers);
//! let mut depth = [0.0; 12];
//! let result = integrate(&input, &DepthParams::default(), arena, &mut depth, 4).unwrap();
//! assert!(result.converged && result.regions == 1);
//! assert!((depth[0] - depth[1] - 0.75).abs() < 1e-6);
//! ```

#![allow(clippy::inline_always, reason = "row kernels are only fast when they melt into one vectorized loop")]

mod coarsen;
mod cosine_transform;
mod coupled;
mod coupled_change;
mod coupled_equations;
mod coupled_levels;
mod coupled_transfer;
mod fourier;
mod grid;
mod hierarchy;
mod input;
mod job;
mod operator;
mod parameters;
mod poisson;
mod rectangle;
mod regions;
mod right_side;
mod solver;
mod span;
mod sweep;
mod transfer;
mod trend;
mod tridiagonal;
mod word;

use crate::math::arena::{Arena, Need};

pub use input::{DepthInput, Plane, Slopes, WEIGHT_RANGE};
pub use parameters::{DepthError, DepthParams, DepthResult, MAX_PIXELS, Method};

/// What [`integrate`] needs as workspace for a picture of this size; `None` if there is no such picture.
///
/// With w and h for width and height that is `2 ((h + 2) (w + 1) + 1) + 8 (floor(w h / 3) + 3 w + 2 h + 180) + 7 (w + 2)`
/// numbers in single precision and `(h + 2) (w + 1) + 1 + 4 (2 h + 30)` integers.
#[must_use]
pub const fn need(width: usize, height: usize) -> Option<Need> {
    hierarchy::need(width, height)
}

/// Integrates `input` into `depth`, rows `depth_row_stride` numbers apart. Pixels without a depth become NaN (the
/// positive quiet one); numbers between the rows stay as they are.
///
/// Regions without connection each have zero mean, unless [`DepthInput::prior`] has a finite depth in them. The same
/// input gives the same bits on every machine.
///
/// Stack: less than 6 KiB.
///
/// # Errors
/// See [`DepthError`].
pub fn integrate(
    input: &DepthInput,
    params: &DepthParams,
    mut workspace: Arena,
    depth: &mut [f32],
    depth_row_stride: usize,
) -> Result<DepthResult, DepthError> {
    let [width, height] = input.size();
    if !input.is_consistent() {
        return Err(DepthError::Size);
    }
    let need = need(width, height).ok_or(DepthError::Size)?;
    if !params.is_valid() {
        return Err(DepthError::Parameter);
    }
    let span = crate::picture::span(width, height, 1, depth_row_stride).map_err(|_| DepthError::Output)?;
    let data = depth.get_mut(..span).ok_or(DepthError::Output)?;
    let grid = grid::Grid { width, height };
    let parts = hierarchy::split(grid, &mut workspace).ok_or(DepthError::Workspace(need))?;
    let output = solver::Output { data, row_stride: depth_row_stride, width };
    let job = job::Job { input, params, parts, output };
    match params.method {
        Method::Poisson | Method::Paper => poisson::integrate(job),
        Method::Coupled => coupled::integrate(job),
    }
    // A part of the workspace that is not where it was computed to be: cannot happen, and needs no panic to say so.
    .unwrap_or(Err(DepthError::Workspace(need)))
}
