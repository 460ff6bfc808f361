//! What the colors alone say, wherever their pixels lie: the quadratic form C and its robust fit, the pixels that obey the
//! model, shadows, ranks, and regions of different colors.

mod dispersion;
pub mod ellipsoid;
pub mod inliers;
pub mod lmeds;
pub mod location;
pub mod norms;
pub mod rank;
pub mod regression;
pub mod segment;
pub mod shadows;
