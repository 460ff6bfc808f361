//! Colors are brought to about 1 before they are fitted: their squares and products are then of one size.

/// 2^-k for the k that brings `largest` into [1, 2): a power of two, so that scaling is exact.
pub(crate) fn reciprocal_power_of_two(largest: f32) -> f64 {
    libm::ldexp(1.0, -libm::ilogbf(largest))
}
