//! Proofs on a world.
