//! Seven reliefs of 256 by 256 pixels under Table 1's lights and others, rendered by the core.

use crate::depth_maps::{
    Relief, TABLE_1_COLORS, bump, bust, direction, egg, peaks, sphere, table_1_directions, terrain, vase,
};
use ofc_core::math::rng::Rng;
use ofc_core::picture::{Order, Sample};
use ofc_core::render::{self, Canvas, Lights, Outputs, Rows, render};

/// Their names, whether they are convex on the whole, and they.
pub fn reliefs() -> [(&'static str, bool, Relief); 7] {
    [
        ("sphere", true, sphere(256, 256, 0.9, 80.0)),
        ("egg", true, egg(256, 256)),
        ("bump", true, bump(256, 256)),
        ("peaks", false, peaks(256, 256)),
        ("vase", true, vase(256, 256)),
        ("bust", true, bust(256, 256)),
        ("terrain", false, terrain(256, 256)),
    ]
}

/// The picture, eight bits, and its true normals, zero beside the surface.
pub fn rendered(
    relief: &Relief,
    a: &[f64; 9],
    b: &[f64; 9],
    noise: f64,
    seed: u64,
) -> (Vec<u8>, Vec<[f32; 3]>) {
    let (width, height) = (relief.width, relief.height);
    let bytes = relief.bytes();
    let mut pixels = vec![0; width * height * 3];
    let mut normals = vec![0.0; width * height * 3];
    let params = render::Params { noise, seed, ..render::Params::default() };
    let picture = Canvas::new(&mut pixels, width, height, width * 3, Sample::U8, Order::Rgb).expect("room");
    let rows = Rows { values: &mut normals, row_stride: width * 3 };
    let outputs = Outputs { picture, seen: None, normals: Some(rows) };
    render(&relief.view(&bytes), &Lights::new(a, b).expect("lights"), &params, outputs).expect("a picture");
    (pixels, normals.as_chunks().0.to_vec())
}

/// Directions and colors of Table 1's lights, or three of slants 20 to 60 degrees, roughly a third of a turn apart, that follow from the number.
pub fn lights(number: u64) -> ([f64; 9], [f64; 9]) {
    if number == 0 {
        return (table_1_directions(), TABLE_1_COLORS);
    }
    let mut rng = Rng::new(1000 + number);
    let mut uniform = || f64::from(rng.below(1_000_000)) / 1e6;
    let (mut a, mut b) = ([0.0; 9], [0.0; 9]);
    let first = 360.0 * uniform();
    for (light, row) in a.as_chunks_mut::<3>().0.iter_mut().enumerate() {
        let tilt = first + 120.0 * light as f64 + 60.0 * (uniform() - 0.5);
        *row = direction([20.0 + 40.0 * uniform(), tilt]);
    }
    for (i, entry) in b.iter_mut().enumerate() {
        *entry = if i % 4 == 0 { 60.0 + 40.0 * uniform() } else { 10.0 + 35.0 * uniform() };
    }
    (a, b)
}
