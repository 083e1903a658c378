//! Streaming: which blocks belong to the window, how it shifts after the eye, and how built blocks come in.
//!
//! A shift replaces one row or column; it commits when every block of it is there, until then the old window stands. After
//! a jump all begins anew.

use super::switch::{indices_bytes, place};
use super::{Resident, Upload, Window};
use crate::block::payload::{Mesh, Payload};
use crate::grid::BlockIndex;
use crate::pyramid::Range;
use glam::DVec2;
use rayon::prelude::*;
use std::sync::Arc;

/// Blocks east and south that a window moves by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shift {
    pub(super) dx: i32,
    pub(super) dz: i32,
}

impl Window {
    /// Whether a block belongs to the committed window and is not on its way out.
    pub(super) fn is_shown(&self, block: BlockIndex) -> bool {
        let (x, z) = (block.x - self.origin.x, block.z - self.origin.z);
        let n = self.n();
        let inside = (0..n).contains(&x) && (0..n).contains(&z);
        inside
            && self.shift.is_none_or(|shift| {
                let leaving = |at: i32, step: i32| (step > 0 && at == 0) || (step < 0 && at == n - 1);
                !leaving(x, shift.dx) && !leaving(z, shift.dz)
            })
    }

    /// The window that is being worked towards.
    pub(super) fn target(&self) -> BlockIndex {
        let shift = self.shift.unwrap_or(Shift { dx: 0, dz: 0 });
        BlockIndex { x: self.origin.x + shift.dx, z: self.origin.z + shift.dz }
    }

    pub(super) fn in_target(&self, block: BlockIndex) -> bool {
        let target = self.target();
        (0..self.n()).contains(&(block.x - target.x)) && (0..self.n()).contains(&(block.z - target.z))
    }

    /// Offset of the eye from the window's middle, blocks.
    pub(super) fn offset(&self) -> DVec2 {
        let grid = self.landscape.ground.field().grid();
        let eye = (self.eye - DVec2::new(grid.west_m, grid.north_m)) / grid.block_m();
        eye - DVec2::new(f64::from(self.origin.x), f64::from(self.origin.z)) - DVec2::splat(f64::from(self.n()) / 2.0)
    }

    /// Starts a shift, or all over after a jump.
    pub(super) fn follow(&mut self) {
        let offset = self.offset();
        if !self.started || offset.x.abs() > 2.0 || offset.y.abs() > 2.0 {
            let grid = self.landscape.ground.field().grid();
            let half = self.n() / 2;
            let eye = (self.eye - DVec2::new(grid.west_m, grid.north_m)) / grid.block_m();
            self.origin = BlockIndex { x: eye.x.round() as i32 - half, z: eye.y.round() as i32 - half };
            self.shift = None;
            self.jumping = true;
            self.forget_outside(self.origin);
            return;
        }
        if self.shift.is_some() || self.jumping {
            return;
        }
        // Beyond half a block off the middle; the axis that is further off goes first.
        let step = |off: f64| {
            if off > 0.5 {
                1
            } else if off < -0.5 {
                -1
            } else {
                0
            }
        };
        let (dx, dz) = (step(offset.x), step(offset.y));
        let shift = if dx != 0 && (dz == 0 || offset.x.abs() >= offset.y.abs()) {
            Shift { dx, dz: 0 }
        } else {
            Shift { dx: 0, dz }
        };
        if shift != (Shift { dx: 0, dz: 0 }) {
            self.shift = Some(shift);
            self.forget_outside(self.target());
        }
    }

    /// Empties the slots whose blocks are not in the window at `origin`.
    pub(super) fn forget_outside(&mut self, origin: BlockIndex) {
        let n = self.n();
        for (slot, range) in self.slots.iter_mut().zip(&mut self.ranges) {
            if slot.as_ref().is_some_and(|resident| {
                let (x, z) = (resident.block.x - origin.x, resident.block.z - origin.z);
                !(0..n).contains(&x) || !(0..n).contains(&z)
            }) {
                (*slot, *range) = (None, Range::VOID);
            }
        }
    }

