//! Small dense linear algebra, random numbers, order statistics, distributions, the arena that cuts a caller's memory, and work in
//! parts.
//!
//! Nothing here knows of pictures or colors.

pub mod angle;
pub mod arena;
pub mod cholesky;
pub mod mat3;
pub mod mat6;
pub mod parallel;
pub mod pencil;
pub mod rng;
pub mod select;
pub mod student_t;
