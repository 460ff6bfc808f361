//! Oracles, scenes and loaders that the tests share.

pub mod linear;
pub mod photographs;
pub mod slant_oracle;
