//! Exact answers about the ground.
