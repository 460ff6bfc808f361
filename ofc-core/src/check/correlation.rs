//! The correlation of two channels.

use libm::sqrt;

/// Sums for a correlation, relative to the first pair: values far from zero lose no digits.
#[derive(Clone, Copy, Default)]
pub(super) struct Correlation {
    first: Option<(f64, f64)>,
    count: f64,
    a: f64,
    b: f64,
    aa: f64,
    ab: f64,
    bb: f64,
}

impl Correlation {
    /// Adds a pair.
    pub fn add(&mut self, a: f64, b: f64) {
        let (first_a, first_b) = *self.first.get_or_insert((a, b));
        let (a, b) = (a - first_a, b - first_b);
        self.count += 1.0;
        self.a += a;
        self.b += b;
        self.aa += a * a;
        self.ab += a * b;
        self.bb += b * b;
    }

    /// The correlation; 0 where one of the two is constant.
    pub fn correlation(&self) -> f64 {
        let count = self.count.max(1.0);
        let (aa, bb) = (self.aa - self.a * self.a / count, self.bb - self.b * self.b / count);
        let ab = self.ab - self.a * self.b / count;
        let product = sqrt(aa.max(0.0)) * sqrt(bb.max(0.0));
        if product > 0.0 { (ab / product).clamp(-1.0, 1.0) } else { 0.0 }
    }
}
