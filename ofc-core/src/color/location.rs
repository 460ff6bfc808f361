//! The one-dimensional least median of squares: where most of a set of numbers lies.
//!
//! The minimizer of the median squared distance is the midpoint of the shortest interval that holds half of the
//! numbers, found exactly on the sorted numbers.
//!
//! # Reference
//! Sections 2.2, 4 and 5. P. J. Rousseeuw, A. M. Leroy, "Robust Regression and Outlier Detection", Wiley 1987,
//! section 4.2.

use super::dispersion::dispersion;
use crate::math::select;

/// A location and the spread around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Location {
    /// The midpoint of the shortest half.
    pub location: f64,
    /// Half the length of the shortest half: the median distance from `location`.
    pub median_distance: f64,
    /// The robust dispersion, 1.4826 (1 + 5 / (n - 1)) `median_distance`.
    pub dispersion: f64,
}

/// The location of `values`, which must all be finite. They are left sorted.
///
/// Where several halves are equally short, the middle one of them counts. Returns `None` for fewer than two values or
/// a scratch shorter than `values`.
///
/// # Scratch
/// As many `f32` as there are values.
pub fn shortest_half(values: &mut [f32], scratch: &mut [f32]) -> Option<Location> {
    let count = values.len();
    if count < 2 || !select::sort(values, scratch) {
        return None;
    }
    let rank = select::median_rank(count);
    let length = |(low, high): (&f32, &f32)| f64::from(*high) - f64::from(*low);
    let halves = || values.iter().zip(values.get(rank..).unwrap_or_default());
    let shortest = halves().map(length).fold(f64::INFINITY, f64::min);
    let ties = halves().filter(|&half| length(half) == shortest).count();
    let (low, high) = halves().filter(|&half| length(half) == shortest).nth(ties.saturating_sub(1) / 2)?;
    let median_distance = 0.5 * shortest;
    Some(Location {
        location: 0.5 * (f64::from(*low) + f64::from(*high)),
        median_distance,
        dispersion: dispersion(median_distance, count, 1),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_textbook_example() {
        // Rousseeuw and Leroy, section 4.2: the observations 90, 93, 86, 92, 95, 83, 75, 40, 88, 80 and their LMS.
        let mut values = [90.0, 93.0, 86.0, 92.0, 95.0, 83.0, 75.0, 40.0, 88.0, 80.0];
        let found = shortest_half(&mut values, &mut [0.0; 10]).unwrap();
        assert_eq!((found.location, found.median_distance), (90.5, 4.5));
    }

    #[test]
    fn outliers_below_half_do_not_move_it() {
        let mut values = [1e6; 99];
        for (i, value) in values.iter_mut().take(51).enumerate() {
            *value = 7.0 + 0.001 * i as f32;
        }
        let found = shortest_half(&mut values, &mut [0.0; 99]).unwrap();
        assert!((found.location - 7.025).abs() < 0.002);
    }

    #[test]
    fn too_few() {
        assert!(shortest_half(&mut [1.0], &mut [0.0]).is_none());
        assert!(shortest_half(&mut [1.0, 2.0], &mut [0.0]).is_none());
        let same = shortest_half(&mut [3.0, 3.0], &mut [0.0; 2]).unwrap();
        assert_eq!((same.location, same.dispersion), (3.0, 0.0));
    }
}
