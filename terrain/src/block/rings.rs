//! How far from the eye which error is allowed, and the masks that keep it.
//!
//! Ring 0 is the near zone: level 0, the ground itself. Ring k >= 1 begins at `radius * 2^(k-1)`, and its limit is one
//! pixel at that distance, so the error on screen stays under a pixel everywhere: an error of `e` metres at `d` metres
//! spans `e / d * focal` pixels on axis. Distances are in plan to a block's nearest point, so every point within the near
//! radius lies in a level-0 block.

use super::mask::{Mask, block_posts};
use crate::edit::Changed;
use crate::field::Field;
use crate::grid::{BlockIndex, Grid};
use crate::paged::Paged;
use rayon::prelude::*;

/// Pixels a radian on axis of the reference view: 1080 rows over 60 degrees.
pub const REFERENCE_FOCAL_PX: f64 = 540.0 / 0.577_350_269_189_625_8;

/// The near radius asked for, metres, where the window is large enough.
pub const NEAR_RADIUS_M: f64 = 13_000.0;

/// Rings beyond the near zone.
pub const FAR_RINGS: usize = 3;

/// Distances and limits of the rings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rings {
    /// Inner radius of each far ring, metres; the first is the near radius.
    pub radii_m: [f64; FAR_RINGS],
    /// Greatest vertical error allowed in each far ring, metres.
    pub limits_m: [f64; FAR_RINGS],
}

impl Rings {
    /// The rings for a window of `window` x `window` blocks and an error of `limit_px` pixels in the reference view.
    pub fn new(grid: &Grid, window: u32, limit_px: f64) -> Self {
        let room_m = (f64::from(window) / 2.0 - 2.0) * grid.block_m();
        Self::with_near_radius(NEAR_RADIUS_M.min(room_m), limit_px)
    }

    /// The rings around a near zone of a given radius.
    pub fn with_near_radius(near_m: f64, limit_px: f64) -> Self {
        let radii_m = std::array::from_fn(|ring| near_m * f64::from(1 << ring));
        Self { radii_m, limits_m: radii_m.map(|radius_m| radius_m * limit_px / REFERENCE_FOCAL_PX) }
    }

    /// Everything at level 0.
    pub fn all_level_0() -> Self {
        Self { radii_m: [f64::INFINITY; FAR_RINGS], limits_m: [0.0; FAR_RINGS] }
    }

    /// The ring that a distance lies in: 0 near, then 1..=[`FAR_RINGS`].
    pub fn ring_at(&self, distance_m: f64) -> usize {
        self.radii_m.iter().take_while(|radius_m| distance_m >= **radius_m).count()
    }
}

/// The masks of all blocks for the far rings of one set of limits.
#[derive(Debug, Clone, PartialEq)]
pub struct RingMasks {
    /// The limits the masks keep, metres.
    pub limits_m: [f64; FAR_RINGS],
    /// A mask a block and ring, blocks as in [`Grid::block_number`].
    pub masks: Paged<[Mask; FAR_RINGS]>,
}

impl RingMasks {
    /// Makes the masks of every block; on all cores.
    pub fn new(field: &Field, limits_m: [f64; FAR_RINGS]) -> Self {
        let blocks: Vec<BlockIndex> = field.grid().blocks().collect();
        let masks = blocks
            .par_iter()
            .map(|block| {
                let posts = block_posts(field, *block);
                limits_m.map(|limit_m| Mask::for_limit(&posts, limit_m))
            })
            .collect();
        Self { limits_m, masks: Paged::new(masks) }
    }

    /// The masks of a field's next version: those of blocks with a changed post are made anew.
    pub(crate) fn edited(&self, field: &Field, changed: &Changed) -> Self {
        let grid = field.grid();
        let made = changed.blocks(grid, Changed::reaches_surface).into_iter().filter_map(|block| {
            let posts = block_posts(field, block);
            Some((grid.block_number(block)?, self.limits_m.map(|limit_m| Mask::for_limit(&posts, limit_m))))
        });
        Self { limits_m: self.limits_m, masks: self.masks.with(made) }
    }

    /// The mask of a block in a ring; all fine in ring 0, and where there is no block.
    pub fn mask(&self, grid: &Grid, block: BlockIndex, ring: usize) -> Mask {
        match (ring.checked_sub(1), grid.block_number(block)) {
            (Some(far), Some(number)) => self.masks.get(number)[far.min(FAR_RINGS - 1)],
            _ => Mask::all(),
        }
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        self.masks.bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_one_pixel_at_13_26_and_52_km() {
        let rings = Rings::new(&Grid::centred(200.0, 60, 60).unwrap(), 24, 1.0);
        if crate::CELLS == 30 {
            assert_eq!(rings.radii_m, [13_000.0, 26_000.0, 52_000.0]);
        }
        for (limit, expected) in rings.limits_m.iter().zip([13.9, 27.8, 55.6]) {
            assert!((limit - expected).abs() < 0.05, "{limit}");
        }
        assert_eq!([0.0, 12_999.0, 13_000.0, 26_000.0, 60_000.0, 1e9].map(|d| rings.ring_at(d)), [0, 0, 1, 2, 3, 3]);
        assert_eq!(Rings::all_level_0().ring_at(1e9), 0);
    }

    #[test]
    fn a_small_window_shrinks_the_near_zone() {
        let rings = Rings::new(&Grid::centred(25.0, 60, 60).unwrap(), 12, 1.0);
        assert_eq!(rings.radii_m[0], 4.0 * 25.0 * f64::from(crate::CELLS));
    }
}
