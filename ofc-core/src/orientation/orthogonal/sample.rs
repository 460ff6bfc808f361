//! Cells of four inliers as a vector and its differences, and a sample of them that makes (15) cheap to compute.
//!
//! # Reference
//! Section 2.3, eq. 15, by the quotient rule (see the parent module).

use crate::math::mat3::{self, Mat3};
use crate::orientation::integrability::SMALLEST_N3;
use crate::picture::cells::for_each_block;
use crate::picture::{Image, Window, for_each_bit};

/// Visits every cell of four inliers with the mean over it of v = `transform` rho, and its differences `v_x` and `v_y` (y
/// up), a pixel apart.
pub(crate) fn for_each_cell(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    transform: &Mat3,
    mut visit: impl FnMut([f64; 3], [f64; 3], [f64; 3]),
) {
    for_each_block(image, inliers, |block| {
        for_each_bit(block.cells(), |i| {
            let at = |window: &Window, i| window.pixel(i).map(f64::from);
            let (nw, ne) = (at(&block.top, i), at(&block.top, i + 1));
            let (sw, se) = (at(&block.bottom, i), at(&block.bottom, i + 1));
            let west = add(nw, sw);
            let east = add(ne, se);
            let mean = mat3::scale(add(west, east), 0.25);
            let x = mat3::scale(subtract(east, west), 0.5);
            let y = mat3::scale(subtract(add(nw, ne), add(sw, se)), 0.5);
            visit(mat3::apply(transform, mean), mat3::apply(transform, x), mat3::apply(transform, y));
        });
    });
}

fn add([a1, a2, a3]: [f64; 3], [b1, b2, b3]: [f64; 3]) -> [f64; 3] {
    [a1 + b1, a2 + b2, a3 + b3]
}

fn subtract([a1, a2, a3]: [f64; 3], [b1, b2, b3]: [f64; 3]) -> [f64; 3] {
    [a1 - b1, a2 - b2, a3 - b3]
}

/// `f32` of workspace for one cell.
pub(crate) const CELL: usize = 9;

/// The cells that a search looks at: `v`, `v x v_x` and `v x v_y` of each.
pub(crate) struct Sample<'w> {
    cells: &'w [[f32; CELL]],
}

impl<'w> Sample<'w> {
    /// Evenly spaced cells in picture order, as many as the workspace holds and at most `limit`; all of them when there
    /// are no more. `None` when there are none.
    pub(crate) fn gather(
        image: &Image,
        inliers: impl Fn(&Window) -> u64,
        transform: &Mat3,
        limit: usize,
        workspace: &'w mut [f32],
    ) -> Option<Self> {
        let (slots, _) = workspace.as_chunks_mut::<CELL>();
        let mut total = 0_u64;
        for_each_block(image, &inliers, |block| total += u64::from(block.cells().count_ones()));
        let take = (slots.len().min(limit) as u64).min(total);
        let (mut taken, mut seen) = (0, 0);
        for_each_cell(image, &inliers, transform, |v, v_x, v_y| {
            // Below 2^31 pixels: the product has room in 64 bits.
            if taken < take && seen * take >= taken * total {
                if let Some(slot) = slots.get_mut(taken as usize) {
                    let ([v1, v2, v3], [a1, a2, a3]) = (v, mat3::cross(v, v_x));
                    let [b1, b2, b3] = mat3::cross(v, v_y);
                    *slot = [v1, v2, v3, a1, a2, a3, b1, b2, b3].map(|value| value as f32);
                }
                taken += 1;
            }
            seen += 1;
        });
        let cells = slots.get(..taken as usize)?;
        (!cells.is_empty()).then_some(Self { cells })
    }

