//! The ground: posts on a regular grid, the one surface between them, and the blocks it is shown in.
//!
//! This crate has no GPU and no physics engine. Everything that stands on, hits, sees or draws the ground reads the
//! posts of one [`Field`] cut by one diagonal, so an answer never depends on a camera, on what is loaded or on time.
//!
//! Frame: see [`frame`]. The block scheme follows Gabdrakhmanov's landscape model for a flight trainer: a constant post
//! step, square blocks in sliding windows, all block borders at level 0.
#![forbid(unsafe_code)]

pub mod bake;
pub mod block;
mod clearance;
pub mod edit;
pub mod features;
mod field;
pub mod frame;
mod grid;
mod ground;
pub mod near;
mod noise;
pub mod paged;
mod projection;
mod pyramid;
pub mod store;
pub mod synthetic;
pub mod thread_time;
pub mod verify;

pub use block::rings::{RingMasks, Rings};
pub use clearance::Clearance;
pub use field::{Corner, Field, FieldError, Triangle};
pub use grid::{BlockIndex, CELLS, Grid, GridError, POSTS, PostRect};
pub use ground::{Area, AreaError, Ground, SurfaceHit};
pub use projection::{Ellipsoid, Geodetic, MAX_CENTRE_LAT_DEG, Projection, ProjectionError, TransverseMercator, WGS84};
pub use pyramid::{Pyramid, Range};
