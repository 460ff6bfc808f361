//! Oracles, scenes and loaders that the tests share.

pub mod photographs;
