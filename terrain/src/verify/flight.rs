//! A window that is flown, and beside it what a graphics device would hold after the window's uploads.
//!
//! Invariant others rely on: what [`Flight::drawn`] gives is what the uploads put there, not what the world says.

use crate::block::mesh;
use crate::block::payload::{Landscape, Payload};
use crate::block::rings::Rings;
use crate::block::window::{BUDGET_BYTES, Draw, Level, Settings, Upload, Window};
use crate::grid::BlockIndex;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// See the module.
pub struct Flight {
    window: Window,
    slots: Vec<Held>,
}

#[derive(Default, Clone)]
struct Held {
    payload: Option<Arc<Payload>>,
    indices: Arc<Vec<u16>>,
}

/// A block as it is drawn.
#[derive(Debug, Clone, Copy)]
pub struct Piece<'a> {
    /// Which block.
    pub block: BlockIndex,
    /// Its triangle list.
    pub indices: &'a [u16],
    /// Its height tile, `TILE` x `TILE`.
    pub heights_m: &'a [f32],
}

/// A block's change of ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingSwitch {
    /// Which block.
    pub block: BlockIndex,
    /// Its ring before.
    pub from: usize,
    /// Its ring after.
    pub to: usize,
    /// Plan distance to its nearest point at the switch, metres.
    pub distance_m: f64,
}

impl Flight {
    /// A window of `blocks` x `blocks` over a landscape, as a frame-by-frame flight has it.
    pub fn new(landscape: Arc<Landscape>, rings: Rings, blocks: u32) -> Self {
        let settings = Settings { blocks, rings, budget_bytes: BUDGET_BYTES, wait: true, threads: 2 };
        let window = Window::new(landscape, settings, DVec3::Y);
        let side = window.settings().blocks as usize;
        Self { window, slots: vec![Held::default(); side * side] }
    }

    /// The window.
    pub fn window(&self) -> &Window {
        &self.window
    }

    /// Moves the eye (plan x, z, metres) at a speed; says which blocks changed ring.
    pub fn fly_to(&mut self, eye: DVec2, speed_mps: f64) -> Vec<RingSwitch> {
        let rings = |window: &Window| -> Vec<Option<(BlockIndex, usize)>> {
            (0..self.slots.len()).map(|slot| window.resident(slot).map(|r| (r.block, r.ring))).collect()
        };
        let before = rings(&self.window);
        for upload in self.window.update(eye, speed_mps) {
            match upload {
                Upload::Block { slot, payload, .. } => self.slots[slot].payload = Some(payload),
                Upload::Indices { slot, indices } => self.slots[slot].indices = indices,
                Upload::Light { .. } => {}
            }
        }
        let after = (0..self.slots.len()).map(|slot| self.window.resident(slot).map(|r| (r.block, r.ring)));
        let grid = self.window.landscape().ground.field().grid();
        before
            .into_iter()
            .zip(after)
            .filter_map(|pair| match pair {
                (Some((block, from)), Some((same, to))) if block == same && from != to => {
                    Some(RingSwitch { block, from, to, distance_m: grid.distance_to_block_m(eye.x, eye.y, block) })
                }
                _ => None,
            })
            .collect()
    }

    /// All blocks of the window that are drawn, whichever way the eye looks.
    pub fn draws(&self) -> Vec<Draw> {
        self.window.draws(|_, _, _| true)
    }

    /// What is drawn for a block.
    pub fn drawn(&self, draw: &Draw) -> Option<Piece<'_>> {
        let held = &self.slots[draw.slot];
        let payload = held.payload.as_ref()?;
        let indices: &[u16] = match draw.level {
            Level::Zero => mesh::level_0(),
            Level::One => mesh::level_1(),
            Level::Own { indices } => held.indices.get(..indices as usize)?,
        };
        Some(Piece { block: payload.block, indices, heights_m: &payload.heights_m })
    }
}
