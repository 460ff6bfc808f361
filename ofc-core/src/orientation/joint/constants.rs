//! The numbers that the joint estimate rests on, each with where it comes from.
//!
//! "By trial" says that no formula gives a number: it was chosen on the rendered scenes of `tests/tests/joint.rs` and
//! `tests/tests/uncertainty.rs` and on the photographs, for errors near those of the best transformation there is and for
//! uncertainties that hold, and these tests hold it.

use core::f64::consts::LN_2;

// Cells and windows.

/// Pixels along the side of the smallest squares: the smallest with which a plane leaves most of its pixels for residuals.
pub(super) const SIDE: usize = 4;

/// Of the 16 pixels of a smallest square so many are inliers where it has a gradient: most of it, so that the plane is not that
/// of one side. By trial.
pub(super) const SMALLEST_GRADIENT_COUNT: f64 = 10.0;

/// Of the 16 pixels of a smallest square so many are inliers where it has residuals: three are spent on the plane, and nine are
/// left. By trial.
pub(super) const SMALLEST_RESIDUAL_COUNT: f64 = 12.0;

/// Cells whose residuals are above this many times the median are creases and edges rather than noise: noise alone comes to that
/// in fewer than one of 100,000 full squares (13 degrees of freedom and more).
pub(super) const CREASE: f32 = 4.0;

/// Square windows of so many pixels, smallest first: two by two of the smallest squares, and twice as large each time. By
/// trial.
pub(super) const WINDOW_SIZES: [usize; 4] = [8, 16, 32, 64];

/// A window counts if this share of its pixels are inliers: more than half, so that it is not that of one side. By trial.
pub(super) const SMALLEST_FILL: f64 = 0.6;

/// Fewer windows than this say nothing: three parameters take as many to be found and as many to be doubted.
pub(super) const SMALLEST_WINDOWS: usize = 6;

/// What a window that overlaps no other counts in a negative log likelihood: half of its square over its variance.
pub(super) const INDEPENDENT: f64 = 0.5;

/// Shares of the room that windows of 64, 32 and 16 pixels may take, where there is not room for all: one in so many. There are the
/// more of them the smaller they are.
pub(super) const SHARES: [usize; 3] = [8, 6, 4];

/// Cells at least, where there is not room for those of four pixels: sixteen by twelve for pictures of that shape, three
/// along each side of a part.
pub(super) const FEWEST_CELLS: usize = 192;

// Integrability.

/// Times that windows are weighed anew. By trial.
pub(super) const ROUNDS: usize = 5;

/// Times that the cost may be computed while rows are polished between two of these rounds: twelve Newton steps.
pub(super) const ROUND_EVALUATIONS: u32 = 120;

/// s^2 above this many times its variance, two deviations, loses weight quickly. By trial; Student's distribution of three degrees
/// of freedom falls off about as fast.
pub(super) const CUT: f64 = 4.0;

/// The median of the square of a normal number of variance 1.
pub(super) const MEDIAN_OF_ONE: f64 = 0.454_936;

/// The median of the sum of the squares of two normal numbers of variance 1/2: that of an exponential distribution.
pub(super) const MEDIAN_OF_TWO: f64 = LN_2;

/// Systematic errors: as if there were so few independent windows where they explain all of s, and more with the cube of the
/// share that they explain. By trial.
pub(super) const SYSTEMATIC_WINDOWS: f64 = 0.1;

/// Systematic errors explain at least this share of s: none is ruled out by an estimate that happens to be zero.
pub(super) const SMALLEST_SYSTEMATIC_SHARE: f64 = 1e-3;

/// The scatter of gradients over the parts of a picture is less than it would be over pictures, because neighbors are alike: by
/// this factor, by trial.
pub(super) const GRADIENT_NEIGHBORS: f64 = 2.0;

/// Second derivatives below this share of their trace are rounding of the differences that they are made of.
pub(super) const SMALLEST_CURVATURE: f64 = 1e-6;

// Outward normals.

/// The picture is cut into so many parts along each side: 25 values leave a variance good to 30 %, and a part is still many
/// cells.
pub(super) const PARTS: usize = 5;

/// The variance of slopes over a jackknife of the parts is less than it would be over pictures, because neighbors bulge
/// together: by this factor, by trial.
pub(super) const SLOPE_NEIGHBORS: f64 = 1.5;

/// Weights that are tried, of one kind of slopes against the other, from 0 to 1: steps of a tenth, finer than a jackknife
/// over 25 parts tells apart.
pub(super) const SLOPE_WEIGHTS: usize = 11;

/// No slope is more certain than this share of its square, a thousandth of itself.
pub(super) const SMALLEST_SLOPE_VARIANCE: f64 = 1e-6;

/// Parts whose normals are further from the camera than this (about 84 degrees) say nothing about slopes: slopes are
/// ten times n there, and so is their noise.
pub(super) const SMALLEST_N3: f64 = 0.1;

/// As how many independent places the deviations of a surface from a sphere count: those of one part of it lean to one side
/// together. By trial.
pub(super) const ROUND_PLACES: f64 = 10.0;

/// The share of the variance that a sphere leaves at least, however round a surface looks. By trial.
pub(super) const LEAST_UNEXPLAINED: f64 = 0.03;

/// A surface of which a sphere leaves this share is as likely no part of one; those that lean, and are cut off around, leave as much.
/// By trial: gels that a ball is pressed into leave less than half of it.
pub(super) const ROUND: f64 = 0.1;

// The choice of windows, and the answer.

/// Larger windows are taken for a variance that is smaller by this factor at least: it does not hold what they hide of
/// curvature. By trial.
pub(super) const GAIN: f64 = 0.5;

/// Estimates from windows of two sizes agree up to this distance, squared, in standard deviations of three parameters: 83 % of
/// those that differ by noise alone do. By trial.
pub(super) const LARGEST_DISTANCE: f64 = 5.0;

/// No rotation is more uncertain than this, in radians squared: a rotation of which nothing is known has pi^2 / 3 along each axis.
pub(super) const LARGEST_VARIANCE: f64 = 3.0;

/// One kind of evidence decided where this share of the information is its own: three times as much as the other's.
pub(super) const DECIDING_SHARE: f64 = 0.75;

/// Candidates less than this far apart, in radians, are one: about 11 degrees. By trial.
pub const APART: f64 = 0.2;

// The search.

/// Rotations that every search starts from: 60, spread over all of them, after two of the caller's own.
pub(super) const STARTS: usize = 62;

/// Starts that are followed to their minimum. By trial.
pub(super) const FOLLOWED: usize = 8;

/// Times that each followed start may compute the cost: 24 Newton steps.
pub(super) const EVALUATIONS: u32 = 240;

/// The angle of the differences that derivatives are made of, in radians: a tenth of a degree, far below the uncertainties that
/// they lead to, and far above the rounding of costs. By trial.
pub(super) const STEP: f64 = 2e-3;

/// A frame that a search starts from is turned by multiples of this about the line of sight: a fifth of a turn.
pub(super) const START_TURN: f64 = 1.256;

/// Such a frame is then tipped by multiples of this from the line of sight, 0, 40 and 80 degrees.
pub(super) const START_TIP: f64 = 0.7;

/// Such a frame is tipped in directions that are multiples of this apart, a quarter of a turn.
pub(super) const START_DIRECTION: f64 = 1.57;

/// Such directions are turned by this for every tip, so that no two frames lie in a row.
pub(super) const START_SHEAR: f64 = 0.3;
