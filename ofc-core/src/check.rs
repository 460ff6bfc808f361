//! Self-checks: whether to believe an answer when the truth is not known.
//!
//! The picture is lit again: every inlier's normal n = F^-1 rho, set to unit length, is shaded with f1, f2, f3, one light a
//! channel, and the result is compared with the input. How to read it:
//!
//! - `correlations` say how well the colors obey rho = F n with normals of unit length: how Lambertian the surface is, and
//!   how alike its lighting everywhere. 0.999 is the paper's egg; below about 0.99 the model explains the picture poorly.
//!   They depend on C alone: F n is G0^-1 N whatever the orthogonal transformation R is, so they see no wrong R.
//! - `tilt_differences` compare Pentland's tilts of the relit picture with those of the input. They see no wrong R either,
//!   as the relit picture does not depend on it. Small ones say that pulling the normals to unit length changed nothing that
//!   the tilts depend on; large ones that they rest on noise and rim.
//! - `tilt_residuals` compare the tilts of the rows of F with Pentland's of the input. A turn about the line of sight shows
//!   by its angle in all three, the convex/concave twin by 180 degrees, other turns by more than their angle where slants are
//!   small. They are zero by construction where F was made from these tilts, and not zero for a right F where the border of
//!   the surface misleads Pentland's estimator: up to 15 degrees on closed shapes, anything on relief that touches the frame.
//! - `turn` is the check that sees every wrong R: the angle by which all normals would have to be turned to agree best with
//!   integrability and to point outward, beside the angle to be expected of a right F. Normals turned by 10, 25 or 40
//!   degrees about any axis show by 8, 20 and 32 degrees, the twin by 110 and a mirror image by 71, give or take what is
//!   expected. An angle of several times the expected one says that F is wrong; a `convexity` near zero, that nothing says
//!   which of the twins is right. It is small by construction where F comes from [`joint`](crate::orientation::joint).
//! - `norms` are those of n before it is set to unit length. Median near 1, range narrow (the paper's egg: 1.009, from 0.915
//!   to 1.061) is good; a wide range on one side is shadow or gloss among the inliers.
//! - `depth` holds the surface integrated from the normals against them. `median_angle` is what integration had to bend: a
//!   degree or two is noise and pixel size; more says that the normals are not those of one surface, because F is wrong or the
//!   surface has steps. A turn of 25 degrees about the line of sight shows by 6 to 13 degrees, but one about an axis in the
//!   picture by one or two, and the twin, which is as good a surface, not at all. `tilt_differences` are section 5's test:
//!   the surface is shaded with f1, f2, f3, and Pentland's tilts of that picture are compared with those of the input. They
//!   see a turn about the line of sight by about its angle, other turns of 25 degrees by less than 3, the twin not at all.
//! - `largest_p` is the significance of the least significant of the six coefficients of the ellipsoid. Below 0.05 all are
//!   significant. An off-diagonal coefficient may be insignificant because it is zero, in a lucky arrangement of lights.
//!
//! # Reference
//! Sections 4-6.

mod correlation;
mod depth;
mod differences;
mod turn;

pub use depth::DepthCheck;
pub use turn::Turn;

use crate::color::inliers::Inliers;
use crate::color::regression::{Estimate, TERMS};
use crate::light::tilt::{Tilts, pentland};
use crate::math::mat3;
use crate::math::select::{kth_smallest, median_rank};
use crate::orientation::matrix::Orientation;
use crate::picture::{Image, Pixels, for_each_bit};
use crate::render::DepthMap;
use crate::surface::normals::{Length, normal};
use core::fmt;
use correlation::Correlation;
use differences::minus;
use libm::{atan2, sqrt};

/// What the lengths of the normals are, before they are set to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Norms {
    /// The median.
    pub median: f64,
    /// The smallest.
    pub min: f64,
    /// The largest.
    pub max: f64,
}

/// The checks; how to read them is at the head of this file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Check {
    /// How many pixels were compared.
    pub inliers: usize,
    /// The correlation of each channel with the relit one; 0 where one of them is constant.
    pub correlations: [f64; 3],
    /// Lengths of the recovered normals.
    pub norms: Norms,
    /// Pentland's tilts of the input; `None` where there are none.
    pub tilts: Option<Tilts>,
    /// Pentland's tilts of the relit picture; `None` where there are none.
    pub relit_tilts: Option<Tilts>,
    /// Tilts of the relit picture minus those of the input, in (-pi, pi].
    pub tilt_differences: Option<[f64; 3]>,
    /// Tilts of the rows of F minus those of the input, in (-pi, pi].
    pub tilt_residuals: Option<[f64; 3]>,
    /// How far the normals are from where integrability and outward normals would have them; `None` where the picture does
    /// not say.
    pub turn: Option<Turn>,
    /// The integrated surface against its normals, where there is one.
    pub depth: Option<DepthCheck>,
    /// The largest p value of the six coefficients; 1 where one is not a number.
    pub largest_p: f64,
}

/// Why there is nothing to check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CheckError {
    /// F or its inverse is not finite, or its rank is below 3.
    Orientation,
    /// The workspace is shorter than [`workspace_len`].
    WorkspaceTooShort,
    /// There are no inliers.
    NoInliers,
    /// The surface does not have the size of the picture.
    Size,
}

