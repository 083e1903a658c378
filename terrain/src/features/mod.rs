//! What lies on the ground.

pub mod by_block;
pub mod cover;
pub mod cover_bake;
pub mod cover_rules;
pub mod index;
pub mod imagery;
pub mod lake_bake;
pub mod lakes;
pub mod model;
pub mod placing;
pub mod shape;
pub mod solid;
