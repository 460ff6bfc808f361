//! Moments of N over squares of pixels, and the plane that they make.

/// Numbers of [`Moments`].
pub(super) const NUMBERS: usize = 15;

/// Sums over the inliers of a square, x right and y up from its middle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moments {
    /// Of 1, x, y, x^2, x y, y^2.
    pub position: [f64; 6],
    /// Of N.
    pub normal: [f64; 3],
    /// Of x N.
    pub along_x: [f64; 3],
    /// Of y N.
    pub along_y: [f64; 3],
}

/// The sum of two, the second times `sign`.
#[inline]
fn plus(a: &[f64; NUMBERS], b: &[f64; NUMBERS], sign: f64) -> [f64; NUMBERS] {
    let mut sum = *a;
    for (sum, b) in sum.iter_mut().zip(b) {
        *sum += sign * b;
    }
    sum
}

/// The plane `N = middle + x N_x + y N_y` through the inliers of a square, about their mean position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    /// The mean of N.
    pub middle: [f64; 3],
    /// `N_x` and `N_y`.
    pub gradient: [[f64; 3]; 2],
    /// The variances of `N_x` and `N_y` and their covariance (xx, xy, yy), as multiples of that of a pixel.
    pub variance: [f64; 3],
}

impl Moments {
    pub fn load(numbers: &[f32; NUMBERS]) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = numbers.map(f64::from);
        Self { position: [a, b, c, d, e, f], normal: [g, h, i], along_x: [j, k, l], along_y: [m, n, o] }
    }

    pub fn store(&self, numbers: &mut [f32; NUMBERS]) {
        let all = self.position.iter().chain(&self.normal).chain(&self.along_x).chain(&self.along_y);
        for (slot, &value) in numbers.iter_mut().zip(all) {
            *slot = value as f32;
        }
    }

    /// Pixels that are inliers.
    pub const fn count(&self) -> f64 {
        let [count, ..] = self.position;
        count
    }

    pub fn add_pixel(&mut self, x: f64, y: f64, n: [f64; 3]) {
        for (sum, term) in self.position.iter_mut().zip([1.0, x, y, x * x, x * y, y * y]) {
            *sum += term;
        }
        let sums = self.normal.iter_mut().zip(&mut self.along_x).zip(&mut self.along_y);
        for (((sum, along_x), along_y), value) in sums.zip(n) {
            *sum += value;
            *along_x += x * value;
            *along_y += y * value;
        }
    }

    /// Adds the sums of a square whose middle lies at (`dx`, `dy`) from this one's.
    pub fn add(&mut self, other: &Self, dx: f64, dy: f64) {
        let [n, x, y, xx, xy, yy] = other.position;
        let shifted = [
            n,
            x + dx * n,
            y + dy * n,
            xx + dx * (2.0 * x + dx * n),
            xy + dx * y + dy * (x + dx * n),
            yy + dy * (2.0 * y + dy * n),
        ];
        for (sum, term) in self.position.iter_mut().zip(shifted) {
            *sum += term;
        }
        for (i, &value) in other.normal.iter().enumerate() {
            let at = |values: &[f64; 3]| values.get(i).copied().unwrap_or(0.0);
            let (along_x, along_y) = (at(&other.along_x), at(&other.along_y));
            for (sums, term) in [
                (&mut self.normal, value),
                (&mut self.along_x, along_x + dx * value),
                (&mut self.along_y, along_y + dy * value),
            ] {
                if let Some(sum) = sums.get_mut(i) {
                    *sum += term;
                }
            }
        }
    }

    /// The sums of two by two squares (top left and right, bottom left and right) about their common corner, from which the middles of all
    /// four are `half` away along each axis.
    #[inline]
    pub fn of_four(squares: [&[f32; NUMBERS]; 4], half: f64) -> Self {
        let [top_left, top_right, bottom_left, bottom_right] = squares.map(|numbers| numbers.map(f64::from));
        let [left, right] = [plus(&top_left, &bottom_left, 1.0), plus(&top_right, &bottom_right, 1.0)];
        let [top, bottom] = [plus(&top_left, &top_right, 1.0), plus(&bottom_left, &bottom_right, 1.0)];
        let all = plus(&left, &right, 1.0);
        let [right, up] =
            [plus(&right, &left, -1.0), plus(&top, &bottom, -1.0)].map(|sums| sums.map(|sum| half * sum));
        let [n, x, y, xx, xy, yy, a, b, c, d, e, f, g, h, i] = all;
        let [across, right_x, right_y, .., u, v, w, _, _, _, _, _, _] = right;
        let [above, up_x, up_y, .., p, q, r, _, _, _, _, _, _] = up;
        let ([tl, ..], [tr, ..], [bl, ..], [br, ..]) = (top_left, top_right, bottom_left, bottom_right);
        let square = half * half;
        Self {
            position: [
                n,
                x + across,
                y + above,
                xx + 2.0 * right_x + square * n,
                xy + right_y + up_x + square * ((tr - tl) - (br - bl)),
                yy + 2.0 * up_y + square * n,
            ],
            normal: [a, b, c],
            along_x: [d + u, e + v, f + w],
            along_y: [g + p, h + q, i + r],
        }
    }

    /// The plane; `None` where the inliers lie on a line.
    pub fn plane(&self) -> Option<Plane> {
        let [n, x, y, xx, xy, yy] = self.position;
        if n < 3.5 {
            return None;
        }
        let (x, y) = (x / n, y / n);
        let (xx, xy, yy) = (xx - n * x * x, xy - n * x * y, yy - n * y * y);
        let determinant = xx * yy - xy * xy;
        if determinant.is_nan() || determinant <= 1e-6 * n * n {
            return None;
        }
        let (a, b, c) = (yy / determinant, -xy / determinant, xx / determinant);
        let (mut gradient, mut middle) = ([[0.0; 3]; 2], self.normal);
        let [along_x, along_y] = &mut gradient;
        let sums = self.normal.iter().zip(self.along_x).zip(self.along_y);
        for ((((&sum, sx), sy), out_x), out_y) in sums.zip(along_x).zip(along_y) {
            let (sx, sy) = (sx - x * sum, sy - y * sum);
            (*out_x, *out_y) = (a * sx + b * sy, b * sx + c * sy);
        }
        for value in &mut middle {
            *value /= n;
        }
        Some(Plane { middle, gradient, variance: [a, b, c] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;

    fn close(a: &Moments, b: &Moments) -> bool {
        let all = |m: &Moments| {
            let mut numbers = [0.0; NUMBERS];
            m.store(&mut numbers);
            numbers
        };
        all(a).iter().zip(all(b)).all(|(a, b)| (a - b).abs() <= 1e-5 * b.abs().max(1.0))
    }

    #[test]
    fn sums_about_another_middle_are_those_of_the_moved_pixels() {
        let mut rng = Rng::new(4);
        let (mut own, mut moved) = (Moments::default(), Moments::default());
        let (dx, dy) = (3.5, -2.25);
        for _ in 0..30 {
            let [x, y, a, b, c] = [(); 5].map(|()| 4.0 * rng.unit() - 2.0);
            own.add_pixel(x, y, [a, b, c]);
            moved.add_pixel(x + dx, y + dy, [a, b, c]);
        }
        let mut added = Moments::default();
        added.add(&own, dx, dy);
        assert!(close(&added, &moved), "{added:?} {moved:?}");
        let mut numbers = [0.0; NUMBERS];
        own.store(&mut numbers);
        assert!(close(&Moments::load(&numbers), &own) && (own.count() - 30.0).abs() < 1e-12);
    }

    #[test]
    fn two_by_two_squares_are_their_moved_sums() {
        let mut rng = Rng::new(6);
        let mut numbers = [[0.0; NUMBERS]; 4];
        let mut expected = Moments::default();
        for (numbers, [dx, dy]) in
            numbers.iter_mut().zip([[-2.0, 2.0], [2.0, 2.0], [-2.0, -2.0], [2.0, -2.0]])
        {
            let mut own = Moments::default();
            for _ in 0..10 {
                let [x, y, a, b, c] = [(); 5].map(|()| 4.0 * rng.unit() - 2.0);
                own.add_pixel(x, y, [a, b, c]);
            }
            own.store(numbers);
            expected.add(&own, dx, dy);
        }
        let found = Moments::of_four(numbers.each_ref(), 2.0);
        assert!(close(&found, &expected), "{found:?} {expected:?}");
    }

    #[test]
    fn a_plane_is_found_with_the_variance_of_its_slopes() {
        let mut rng = Rng::new(5);
        let (middle, along_x, along_y) = ([0.3, -0.2, 0.9], [0.05, -0.01, 0.02], [-0.03, 0.04, 0.01]);
        let mut sums = Moments::default();
        let places = [(); 12].map(|()| [8.0 * rng.unit() - 3.0, 6.0 * rng.unit() - 4.0]);
        let mut mean = [0.0; 2];
        for [x, y] in places {
            sums.add_pixel(x, y, [0, 1, 2].map(|i: usize| middle[i] + x * along_x[i] + y * along_y[i]));
            mean = [mean[0] + x / 12.0, mean[1] + y / 12.0];
        }
        let plane = sums.plane().unwrap();
        let ([x, y], [mut xx, mut xy, mut yy]) = (mean, [0.0; 3]);
        for [px, py] in places {
            (xx, xy, yy) = (xx + (px - x) * (px - x), xy + (px - x) * (py - y), yy + (py - y) * (py - y));
        }
        for i in 0..3 {
            assert!((plane.gradient[0][i] - along_x[i]).abs() < 1e-12);
            assert!((plane.gradient[1][i] - along_y[i]).abs() < 1e-12);
            let there = middle[i] + x * along_x[i] + y * along_y[i];
            assert!((plane.middle[i] - there).abs() < 1e-12);
        }
        // The inverse of the scatter of the places.
        let [a, b, c] = plane.variance;
        assert!((a * xx + b * xy - 1.0).abs() < 1e-12 && (a * xy + b * yy).abs() < 1e-12);
        assert!((b * xx + c * xy).abs() < 1e-12 && (b * xy + c * yy - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_line_is_no_plane() {
        let (mut line, mut few) = (Moments::default(), Moments::default());
        for i in 0..10 {
            let x = f64::from(i);
            line.add_pixel(x, 2.0 * x - 1.0, [x, 1.0, 0.0]);
        }
        for (x, y) in [(0.0, 0.0), (5.0, 0.0), (0.0, 5.0)] {
            few.add_pixel(x, y, [1.0; 3]);
        }
        assert!(line.plane().is_none() && few.plane().is_none());
        few.add_pixel(5.0, 5.0, [1.0; 3]);
        assert!(few.plane().is_some());
    }
}
