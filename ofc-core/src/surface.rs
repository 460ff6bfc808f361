//! The surface: [`normals`] by eq. 8, the [`uncertainty`] of each, how far its pixel departs from the matte model ([`wolff`]), and
//! [`depth`] by integration.

pub mod completion;
pub mod depth;
pub mod normals;
mod rows;
pub mod uncertainty;
mod unit_normals;
pub mod wolff;
