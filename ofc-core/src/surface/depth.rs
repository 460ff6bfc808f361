//! Depth from normals or gradients, over any mask, in memory that the caller gives.
//!
//! The depths of two neighbouring pixels should differ by the mean of their slopes times the pixel pitch; depth is the
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
//! [`workspace_len`] numbers, about 17/3 a pixel (23 bytes). What they hold before changes nothing.
//!
//! # Example
//! ```
//! use ofc_core::surface::depth::{DepthInput, DepthParams, Plane, Slopes, integrate, workspace_len};
//! let normals = [[0.6_f32, 0.0, 0.8]; 12].as_flattened().to_vec();
//! let slopes = Slopes::Normals(Plane::new(&normals, 4, 3, 3, 12).unwrap());
//! let input = DepthInput { slopes, mask: None, weights: None, prior: None };
//! let mut workspace = vec![0.0; workspace_len(4, 3).unwrap()];
//! let mut depth = [0.0; 12];
//! let result = integrate(&input, &DepthParams::default(), &mut workspace, &mut depth, 4).unwrap();
//! assert!(result.converged && result.regions == 1);
//! assert!((depth[0] - depth[1] - 0.75).abs() < 1e-6);
//! ```

#![allow(clippy::inline_always, reason = "row kernels are only fast when they melt into one vectorised loop")]

mod coarsen;
mod cosine_transform;
mod coupled;
mod fourier;
mod grid;
mod input;
mod operator;
mod paper;
mod poisson;
mod rectangle;
mod regions;
mod right_side;
mod solver;
mod sweep;
mod transfer;
mod trend;
mod tridiagonal;

pub use input::{DepthInput, Plane, Slopes, WEIGHT_RANGE};

use core::fmt;

/// The largest number of pixels that can be integrated, 2^29 - 1.
pub const MAX_PIXELS: usize = (1 << 29) - 1;

/// What to do where the slope is unusable: its normal is not finite or faces away, or its weight is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Least squares over the usable pixels of the mask; there is no depth elsewhere.
    #[default]
    Poisson,
    /// The paper's own choice (section 5): least squares over the whole rectangle, flat (p = q = 0) wherever the pixel is
    /// outside the mask or unusable. Weights beyond zero or not are ignored. Depth is given in the mask.
    Paper,
    /// The coupled depth/slope model: smooth slopes are fitted to the usable pixels and span the others, then depth is
    /// fitted to these slopes, over the whole mask.
    Coupled,
}

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthParams {
    /// What to do where the slope is unusable.
    pub method: Method,
    /// Width and height of a pixel on the surface, in the unit that depth is wanted in: positive. Default 1.
    pub pixel_pitch: f64,
    /// The residual to reach, as a part of the right side's norm: in [1e-6, 1]. Default 1e-4.
    pub tolerance: f64,
    /// Multigrid cycles at most, for each system of equations. Default 1000.
    pub max_cycles: u32,
    /// Normals of which n3 / |n| is less than this lose weight, with its square, and their slope stops growing: in
    /// [0.001, 1]. Default 0.05 (slopes up to 20).
    pub min_n3: f64,
    /// Weight of a pixel of the prior against the equation of one edge; zero ignores the prior: in [0, 1e6]. Default 1e-3.
    pub prior_weight: f64,
    /// Weight of the squared difference of neighbouring slopes against that of a pixel's slope from its data, for
    /// [`Method::Coupled`]: in [1e-3, 1e3]. Default 0.1.
    pub smoothness: f64,
}

impl Default for DepthParams {
    fn default() -> Self {
        Self {
            method: Method::Poisson,
            pixel_pitch: 1.0,
            tolerance: 1e-4,
            max_cycles: 1000,
            min_n3: 0.05,
            prior_weight: 1e-3,
            smoothness: 0.1,
        }
    }
}

impl DepthParams {
    fn is_valid(&self) -> bool {
        let within = |value: f64, least: f64, most: f64| value >= least && value <= most;
        within(self.pixel_pitch, 1e-30, 1e30)
            && within(self.tolerance, 1e-6, 1.0)
            && within(self.min_n3, 1e-3, 1.0)
            && within(self.prior_weight, 0.0, 1e6)
            && within(self.smoothness, 1e-3, 1e3)
    }
}

