//! What is asked of the builders, what comes back, and when there is nothing to ask.

use super::Window;
use super::change::Change;
use super::switch::{margins, wanted_ring};
use crate::block::builder::{Built, Job};
use crate::grid::BlockIndex;
use glam::DVec2;
use std::sync::Arc;

/// Nothing is owed and nothing will be wanted while the eye stays within a circle: most frames are no work at all.
#[derive(Debug, Clone, Copy)]
pub(super) struct Quiet {
    pub(super) from: DVec2,
    reach_m: f64,
    speed_mps: f64,
    /// The sides on which the window is built ahead.
    ahead: [bool; 2],
}

/// What is under way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Asked {
    Payload(BlockIndex),
    Mesh(BlockIndex, usize),
    Light(BlockIndex),
}

impl From<&Job> for Asked {
    fn from(job: &Job) -> Self {
        match *job {
            Job::Payload { block, .. } => Self::Payload(block),
            Job::Mesh { block, ring } => Self::Mesh(block, ring),
            Job::Light { block, .. } => Self::Light(block),
        }
    }
}

impl Window {
    /// Asks for all that is wanted and neither there, ready nor asked for; forgets what is no longer near.
    pub(super) fn ask(&mut self, speed_mps: f64) {
        let grid = *self.landscape.ground.field().grid();
        let target = self.target();
        let (n, offset, rings) = (self.n(), self.offset(), self.settings.rings);
        // The next row and column on the side the eye is on, so that a shift finds them ready.
        let ahead = |off: f64| if off > 0.0 { (0, 1) } else { (-1, 0) };
        let ((west, east), (north, south)) = (ahead(offset.x), ahead(offset.y));
        let near = |block: BlockIndex| {
            (-2..n + 2).contains(&(block.x - target.x)) && (-2..n + 2).contains(&(block.z - target.z))
        };
        self.ready.retain(|block, _| near(*block));
        let to_sun = self.suns[self.front];
        let (slots, asked) = (&self.slots, &mut self.asked);
        let number = self.number;
        // What a change needs stays: its blocks are resident, or it is a few jobs too many.
        let gone = self.builder.withdraw(|of, job| of == number && !near(job.block()));
        gone.iter().for_each(|(_, job)| {
            asked.remove(&Asked::from(job));
        });
        let mut jobs = Vec::new();
        let slot_of = |block: BlockIndex| (block.z.rem_euclid(n) * n + block.x.rem_euclid(n)) as usize;
        let distance = |block: BlockIndex| grid.distance_to_block_m(self.eye.x, self.eye.y, block);
        for z in (target.z + north).max(0)..(target.z + n + south).min(grid.blocks_z as i32) {
            for x in (target.x + west).max(0)..(target.x + n + east).min(grid.blocks_x as i32) {
                let block = BlockIndex { x, z };
                let resident = slots[slot_of(block)].as_ref().filter(|r| r.block == block);
                if resident.is_none() && !self.ready.contains_key(&block) && asked.insert(Asked::Payload(block)) {
                    jobs.push((distance(block), Job::Payload { block, to_sun }));
                }
            }
        }
        for resident in slots.iter().flatten() {
            let block = resident.block;
            let wanted = wanted_ring(&rings, resident.ring, distance(block), speed_mps);
            if wanted != resident.ring
                && !self.meshes.contains_key(&(block, wanted))
                && asked.insert(Asked::Mesh(block, wanted))
            {
                // Meshes are small and are needed at once: before any payload.
                jobs.push((-1e9 + distance(block), Job::Mesh { block, ring: wanted }));
            }
            let back = 1 - self.front;
            if self.relighting
                && !resident.lit[back]
                && !self.lights.contains_key(&block)
                && asked.insert(Asked::Light(block))
            {
                jobs.push((1e9 + distance(block), Job::Light { block, to_sun: self.suns[back] }));
            }
        }
        // A ready block on its way in needs a mesh too.
        let incoming: Vec<BlockIndex> = self.ready.keys().copied().collect();
        for block in incoming {
            let ring = self.settings.rings.ring_at(distance(block) - margins(speed_mps).0);
            if !self.meshes.contains_key(&(block, ring)) && self.asked.insert(Asked::Mesh(block, ring)) {
                jobs.push((-1e9 + distance(block), Job::Mesh { block, ring }));
            }
        }
        self.builder.request(self.number, &self.landscape, jobs);
        self.ask_change();
    }

