//! What lies on the ground.

pub mod lakes;
