# In Rust: normals.rs is README's program, and cargo takes it for the main file.
cargo init --quiet --name normals --vcs none
cargo add --quiet --path "$clone/ofc-core"
cargo run --quiet --release <ball.rgb >normals.f32
