//! Depth from normals.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::surface::depth::{DepthInput, DepthParams, Method, integrate};
use ofc_tests::depth_scenes::{Scene, all, bumps, disc, scene};
use ofc_tests::depth_workspace::Workspace;

fn time_depth(bencher: Bencher, scene: &Scene, method: Method) {
    let Scene { width, height, .. } = *scene;
    let input = DepthInput { mask: scene.input().mask.filter(|_| scene.mask.contains(&0)), ..scene.input() };
    let params = DepthParams { method, ..DepthParams::default() };
    let mut workspace = Workspace::new(width, height, 0.0);
    let mut depths = vec![0.0; width * height];
    bencher.counter(ItemsCount::new(width * height)).bench_local(|| {
        integrate(black_box(&input), &params, workspace.arena(), &mut depths, width).expect("room for all")
    });
}

/// A square without a mask.
#[divan::bench(args = [256, 512, 1024])]
fn rectangle(bencher: Bencher, size: usize) {
    time_depth(bencher, &scene([size, size], bumps, 0.01, all), Method::Poisson);
}

/// A disc in a square.
#[divan::bench(args = [256, 512, 1024])]
fn in_disc(bencher: Bencher, size: usize) {
    time_depth(bencher, &scene([size, size], bumps, 0.01, disc(size)), Method::Poisson);
}

/// The other methods.
#[divan::bench(args = [Method::Paper, Method::Coupled])]
fn other(bencher: Bencher, method: Method) {
    time_depth(bencher, &scene([512, 512], bumps, 0.01, disc(512)), method);
}
