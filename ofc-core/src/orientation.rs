//! The color-orientation matrix F, and the orthogonal transformation that C leaves open.

pub mod integrability;
pub mod joint;
pub mod matrix;
pub mod orthogonal;
