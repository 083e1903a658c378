//! Beyond the near zone: the true distance between what is drawn and the ground, for every block and ring.
//!
//! A block's mesh depends on its ring only, never on the eye, so all pictures from all eyes are looked at here. The
//! difference is that of [`surface`]: over all vertices of the two triangulations laid over each other.

use super::surface::{Surface, greatest_difference_m};
use crate::block::Landscape;
use crate::block::payload::tile_heights_m;
use crate::block::rings::FAR_RINGS;
use crate::grid::BlockIndex;
use rayon::prelude::*;

/// What f64 rounding may add to a difference of heights within 100 km: a dozen roundings of 1.5e-11 m.
const ROUNDING_M: f64 = 1e-9;

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Far {
    /// Largest distance in each far ring, metres.
    pub errors_max_m: [f64; FAR_RINGS],
    /// Blocks, counted once a ring, with a place beyond the ring's limit.
    pub violations: u64,
    /// Blocks looked at, counted once a ring.
    pub meshes: u64,
}

/// Looks at every block of a world in every far ring; on all cores.
pub fn prove(landscape: &Landscape) -> Far {
    let field = landscape.ground.field();
    let limits_m = landscape.masks.limits_m;
    let blocks: Vec<BlockIndex> = field.grid().blocks().collect();
    blocks
        .par_iter()
        .map(|block| {
            let heights_m = tile_heights_m(field, *block);
            let ground = Surface::ground(&heights_m);
            let mut far = Far::default();
            for (ring, limit_m) in limits_m.iter().enumerate() {
                let mesh = landscape.mesh(*block, ring + 1);
                let error_m = greatest_difference_m(&Surface::of(mesh.indices(), &heights_m), &ground);
                far.errors_max_m[ring] = error_m;
                far.violations += u64::from(error_m > limit_m + ROUNDING_M);
                far.meshes += 1;
            }
            far
        })
        .reduce(Far::default, |a, b| Far {
            errors_max_m: std::array::from_fn(|ring| a.errors_max_m[ring].max(b.errors_max_m[ring])),
            violations: a.violations + b.violations,
            meshes: a.meshes + b.meshes,
        })
}
