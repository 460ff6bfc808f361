//! How sure F and every normal are.
//!
//! An error of G = F^-1 is written as G -> (1 + T) G. Its symmetric part is an error of C ([`Fit::covariance`]), its
//! antisymmetric part a rotation ([`Joint::covariance`]). The covariance of T gives that of F, by dF = -F T, and that of a normal,
//! by dn = T n + G d rho, where d rho is noise of equal deviation in every channel ([`Fit::pixel_noise`]). `docs/uncertainty.md`
//! derives this.
//!
//! The result is the 1-sigma angle of each normal, below which 68.3 % of the errors are expected to lie. Then 95.4 to 99.0 %
//! lie below twice the angle and 99.7 to 100.0 % below three times ([`one_sigma`]). Errors of C and of the rotation are shared by
//! all pixels of a picture: the shares in one picture may be far from these, over many pictures they are not.
//!
//! What is not in it: pixels that do not obey the model and are inliers all the same (the edge of a shadow), the choice
//! between a surface and its twin ([`Joint::convexity`]), and orientations far from the best one ([`Joint::second_best`]).
//!
//! [`Fit::covariance`]: crate::color::lmeds::Fit::covariance
//! [`Fit::pixel_noise`]: crate::color::lmeds::Fit::pixel_noise
//! [`Joint::covariance`]: crate::orientation::joint::Joint::covariance
//! [`Joint::convexity`]: crate::orientation::joint::Joint::convexity
//! [`Joint::second_best`]: crate::orientation::joint::Joint::second_best

mod angle;
mod propagate;

pub use angle::one_sigma;
pub use propagate::{Covariance9, of_f, of_f_inverse, of_turn};

use super::rows::{self, TooShort};
use crate::color::regression::Triangle;
use crate::math::mat3::{self, Mat3};
use crate::math::parallel::{Parallel, Serial};
use crate::picture::{Image, Window};
use core::f64::consts::PI;
use libm::sqrt;

/// What the uncertainty of normals comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sources {
    /// F, in pixel values.
    pub f: Mat3,
    /// Its inverse.
    pub f_inverse: Mat3,
    /// Expected squares and products of the errors of the coefficients of C.
    pub c: Triangle,
    /// Covariance of the rotation, in the frame of n, radians squared.
    pub rotation: Mat3,
    /// Noise in each channel, as a standard deviation in pixel values.
    pub noise: f64,
}

/// Covariances of normals, ready for many of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    f_inverse: Mat3,
    /// Of noise alone, for a normal of length 1.
    noise: Mat3,
    /// The six entries (xx, yy, zz, xy, xz, yz) of the covariance of T n, each as coefficients of the monomials (xx, yy, zz, xy,
    /// xz, yz) of n.
    model: [[f64; 6]; 6],
}

impl Uncertainty {
    /// From what it comes from.
    #[must_use]
    #[inline(never)]
    pub fn new(sources: &Sources) -> Self {
        let Sources { f, f_inverse, c, rotation, noise } = sources;
        let variance = noise * noise;
        Self {
            f_inverse: *f_inverse,
            noise: mat3::multiply(f_inverse, &mat3::transpose(f_inverse))
                .map(|row| mat3::scale(row, variance)),
            model: propagate::forms(&of_turn(f, c, rotation)),
        }
    }

    /// The 1-sigma angle of the normal of a color, in radians, at most pi; pi for black, which has no normal.
    #[must_use]
    #[inline]
    pub fn angle(&self, color: [f32; 3]) -> f64 {
        let n = mat3::apply(&self.f_inverse, color.map(f64::from));
        let square = mat3::dot(n, n);
        if !(square > 0.0 && square.is_finite()) {
            return PI;
        }
        let n = mat3::scale(n, 1.0 / sqrt(square));
        let [x, y, z] = n;
        let monomials = [x * x, y * y, z * z, x * y, x * z, y * z];
        let [xx, yy, zz, xy, xz, yz] = self
            .model
            .each_ref()
            .map(|form| form.iter().zip(monomials).fold(0.0, |sum, (entry, term)| sum + entry * term));
        let mut covariance = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        for (row, noise) in covariance.iter_mut().zip(&self.noise) {
            for (entry, noise) in row.iter_mut().zip(noise) {
                *entry += noise / square;
            }
        }
        one_sigma(&covariance, n).min(PI)
    }

    /// Writes the 1-sigma angle of every inlier's normal, in radians, and pi everywhere else: there is no normal there.
    ///
    /// # Shape
    /// `angles` is height rows of width, rows `row_stride` `f32` apart, row 0 at the top; what lies between rows is left alone.
    ///
    /// # Errors
    /// [`TooShort`], also when a row stride is smaller than a row.
    ///
    /// # Example
    /// ```
    /// use ofc_core::Uncertainty;
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
    /// let sources = solution.uncertainty_sources().expect("the joint method knows");
    /// let mut angles = vec![0.0; 96 * 96];
    /// Uncertainty::new(&sources).compute(&image, solution.inliers.selector(), &mut angles, 96).unwrap();
    /// assert!(angles[48 * 96 + 48].to_degrees() < 2.0); // in the middle
    /// ```
    pub fn compute(
        &self,
        image: &Image,
        inliers: impl Fn(&Window) -> u64 + Sync,
        angles: &mut [f32],
        row_stride: usize,
    ) -> Result<(), TooShort> {
        self.compute_in_parts(image, inliers, angles, row_stride, &Serial)
    }

    /// What [`Self::compute`] writes, by whatever runs parts.
    ///
    /// # Shape
    /// As [`Self::compute`].
    ///
    /// # Errors
    /// As [`Self::compute`].
    pub fn compute_in_parts(
        &self,
        image: &Image,
        inliers: impl Fn(&Window) -> u64 + Sync,
        angles: &mut [f32],
        row_stride: usize,
        parallel: &impl Parallel,
    ) -> Result<(), TooShort> {
        let own = *self;
        let angle = move |color| [own.angle(color) as f32];
        rows::write_each_in_parts(image, inliers, angle, PI as f32, angles, row_stride, parallel)
    }
}
