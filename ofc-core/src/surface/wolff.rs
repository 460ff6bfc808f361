//! How far a matte surface departs from the matte model toward its outline.
//!
//! The linear model (7) says that a matte surface is as bright from everywhere. The light of a smooth dielectric (plastic, glaze,
//! paint, a gel) comes from below its surface, and Fresnel's equations say how much of it gets out. By Wolff's model a light of
//! strength L at an angle psi from the normal makes, seen at an angle phi from the normal, the radiance
//!
//! ```text
//! albedo L (1 - R(psi)) cos psi (1 - R(phi)),
//! ```
//!
//! R being the reflectance of unpolarized light at that angle in air (from inside, at the refracted angle, it is the same). What is
//! seen of every light at once is the last factor, which depends on the angle between the normal and the line of sight alone. Over
//! what it is at phi = 0 it is the *matte weight* of a pixel: 1 where a normal faces the camera, and for a refractive index of
//! 1.5 still 0.95 at 60 degrees, 0.86 at 70, 0.64 at 80 and 0 at 90. Colors are darker than the model says by this factor, so
//! their normals are too short, and fits, depth and shading can count a pixel the less the smaller its weight is.
//!
//! The first factor, of lights that graze the surface, is different for each of them: the model holds their sum alone, and no pixel
//! says it.
//!
//! # Reference
//! Section 5, which names the departure. \[26\]: L. B. Wolff, "Diffuse reflection", CVPR 1992. L. B. Wolff, "Diffuse-reflectance model
//! for smooth dielectric surfaces", J. Opt. Soc. Am. A 11, 1994.

use super::normals::{Length, normal};
use super::rows::{self, TooShort};
use crate::math::mat3::Mat3;
use crate::picture::{Image, Window};
use libm::sqrt;

/// A smooth surface of something transparent over something matte.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dielectric {
    refractive_index: f64,
}

impl Dielectric {
    /// Of a refractive index, at least 1: 1.5 for most plastics, glazes and paints, 1.4 for silicone, 1 for a surface that is as the
    /// model says. `None` for one that is smaller or not finite.
    #[must_use]
    pub fn new(refractive_index: f64) -> Option<Self> {
        (refractive_index >= 1.0 && refractive_index.is_finite()).then_some(Self { refractive_index })
    }

    /// The matte weight, from 0 to 1, of a unit normal with this component toward the camera; 0 where it faces away.
    #[must_use]
    pub fn weight(&self, n3: f64) -> f64 {
        if n3.is_nan() || n3 <= f64::EPSILON {
            return 0.0;
        }
        let (outside, index) = (n3.min(1.0), self.refractive_index);
        // The cosine of the refracted angle.
        let inside = sqrt(index * index - 1.0 + outside * outside) / index;
        // Fresnel's transmittances for light across and along the plane of incidence, each over 4 n cos phi cos t.
        let (across, along) = (outside + index * inside, index * outside + inside);
        let transmitted = outside * inside * (1.0 / (across * across) + 1.0 / (along * along));
        // Above a refractive index of about four more light may leave aslant than straight.
        (0.5 * (1.0 + index) * (1.0 + index) * transmitted).min(1.0)
    }

    /// Writes the matte weight of every inlier's normal, `f_inverse` rho of unit length, and 0 everywhere else: there is no normal
    /// there.
    ///
    /// # Shape
    /// `weights` is height rows of width, rows `row_stride` `f32` apart, row 0 at the top; what lies between rows is left alone.
    ///
    /// # Errors
    /// [`TooShort`], also when a row stride is smaller than a row.
    pub fn compute(
        &self,
        image: &Image,
        inliers: impl Fn(&Window) -> u64,
        f_inverse: &Mat3,
        weights: &mut [f32],
        row_stride: usize,
    ) -> Result<(), TooShort> {
        let weight = |color| {
            let [.., n3] = normal(f_inverse, color, Length::Unit);
            [self.weight(n3) as f32]
        };
        rows::write(image, inliers, weight, 0.0, weights, row_stride)
    }
}
