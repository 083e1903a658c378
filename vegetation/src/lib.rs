//! What grows where, and what it looks like: species, their places, the closed forest far away, and models.
//!
//! No GPU, no state: the same cell and salt give the same plant in any order, on any machine and thread. Frame:
//! [`terrain::frame`].
#![forbid(unsafe_code)]

pub mod canopy;
pub mod clearings;
pub mod detail;
mod noise;
pub mod pictures;
pub mod place;
pub mod scatter;
pub mod species;
