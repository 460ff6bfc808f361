//! The color-orientation matrix F, and the orthogonal transformation that C leaves open.
//!
//! [`matrix`] composes F and inverts it (eqs. 7, 8 and 19). [`integrability`] measures how far normals are from being those of
//! a surface (eq. 15). [`orthogonal`] finds the transformation by that measure alone, as the paper's section 2.3 does, and
//! [`joint`] by integrability and outward normals together. [`relief`] has no F: it finds slopes relative to a plane.

pub mod integrability;
pub mod joint;
pub mod matrix;
pub mod orthogonal;
pub mod relief;
