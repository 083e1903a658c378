//! Ring switches: when a block turns finer or coarser, and how its new triangles come in.

use super::{Level, Upload, Window};
use crate::block::payload::Mesh;
use crate::block::rings::Rings;
use crate::grid::BlockIndex;

impl Window {
    /// Puts ring switches into effect whose mesh is there.
    pub(super) fn switch_rings(&mut self, speed_mps: f64, uploads: &mut Vec<Upload>, left: &mut usize) {
        if self.meshes.is_empty() {
            return;
        }
        let grid = *self.landscape.ground.field().grid();
        let mut switches: Vec<(f64, usize, usize)> = Vec::new();
        for (slot, resident) in self.slots.iter().enumerate() {
            if let Some(resident) = resident {
                let distance_m = grid.distance_to_block_m(self.eye.x, self.eye.y, resident.block);
                let wanted = wanted_ring(&self.settings.rings, resident.ring, distance_m, speed_mps);
                if wanted != resident.ring && self.meshes.contains_key(&(resident.block, wanted)) {
                    switches.push((distance_m, slot, wanted));
                }
            }
        }
        switches.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (_, slot, ring) in switches {
            let Some(block) = self.slots[slot].as_ref().map(|r| r.block) else { continue };
            let Some(mesh) = self.meshes.get(&(block, ring)) else { continue };
            let Some(level) = place(mesh, slot, uploads, left) else { continue };
            let list_hash = mesh.hash();
            self.meshes.remove(&(block, ring));
            if let Some(resident) = &mut self.slots[slot] {
                (resident.ring, resident.level, resident.list_hash) = (ring, level, list_hash);
                self.counters.switches += 1;
            }
        }
        // Meshes for rings that their blocks have left again.
        let (slots, n, rings, eye) = (&self.slots, self.n(), self.settings.rings, self.eye);
        let slot_of = |block: BlockIndex| (block.z.rem_euclid(n) * n + block.x.rem_euclid(n)) as usize;
        let ready = &self.ready;
        self.meshes.retain(|(block, ring), _| {
            ready.contains_key(block)
                || slots[slot_of(*block)].as_ref().is_some_and(|resident| {
                    let distance_m = grid.distance_to_block_m(eye.x, eye.y, *block);
                    resident.block == *block && *ring == wanted_ring(&rings, resident.ring, distance_m, speed_mps)
                })
        });
    }
}

/// How far before a ring's radius a block turns finer, and how far behind it coarser again, metres.
pub(super) fn margins(speed_mps: f64) -> (f64, f64) {
    // A builder answers within a frame or two, and meshes go before all else; a fifth of a second of flight is ample.
    let margin_m = 60.0 + 0.2 * speed_mps.abs().min(20_000.0);
    (margin_m, margin_m + 60.0)
}

/// The ring a block should be drawn for: finer a margin early, coarser a little behind that.
pub(super) fn wanted_ring(rings: &Rings, ring: usize, distance_m: f64, speed_mps: f64) -> usize {
    let (finer, coarser) = margins(speed_mps);
    let (fine, coarse) = (rings.ring_at(distance_m - finer), rings.ring_at(distance_m - coarser));
    if fine < ring {
        fine
    } else if coarse > ring {
        coarse
    } else {
        ring
    }
}

pub(super) fn indices_bytes(mesh: &Mesh) -> usize {
    match mesh {
        Mesh::Own(list) => size_of_val(list.as_slice()),
        Mesh::Level0 | Mesh::Level1 => 0,
    }
}

/// Makes a mesh the slot's, uploading its own list if it has one; `None` if that is over budget.
pub(super) fn place(mesh: &Mesh, slot: usize, uploads: &mut Vec<Upload>, left: &mut usize) -> Option<Level> {
    match mesh {
        Mesh::Level0 => Some(Level::Zero),
        Mesh::Level1 => Some(Level::One),
        Mesh::Own(list) => {
            let bytes = indices_bytes(mesh);
            if bytes > *left {
                return None;
            }
            *left -= bytes;
            uploads.push(Upload::Indices { slot, indices: list.clone() });
            Some(Level::Own { indices: list.len() as u32 })
        }
    }
}
