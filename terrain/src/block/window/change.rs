//! The next version of the ground: every block that it reaches is made anew while the old one is drawn, then all of them
//! go up in one update, so no border is ever between two versions.
//!
//! What goes up at once is not held to the update's budget: 28 KiB and its triangles for a block whose posts or colours
//! changed (a crater of a kilometre reaches one to four, at worst nine), 4 KiB for one that it only shades. A version that comes while one is
//! being built waits for it, together with all that come after it.

use super::ask::Asked;
use super::switch::{indices_bytes, place};
use super::{Resident, Upload, Window};
use crate::block::builder::{Built, Job};
use crate::block::light::Walk;
use crate::block::payload::{Landscape, Mesh, Payload};
use crate::edit::Changed;
use crate::grid::BlockIndex;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// A version of the ground and how it differs from the one before.
pub(super) struct Coming {
    landscape: Arc<Landscape>,
    changed: Changed,
}

/// A version that is being built.
pub(super) struct Change {
    coming: Coming,
    number: u64,
    asked: HashSet<(Asked, usize)>,
    payloads: HashMap<BlockIndex, Arc<Payload>>,
    meshes: HashMap<(BlockIndex, usize), Mesh>,
    /// By block and layer.
    lights: HashMap<(BlockIndex, usize), Arc<[u8]>>,
    /// Towards the suns of the two layers.
    walks: [Walk; 2],
}

/// What a block of the window needs of a change.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Needs {
    payload: bool,
    /// In each layer, for blocks that hold light there.
    light: [bool; 2],
}

impl Change {
    /// Whether a builder has been asked for anything of it that it has not given.
    pub(super) fn is_owed(&self) -> bool {
        !self.asked.is_empty()
    }

    fn needs(&self, resident: &Resident, front: usize) -> Needs {
        let changed = &self.coming.changed;
        let payload = changed.reaches_payload(resident.block);
        let light = [0, 1].map(|layer| {
            let held = layer == front || resident.lit[layer];
            // A payload brings the light of the layer in use.
            held && !(payload && layer == front)
                && changed.reaches_light(resident.block, &self.walks[layer], resident.lowest_m)
        });
        Needs { payload, light }
    }

    fn is_ready(&self, needs: Needs, resident: &Resident) -> bool {
        let there = |layer: usize| self.lights.contains_key(&(resident.block, layer));
        let surface = !needs.payload
            || self.payloads.contains_key(&resident.block)
                && self.meshes.contains_key(&(resident.block, resident.ring));
        surface && (0..2).all(|layer| !needs.light[layer] || there(layer))
    }
}

impl Window {
    /// Takes over a new version of the ground; `changed` is what it differs in from the one last given. It is shown as soon
    /// as every block that it reaches is made: in the next update, where the window waits for builders.
    pub fn set_landscape(&mut self, landscape: Arc<Landscape>, changed: &Changed) {
        if !self.started {
            self.landscape = landscape;
            return;
        }
        let coming = match self.coming.take() {
            Some(before) => Coming { landscape, changed: before.changed.and(changed) },
            None => Coming { landscape, changed: changed.clone() },
        };
        self.coming = Some(coming);
        self.begin_change();
    }

    fn walks(&self) -> [Walk; 2] {
        let step_m = self.landscape.ground.field().grid().step_m;
        self.suns.map(|to_sun| Walk::new(step_m, to_sun))
    }

    /// The sun of a layer, or the layer in use, is another: what of a change was lit before is made again.
    pub(super) fn relight_change(&mut self) {
        let walks = self.walks();
        if let Some(change) = &mut self.change {
            change.payloads.clear();
            change.lights.clear();
            change.asked.retain(|(asked, _)| matches!(asked, Asked::Mesh(..)));
            change.walks = walks;
        }
    }

    /// Whether a new version of the ground is on its way.
    pub fn is_changing(&self) -> bool {
        self.change.is_some()
    }

    /// Starts on the version that waits, unless one is being built.
    pub(super) fn begin_change(&mut self) {
        if self.change.is_some() {
            return;
        }
        let Some(coming) = self.coming.take() else { return };
        self.quiet = None;
        self.change = Some(Change {
            coming,
            number: self.number + 1,
            asked: HashSet::new(),
            payloads: HashMap::new(),
            meshes: HashMap::new(),
            lights: HashMap::new(),
            walks: self.walks(),
        });
    }

