//! Shells and bombs: the path of a step, and what it strikes first.
//!
//! Frame: the world's (X east, Y up, Z south), metres, seconds, f64. A projectile is a point; it is no rigid body of the
//! physics engine, so its speed has no limit and it cannot pass through anything between two steps.

mod chords;
pub mod impact;
pub mod path;
pub mod shape;
pub mod targets;
