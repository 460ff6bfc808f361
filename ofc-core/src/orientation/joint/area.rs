//! Where the surface lies in the picture, and the parts that it is cut into.

use super::constants::PARTS;

/// A rectangle around all inliers, in pixels from the top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Area {
    pub from: [u32; 2],
    pub size: [u32; 2],
}

impl Area {
    /// Its parts, for positions with x right and y up from the top left pixel.
    pub fn parts(&self) -> Parts {
        let ([x, y], [width, height]) = (self.from.map(f64::from), self.size.map(f64::from));
        Parts { from: [x, 1.0 - y - height], size: [width, height] }
    }
}

/// The parts of a picture: where the inliers lie, cut into [`PARTS`] by [`PARTS`]. Positions are in pixels, x right and y up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts {
    /// Left and lower border.
    pub from: [f64; 2],
    /// Width and height.
    pub size: [f64; 2],
}

impl Parts {
    /// The part that a position lies in.
    pub fn of(&self, [x, y]: [f64; 2]) -> usize {
        let ([x0, y0], [width, height]) = (self.from, self.size);
        let index = |at: f64, from: f64, size: f64| {
            (1..PARTS).filter(|&border| (at - from) * PARTS as f64 >= border as f64 * size).count()
        };
        index(y, y0, height) * PARTS + index(x, x0, width)
    }

    /// The middle of all parts.
    pub fn middle(&self) -> [f64; 2] {
        let ([x0, y0], [width, height]) = (self.from, self.size);
        [x0 + 0.5 * width, y0 + 0.5 * height]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_counted_from_the_lower_left() {
        let parts = Area { from: [10, 20], size: [50, 100] }.parts();
        assert_eq!(parts.middle(), [35.0, -69.0]);
        // The top left pixel, its right neighbors up to the border, and the bottom right pixel.
        assert_eq!(parts.of([10.0, -20.0]), 20);
        assert_eq!(parts.of([19.0, -20.0]), 20);
        assert_eq!(parts.of([20.0, -20.0]), 21);
        assert_eq!(parts.of([59.0, -119.0]), 4);
        assert_eq!(parts.of([59.0, -99.0]), 9);
    }
}
