//! Shapes of what stands on the ground, made from code (or from a glTF file, [`glb`]), as plain triangle lists.
//!
//! Frame of a shape: x to its right, y up, z backward, metres, its front along -z and its foot at the origin; what is
//! made for a tile of the world instead has x east and z south of the tile's post and y above sea level. Faces are flat:
//! corners are not shared between them. Colours are albedo, kept as square roots in eight bits, as the ground map's are.

mod aircraft;
mod airfield;
pub mod building;
pub mod glb;
mod loose;
mod masts;
mod mesh;
mod parts;
pub mod things;
mod vehicles;

pub use mesh::{Mesh, Paint, Vertex, size_code};
