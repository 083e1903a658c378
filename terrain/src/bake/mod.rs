//! Bake: real data in, a world out.
