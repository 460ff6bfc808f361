//! How to integrate, what comes out beside the depth, and why nothing does.

use crate::math::arena::Need;
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
    /// The coupled depth/slope model, over the whole mask: depth and smooth slopes that fit each other, and the usable pixels,
    /// span the others. The squared misfit of depth and slopes along an edge has ten times the weight of the smoothness; it is
    /// the equation of an edge that the weight of a prior refers to.
    Coupled,
}

/// How to integrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthParams {
    /// What to do where the slope is unusable.
    pub method: Method,
    /// Width and height of a pixel on the surface, in the unit that depth is wanted in: positive. Default 1.
    pub pixel_pitch: f64,
    /// The residual to reach, as a part of the right side's norm: in [1e-6, 1]. Default 1e-4. For [`Method::Coupled`] also how
    /// far depth may still have to go, as a part of the size of depth and slopes.
    pub tolerance: f64,
    /// Multigrid cycles at most, for each system of equations. Default 1000.
    pub max_cycles: u32,
    /// Normals of which n3 / |n| is less than this lose weight, with its square, and their slope stops growing: in
    /// [0.001, 1]. Default 0.05 (slopes up to 20).
    pub min_n3: f64,
    /// Weight of a pixel of the prior against the equation of one edge; zero ignores the prior: in [0, 1e6]. With any other,
    /// known depths are right on average in each region, and with the smallest that is all they do. Default 1e-3.
    pub prior_weight: f64,
    /// Weight of the squared difference of neighboring slopes against that of a pixel's slope from its data, for
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
    /// Whether every parameter is in its range.
    pub(super) fn is_valid(&self) -> bool {
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
    /// Whether the tolerance was reached, or, by a direct solution, what f32 can hold. By [`Method::Coupled`] the changes of
    /// depth that are still to come, as the last ones tell, are below the tolerance, too.
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
    /// The workspace holds less than this.
    Workspace(Need),
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
            Self::Workspace(need) => write!(f, "the workspace holds less than {} bytes", need.bytes()),
            Self::Output => {
                f.write_str("the depth buffer ends before the last row, or its rows are too short")
            }
            Self::Empty => f.write_str("no pixel of the mask is usable"),
        }
    }
}

impl core::error::Error for DepthError {}
