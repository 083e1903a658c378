//! Proofs on a world: that its picture has no cracks, is the ground nearby, keeps its limit afar and switches unseen.
//!
//! Each proof is written as plainly as it can be and shares as little as it can with what it proves: it starts from the
//! index lists and height tiles that are drawn, and from the posts. Frame and units as in [`crate::field`]. Nothing here
//! decides whether a proof holds: it counts and measures, the caller compares with what was promised.

pub mod cracks;
pub mod far;
pub mod flight;
pub mod near;
pub mod overlay;
pub mod pop;
pub mod surface;
