//! What lies on the ground.

pub mod by_block;
pub mod cover;
pub mod cover_bake;
pub mod cover_rules;
pub mod imagery;
pub mod lake_bake;
pub mod lakes;
pub mod model;
