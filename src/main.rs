//! The `periplus` program: see the library's crate documentation.
fn main() {}
