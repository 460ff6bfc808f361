//! The regression in color space.

use crate::scenes::{Case, cases};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use ofc_core::color::lmeds::{Params, fit, workspace_len};
use ofc_core::picture::Usable;

/// Least median of squares with default parameters.
#[divan::bench(args = cases())]
fn least_median(bencher: Bencher, case: &Case) {
    let photograph = case.photograph();
    let image = photograph.image();
    let pixels = image.width() * image.height();
    let params = Params::default();
    let mut workspace = vec![0.0; workspace_len(pixels, params.sample_size)];
    bencher.counter(ItemsCount::new(pixels)).bench_local(|| {
        fit(black_box(&image), Usable::below(255.0), &params, &mut workspace).expect("colors of a surface")
    });
}
