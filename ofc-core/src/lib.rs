//! Orientation from color: surface normals from one RGB picture of a uniformly coloured matte surface under several
//! unknown coloured lights.
//!
//! `no_std`, no allocation, no unsafe code, no panic: every function works over borrowed buffers.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod math;
pub mod picture;

pub mod color;
pub mod light;
pub mod orientation;
pub mod surface;

pub mod render;

pub mod check;
pub mod solve;
pub mod stream;
