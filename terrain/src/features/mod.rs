//! What lies on the ground.

pub mod lake_bake;
pub mod lakes;
