//! The surface: [`normals`] by eq. 8, the [`uncertainty`] of each, and [`depth`] by integration.

pub mod depth;
pub mod normals;
pub mod uncertainty;
