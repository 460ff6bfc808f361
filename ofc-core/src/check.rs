//! Self-checks: whether to believe an answer when the truth is not known.
//!
//! The picture is lit again: every inlier's normal n = F^-1 rho, set to unit length, is shaded with f1, f2, f3, one light a
//! channel, and the result is compared with the input. How to read it:
//!
//! - `correlations` say how well the colors obey rho = F n with normals of unit length: how Lambertian the surface is, and
//!   how alike its lighting everywhere. 0.999 is the paper's egg; below about 0.99 the model explains the picture poorly.
//!   They do **not** depend on the orthogonal transformation: F n is G0^-1 N whatever R is, so a wrong R, wrong tilts, a
//!   convex/concave inversion go unnoticed.
//! - `tilt_differences` compare Pentland's tilts of the relit picture with those of the input. Small ones say that pulling
//!   the normals to unit length changed nothing that the tilts depend on; large ones that they rest on noise and rim.
//! - `tilt_residuals` compare the tilts of the rows of F with Pentland's of the input: zero where F was made from these
//!   tilts, and the check that the correlations are not, where F comes from elsewhere.
//! - `norms` are those of n before it is set to unit length. Median near 1, range narrow (the paper's egg: 1.009, from 0.915
//!   to 1.061) is good; a wide range on one side is shadow or gloss among the inliers.
//! - `depth` holds the surface integrated from the normals against them. `median_angle` is what integration had to bend: a
//!   degree or two is noise and pixel size; more says that the normals are not those of one surface, so F is wrong or the
//!   surface has steps. `tilt_differences` are section 5's test: the surface is shaded with f1, f2, f3, and Pentland's
//!   tilts of that picture are compared with those of the input. Wrong normals shade differently.
//! - `largest_p` is the significance of the least significant of the six coefficients of the ellipsoid. Below 0.05 all are
//!   significant. An off-diagonal coefficient may be insignificant because it is zero, in a lucky arrangement of lights.
//!
//! # Reference
//! Sections 4-6.

use crate::color::regression::{Estimate, TERMS};
use crate::light::tilt::{Tilts, pentland};
use crate::math::mat3;
use crate::math::select::{kth_smallest, median_rank};
use crate::orientation::matrix::Orientation;
use crate::picture::Pixels;
use crate::picture::{Image, Window, for_each_bit};
use crate::render::DepthMap;
use crate::surface::normals::{Length, normal};
use core::f64::consts::{PI, TAU};
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
    /// The integrated surface against its normals, where there is one.
    pub depth: Option<DepthCheck>,
    /// The largest p value of the six coefficients; 1 where one is not a number.
    pub largest_p: f64,
}

/// A surface integrated from the normals, against them and the picture. All are zero where it covers no inlier.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DepthCheck {
    /// Inliers that have a depth.
    pub pixels: usize,
    /// The median angle between the surface's normals and those recovered from the colors.
    pub median_angle: f64,
    /// Pentland's tilts of the surface shaded with F; `None` where there are none.
    pub tilts: Option<Tilts>,
    /// These minus the tilts of the input, in (-pi, pi].
    pub tilt_differences: Option<[f64; 3]>,
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

/// How many `f32` [`check`] needs for a picture of `pixels` pixels.
#[must_use]
pub const fn workspace_len(pixels: usize) -> usize {
    pixels
}

