//! Every solution of eqs. 24 by elimination: another way than the core's, and no code of it.
//!
//! For a given slant 3, eqs. 13 and 23 give two slants 1 and two slants 2, and eq. 12 must hold for one of the four
//! combinations. The product of its residuals over all four, times R1^4 R2^4 to clear denominators, is a polynomial in
//! cos s3 and sin s3 that does not change under s -> -s and s -> s + pi: a polynomial in c = cos 2 s3, and counting
//! solutions (sixteen, four of which share each c) makes it a quartic. Its values at five points determine it.

use std::f64::consts::{FRAC_PI_2, PI};

/// Slants that solve eqs. 24 for the given tilts and cosines (h12, h13, h23), each in [0, pi/2], residuals below 1e-11.
/// Not sorted; solutions less than `1e-6` apart are one.
#[must_use]
pub fn roots(tilts: [f64; 3], cosines: [f64; 3]) -> Vec<[f64; 3]> {
    let [t1, t2, t3] = tilts;
    let k = [(t1 - t2).cos(), (t1 - t3).cos(), (t2 - t3).cos()];
    let quartic = Quartic::through(|c| eliminated(k, cosines, c));
    let mut found: Vec<[f64; 3]> = Vec::new();
    for c in quartic.candidates() {
        let s3 = 0.5 * c.clamp(-1.0, 1.0).acos();
        // Rounding in the quartic moves its close roots; starts beside them let Newton's method reach each.
        for beside in [0.0, 1e-4, -1e-4, 3e-3, -3e-3] {
            for start in starts(k, cosines, s3 + beside) {
                let Some(root) = newton(k, cosines, start) else { continue };
                if found.iter().all(|known| distance(*known, root) > 1e-6) {
                    found.push(root);
                }
            }
        }
    }
    found
}

/// The largest difference between two triples of slants.
#[must_use]
pub fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// Both sides' differences in eqs. 24.
#[must_use]
pub fn residuals(k: [f64; 3], h: [f64; 3], s: [f64; 3]) -> [f64; 3] {
    [(0, 1), (0, 2), (1, 2)].map(|(i, j)| {
        let pair = i + j - 1;
        k[pair] * s[i].sin() * s[j].sin() + s[i].cos() * s[j].cos() - h[pair]
    })
}

/// The derivatives of eqs. 24.
#[must_use]
pub fn jacobian(k: [f64; 3], s: [f64; 3]) -> [[f64; 3]; 3] {
    [(0, 1), (0, 2), (1, 2)].map(|(i, j)| {
        let mut row = [0.0; 3];
        row[i] = k[i + j - 1] * s[i].cos() * s[j].sin() - s[i].sin() * s[j].cos();
        row[j] = k[i + j - 1] * s[i].sin() * s[j].cos() - s[i].cos() * s[j].sin();
        row
    })
}

/// The determinant of a 3x3 matrix.
#[must_use]
pub fn determinant(m: [[f64; 3]; 3]) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

/// The product over both signs of u and v of eq. 12 with slants 1 and 2 from eqs. 13 and 23.
fn eliminated(k: [f64; 3], h: [f64; 3], c: f64) -> f64 {
    let s3 = 0.5 * c.acos();
    // cos s1 = (a1 h13 + b1 u) / r1, sin s1 = (b1 h13 - a1 u) / r1, u^2 = r1 - h13^2, possibly negative; s2 alike.
    let (a, b1, b2) = (s3.cos(), k[1] * s3.sin(), k[2] * s3.sin());
    let (r1, r2) = (a * a + b1 * b1, a * a + b2 * b2);
    let (uu, vv) = (r1 - h[1] * h[1], r2 - h[2] * h[2]);
    // Eq. 12 times r1 r2 is p + q u + r v + s u v.
    let p = k[0] * b1 * h[1] * b2 * h[2] + a * h[1] * a * h[2] - h[0] * r1 * r2;
    let q = -k[0] * a * b2 * h[2] + b1 * a * h[2];
    let r = -k[0] * b1 * h[1] * a + a * h[1] * b2;
    let s = k[0] * a * a + b1 * b2;
    let even = p * p + r * r * vv - uu * (q * q + s * s * vv);
    let odd = 2.0 * (p * r - uu * q * s);
    (even * even - vv * odd * odd) / (r1 * r1 * r2 * r2)
}

