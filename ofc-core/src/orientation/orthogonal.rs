//! The orthogonal transformation that the regression leaves open, by integrability: no estimator of light direction.
//!
//! The root G0 of C turns colors into N = G0 rho, the normals up to a member of O(3). With rows r1, r2, r3 of that
//! member as in section 2.4 the normal is n = (r1.N, r2.N, r3.N); the paper's R of eqs. 13-14 is the matrix that has
//! r1, r2, r3 as columns. So F^-1 = (rows) G0 and F = G0^-1 (rows)^T.
//!
//! [`annealing`] minimises the integral (15) itself; [`closed_form`] takes r3 from the smoothness condition (16) and the
//! remaining angle from (15). Both end in [`Found`]: neither can tell a surface from its convex/concave twin, for which
//! rows r1 and r2 have the other sign (section 2.4), so both are given, and tilts from elsewhere choose between them
//! where there are any.
//!
//! In both the slope condition is taken in the form
//!
//! ```text
//! n3^2 (p_y - q_x) = -(c1 . (N x N_x) + c2 . (N x N_y)),   c1 = r2 x r3,  c2 = r3 x r1,
//! ```
//!
//! which is the quotient rule written with cross products; c1 = r1 and c2 = r2 up to the sign of the determinant.
//!
//! # Reference
//! Sections 2.3-2.4, eqs. 13-16.

pub mod annealing;
pub mod closed_form;
pub(crate) mod polish;
pub(crate) mod sample;
pub mod tilts_given;

use crate::math::angle::sincos;
use crate::math::mat3::{self, Mat3};
use crate::orientation::integrability::{self, Integrability};
use crate::picture::{Image, Window};
use libm::{acos, atan2, sqrt};
use sample::for_each_cell;

/// Why there is no transformation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrthogonalError {
    /// A parameter is out of its range, or a tilt is not finite.
    Params,
    /// The workspace is too short.
    WorkspaceTooShort,
    /// The root has no inverse, or is not finite.
    SingularRoot,
    /// There are no cells of four inliers, or the normals do not vary over them.
    NoCells,
}

/// One member of O(3) and the F that follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transformation {
    /// r1, r2, r3: n = `rows` G0 rho. Its determinant is 1 or -1.
    pub rows: Mat3,
    /// F = G0^-1 `rows`^T, in pixel values.
    pub f: Mat3,
    /// F^-1 = `rows` G0.
    pub f_inverse: Mat3,
    /// The tilts of the rows of F in (-pi, pi].
    pub tilts: [f64; 3],
    /// The slants of the rows of F. One above pi/2 is no light of the paper's, and says that this is not the answer.
    pub slants: [f64; 3],
}

impl Transformation {
    fn new(rows: Mat3, root: &Mat3, root_inverse: &Mat3) -> Self {
        let f = mat3::multiply(root_inverse, &mat3::transpose(&rows));
        let tilts = f.map(|[x, y, _]| atan2(y, x));
        let slants = f.map(|row| {
            let length = sqrt(mat3::dot(row, row));
            if length > 0.0 { acos((row[2] / length).clamp(-1.0, 1.0)) } else { 0.0 }
        });
        Self { rows, f, f_inverse: mat3::multiply(&rows, root), tilts, slants }
    }
}

/// What chose between the twins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TwinChoice {
    /// No tilts were given: the convex one, for which `n1_x + n2_y` is positive on the whole.
    Convex,
    /// The tilts of the rows of F that are nearer to those given.
    Tilts,
}

/// A minimum of the integral (15) and its convex/concave twin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// The one of the two that was chosen.
    pub transformation: Transformation,
    /// The other: rows r1 and r2 with the other sign. Its integral is the same.
    pub twin: Transformation,
    /// What chose.
    pub choice: TwinChoice,
    /// How clear the choice is, from 0 (the twins are equally good) to 1: for tilts, the mean over channels of the
    /// cosine of the difference in tilt, weighted by the sines of the slants; for the convex twin,
    /// `sum(n1_x + n2_y)` over `sum |n1_x + n2_y|`.
    pub clarity: f64,
    /// The integral (15) of both, by [`integrability::integral`].
    pub integral: Integrability,
    /// The same before the polish on the full data.
    pub unpolished: Integrability,
    /// Times the integral (15) was computed over the whole picture.
    pub evaluations: u32,
}