/// Checks an F and the regression behind it on the pixels that `inliers` gives the bits of, and the surface integrated from
/// their normals if there is one.
///
/// # Units
/// Radians; lengths of normals have none.
///
/// # Errors
/// See [`CheckError`].
///
/// # Scratch
/// [`workspace_len`] `f32`, one a pixel; what they hold before does not matter.
pub fn check(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
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

    let norms = image.gather(&inliers, workspace, |r, g, b| {
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
        for_each_bit(inliers(window), |i| {
            let color = window.pixel(i);
            for ((sums, input), output) in correlations.iter_mut().zip(color).zip(relit(color)) {
                sums.add(f64::from(input), output);
            }
        });
    });

    let tilts = pentland::tilts(image, &inliers);
    let relit_tilts = pentland::tilts_of(image, &inliers, |window, i| relit(window.pixel(i)));
    let depth = depth.map(|depth| {
        let mut check = check_depth(image, &inliers, orientation, depth, workspace);
        check.tilt_differences = check.tilts.zip(tilts).map(|(depth, tilts)| minus(depth.tilts, tilts));
        check
    });
    Ok(Check {
        inliers: count,
        correlations: correlations.map(|sums| sums.correlation()),
        norms,
        tilts,
        relit_tilts,
        tilt_differences: relit_tilts.zip(tilts).map(|(relit, tilts)| minus(relit.tilts, tilts)),
        depth,
        tilt_residuals: tilts.map(|tilts| minus(f.map(|[x, y, _]| atan2(y, x)), tilts)),
        largest_p: coefficients.iter().map(|estimate| estimate.p).fold(0.0, |largest, p| {
            // A p value that is not a number is no evidence.
            if p.is_nan() { 1.0 } else { p.max(largest) }
        }),
    })
}

fn check_depth(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    Orientation { f, f_inverse, .. }: &Orientation,
    depth: &DepthMap,
    workspace: &mut [f32],
) -> DepthCheck {
    // The inliers of a window that have a depth.
    let surface = |window: &Window| {
        let mut bits = inliers(window);
        for_each_bit(bits, |i| {
            if depth.at(window.x + i, window.y).is_none() {
                bits &= !(1 << i);
            }
        });
        bits
    };
    let normal_at = |window: &Window, i| depth.normal(window.x + i, window.y).unwrap_or_default();
    let mut pixels = 0;
    image.for_each_window(|window| {
        for_each_bit(surface(window), |i| {
            let (a, b) = (normal_at(window, i), normal(f_inverse, window.pixel(i), Length::Unit));
            let cross = mat3::cross(a, b);
            if let Some(slot) = workspace.get_mut(pixels) {
                *slot = atan2(sqrt(mat3::dot(cross, cross)), mat3::dot(a, b)) as f32;
                pixels += 1;
            }
        });
    });
    let angles = workspace.get_mut(..pixels).unwrap_or_default();
    let median_angle = kth_smallest(angles, median_rank(pixels)).map_or(0.0, f64::from);
    let tilts = pentland::tilts_of(image, surface, |window, i| mat3::apply(f, normal_at(window, i)));
    DepthCheck { pixels, median_angle, tilts, tilt_differences: None }
}

/// `a` minus tilts, in (-pi, pi].
fn minus(a: [f64; 3], tilts: Tilts) -> [f64; 3] {
    let mut differences = a;
    for (a, b) in differences.iter_mut().zip(tilts.tilts) {
        *a = turn(*a - b);
    }
    differences
}

/// The same angle in (-pi, pi], for differences of two such angles.
fn turn(angle: f64) -> f64 {
    if angle > PI {
        angle - TAU
    } else if angle <= -PI {
        angle + TAU
    } else {
        angle
    }
}

/// Sums for a correlation, relative to the first pair: values far from zero lose no digits.
#[derive(Clone, Copy, Default)]
struct Correlation {
    first: Option<(f64, f64)>,
    count: f64,
    a: f64,
    b: f64,
    aa: f64,
    ab: f64,
    bb: f64,
}

impl Correlation {
    fn add(&mut self, a: f64, b: f64) {
        let (first_a, first_b) = *self.first.get_or_insert((a, b));
        let (a, b) = (a - first_a, b - first_b);
        self.count += 1.0;
        self.a += a;
        self.b += b;
        self.aa += a * a;
        self.ab += a * b;
        self.bb += b * b;
    }

    fn correlation(&self) -> f64 {
        let count = self.count.max(1.0);
        let (aa, bb) = (self.aa - self.a * self.a / count, self.bb - self.b * self.b / count);
        let ab = self.ab - self.a * self.b / count;
        let product = sqrt(aa.max(0.0)) * sqrt(bb.max(0.0));
        if product > 0.0 { (ab / product).clamp(-1.0, 1.0) } else { 0.0 }
    }
}
