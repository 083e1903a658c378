//! poligon
fn main() {}
