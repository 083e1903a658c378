//! Blocks: the squares of [`CELLS`](crate::CELLS) x `CELLS` cells that the ground is streamed and drawn in.
//!
//! A block is cut into *sub-blocks* of 2 x 2 cells. Each is *fine* (its eight level-0 triangles) or *coarse*. Which ones
//! are fine is one [`Mask`]; all levels are one mask and one table of templates, and one builder makes the indices.
//! Level 0 is "all fine", level 1 "none fine", anything between is mixed.
//!
//! Invariant others rely on: every edge on a block's border is cut at every post whatever the mask, so any two blocks
//! fit in any state and a block never needs to know its neighbours.
//!
//! Source: Gabdrakhmanov, landscape model for a flight trainer: block types 0, 1 and combined; borders at level 0.

pub mod builder;
pub mod ground_map;
pub mod light;
pub mod mask;
pub mod mesh;
pub mod overlay;

pub mod payload;
pub mod rings;
pub mod template;
pub mod window;

pub use mask::Mask;

pub use payload::{Landscape, Payload};
pub use rings::Rings;
