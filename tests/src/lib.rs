//! Oracles, scenes and loaders that the tests share.

pub mod linear;
pub mod lmeds_oracle;
pub mod photographs;
pub mod scenes;
pub mod slant_oracle;
pub mod tolerances;