impl fmt::Display for CheckError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Orientation => {
                "the color-orientation matrix or its inverse is not finite, or its rank is below 3"
            }
            Self::WorkspaceTooShort => "the workspace is too short",
            Self::NoInliers => "there are no inliers",
            Self::Size => "the surface does not have the size of the picture",
        })
    }
}

impl core::error::Error for CheckError {}

/// How many `f32` [`check`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize) -> usize {
    pixels.saturating_mul(2)
}

/// Checks an F and the regression behind it on the inliers, and the surface integrated from their normals if there is one.
///
/// # Units
/// Radians; lengths of normals have none.
///
/// # Errors
/// See [`CheckError`].
///
/// # Scratch
/// [`workspace_len`] `f32`, two a pixel; what they hold before does not matter.
///
/// # Example
/// ```
/// use ofc_core::check::{check, workspace_len};
/// # use ofc_core::{Image, Order, Params, Sample, solve};
/// # let f = [[110.0, 15.0, 95.0], [-65.0, 90.0, 100.0], [-40.0, -95.0, 90.0]];
/// # let pixel = |i: usize| {
/// #     let (x, y) = (((i % 96) as f64 - 47.5) / 60.0, (47.5 - (i / 96) as f64) / 60.0);
/// #     let n = [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()];
/// #     f.map(|row: [f64; 3]| row.iter().zip(n).map(|(f, n)| f * n).sum::<f64>().max(0.0).round() as u8)
/// # };
/// # let pixels: Vec<u8> = (0..96 * 96).flat_map(pixel).collect();
/// # let image = Image::interleaved(&pixels, 96, 96, 3 * 96, Sample::U8, Order::Rgb).unwrap();
/// # let params = Params::default();
/// # let mut workspace = vec![0.0; solve::workspace_len(96 * 96, params.lmeds.sample_size)];
/// // A ball of 96 x 96 pixels, whose rim one of the lights does not reach.
/// let solution = solve(&image, &params, &mut workspace).unwrap();
/// let orientation = &solution.choice.as_ref().expect("F").orientation;
/// let coefficients = &solution.fit.as_ref().expect("a fit").coefficients;
/// let mut workspace = vec![0.0; workspace_len(96 * 96)];
/// let checked = check(&image, &solution.inliers, orientation, coefficients, None, &mut workspace).unwrap();
/// assert!(checked.correlations.iter().all(|correlation| *correlation > 0.999));
/// ```
pub fn check(
    image: &Image,
    inliers: &Inliers,
    orientation: &Orientation,
    coefficients: &[Estimate; TERMS],
    depth: Option<&DepthMap>,
    workspace: &mut [f32],
) -> Result<Check, CheckError> {
    let Orientation { f, f_inverse, rank, .. } = orientation;
    if *rank < 3 || f.iter().chain(f_inverse).flatten().any(|entry| !entry.is_finite()) {
        return Err(CheckError::Orientation);
    }
    let pixels = image.width() * image.height();
    let workspace = workspace.get_mut(..workspace_len(pixels)).ok_or(CheckError::WorkspaceTooShort)?;
    if depth.is_some_and(|depth| [depth.width(), depth.height()] != [image.width(), image.height()]) {
        return Err(CheckError::Size);
    }

    let turn = turn::turn(image, inliers, f_inverse, workspace);
    let bits = inliers.selector();
    let norms = image.gather(bits, workspace, |r, g, b| {
        let n = normal(f_inverse, [r, g, b], Length::Kept);
        sqrt(mat3::dot(n, n))
    });
    let count = norms.len();
    let median = kth_smallest(norms, median_rank(count)).ok_or(CheckError::NoInliers)?;
    let extreme = |pick: fn(f32, f32) -> f32, from| f64::from(norms.iter().copied().fold(from, pick));
    let norms = Norms {
        median: f64::from(median),
        min: extreme(f32::min, f32::INFINITY),
        max: extreme(f32::max, f32::NEG_INFINITY),
    };

    let relit = |color: [f32; 3]| mat3::apply(f, normal(f_inverse, color, Length::Unit));
    let mut correlations = [Correlation::default(); 3];
    image.for_each_window(|window| {
        for_each_bit(bits(window), |i| {
            let color = window.pixel(i);
            for ((sums, input), output) in correlations.iter_mut().zip(color).zip(relit(color)) {
                sums.add(f64::from(input), output);
            }
        });
    });

    let tilts = pentland::tilts(image, bits);
    let relit_tilts = pentland::tilts_of(image, bits, |window, i| relit(window.pixel(i)));
    let depth = depth.map(|depth| depth::check(image, inliers, orientation, depth, tilts, workspace));
    Ok(Check {
        inliers: count,
        correlations: correlations.map(|sums| sums.correlation()),
        norms,
        tilts,
        relit_tilts,
        tilt_differences: relit_tilts.zip(tilts).map(|(relit, tilts)| minus(relit.tilts, tilts)),
        turn,
        depth,
        tilt_residuals: tilts.map(|tilts| minus(f.map(|[x, y, _]| atan2(y, x)), tilts)),
        largest_p: coefficients.iter().map(|estimate| estimate.p).fold(0.0, |largest, p| {
            // A p value that is not a number is no evidence.
            if p.is_nan() { 1.0 } else { p.max(largest) }
        }),
    })
}
