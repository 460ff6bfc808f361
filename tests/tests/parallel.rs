//! Whatever runs the parts of some work, and in which order: the bits are those of one thread.

use ofc_core::math::parallel::{MOST_PARTS, Parallel};
use ofc_core::picture::Window;
use ofc_core::surface::normals::{Length, compute, compute_in_parts};
use ofc_core::{Image, Order, Sample, Uncertainty};
use std::sync::atomic::{AtomicUsize, Ordering};

/// So many threads, each of which takes every so many-th item from the end, and how many items there were.
struct Threads(usize, AtomicUsize);

impl Parallel for Threads {
    fn for_each<T: Send, F: Fn(usize, &mut T) + Sync>(&self, items: &mut [T], part: F) {
        assert!(items.len() <= MOST_PARTS);
        self.1.fetch_max(items.len(), Ordering::Relaxed);
        let mut hands: Vec<Vec<(usize, &mut T)>> = (0..self.0).map(|_| Vec::new()).collect();
        for (i, item) in items.iter_mut().enumerate().rev() {
            hands[i % self.0].push((i, item));
        }
        std::thread::scope(|scope| {
            for hand in hands {
                scope.spawn(|| hand.into_iter().for_each(|(i, item)| part(i, item)));
            }
        });
    }
}

/// Every number of threads that is tried.
fn threads() -> impl Iterator<Item = Threads> {
    [1, 2, 3, 16].into_iter().map(|count| Threads(count, AtomicUsize::new(0)))
}

fn bits(values: &[f32]) -> Vec<u32> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn normals_and_angles_have_the_bits_of_one_thread() {
    const STRIDE: usize = 230;
    let matrix = [[0.004, 0.001, -0.002], [-0.001, 0.005, 0.001], [0.001, -0.001, 0.004]];
    for (width, height) in [(70, 311), (200, 1), (1, 9000), (150, 150)] {
        let pixels: Vec<u8> = (0..3 * width * height).map(|i| (i * i % 251) as u8).collect();
        let image =
            Image::interleaved(&pixels, width, height, 3 * width, Sample::U8, Order::Rgb).expect("a picture");
        let inliers = |window: &Window| window.masked & 0xf7ff_ffef_ffff_ff3f;
        for length in [Length::Unit, Length::Kept] {
            let stride = 3 * STRIDE;
            let mut wanted = vec![7.0; height * stride];
            compute(&image, inliers, &matrix, length, &mut wanted, stride).expect("room");
            for threads in threads() {
                let mut found = vec![7.0; height * stride];
                compute_in_parts(&image, inliers, &matrix, length, &mut found, stride, &threads)
                    .expect("room");
                assert_eq!(bits(&found), bits(&wanted), "{width} x {height}");
                assert_eq!(threads.1.into_inner() > 1, width * height > 4096, "{width} x {height}");
            }
        }
        let sources = ofc_core::surface::uncertainty::Sources {
            f: ofc_core::math::mat3::IDENTITY,
            f_inverse: matrix,
            c: [1e-12; 21],
            rotation: [[1e-4, 0.0, 0.0], [0.0, 1e-4, 0.0], [0.0, 0.0, 1e-4]],
            noise: 1.0,
        };
        let uncertainty = Uncertainty::new(&sources);
        let mut wanted = vec![7.0; height * STRIDE];
        uncertainty.compute(&image, inliers, &mut wanted, STRIDE).expect("room");
        for threads in threads() {
            let mut found = vec![7.0; height * STRIDE];
            uncertainty.compute_in_parts(&image, inliers, &mut found, STRIDE, &threads).expect("room");
            assert_eq!(bits(&found), bits(&wanted), "{width} x {height}");
        }
    }
}
