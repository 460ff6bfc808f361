//! Oracles, scenes and loaders that the tests share.

pub mod photographs;
pub mod scene;
pub mod slant_oracle;
