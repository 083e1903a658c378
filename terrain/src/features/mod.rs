//! What lies on the ground.

pub mod airfield_lights;
pub mod by_block;
pub mod cover;
pub mod cover_bake;
pub mod cover_rules;
pub mod imagery;
pub mod index;
pub mod lake_bake;
pub mod lakes;
pub mod light_point;
pub mod model;
pub mod placing;
pub mod settlement_lights;
pub mod shape;
pub mod solid;
