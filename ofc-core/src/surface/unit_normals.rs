//! Unit normals of a window at once, in single precision.
//!
//! A normal is written in single precision, so nothing is gained by more on the way to it where no digits cancel. The square root and
//! the division that make the length 1 are replaced by Newton's iteration for 1 / sqrt(s): additions and multiplications, which
//! vectorize and give the same bits on every machine.

use crate::math::mat3::Mat3;
use crate::picture::{WINDOW, Window, first_bits, for_each_bit};

/// F^-1 in single precision.
#[derive(Clone, Copy, Debug)]
pub struct UnitNormals {
    rows: [[f32; 3]; 3],
    /// The least square of a normal in relation to that of its color.
    least: f32,
}

impl UnitNormals {
    /// How short a normal may be in relation to the largest that a color of the same length may have: below this its digits have
    /// cancelled. The errors of what is left are below 5e-5 in each component, and in most normals 1e-7.
    const SHORTEST: f32 = 0.01;

    /// Of any matrix.
    pub fn new(f_inverse: &Mat3) -> Self {
        let rows = f_inverse.map(|row| row.map(|entry| entry as f32));
        let squares = rows.iter().flatten().fold(0.0, |sum, entry| sum + entry * entry);
        Self { rows, least: Self::SHORTEST * Self::SHORTEST * squares }
    }

    /// Writes the normals of those of the window's pixels that have a bit, and zeros for the others. The bits that it returns are those
    /// of pixels so dark, bright or close to the null space of F^-1 that single precision is not enough, and what is written for
    /// them means nothing.
    #[inline(never)]
    pub fn write(&self, window: &Window, bits: u64, normals: &mut [[f32; 3]]) -> u64 {
        if bits == 0 {
            normals.fill([0.0; 3]);
            return 0;
        }
        let [red, green, blue] = &window.color;
        let mut n = [[0.0_f32; WINDOW]; 3];
        for (component, row) in n.iter_mut().zip(self.rows) {
            for (((value, r), g), b) in component.iter_mut().zip(red).zip(green).zip(blue) {
                *value = dot(row, [*r, *g, *b]);
            }
        }
        let [x, y, z] = &n;
        let (mut factors, mut is_doubtful) = ([0.0_f32; WINDOW], false);
        for ((((((factor, x), y), z), r), g), b) in
            factors.iter_mut().zip(x).zip(y).zip(z).zip(red).zip(green).zip(blue)
        {
            *factor = self.factor([*x, *y, *z], [*r, *g, *b]);
            is_doubtful |= factor.is_nan();
        }
        for ((((normal, x), y), z), factor) in normals.iter_mut().zip(x).zip(y).zip(z).zip(&factors) {
            *normal = [x * factor, y * factor, z * factor];
        }
        let mut doubtful = 0;
        for_each_bit(first_bits(normals.len()) & if is_doubtful { u64::MAX } else { !bits }, |i| {
            if let (Some(normal), Some(factor)) = (normals.get_mut(i), factors.get(i)) {
                if bits >> i & 1 == 0 {
                    *normal = [0.0; 3];
                } else if factor.is_nan() {
                    doubtful |= 1 << i;
                }
            }
        });
        doubtful
    }

    /// What makes the length of a color's normal 1, NaN where single precision is not enough.
    #[inline]
    #[expect(clippy::needless_bitwise_bool, reason = "all of them at once, which vectors can")]
    fn factor(&self, n: [f32; 3], color: [f32; 3]) -> f32 {
        let (square, color) = (dot(n, n), dot(color, color));
        let is_certain =
            (square > self.least * color) & (square > SMALLEST) & (square < LARGEST) & (color < LARGEST);
        let factor = inverse_root(square);
        if is_certain { factor } else { f32::NAN }
    }
}

#[inline]
fn dot([a, b, c]: [f32; 3], [x, y, z]: [f32; 3]) -> f32 {
    a * x + b * y + c * z
}

