//! What rounding adds to colors.

/// The standard deviation of rounding to whole steps, in steps: 1 / sqrt(12).
pub(crate) const DEVIATION: f64 = 0.288_675_134_594_812_9;
