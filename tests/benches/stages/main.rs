//! How long stages take: `cargo bench -p ofc-tests`, with a part of a name to run some of them alone. `OFC_BENCH_LARGE=1` adds pictures
//! of 12 million pixels, `OFC_DATA` the photograph of a cat. `counts.sh` beside this folder counts instructions instead, and `peers/`
//! compares with others.

mod depth;
mod fit;
mod gel;
mod normals;
mod render;
mod scenes;
mod solve;
mod surface;

fn main() {
    divan::main();
}
