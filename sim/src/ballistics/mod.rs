//! Shells and bombs: how they fly, the path of a step, and what it strikes first.
//!
//! Frame: the world's (X east, Y up, Z south), metres, seconds, f64; a shot by itself is flown in its planet's frame. A
//! projectile is a point; it is no rigid body of the physics engine, so its speed has no limit and it cannot pass through
//! anything between two steps.
//!
//! Tiers: vacuum (`drag = "none"` or no air), drag table, and with `spin` the modified point mass, which here is an
//! estimate of spin drift beside the point mass ([`drift`]).

mod chords;
pub mod column;
pub mod drag;
pub mod drift;
pub mod geodesic;
pub mod impact;
pub mod launch;
pub mod motion;
mod observer;
pub mod path;
pub mod projectile;
pub mod shape;
pub mod targets;
pub mod trajectory;
