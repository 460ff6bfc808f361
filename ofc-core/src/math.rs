//! Small dense linear algebra, random numbers, order statistics and distributions.

pub mod angle;
pub mod arena;
pub mod mat3;
pub mod mat6;
pub mod rng;
pub mod select;
pub mod student_t;
