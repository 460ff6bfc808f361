//! Tilts of the channels' equivalent lights, one estimator a file.

pub mod chojnacki;
pub mod lee_rosenfeld;
pub mod pentland;
pub mod zheng_chellappa;

/// Whether a mean gradient points anywhere.
fn has_direction(x: f64, y: f64) -> bool {
    x.is_finite() && y.is_finite() && (x != 0.0 || y != 0.0)
}
