//! Blocks: what the ground is shown in.
