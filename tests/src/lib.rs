//! Oracles, scenes and loaders that the tests share.
#![allow(clippy::missing_panics_doc, clippy::must_use_candidate, reason = "a panic is how a test fails")]

pub mod bust;
pub mod call_graph;
pub mod camera;
pub mod depth_maps;
pub mod depth_oracle;
pub mod depth_scenes;
pub mod depth_workspace;
pub mod header_text;
pub mod linear;
pub mod linear_scenes;
pub mod lit_reliefs;
pub mod lmeds_oracle;
pub mod painted_scenes;
pub mod photographs;
pub mod reason_scenes;
pub mod relief_scenes;
pub mod shaded_scenes;
pub mod shapes;
pub mod shipped;
pub mod shots;
pub mod slant_oracle;
pub mod solved;
pub mod stack_depth;
pub mod tolerances;

/// README's program in Rust compiles.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;