/// G0, its inverse, and the inliers of a picture: what every method to the transformation starts from.
struct Problem<'a, 'p, S> {
    image: &'a Image<'p>,
    inliers: S,
    root: &'a Mat3,
    root_inverse: Mat3,
    tilts: Option<[f64; 3]>,
}

impl<'a, 'p, S: Fn(&Window) -> u64> Problem<'a, 'p, S> {
    fn new(
        image: &'a Image<'p>,
        inliers: S,
        root: &'a Mat3,
        tilts: Option<[f64; 3]>,
    ) -> Result<Self, OrthogonalError> {
        if tilts.iter().flatten().any(|tilt| !tilt.is_finite()) {
            return Err(OrthogonalError::Params);
        }
        if root.iter().flatten().any(|entry| !entry.is_finite()) {
            return Err(OrthogonalError::SingularRoot);
        }
        let (root_inverse, rank) = mat3::pseudo_inverse(&mat3::svd(root), f64::EPSILON);
        if rank < 3 {
            return Err(OrthogonalError::SingularRoot);
        }
        Ok(Self { image, inliers, root, root_inverse, tilts })
    }

    fn integral(&self, rows: &Mat3) -> Option<Integrability> {
        integrability::integral(self.image, &self.inliers, &mat3::multiply(rows, self.root))
    }

    /// Polishes `rows` on the whole picture, and chooses between the twins.
    fn finish(&self, rows: Mat3, polish_evaluations: u32) -> Result<Found, OrthogonalError> {
        let unpolished = self.integral(&rows).ok_or(OrthogonalError::NoCells)?;
        let (rows, used) = polish::polish(rows, unpolished.mean, polish_evaluations, |rows| {
            self.integral(rows).map_or(f64::INFINITY, |integral| integral.mean)
        });
        let integral = self.integral(&rows).ok_or(OrthogonalError::NoCells)?;
        let [r1, r2, r3] = rows;
        let first = Transformation::new(rows, self.root, &self.root_inverse);
        let negated = [mat3::scale(r1, -1.0), mat3::scale(r2, -1.0), r3];
        let second = Transformation::new(negated, self.root, &self.root_inverse);
        let (choice, preference) = match self.tilts {
            Some(tilts) => (TwinChoice::Tilts, agreement(&first, tilts)),
            None => (TwinChoice::Convex, self.convexity(&first.f_inverse)),
        };
        let (transformation, twin) = if preference < 0.0 { (second, first) } else { (first, second) };
        Ok(Found {
            transformation,
            twin,
            choice,
            clarity: preference.abs(),
            integral,
            unpolished,
            evaluations: used + 2,
        })
    }

    /// From 1 where `n1_x + n2_y` is positive everywhere to -1 where it is negative everywhere.
    fn convexity(&self, f_inverse: &Mat3) -> f64 {
        let (mut sum, mut absolute) = (0.0, 0.0);
        for_each_cell(self.image, &self.inliers, f_inverse, |_, n_x, n_y| {
            let divergence = n_x[0] + n_y[1];
            sum += divergence;
            absolute += divergence.abs();
        });
        if absolute > 0.0 { sum / absolute } else { 0.0 }
    }
}

/// From 1 where the tilts of the rows of F are those given to -1 where they are opposite; a row along z has no say.
fn agreement(transformation: &Transformation, tilts: [f64; 3]) -> f64 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for ((slant, tilt), wanted) in transformation.slants.iter().zip(transformation.tilts).zip(tilts) {
        let weight = sincos(*slant).0.abs();
        sum += weight * sincos(tilt - wanted).1;
        weights += weight;
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// A unit vector along `v`; `None` when it has no direction.
fn unit(v: [f64; 3]) -> Option<[f64; 3]> {
    let length = sqrt(mat3::dot(v, v));
    (length > 0.0 && length.is_finite()).then(|| mat3::scale(v, 1.0 / length))
}
