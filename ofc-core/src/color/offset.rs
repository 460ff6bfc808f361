//! Light that is not the model's: colors on an ellipsoid that is not around black.
//!
//! Room light, a lens that glares and a black level that was not subtracted add nearly the same color to every pixel. The colors
//! then lie on (rho - a)^T C (rho - a) = 1. The cap that the camera sees of an ellipsoid looks much like the cap of a larger one
//! around another center, so a fit of the nine coefficients of a quadric fails. What works is a least-squares fit of the distances
//! of the colors from the ellipsoid, with Tukey's weights, that starts at black and at the C that was found there.
//!
//! It takes the colors that all lights reach: where one is shaded, colors lie on no ellipsoid. And it takes for an offset whatever
//! looks like one: near lights, interreflection and a curve of transfer do. Its own errors are from blocks of the picture rather than
//! from pixels, because what does not obey the model is alike in neighbors.
//!
//! # Reference
//! S. J. Ahn, W. Rauh, H.-J. Warnecke, "Least-squares orthogonal distances fitting of circle, sphere, ellipse, hyperbola, and
//! parabola", Pattern Recognition 34, 2001, for what is fitted; the distance is that of P. D. Sampson's approximation. K.-Y. Liang,
//! S. L. Zeger, "Longitudinal data analysis using generalized linear models", Biometrika 73, 1986, for errors from blocks.

mod center;
mod descent;
mod fit;
mod result;
mod sample;

pub use center::Centered;
pub use fit::fit;
pub use result::{LEAST, Offset, OffsetError};
pub use sample::workspace_len;
