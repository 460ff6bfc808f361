//! Oracles, scenes and loaders that the tests share.

pub mod slant_oracle;