/// Squares between these neither overflow nor lose digits, and neither do the products that they are sums of.
const SMALLEST: f32 = 1e-20;
const LARGEST: f32 = 1e30;

/// 1 / sqrt of a number that is neither tiny nor huge, to its last digit but one: half of the exponent, and three steps of Newton's
/// iteration, the last one as a correction, which rounds at the size of the error.
#[inline]
fn inverse_root(square: f32) -> f32 {
    let half = 0.5 * square;
    let mut root = f32::from_bits(0x5f37_59df_u32.wrapping_sub(square.to_bits() >> 1));
    root *= 1.5 - half * root * root;
    root *= 1.5 - half * root * root;
    root + root * (0.5 - half * root * root)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::mat3;
    use crate::math::rng::Rng;
    use crate::surface::normals::{Length, normal};

    #[test]
    fn normals_are_those_of_double_precision_or_left_to_it() {
        let mut rng = Rng::new(8);
        let (mut worst, mut left) = (0.0_f64, 0);
        for round in 0..600 {
            // Any matrix, well conditioned or nearly singular, and colors of any size.
            let size = libm::pow(10.0, 60.0 * rng.unit() - 30.0);
            let mut matrix = [[0.0; 3]; 3];
            for entry in matrix.iter_mut().flatten() {
                *entry = (rng.unit() - 0.5) / size;
            }
            if round % 3 == 0 {
                matrix[2] = mat3::scale(matrix[1], 1.0 + 1e-6 * rng.unit());
            }
            let mut window = Window::new();
            for channel in &mut window.color {
                channel.fill_with(|| (size * rng.unit()) as f32);
            }
            let (bits, len) = (rng.next_u64() | rng.next_u64(), 1 + rng.below(64) as usize);
            let mut normals = [[7.0; 3]; WINDOW];
            let doubtful =
                UnitNormals::new(&matrix).write(&window, bits & first_bits(len), &mut normals[..len]);
            assert_eq!(doubtful & !(bits & first_bits(len)), 0);
            left += doubtful.count_ones();
            for (i, found) in normals.iter().enumerate() {
                let wanted = normal(&matrix, window.pixel(i), Length::Unit);
                if i >= len {
                    assert_eq!(*found, [7.0; 3]);
                } else if bits >> i & 1 == 0 {
                    assert_eq!(*found, [0.0; 3]);
                } else if doubtful >> i & 1 == 0 {
                    for (found, wanted) in found.iter().zip(wanted) {
                        worst = worst.max((f64::from(*found) - wanted).abs());
                    }
                }
            }
        }
        assert!(worst < 5e-5 && left > 100, "{worst} {left}");
    }

    #[test]
    fn a_normal_does_not_depend_on_its_neighbors() {
        let matrix = [[0.004, 0.001, -0.002], [-0.001, 0.005, 0.001], [0.001, -0.001, 0.004]];
        let mut rng = Rng::new(9);
        let mut window = Window::new();
        for channel in &mut window.color {
            channel.fill_with(|| rng.below(256) as f32);
        }
        let mut among_all = [[0.0; 3]; WINDOW];
        let unit = UnitNormals::new(&matrix);
        assert_eq!(unit.write(&window, u64::MAX, &mut among_all), 0);
        for channel in &mut window.color {
            channel[20] = 0.0;
            channel[33] = f32::NAN;
        }
        let mut beside_black = [[0.0; 3]; WINDOW];
        assert_eq!(unit.write(&window, u64::MAX, &mut beside_black), 1 << 20 | 1 << 33);
        for i in (0..WINDOW).filter(|i| ![20, 33].contains(i)) {
            assert_eq!(among_all[i].map(f32::to_bits), beside_black[i].map(f32::to_bits), "{i}");
            let length = among_all[i].iter().map(|c| f64::from(*c).powi(2)).sum::<f64>();
            assert!((length - 1.0).abs() < 4e-7, "{length}");
        }
    }
}
