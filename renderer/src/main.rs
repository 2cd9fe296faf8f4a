//! penumbra
fn main() {}