    /// Whether a builder has been asked for anything that it has not given.
    pub(super) fn is_owed(&self) -> bool {
        !self.asked.is_empty() || self.change.as_ref().is_some_and(Change::is_owed)
    }

    /// Flips of light and ground so far.
    pub(super) fn flips(&self) -> u64 {
        self.counters.relights + self.counters.changes
    }

    pub(super) fn collect(&mut self) {
        while let Some((number, built)) = self.builder.try_take() {
            self.take(number, built);
            self.quiet = None;
        }
    }

    /// Whether the last look at every block still holds.
    pub(super) fn is_quiet(&self, speed_mps: f64) -> bool {
        self.quiet.is_some_and(|quiet| {
            let offset = self.offset();
            self.eye.distance(quiet.from) < quiet.reach_m
                && speed_mps == quiet.speed_mps
                && [offset.x > 0.0, offset.y > 0.0] == quiet.ahead
                && offset.abs().max_element() <= 0.5
        })
    }

    /// How far the eye may go before any block wants another ring; `None` while anything is owed.
    pub(super) fn settled(&self, speed_mps: f64) -> Option<Quiet> {
        // A flip in this very update has emptied what was built ahead.
        let flipped = self.quiet_flips != self.flips();
        if flipped
            || self.change.is_some()
            || !self.asked.is_empty()
            || self.shift.is_some()
            || self.jumping
            || self.relighting
        {
            return None;
        }
        let grid = self.landscape.ground.field().grid();
        let (finer_m, coarser_m) = margins(speed_mps);
        let radii_m = &self.settings.rings.radii_m;
        let mut reach_m = f64::INFINITY;
        for resident in self.slots.iter().flatten() {
            let distance_m = grid.distance_to_block_m(self.eye.x, self.eye.y, resident.block);
            if let Some(radius_m) = resident.ring.checked_sub(1).and_then(|inner| radii_m.get(inner)) {
                reach_m = reach_m.min(distance_m - finer_m - radius_m);
            }
            if let Some(radius_m) = radii_m.get(resident.ring) {
                reach_m = reach_m.min(radius_m + coarser_m - distance_m);
            }
        }
        let offset = self.offset();
        let ahead = [offset.x > 0.0, offset.y > 0.0];
        (reach_m > 0.0).then_some(Quiet { from: self.eye, reach_m, speed_mps, ahead })
    }

    pub(super) fn take(&mut self, number: u64, built: Built) {
        if number != self.number {
            // For the ground to come, or for one that is gone.
            return self.take_changed(number, built);
        }
        match built {
            Built::Payload(payload) => {
                self.asked.remove(&Asked::Payload(payload.block));
                // One lit from a sun that is no longer drawn is asked for again.
                if payload.light_sun == self.suns[self.front] {
                    self.ready.insert(payload.block, Arc::from(payload));
                }
            }
            Built::Mesh { block, ring, mesh } => {
                self.asked.remove(&Asked::Mesh(block, ring));
                self.meshes.insert((block, ring), mesh);
            }
            Built::Light { block, to_sun, light } => {
                self.asked.remove(&Asked::Light(block));
                // Light for a sun that has moved on is asked for again.
                if self.relighting && to_sun == self.suns[1 - self.front] {
                    self.lights.insert(block, (to_sun, Arc::from(light)));
                }
            }
        }
    }
}