    /// Asks for what the change needs and has neither got nor asked for.
    pub(super) fn ask_change(&mut self) {
        let Some(change) = &mut self.change else { return };
        let grid = self.landscape.ground.field().grid();
        let mut jobs = Vec::new();
        for resident in self.slots.iter().flatten() {
            let (block, ring) = (resident.block, resident.ring);
            let needs = change.needs(resident, self.front);
            // Before the row of a shift, after the meshes of a ring.
            let distance_m = grid.distance_to_block_m(self.eye.x, self.eye.y, block) - 5e8;
            let mut ask = |asked: Asked, layer: usize, job: Job| {
                if change.asked.insert((asked, layer)) {
                    jobs.push((distance_m, job));
                }
            };
            if needs.payload && !change.payloads.contains_key(&block) {
                ask(Asked::Payload(block), 0, Job::Payload { block, to_sun: self.suns[self.front] });
            }
            if needs.payload && !change.meshes.contains_key(&(block, ring)) {
                ask(Asked::Mesh(block, ring), 0, Job::Mesh { block, ring });
            }
            for layer in [0, 1] {
                if needs.light[layer] && !change.lights.contains_key(&(block, layer)) {
                    ask(Asked::Light(block), layer, Job::Light { block, to_sun: self.suns[layer] });
                }
            }
        }
        self.builder.request(change.number, &change.coming.landscape, jobs);
    }

    /// Keeps what was made for the change; what is for a ground that is gone is dropped.
    pub(super) fn take_changed(&mut self, number: u64, built: Built) {
        let Some(change) = self.change.as_mut().filter(|change| change.number == number) else { return };
        match built {
            Built::Payload(payload) => {
                change.asked.remove(&(Asked::Payload(payload.block), 0));
                if payload.light_sun == self.suns[self.front] {
                    change.payloads.insert(payload.block, Arc::from(payload));
                }
            }
            Built::Mesh { block, ring, mesh } => {
                change.asked.remove(&(Asked::Mesh(block, ring), 0));
                change.meshes.insert((block, ring), mesh);
            }
            Built::Light { block, to_sun, light } => {
                let light: Arc<[u8]> = Arc::from(light);
                for layer in [0, 1].into_iter().filter(|layer| self.suns[*layer] == to_sun) {
                    change.asked.remove(&(Asked::Light(block), layer));
                    change.lights.insert((block, layer), light.clone());
                }
            }
        }
    }

    /// Shows the new version if all of it is there; says how many bytes that uploads.
    pub(super) fn flip_change(&mut self, uploads: &mut Vec<Upload>) -> usize {
        let Some(change) = &self.change else { return 0 };
        let needs = |resident: &Resident| change.needs(resident, self.front);
        if !self.slots.iter().flatten().all(|resident| change.is_ready(needs(resident), resident)) {
            return 0;
        }
        let Some(mut change) = self.change.take() else { return 0 };
        let (mut bytes, mut room) = (0, usize::MAX);
        for (slot, range) in (0..self.slots.len()).zip(&mut self.ranges) {
            let Some(resident) = &mut self.slots[slot] else { continue };
            let (block, ring) = (resident.block, resident.ring);
            let needs = change.needs(resident, self.front);
            for layer in [0, 1] {
                if let Some(light) = change.lights.remove(&(block, layer)).filter(|_| needs.light[layer]) {
                    bytes += light.len();
                    uploads.push(Upload::Light { slot, layer, light });
                }
            }
            let payload = change.payloads.remove(&block).filter(|_| needs.payload);
            if let (Some(payload), Some(mesh)) = (payload, change.meshes.remove(&(block, ring))) {
                bytes += payload.upload_bytes() + indices_bytes(&mesh);
                resident.range = payload.range;
                resident.lowest_m = payload.lowest_m();
                (resident.has_water, resident.ground_triangles) = (payload.has_water, payload.ground_triangles);
                *range = payload.range;
                uploads.push(Upload::Block { slot, layer: self.front, payload });
                if let Some(level) = place(&mesh, slot, uploads, &mut room) {
                    (resident.level, resident.list_hash) = (level, mesh.hash());
                }
            }
        }
        self.adopt(change);
        bytes
    }

    /// Makes the version of a change the one that is drawn, and forgets what was built ahead for the one before where the
    /// change reaches it.
    fn adopt(&mut self, change: Change) {
        let Coming { landscape, changed } = change.coming;
        self.landscape = landscape;
        self.number = change.number;
        let lowest_m = self.landscape.ground.pyramid().all().least_m;
        let (front, back) = (&change.walks[self.front], &change.walks[1 - self.front]);
        self.ready
            .retain(|block, _| !changed.reaches_payload(*block) && !changed.reaches_light(*block, front, lowest_m));
        self.meshes.retain(|(block, _), _| !changed.reaches_surface(*block));
        self.lights.retain(|block, _| !changed.reaches_light(*block, back, lowest_m));
        self.builder.withdraw(|_, _| true);
        self.asked.clear();
        self.counters.changes += 1;
    }
}
