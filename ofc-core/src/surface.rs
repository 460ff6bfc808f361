//! The surface: normals, how sure they are, and depth.

pub mod depth;
pub mod normals;
pub mod uncertainty;
