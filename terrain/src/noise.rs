//! Value noise on whole-number lattices: the same everywhere, for all who ask about the same place.
//!
//! Coordinates are world metres over a wavelength, so neighbouring blocks agree on what lies on their border.

/// 0 at `low` and below, 1 at `high` and above, smooth between.
pub(crate) fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Value noise of two octaves on a whole-number lattice, 0..=1.
pub(crate) fn noise(x: f64, z: f64, seed: u32) -> f32 {
    0.65 * value_noise(x, z, seed) + 0.35 * value_noise(x * 2.17 + 31.7, z * 2.17 - 17.3, seed ^ 0x5bd1_e995)
}

pub(crate) fn value_noise(x: f64, z: f64, seed: u32) -> f32 {
    let (x0, z0) = (x.floor(), z.floor());
    let at = |dx: i32, dz: i32| unit(x0 as i32 + dx, z0 as i32 + dz, seed);
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease((x - x0) as f32), ease((z - z0) as f32));
    let (north, south) = (at(0, 0) + u * (at(1, 0) - at(0, 0)), at(0, 1) + u * (at(1, 1) - at(0, 1)));
    north + v * (south - north)
}

/// A number in 0..1 of a lattice point (the finaliser of MurmurHash3, public domain, A. Appleby).
pub fn unit(x: i32, z: i32, seed: u32) -> f32 {
    let mut h =
        (x as u32).wrapping_mul(0x9E37_79B1) ^ (z as u32).wrapping_mul(0x85EB_CA77) ^ seed.wrapping_mul(0xC2B2_AE3D);
    h ^= h >> 16;
    h = h.wrapping_mul(0x85EB_CA6B);
    h ^= h >> 13;
    h = h.wrapping_mul(0xC2B2_AE35);
    h ^= h >> 16;
    (h >> 8) as f32 / (1u32 << 24) as f32
}
