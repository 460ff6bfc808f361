//! Oracles, scenes and loaders that the tests share.

pub mod depth_maps;
pub mod photographs;
pub mod scene;
pub mod slant_oracle;