/// A polynomial of degree four as Newton's divided differences.
struct Quartic {
    nodes: [f64; 5],
    coefficients: [f64; 5],
}

impl Quartic {
    fn through(f: impl Fn(f64) -> f64) -> Self {
        let nodes = [0, 1, 2, 3, 4].map(|i| (PI * (2.0 * f64::from(i) + 1.0) / 10.0).cos());
        let mut coefficients = nodes.map(f);
        for order in 1..5 {
            for i in (order..5).rev() {
                coefficients[i] = (coefficients[i] - coefficients[i - 1]) / (nodes[i] - nodes[i - order]);
            }
        }
        Self { nodes, coefficients }
    }

    fn at(&self, c: f64) -> f64 {
        let mut value = 0.0;
        for (node, coefficient) in self.nodes.iter().zip(self.coefficients).rev() {
            value = value * (c - node) + coefficient;
        }
        value
    }

    /// Where the polynomial crosses zero in [-1, 1], and every extremum and end, where it may touch zero. Too many is
    /// no harm: what comes of them is checked in eqs. 24.
    fn candidates(&self) -> Vec<f64> {
        const STEPS: i32 = 400;
        // Even in cos-space: finer at the ends, as slants are uniform in the angle.
        let grid: Vec<f64> = (0..=STEPS).map(|i| (PI * f64::from(i) / f64::from(STEPS)).cos()).collect();
        let mut candidates = vec![1.0, -1.0];
        for pair in grid.windows(2) {
            if self.at(pair[0]) * self.at(pair[1]) <= 0.0 {
                candidates.push(bisect(|c| self.at(c), pair[0], pair[1]));
            }
        }
        for triple in grid.windows(3) {
            let [before, here, after] = [triple[0], triple[1], triple[2]].map(|c| self.at(c));
            if (before - here) * (here - after) <= 0.0 {
                let slope = |c: f64| self.at(c + 1e-6) - self.at(c - 1e-6);
                let extremum = bisect(slope, triple[0], triple[2]);
                candidates.push(extremum);
                // A pair of crossings between two grid points lies on the two sides of the extremum.
                for end in [triple[0], triple[2]] {
                    if self.at(extremum) * self.at(end) <= 0.0 {
                        candidates.push(bisect(|c| self.at(c), extremum, end));
                    }
                }
            }
        }
        candidates
    }
}

fn bisect(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let (mut from, mut to) = (from, to);
    let from_sign = f(from) > 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        if (f(middle) > 0.0) == from_sign {
            from = middle;
        } else {
            to = middle;
        }
    }
    0.5 * (from + to)
}

/// The four combinations of slants 1 and 2 that go with slant 3.
fn starts(k: [f64; 3], h: [f64; 3], s3: f64) -> [[f64; 3]; 4] {
    let ([p1, m1], [p2, m2]) = (others(k[1], h[1], s3), others(k[2], h[2], s3));
    [[p1, p2, s3], [p1, m2, s3], [m1, p2, s3], [m1, m2, s3]]
}

/// The two slants that make the angle arccos h with one of slant s; where there is none by a little, the nearest one.
fn others(k: f64, h: f64, s: f64) -> [f64; 2] {
    let (a, b) = (s.cos(), k * s.sin());
    let (phi, alpha) = (b.atan2(a), (h / a.hypot(b)).clamp(-1.0, 1.0).acos());
    [phi + alpha, phi - alpha]
}

/// Newton's method from a start that should be close, by Cramer's rule.
fn newton(k: [f64; 3], h: [f64; 3], start: [f64; 3]) -> Option<[f64; 3]> {
    let inside = |s: f64| (-1e-9..=FRAC_PI_2 + 1e-9).contains(&s);
    let mut s = start;
    for _ in 0..40 {
        let (f, j) = (residuals(k, h, s), jacobian(k, s));
        let det = determinant(j);
        if det.abs() < 1e-14 || f.iter().all(|f| f.abs() < 1e-15) {
            break;
        }
        for column in 0..3 {
            let mut replaced = j;
            for row in 0..3 {
                replaced[row][column] = f[row];
            }
            s[column] -= determinant(replaced) / det;
        }
    }
    let good = residuals(k, h, s).iter().all(|f| f.abs() < 1e-11) && s.iter().all(|&s| inside(s));
    good.then_some(s)
}
