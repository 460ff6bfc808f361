use ofc_core::image::{Order, Sample};
use ofc_core::render::*;
use ofc_tests::scenes;
fn main() {
    let a = scenes::table_1_directions();
    let s3 = 1.0 / 3f64.sqrt();
    for (name, scene) in [("bust", scenes::bust(256, 256)), ("sphere", scenes::sphere(256, 256, 0.9, 80.0)), ("egg", scenes::egg(256, 256)),
        ("bump", scenes::bump(256, 256)), ("peaks", scenes::peaks(256, 256)), ("vase", scenes::vase(256, 256)), ("terrain", scenes::terrain(256, 256))] {
        let bytes = scene.bytes();
        let mut norm = vec![0f32; 256 * 256 * 3];
        for (tag, a, b) in [("color", &a[..], &scenes::TABLE_1_COLORS[..]), ("gray", &[s3, s3, s3][..], &[1.0, 1.0, 1.0][..])] {
            let mut out = vec![0u8; 256 * 256 * 3];
            let lights = Lights::new(a, b).unwrap();
            let mut best = 1e9f64;
            for _ in 0..5 {
                let t = std::time::Instant::now();
                let canvas = Canvas::new(&mut out, 256, 256, 768, Sample::U8, Order::Rgb).unwrap();
                render(&scene.view(&bytes), &lights, &Params { noise: 1.0, ..Params::default() },
                    Outputs { picture: canvas, seen: None, normals: Some(Rows { values: &mut norm, row_stride: 768 }) }).unwrap();
                best = best.min(t.elapsed().as_secs_f64() * 1e3);
            }
            let mut slopes: Vec<f64> = norm.chunks(3).filter(|n| n[2] > 0.0).map(|n| f64::from(n[2]).acos().to_degrees()).collect();
            slopes.sort_by(f64::total_cmp);
            println!("{name} {tag} {best:.1} ms, slant median {:.1} max {:.1} n {}", slopes[slopes.len() / 2], slopes[slopes.len() - 1], slopes.len());
            let file = std::fs::File::create(format!("/tmp/look_{name}_{tag}.png")).unwrap();
            let mut e = png::Encoder::new(file, 256, 256);
            e.set_color(png::ColorType::Rgb);
            e.write_header().unwrap().write_image_data(&out).unwrap();
        }
    }
}
