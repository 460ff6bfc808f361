//! Times depth integration and, with files, lets a script compare it with others: see `tests/benches/depth_peers.py`.
//!
//! `depth_timer NORMALS.f32 MASK.u8 WIDTH HEIGHT DEPTH.f32 [METHOD [REPEATS]]` reads tightly packed normals (three f32 a
//! pixel) and mask, writes the depth, and prints the best and the median time in milliseconds and the result.

use ofc_core::surface::depth::{DepthInput, DepthParams, Method, Plane, Slopes, integrate, need};
use ofc_tests::depth_workspace::Workspace;
use std::time::Instant;

fn floats(path: &str) -> Vec<f32> {
    let bytes = std::fs::read(path).expect("normals");
    bytes.as_chunks::<4>().0.iter().map(|&b| f32::from_ne_bytes(b)).collect()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let [_, normals, mask, width, height, out, rest @ ..] = args.as_slice() else {
        eprintln!(
            "depth_timer NORMALS.f32 MASK.u8|- WIDTH HEIGHT DEPTH.f32 [poisson|paper|coupled [REPEATS]]"
        );
        std::process::exit(2);
    };
    let (width, height): (usize, usize) = (width.parse().expect("width"), height.parse().expect("height"));
    let method = match rest.first().map(String::as_str) {
        Some("paper") => Method::Paper,
        Some("coupled") => Method::Coupled,
        _ => Method::Poisson,
    };
    let repeats: usize = rest.get(1).map_or(5, |r| r.parse().expect("repeats"));
    let tolerance = rest.get(2).map_or(1e-4, |r| r.parse().expect("tolerance"));
    let normals = floats(normals);
    let mask = (mask != "-").then(|| std::fs::read(mask).expect("mask"));
    let input = DepthInput {
        slopes: Slopes::Normals(Plane::new(&normals, width, height, 3, 3 * width).expect("size of normals")),
        mask: mask.as_ref().map(|m| Plane::new(m, width, height, 1, width).expect("size of mask")),
        weights: None,
        prior: None,
    };
    let params = DepthParams { method, tolerance, ..DepthParams::default() };
    let bytes = need(width, height).expect("size").bytes();
    let mut workspace = Workspace::new(width, height, 1.0);
    let mut depth = vec![1.0_f32; width * height];
    let mut times = Vec::new();
    let mut result = None;
    for _ in 0..repeats {
        let start = Instant::now();
        result = Some(integrate(&input, &params, workspace.arena(), &mut depth, width).expect("integrate"));
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    let result = result.expect("at least one repeat");
    println!(
        "best {:.2} median {:.2} bytes_per_pixel {:.2} cycles {} residual {:.3e} regions {} pixels {} converged {}",
        times[0],
        times[times.len() / 2],
        bytes as f64 / (width * height) as f64,
        result.cycles,
        result.residual,
        result.regions,
        result.pixels,
        result.converged
    );
    let bytes: Vec<u8> = depth.iter().flat_map(|d| d.to_ne_bytes()).collect();
    std::fs::write(out, bytes).expect("depth");
}
