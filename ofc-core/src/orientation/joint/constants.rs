//! The numbers that the joint estimate rests on, each with where it comes from.
//!
//! "By trial" says that no formula gives a number: it was chosen on the rendered scenes of `tests/tests/joint.rs` and
//! `tests/tests/uncertainty.rs` and on the photographs, for errors near those of the best transformation there is and for
//! uncertainties that hold, and these tests hold it.

use core::num::NonZero;

// Cells and windows.

/// Pixels along the side of the smallest squares: the smallest with which a plane leaves most of its pixels for residuals.
pub(super) const SIDE: usize = 4;

/// Quads are of pixels, which see all detail, and of the smallest squares, which see less noise.
pub(super) const SCALES: usize = 2;

/// Pixels along the side of what a quad is made of.
pub(super) const LENGTHS: [usize; SCALES] = [1, SIDE];

/// Cells along the side of a window: windows of 16 pixels, and of 32, which have an eighth of the noise and lose detail that the
/// smallest squares do not see either. By trial.
pub(super) const WINDOW_CELLS: [NonZero<usize>; SCALES] =
    [NonZero::new(2).unwrap(), NonZero::new(4).unwrap()];

/// Of the 16 pixels of a smallest square so many are inliers where it has a gradient: most of it, so that the plane is not that
/// of one side. By trial.
pub(super) const SMALLEST_GRADIENT_COUNT: f64 = 10.0;

/// Of the 16 pixels of a smallest square so many are inliers where it has residuals: three are spent on the plane, and nine are
/// left. By trial.
pub(super) const SMALLEST_RESIDUAL_COUNT: f64 = 12.0;

/// A pixel is among inliers if this share of the pixels around it in its row are inliers.
pub(super) const SMALLEST_AMONG: f64 = 0.6;

/// So many on both sides. By trial.
pub(super) const AMONG: usize = 4;

/// Cells whose residuals are above this many times the median are creases and edges rather than noise: noise alone comes to that
/// in fewer than one of 100,000 full squares (13 degrees of freedom and more).
pub(super) const CREASE: f32 = 4.0;

/// A window counts if this share of its pixels are in quads: half, so that it is not that of one side. By trial.
pub(super) const SMALLEST_FILL: f64 = 0.5;

/// Smallest squares along the side of the smallest cells, of 8 pixels, of which windows of 16 are made. By trial.
pub(super) const SMALLEST_TIMES: usize = 2;

/// Cells at most: larger pictures have larger ones.
pub(super) const MOST_CELLS: usize = 2400;

/// Cells at least, where there is not room for smaller ones: ten by eight for pictures of 320 by 240, with which a stream and
/// its memory stay below 48 KiB.
pub(super) const FEWEST_CELLS: usize = 88;

// Integrability.

/// Neighbors whose N differs by more than this, squared, lie on both sides of a depth step: half a radian.
pub(super) const JUMP: f64 = 0.25;

/// As how many windows that share no pixel one counts, where each overlaps others by half along both sides.
pub(super) const INDEPENDENT: f64 = 0.25;

/// The error of the model relative to curvature is at least this: none is ruled out.
pub(super) const SMALLEST_EPS: f64 = 1e-3;

/// It is at most all.
pub(super) const LARGEST_EPS: f64 = 1.0;

/// Errors of the model relative to curvature that a search begins with.
pub(super) const FIRST_EPS: [f64; 3] = [0.005, 0.05, 0.3];

/// Variances of s are at least this: no window is exact.
pub(super) const SMALLEST_VARIANCE: f64 = 1e-14;

/// An error of the model of this size turns all windows alike by [`COMMON_TURN`], and others by the square of their ratio. By
/// trial: on rendered pictures it is 0.001 to 0.007, where integrability is right to a degree or two; on photographs it is 0.027 to
/// 0.3, where integrability is off by 4-20 degrees on figurines.
pub(super) const COMMON_EPS: f64 = 0.027;

/// See [`COMMON_EPS`]; radians.
pub(super) const COMMON_TURN: f64 = 0.16;

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

/// No rotation is more uncertain than this, in radians squared: a rotation of which nothing is known has pi^2 / 3 along each axis.
pub(super) const LARGEST_VARIANCE: f64 = 3.0;

/// What one window alone would add to the deviation of the rotation about each axis, in radians; many add as much less. Where
/// the model holds and windows are few, second derivatives are as uncertain as they are. A degree for 30 windows. By trial.
pub(super) const WINDOW_TURN: f64 = 0.5;

/// One kind of evidence decided where this share of the information is its own: three times as much as the other's.
pub(super) const DECIDING_SHARE: f64 = 0.75;

/// Candidates less than this far apart, in radians, are one: about 11 degrees. By trial.
pub const APART: f64 = 0.2;

// The search.

/// Rotations that every search starts from, spread over all of them.
pub(super) const STARTS: usize = 60;

/// Windows at most that the search is over; the end is over all of them.
pub(super) const SAMPLE: usize = 160;

/// Steps of the search from each start, and of its end, at most.
pub(super) const STEPS: usize = 12;

/// Steps of the candidates that are compared with the best one, at most.
pub(super) const OTHER_STEPS: usize = 6;

/// A step is at most this long, in radians.
pub(super) const LONGEST_STEP: f64 = 0.3;

/// A candidate that is less than this far from the best one, in radians, has led to the same: about a degree. By trial.
pub(super) const SAME: f64 = 0.02;

/// Starts that are followed are so far apart at least, in radians.
pub(super) const STARTS_APART: f64 = 0.4;

/// Times that the weight of integrability is renewed. By trial.
pub(super) const ROUNDS: usize = 3;

/// Starts that are followed to their minimum. By trial.
pub(super) const FOLLOWED: usize = 4;

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
