//! What the colors alone say, wherever their pixels lie (section 2).
//!
//! [`regression`] solves M z = 1 by least squares and says how wrong z may be (eq. 11); [`lmeds`] does so robustly. `dispersion`
//! is eq. 12. [`ellipsoid`] makes of z the matrix C, its root, and the lengths and angles of the rows of F (eqs. 9, 10, 18).
//! [`inliers`] holds both rejections as bands of rho^T C rho: the first by the residual, the second by the length of the
//! normal, which [`norms`] and [`location`] find. [`shadows`] finds colors that a light does not reach, [`paint`] fits C
//! where the albedo is uneven, [`offset`] where the colors hold light of another kind, [`rank`] counts the dimensions of colors and normals, and [`segment`] separates materials.

pub(crate) mod dispersion;
pub mod ellipsoid;
pub mod inliers;
pub mod lmeds;
pub mod location;
pub mod norms;
pub mod offset;
pub mod paint;
pub mod rank;
pub mod regression;
pub(crate) mod rounding;
pub(crate) mod scale;
pub(crate) mod second_moments;
pub mod segment;
pub mod shadows;