    /// Builds the whole window on all cores: there is no picture yet that could wait.
    pub(super) fn build_all(&mut self) {
        let blocks: Vec<BlockIndex> = self.wanted_blocks().collect();
        let (landscape, to_sun) = (&self.landscape, self.suns[self.front]);
        let grid = landscape.ground.field().grid();
        let ring =
            |block: BlockIndex| self.settings.rings.ring_at(grid.distance_to_block_m(self.eye.x, self.eye.y, block));
        let built: Vec<(Arc<Payload>, usize, Mesh)> = blocks
            .par_iter()
            .map(|block| {
                (Arc::new(landscape.payload(*block, to_sun)), ring(*block), landscape.mesh(*block, ring(*block)))
            })
            .collect();
        for (payload, ring, mesh) in built {
            self.meshes.insert((payload.block, ring), mesh);
            self.ready.insert(payload.block, payload);
        }
    }

    /// Uploads the blocks of the target window that are ready, nearest first; commits the shift when all are there.
    pub(super) fn fill(&mut self, uploads: &mut Vec<Upload>, left: &mut usize) {
        let grid = *self.landscape.ground.field().grid();
        let mut incoming: Vec<(f64, BlockIndex)> = self
            .ready
            .keys()
            .filter(|block| self.in_target(**block) && self.slots[self.slot(**block)].is_none())
            .map(|block| (grid.distance_to_block_m(self.eye.x, self.eye.y, *block), *block))
            .collect();
        incoming.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (distance_m, block) in incoming {
            let ring = self.settings.rings.ring_at(distance_m);
            let slot = self.slot(block);
            // A finer mesh than needed will do; after a jump it is made here, as the picture is incomplete anyway.
            let known = (0..=ring).rev().find_map(|r| self.meshes.remove(&(block, r)).map(|mesh| (r, mesh)));
            let Some((ring, mesh)) =
                known.or_else(|| (!self.started || self.jumping).then(|| (ring, self.landscape.mesh(block, ring))))
            else {
                continue;
            };
            let Some(payload) = self.ready.get(&block).cloned() else { continue };
            if payload.upload_bytes() + indices_bytes(&mesh) > *left {
                self.meshes.insert((block, ring), mesh);
                break;
            }
            self.ready.remove(&block);
            *left -= payload.upload_bytes();
            let mut lit = [false; 2];
            lit[self.front] = true;
            let (range, has_water, ground_triangles) = (payload.range, payload.has_water, payload.ground_triangles);
            let lowest_m = payload.lowest_m();
            uploads.push(Upload::Block { slot, layer: self.front, payload });
            let Some(level) = place(&mesh, slot, uploads, left) else { continue };
            let list_hash = mesh.hash();
            self.ranges[slot] = range;
            self.slots[slot] =
                Some(Resident { block, ring, level, range, has_water, ground_triangles, lowest_m, list_hash, lit });
        }
        let moving = self.jumping || self.shift.is_some();
        if moving && self.wanted_blocks().all(|block| self.slots[self.slot(block)].is_some()) {
            self.jumping = false;
            if let Some(shift) = self.shift.take() {
                self.origin.x += shift.dx;
                self.origin.z += shift.dz;
                self.counters.shifts += 1;
            }
        }
    }

    /// The blocks of the world in the target window.
    pub(super) fn wanted_blocks(&self) -> impl Iterator<Item = BlockIndex> + use<> {
        let (target, n) = (self.target(), self.n());
        let grid = self.landscape.ground.field().grid();
        let (wide, high) = (grid.blocks_x as i32, grid.blocks_z as i32);
        (target.z.max(0)..(target.z + n).min(high))
            .flat_map(move |z| (target.x.max(0)..(target.x + n).min(wide)).map(move |x| BlockIndex { x, z }))
    }
}
