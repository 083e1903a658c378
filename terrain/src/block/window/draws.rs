//! What a view draws, what of it is late, and its fingerprint.

use super::{Draw, Resident, Window};
use crate::grid::BlockIndex;
use crate::pyramid::Range;

/// Blocks along the squares that are culled as one.
const GROUP: usize = 4;

impl Window {
    /// The blocks of the committed window that are there and visible, nearest first.
    ///
    /// `visible` judges a square of blocks: the north-western one, how many along a side, and the range of heights. It is
    /// asked for squares of several blocks first and must not refuse one that holds a visible block.
    pub fn draws(&self, visible: impl Fn(BlockIndex, i32, Range) -> bool) -> Vec<Draw> {
        let grid = self.landscape.ground.field().grid();
        let all = self.landscape.ground.pyramid().all();
        let n = self.n();
        let mut draws = Vec::with_capacity(self.slots.len() / 2);
        for (group_z, group_x) in (0..n).step_by(GROUP).flat_map(|z| (0..n).step_by(GROUP).map(move |x| (z, x))) {
            let corner = BlockIndex { x: self.origin.x + group_x, z: self.origin.z + group_z };
            if !visible(corner, GROUP as i32, all) {
                continue;
            }
            for z in corner.z..(corner.z + GROUP as i32).min(self.origin.z + n) {
                for x in corner.x..(corner.x + GROUP as i32).min(self.origin.x + n) {
                    let block = BlockIndex { x, z };
                    let slot = self.slot(block);
                    let range = self.ranges[slot];
                    if range.is_void() || !self.is_shown(block) || !visible(block, 1, range) {
                        continue;
                    }
                    // A slot may hold a block that is on its way in already.
                    let Some(resident) = self.slots[slot].as_ref().filter(|r| r.block == block) else { continue };
                    let Resident { level, ring, has_water, ground_triangles, .. } = *resident;
                    let distance_m = grid.distance_to_block_m(self.eye.x, self.eye.y, block);
                    draws.push(Draw { slot, block, level, ring, distance_m, range, has_water, ground_triangles });
                }
            }
        }
        draws.sort_unstable_by(|a: &Draw, b| a.distance_m.total_cmp(&b.distance_m).then(a.slot.cmp(&b.slot)));
        draws
    }

    /// Blocks of the world within the guaranteed range that are not there, or coarser than their ring allows.
    pub fn late_blocks(&self) -> u64 {
        let grid = self.landscape.ground.field().grid();
        let range_m = self.view_range_min_m();
        let reach = (range_m / grid.block_m()).ceil() as i32 + 1;
        let centre = grid.block_at(self.eye.x, self.eye.y);
        let mut late = 0;
        for z in centre.z.saturating_sub(reach).max(0)..=centre.z.saturating_add(reach).min(grid.blocks_z as i32 - 1) {
            for x in
                centre.x.saturating_sub(reach).max(0)..=centre.x.saturating_add(reach).min(grid.blocks_x as i32 - 1)
            {
                let block = BlockIndex { x, z };
                let distance_m = grid.distance_to_block_m(self.eye.x, self.eye.y, block);
                if distance_m >= range_m {
                    continue;
                }
                let fine_enough = self.slots[self.slot(block)].as_ref().is_some_and(|resident| {
                    resident.block == block
                        && self.is_shown(block)
                        && resident.ring <= self.settings.rings.ring_at(distance_m)
                });
                late += u64::from(!fine_enough);
            }
        }
        late
    }

    /// Fingerprint of what is drawn, nearest first: blocks, slots, rings and index lists.
    pub fn mesh_hash(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325u64;
        for draw in self.draws(|_, _, _| true) {
            let list = self.slots[draw.slot].as_ref().map_or(0, |resident| resident.list_hash);
            for word in [draw.slot as u64, draw.block.x as u64, draw.block.z as u64, draw.ring as u64, list] {
                hash = (hash ^ word).wrapping_mul(0x0000_0100_0000_01b3);
            }
        }
        hash
    }
}
