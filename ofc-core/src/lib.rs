//! Orientation from color: surface normals from one RGB picture of a uniformly coloured matte surface under several
//! unknown coloured lights.
//!
//! `no_std`, no allocation, no unsafe code, no panic: every function works over borrowed buffers.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod angle;
pub mod cells;
pub mod channel_maxima;
pub mod check;
pub mod constrained_slant;
pub mod depth;
pub mod differences;
pub mod ellipsoid;
pub mod flat_field;
pub mod image;
pub mod inliers;
pub mod integrability;
pub mod joint;
pub mod lmeds;
pub mod location;
pub mod mat3;
pub mod mat6;
pub mod normals;
pub mod orientation;
pub mod orthogonal;
pub mod pixels;
pub mod rank;
pub mod regression;
pub mod render;
pub mod rng;
pub mod segment;
pub mod select;
pub mod shadows;
pub mod slant;
pub mod solve;
pub mod stream;
pub mod student_t;
pub mod tilt;
pub mod uncertainty;
