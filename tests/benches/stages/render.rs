//! Rendering.

use divan::{Bencher, black_box};
use ofc_core::picture::{Order, Sample};
use ofc_core::render::{self, Canvas, Lights, Outputs, render};
use ofc_tests::depth_maps::{TABLE_1_COLORS, bust, table_1_directions, terrain};

/// A rough terrain and a bust, rendered under the paper's three lights with cast shadows.
#[divan::bench(args = ["terrain", "bust"])]
fn shadows(bencher: Bencher, name: &str) {
    let relief = if name == "bust" { bust(256, 256) } else { terrain(256, 256) };
    let (bytes, directions) = (relief.bytes(), table_1_directions());
    let lights = Lights::new(&directions, &TABLE_1_COLORS).expect("the paper's lights");
    let mut pixels = vec![0_u8; 256 * 256 * 3];
    bencher.bench_local(|| {
        let depth = relief.view(black_box(&bytes));
        let picture =
            Canvas::new(&mut pixels, 256, 256, 256 * 3, Sample::U8, Order::Rgb).expect("room for all");
        let outputs = Outputs { picture, seen: None, normals: None };
        render(&depth, &lights, &render::Params { noise: 1.0, ..render::Params::default() }, outputs)
    });
}
