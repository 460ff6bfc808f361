//! Tilts of the channels' equivalent lights, one estimator a file.

pub mod pentland;
