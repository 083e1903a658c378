//! Bake: real data in, a world out.
//!
//! [`open`](open::open) reads a file of any known format into a [`Raster`](raster::Raster); [`bake`] lays all of them
//! over the posts of a new world ([`mosaic`], kernel in [`resample`]), fills what is missing inside the data
//! ([`void_fill`]), lays the features of files on it ([`features`]), sets lakes to their level and describes the result. Heights are metres above mean sea level, as the
//! sources have them, and clamped nowhere. Formats are read from hostile bytes: sizes are bounded before they are
//! believed, and every failure is an error that names the file, what was expected and what was found.

mod bake_world;
pub mod crs;
mod default_world;
mod error;
mod extent;
pub mod features;
pub mod geotiff;
pub mod hgt;
mod imagery;
pub mod mosaic;
pub mod open;
pub mod photo;
pub mod png;
pub mod raster;
pub mod resample;
pub mod usgs_dem;
pub mod void_fill;

pub use bake_world::{BakeRequest, Bytes, Input, bake};
pub use default_world::{DefaultWorld, default_request, default_world};
pub use error::BakeError;
pub use extent::{MAX_POSTS, MAX_STEP_M, MIN_STEP_M};
