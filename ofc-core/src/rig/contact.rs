//! What is pressed in, as a few numbers.

use crate::orientation::relief::PixelClass;

/// What lies above this share of the highest point is what touches; below, the gel only follows.
const SHARE: f64 = 0.16;

/// A contact. Places are in pixels from the middle of the top left one, y down; lengths are in the unit of the pixel size.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Its area.
    pub area: f64,
    /// The mean of its pixels' places.
    pub center: [f64; 2],
    /// Its first and last column and row: left, top, right, bottom.
    pub bounds: [usize; 4],
    /// How high its highest point is above the plane.
    pub peak: f64,
    /// Where that is.
    pub peak_place: [usize; 2],
    /// The volume above the plane.
    pub volume: f64,
}

/// Measures the contact in a frame: the part of the pixels of [`PixelClass::Contact`] that is at least 0.16 of the highest point away from the
/// plane, which lies where the pixels of [`PixelClass::Plane`] are in the mean. `None` where there is no contact or no plane.
///
/// `classes` are rows of `width` bytes without gaps; depth in pixels is `depth(x, y)`, not finite where it is not known. `mask` is told which pixels are
/// in the contact.
pub fn contact(
    classes: &[u8],
    width: usize,
    pixel_size: f64,
    depth: impl Fn(usize, usize) -> f32,
    mut mask: impl FnMut(usize, usize, bool),
) -> Option<Contact> {
    let pixels = || {
        let rows = classes.chunks(width.max(1)).enumerate();
        rows.flat_map(|(y, row)| row.iter().enumerate().map(move |(x, class)| (x, y, *class)))
    };
    let (mut sum, mut count) = (0.0, 0.0);
    let (mut highest, mut lowest) = ((f32::NEG_INFINITY, [0; 2]), (f32::INFINITY, [0; 2]));
    for (x, y, class) in pixels() {
        let depth = depth(x, y);
        if !depth.is_finite() {
            continue;
        }
        if class == PixelClass::Plane as u8 {
            sum += f64::from(depth);
            count += 1.0;
        } else if class == PixelClass::Contact as u8 {
            if depth > highest.0 {
                highest = (depth, [x, y]);
            }
            if depth < lowest.0 {
                lowest = (depth, [x, y]);
            }
        }
    }
    let plane = Some(sum / count).filter(|level| level.is_finite())?;
    let [above, below] = [highest, lowest].map(|(depth, place)| (f64::from(depth) - plane, place));
    let (peak, [peak_x, peak_y]) = if above.0 >= -below.0 { above } else { below };
    if !peak.is_finite() {
        return None;
    }
    let sign = 1.0_f64.copysign(peak);
    let is_in = |class: u8, depth: f64| {
        class == PixelClass::Contact as u8
            && depth.is_finite()
            && sign * (depth - plane) >= SHARE * libm::fabs(peak)
    };
    let mut found = Contact { bounds: [usize::MAX, usize::MAX, 0, 0], ..Contact::default() };
    let mut pixels_in = 0.0;
    for (x, y, class) in pixels() {
        let depth = f64::from(depth(x, y));
        let is_in = is_in(class, depth);
        mask(x, y, is_in);
        if is_in {
            let ([cx, cy], [left, top, right, bottom]) = (found.center, found.bounds);
            found.center = [cx + x as f64, cy + y as f64];
            found.bounds = [left.min(x), top.min(y), right.max(x), bottom.max(y)];
            found.volume += depth - plane;
            pixels_in += 1.0;
        }
    }
    found.center = found.center.map(|sum| sum / pixels_in);
    found.area = pixels_in * pixel_size * pixel_size;
    found.volume *= pixel_size * pixel_size * pixel_size;
    (found.peak, found.peak_place) = (peak * pixel_size, [peak_x, peak_y]);
    Some(found)
}