    /// The integral (15) of the normals g v, as a mean over the sample.
    pub(crate) fn integral(&self, g: &Mat3) -> f64 {
        let [g1, g2, g3] = *g;
        let (c1, c2) = (mat3::cross(g2, g3), mat3::cross(g3, g1));
        let mut sum = 0.0;
        for cell in self.cells {
            let [v1, v2, v3, a1, a2, a3, b1, b2, b3] = cell.map(f64::from);
            let curl = mat3::dot(c1, [a1, a2, a3]) + mat3::dot(c2, [b1, b2, b3]);
            let n3 = mat3::dot(g3, [v1, v2, v3]).max(SMALLEST_N3);
            let difference = curl / (n3 * n3);
            sum += difference * difference;
        }
        sum / self.cells.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rng::Rng;
    use crate::orientation::orthogonal::polish::rotation;
    use crate::picture::{Order, Sample as Format};

    /// The quotient rule on the mean and the differences of a cell: `(p_y - q_x)^2` for p = -n1 / n3, q = -n2 / n3.
    fn curl(n: [f64; 3], n_x: [f64; 3], n_y: [f64; 3]) -> f64 {
        let slope_y = -(n_y[0] * n[2] - n[0] * n_y[2]) / (n[2] * n[2]);
        let slope_x = -(n_x[1] * n[2] - n[1] * n_x[2]) / (n[2] * n[2]);
        (slope_y - slope_x) * (slope_y - slope_x)
    }

    #[test]
    fn the_integral_of_a_sample_is_that_of_the_quotient_rule() {
        let mut rng = Rng::new(3);
        let (width, height) = (70, 9);
        let colors: std::vec::Vec<f32> =
            (0..width * height * 3).map(|i| [0.1, 0.2, 0.9][i % 3] + 0.1 * rng.unit() as f32).collect();
        let bytes: std::vec::Vec<u8> = colors.iter().flat_map(|value| value.to_ne_bytes()).collect();
        let image = Image::interleaved(&bytes, width, height, width * 12, Format::F32, Order::Rgb).unwrap();
        let all = |window: &Window| window.masked;
        for (turn, sign) in [([0.1, -0.2, 0.4], 1.0), ([0.2, 0.1, -2.0], -1.0)] {
            let [r1, r2, r3] = rotation(turn);
            let rows = [r1, mat3::scale(r2, sign), r3];
            let mut workspace = std::vec![0.0; 1000 * CELL];
            let sample = Sample::gather(&image, all, &mat3::IDENTITY, 1000, &mut workspace).unwrap();
            let (mut sum, mut cells) = (0.0, 0);
            for_each_cell(&image, all, &rows, |n, n_x, n_y| {
                sum += curl(n, n_x, n_y);
                cells += 1;
            });
            assert_eq!((sample.cells.len(), cells), (69 * 8, 69 * 8));
            let (found, wanted) = (sample.integral(&rows), sum / f64::from(cells));
            assert!((found / wanted - 1.0).abs() < 1e-5, "{found} {wanted}");
            // Evenly spaced ones, as many as asked for.
            let few = Sample::gather(&image, all, &mat3::IDENTITY, 100, &mut workspace).unwrap();
            assert_eq!(few.cells.len(), 100);
            assert!((few.integral(&rows) / wanted - 1.0).abs() < 0.5);
        }
        assert!(Sample::gather(&image, |_| 0, &mat3::IDENTITY, 100, &mut [0.0; 90]).is_none());
    }

    #[test]
    fn differences_are_to_the_right_and_upward() {
        // Red grows to the right by 2, green downward by 3.
        let bytes: std::vec::Vec<u8> =
            (0..12).flat_map(|i| [10 + 2 * (i % 4), 20 + 3 * (i / 4), 7]).collect();
        let image = Image::interleaved(&bytes, 4, 3, 12, Format::U8, Order::Rgb).unwrap();
        let mut cells = 0;
        for_each_cell(
            &image,
            |window| window.masked,
            &mat3::IDENTITY,
            |v, v_x, v_y| {
                let (x, y) = (f64::from(cells % 3), f64::from(cells / 3));
                assert_eq!(v, [11.0 + 2.0 * x, 21.5 + 3.0 * y, 7.0]);
                assert_eq!((v_x, v_y), ([2.0, 0.0, 0.0], [0.0, -3.0, 0.0]));
                cells += 1;
            },
        );
        assert_eq!(cells, 6);
    }
}
