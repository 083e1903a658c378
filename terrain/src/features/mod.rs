//! What lies on the ground.

pub mod cover;
pub mod lake_bake;
pub mod lakes;
pub mod model;
