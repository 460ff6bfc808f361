//! Reliefs rendered to f32 with everything that the renderer gives.

use crate::depth_maps::Relief;
use ofc_core::picture::{Order, Sample};
use ofc_core::render::{Canvas, Lights, Outputs, Params, Rendering, Rows, render};

/// What one rendering gives.
pub struct Picture {
    /// The colors, row by row.
    pub colors: Vec<[f32; 3]>,
    /// A bit for each light that a pixel sees.
    pub seen: Vec<u32>,
    /// The normals.
    pub normals: Vec<[f32; 3]>,
    /// What the renderer says of it.
    pub rendering: Rendering,
}

/// Renders the relief under lights of these directions and colors.
pub fn shoot(scene: &Relief, a: &[f64], b: &[f64], params: &Params) -> Picture {
    let pixels = scene.width * scene.height;
    let (mut bytes, mut seen, mut normals) = (vec![0; pixels * 12], vec![0; pixels], vec![9.0; pixels * 3]);
    let (size, depths) = ((scene.width, scene.height), scene.bytes());
    let picture = Canvas::new(&mut bytes, size.0, size.1, size.0 * 12, Sample::F32, Order::Rgb).unwrap();
    let outputs = Outputs {
        picture,
        seen: Some(Rows { values: &mut seen, row_stride: size.0 }),
        normals: Some(Rows { values: &mut normals, row_stride: size.0 * 3 }),
    };
    let rendering = render(&scene.view(&depths), &Lights::new(a, b).unwrap(), params, outputs).unwrap();
    let floats: Vec<f32> = bytes.as_chunks().0.iter().map(|&b| f32::from_ne_bytes(b)).collect();
    let (colors, normals) = (floats.as_chunks().0.to_vec(), normals.as_chunks().0.to_vec());
    Picture { colors, seen, normals, rendering }
}