/// What came out, beside the depth.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthResult {
    /// Whether the tolerance was reached, or, by a direct solution, what f32 can hold.
    pub converged: bool,
    /// Multigrid cycles, of all systems of equations together: zero if depth was solved for directly.
    pub cycles: u32,
    /// The last residual as a part of the right side's norm. It is that of the solution before it is rounded to f32, but
    /// by a direct solution, where nothing but that rounding is left, that of the rounded one: 1e-3 for a million pixels,
    /// 1e-2 for ten.
    pub residual: f64,
    /// Connected regions. Each has zero mean depth unless a prior reaches into it.
    pub regions: usize,
    /// Pixels that have a depth.
    pub pixels: usize,
    /// Pixels of the mask that were unusable.
    pub excluded: usize,
}

/// Why nothing was integrated; the depth is untouched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthError {
    /// The planes do not have the same size or the right number of channels, or there are more than [`MAX_PIXELS`].
    Size,
    /// A parameter is outside its range.
    Parameter,
    /// The workspace is shorter than this.
    Workspace(usize),
    /// The depth buffer ends before the last row does, or its row stride is smaller than a row.
    Output,
    /// No pixel of the mask is usable.
    Empty,
}

impl fmt::Display for DepthError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Size => {
                f.write_str("planes of different sizes or the wrong number of channels, or too large")
            }
            Self::Parameter => f.write_str("a parameter is out of its range"),
            Self::Workspace(need) => write!(f, "the workspace is shorter than {need}"),
            Self::Output => {
                f.write_str("the depth buffer ends before the last row, or its rows are too short")
            }
            Self::Empty => f.write_str("no pixel of the mask is usable"),
        }
    }
}

impl core::error::Error for DepthError {}

/// Numbers that [`integrate`] needs as workspace for a picture of this size; `None` if there is no such picture.
///
/// With w and h for width and height that is `4 ((h + 2) (w + 1) + 1) + 5 (floor(w h / 3) + 3 w + 2 h + 180) +
/// 4 (2 h + 30) + 4 (w + 2)`.
#[must_use]
pub const fn workspace_len(width: usize, height: usize) -> Option<usize> {
    grid::workspace_len(width, height)
}

/// Integrates `input` into `depth`, rows `depth_row_stride` numbers apart. Pixels without a depth become NaN (the
/// positive quiet one); numbers between the rows stay as they are.
///
/// Regions without connection each have zero mean, unless [`DepthInput::prior`] has a finite depth in them. The same
/// input gives the same bits on every machine.
///
/// Stack: less than 4 KiB.
///
/// # Errors
/// See [`DepthError`].
pub fn integrate(
    input: &DepthInput,
    params: &DepthParams,
    workspace: &mut [f32],
    depth: &mut [f32],
    depth_row_stride: usize,
) -> Result<DepthResult, DepthError> {
    let [width, height] = input.size();
    if !input.is_consistent() {
        return Err(DepthError::Size);
    }
    let need = workspace_len(width, height).ok_or(DepthError::Size)?;
    if !params.is_valid() {
        return Err(DepthError::Parameter);
    }
    let span = crate::picture::span(width, height, 1, depth_row_stride).map_err(|_| DepthError::Output)?;
    let data = depth.get_mut(..span).ok_or(DepthError::Output)?;
    let grid = grid::Grid { width, height };
    let parts = grid::split(grid, workspace).ok_or(DepthError::Workspace(need))?;
    let output = solver::Output { data, row_stride: depth_row_stride, width };
    let job = poisson::Job { input, params, parts, output };
    match params.method {
        Method::Poisson => poisson::integrate(job),
        Method::Paper => paper::integrate(job),
        Method::Coupled => coupled::integrate(job),
    }
    // A part of the workspace that is not where it was computed to be: cannot happen, and needs no panic to say so.
    .unwrap_or(Err(DepthError::Workspace(need)))
}
