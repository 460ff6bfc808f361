//! Vectors in single precision, as every pixel has them.

use crate::math::mat3::Mat3;
use libm::sqrtf;

/// Three numbers in the frame of the normals.
pub(super) type Vector = [f32; 3];

/// Three rows.
pub(super) type Matrix = [[f32; 3]; 3];

pub(super) const ZERO: Vector = [0.0; 3];

#[inline]
pub(super) fn dot([a, b, c]: Vector, [x, y, z]: Vector) -> f32 {
    a * x + b * y + c * z
}

#[inline]
pub(super) fn cross([a, b, c]: Vector, [x, y, z]: Vector) -> Vector {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

/// a + s b.
#[inline]
pub(super) fn add([a, b, c]: Vector, s: f32, [x, y, z]: Vector) -> Vector {
    [a + s * x, b + s * y, c + s * z]
}

#[inline]
pub(super) fn scale([a, b, c]: Vector, s: f32) -> Vector {
    [s * a, s * b, s * c]
}

#[inline]
pub(super) fn length(a: Vector) -> f32 {
    sqrtf(dot(a, a))
}

/// Of length 1, or zero where there is no direction.
#[inline]
pub(super) fn unit(a: Vector) -> Vector {
    scale(a, 1.0 / length(a).max(1e-18))
}

/// |a - b|^2.
#[inline]
pub(super) fn distance_squared(a: Vector, b: Vector) -> f32 {
    let d = add(a, -1.0, b);
    dot(d, d)
}

#[inline]
pub(super) fn apply([a, b, c]: &Matrix, v: Vector) -> Vector {
    [dot(*a, v), dot(*b, v), dot(*c, v)]
}

/// M^T v.
#[inline]
pub(super) fn transposed([a, b, c]: &Matrix, [x, y, z]: Vector) -> Vector {
    add(add(scale(*a, x), y, *b), z, *c)
}

/// v^T M v.
#[inline]
pub(super) fn form(m: &Matrix, v: Vector) -> f32 {
    dot(v, apply(m, v))
}

pub(super) fn trace([[a, ..], [_, b, _], [.., c]]: &Matrix) -> f32 {
    a + b + c
}

/// Rounded to single precision.
pub(super) fn single(a: [f64; 3]) -> Vector {
    a.map(|x| x as f32)
}

/// Rounded to single precision.
pub(super) fn single_matrix(a: &Mat3) -> Matrix {
    a.map(single)
}
