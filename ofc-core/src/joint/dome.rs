//! Convex or concave.

use crate::image::{Image, Window, for_each_bit};
use crate::mat3::{self, Mat3};

/// The dome is looked at in every row whose number is a multiple of this.
const ROWS: usize = 4;

/// Normals further from the camera than this (about 84 degrees) say nothing about slopes.
const SMALLEST_N3: f64 = 0.1;

/// `rows` or their twin, whichever makes of the surface a dome about `middle` (x right, y up) rather than a hollow:
/// `sum (x n1 + y n2) / n3` is positive. And that sum over the sum of its absolute terms, from 0 to 1.
pub(super) fn convex(
    image: &Image,
    inliers: impl Fn(&Window) -> u64,
    root: &Mat3,
    rows: Mat3,
    [middle_x, middle_y]: [f64; 2],
) -> (Mat3, f64) {
    let to_normal = mat3::multiply(&rows, root);
    let (mut sum, mut absolute) = (0.0, 0.0);
    let mut window = Window::new();
    for y in (0..image.height()).step_by(ROWS) {
        for x in (0..image.width()).step_by(crate::image::WINDOW) {
            image.read(x, y, &mut window);
            for_each_bit(inliers(&window), |i| {
                let [n1, n2, n3] = mat3::apply(&to_normal, window.pixel(i).map(f64::from));
                if n3 > SMALLEST_N3 {
                    let (x, y) = ((x + i) as f64 - middle_x, -(y as f64) - middle_y);
                    let outward = (x * n1 + y * n2) / n3;
                    sum += outward;
                    absolute += outward.abs();
                }
            });
        }
    }
    let dome = if absolute > 0.0 { sum / absolute } else { 0.0 };
    let [r1, r2, r3] = rows;
    if dome < 0.0 { ([mat3::scale(r1, -1.0), mat3::scale(r2, -1.0), r3], -dome) } else { (rows, dome) }
}
