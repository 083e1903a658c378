//! What lies on the ground.

pub mod airfield_lights;
pub mod cover;
pub mod lake_bake;
pub mod lakes;
pub mod light_point;
pub mod model;
pub mod settlement_lights;
