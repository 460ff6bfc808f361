//! Oracles, scenes and loaders that the tests share.

pub mod photographs;
pub mod scenes;
pub mod slant_oracle;
