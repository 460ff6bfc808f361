//! What every method to the transformation starts from, and how it ends: the polish, and the choice between the twins.

use super::polish;
use super::result::{Found, OrthogonalError, Transformation, TwinChoice};
use super::sample::for_each_cell;
use crate::math::angle::sincos;
use crate::math::mat3::{self, Mat3};
use crate::orientation::integrability::{self, Integrability};
use crate::picture::{Image, Window};

/// G0, its inverse, and the inliers of a picture.
pub(super) struct Problem<'a, 'p, S> {
    image: &'a Image<'p>,
    pub inliers: S,
    root: &'a Mat3,
    root_inverse: Mat3,
    tilts: Option<[f64; 3]>,
}

impl<'a, 'p, S: Fn(&Window) -> u64> Problem<'a, 'p, S> {
    pub fn new(
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
    pub fn finish(&self, rows: Mat3, polish_evaluations: u32) -> Result<Found, OrthogonalError> {
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
