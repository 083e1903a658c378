//! A toroidal window over the block grid that follows the eye: which blocks are there, at which level, in which slot.
//!
//! `n` x `n` slots; block (x, z) always lives in slot (x mod n, z mod n), so moving by one block replaces one row or one
//! column and nothing else. The window has no GPU: [`Window::update`] says what to upload where, [`Window::draws`] what
//! to draw; a renderer, a test and `verify` use it alike.
//!
//! Per update, in this order and within one byte budget: meshes of blocks that change ring, the row or column of a shift
//! in progress, light for a new sun. The row ahead is built before it is needed, so a shift only waits for its uploads;
//! it commits when complete, until then the old window stands. A block turns finer a margin before it must and coarser
//! a little behind that, so a builder's delay is never seen and no block flickers. Light is double-buffered and flips for all blocks together.
//! A new version of the ground ([`Window::set_landscape`]) flips first, all blocks that it reaches in one update.
//!
//! Invariant others rely on: with the eye inside the window's middle two blocks, every block within `n/2 - 1` blocks is
//! there; what is drawn depends on the eye's path only, not on time, when [`Settings::wait`] is set.

mod ask;
mod change;
mod draws;
mod follow;
mod relight;
mod switch;

use self::ask::{Asked, Quiet};
use self::change::{Change, Coming};
use self::follow::Shift;
use self::switch::indices_bytes;
use super::builder::{BuildCost, Builder};
use super::payload::{Landscape, Mesh, Payload};
use super::rings::Rings;
use crate::grid::BlockIndex;
use crate::pyramid::Range;
use glam::{DVec2, DVec3};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// How a window works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Blocks along a side: even, 4..=[`MAX_BLOCKS`].
    pub blocks: u32,
    /// Which error is allowed where.
    pub rings: Rings,
    /// Most bytes uploaded in one update.
    pub budget_bytes: usize,
    /// Wait for every block that is asked for: the same path gives the same pictures.
    pub wait: bool,
    /// Builder threads.
    pub threads: usize,
}

/// Most blocks along a side of a window; the table of blocks then fits the smallest uniform buffer there is.
pub const MAX_BLOCKS: u32 = 32;

/// Bytes that one frame may upload.
pub const BUDGET_BYTES: usize = 128 << 10;

/// Bytes that one frame may upload after a jump, while the picture is incomplete anyway.
const JUMP_BUDGET_BYTES: usize = 4 << 20;

/// Something for the GPU. A slot is `z * n + x`.
#[allow(missing_docs, reason = "the fields say themselves what they are")]
#[derive(Debug, Clone)]
pub enum Upload {
    /// A new block: heights and ground map, and its light into the layer in use.
    Block { slot: usize, layer: usize, payload: Arc<Payload> },
    /// Light of a block for one of the two layers.
    Light { slot: usize, layer: usize, light: Arc<[u8]> },
    /// The slot's own index list.
    Indices { slot: usize, indices: Arc<Vec<u16>> },
}

/// Which index list a block is drawn with.
#[allow(missing_docs, reason = "the fields say themselves what they are")]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// Shared list of level 0.
    Zero,
    /// Shared list of level 1.
    One,
    /// The slot's own list, this many indices.
    Own { indices: u32 },
}

/// A block that is there.
#[derive(Debug, Clone)]
pub struct Resident {
    /// Which block.
    pub block: BlockIndex,
    /// Ring it is drawn for: 0 near.
    pub ring: usize,
    /// Its triangles.
    pub level: Level,
    /// Least and greatest height.
    pub range: Range,
    /// Whether it has water.
    pub has_water: bool,
    /// Triangles at level 0: all that are not void.
    pub ground_triangles: u32,
    /// Lowest ground of its tile, apron included.
    lowest_m: f32,
    /// Fingerprint of its index list.
    list_hash: u64,
    /// Which light layers hold light for the sun of that layer.
    lit: [bool; 2],
}

/// A block to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// Slot of its textures and index list.
    pub slot: usize,
    /// Which block.
    pub block: BlockIndex,
    /// Its triangles.
    pub level: Level,
    /// Ring it is drawn for.
    pub ring: usize,
    /// Plan distance from the eye to its nearest point, metres.
    pub distance_m: f64,
    /// Least and greatest height.
    pub range: Range,
    /// Whether it has water.
    pub has_water: bool,
    /// Triangles at level 0.
    pub ground_triangles: u32,
}

/// Counters of a window.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Counters {
    /// Rows and columns replaced.
    pub shifts: u64,
    /// Ring switches of blocks.
    pub switches: u64,
    /// Bytes uploaded in the last update.
    pub upload_bytes: usize,
    /// Bytes uploaded in all.
    pub upload_bytes_total: u64,
    /// Light flips.
    pub relights: u64,
    /// Versions of the ground taken over.
    pub changes: u64,
}

/// See the module.
pub struct Window {
    landscape: Arc<Landscape>,
    /// Number of the landscape: what comes back from a builder with another is stale.
    number: u64,
    /// The next version of the ground, being built, and what comes after it.
    change: Option<Change>,
    coming: Option<Coming>,
    settings: Settings,
    builder: Builder,
    slots: Vec<Option<Resident>>,
    /// Ranges of height by slot, void where nothing is: all that culling reads, and small enough to stay near.
    ranges: Vec<Range>,
    /// North-west block of the committed window.
    origin: BlockIndex,
    shift: Option<Shift>,
    /// Built, not yet uploaded.
    ready: HashMap<BlockIndex, Arc<Payload>>,
    meshes: HashMap<(BlockIndex, usize), Mesh>,
    lights: HashMap<BlockIndex, (DVec3, Arc<[u8]>)>,
    asked: HashSet<Asked>,
    /// Towards the sun of each layer; `front` is drawn.
    suns: [DVec3; 2],
    front: usize,
    relighting: bool,
    started: bool,
    jumping: bool,
    eye: DVec2,
    quiet: Option<Quiet>,
    /// Flips of light and ground up to the start of this update.
    quiet_flips: u64,
    /// The newest sun, to be lit for when the relight under way is done.
    next_sun: Option<DVec3>,
    counters: Counters,
}

impl Window {
    /// A window with nothing in it yet; the first update fills it around the eye.
    pub fn new(landscape: Arc<Landscape>, mut settings: Settings, to_sun: DVec3) -> Self {
        settings.blocks = settings.blocks.clamp(4, MAX_BLOCKS) & !1;
        let builder = Builder::new(settings.threads);
        Self {
            builder,
            slots: vec![None; (settings.blocks * settings.blocks) as usize],
            ranges: vec![Range::VOID; (settings.blocks * settings.blocks) as usize],
            origin: BlockIndex { x: 0, z: 0 },
            shift: None,
            ready: HashMap::new(),
            meshes: HashMap::new(),
            lights: HashMap::new(),
            asked: HashSet::new(),
            suns: [to_sun; 2],
            front: 0,
            relighting: false,
            started: false,
            jumping: false,
            eye: DVec2::ZERO,
            quiet: None,
            quiet_flips: 0,
            next_sun: None,
            counters: Counters::default(),
            landscape,
            number: 0,
            change: None,
            coming: None,
            settings,
        }
    }

    /// How it works.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// What it shows.
    pub fn landscape(&self) -> &Arc<Landscape> {
        &self.landscape
    }

    /// Distance within which every block of the world is there, metres.
    pub fn view_range_min_m(&self) -> f64 {
        (f64::from(self.settings.blocks) / 2.0 - 1.0) * self.landscape.ground.field().grid().block_m()
    }

    /// The light layer to draw with, and the sun it was made for.
    pub fn light(&self) -> (usize, DVec3) {
        (self.front, self.suns[self.front])
    }

    /// Counters since the start.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// What building has cost.
    pub fn build_cost(&self) -> BuildCost {
        self.builder.cost()
    }

    /// Slot of a block.
    pub fn slot(&self, block: BlockIndex) -> usize {
        let n = self.settings.blocks as i32;
        (block.z.rem_euclid(n) * n + block.x.rem_euclid(n)) as usize
    }

    /// North-west block of the committed window.
    pub fn origin(&self) -> BlockIndex {
        self.origin
    }

    /// The block in a slot.
    pub fn resident(&self, slot: usize) -> Option<&Resident> {
        self.slots.get(slot).and_then(Option::as_ref)
    }

    /// Whether light for a newer sun is on its way.
    pub fn is_relighting(&self) -> bool {
        self.relighting || self.next_sun.is_some()
    }

    /// Whether uploads are still owed after a jump.
    pub fn is_jumping(&self) -> bool {
        self.jumping
    }

    /// Follows the eye (plan x, z, metres) at a speed (m/s); says what to upload, in order.
    pub fn update(&mut self, eye: DVec2, speed_mps: f64) -> Vec<Upload> {
        let eye = if eye.is_finite() { eye.clamp(DVec2::splat(-1e8), DVec2::splat(1e8)) } else { self.eye };
        self.eye = eye;
        // Rounded up, so that a speed that trembles is one speed.
        let speed_mps = if speed_mps.is_finite() { (speed_mps.abs() / 20.0).ceil() * 20.0 } else { 0.0 };
        self.collect();
        if self.is_quiet(speed_mps) {
            self.counters.upload_bytes = 0;
            return Vec::new();
        }
        self.quiet_flips = self.flips();
        self.follow();
        if !self.started {
            self.build_all();
        }
        self.ask(speed_mps);
        if self.settings.wait {
            while self.is_owed() {
                match self.builder.wait() {
                    Some((number, built)) => self.take(number, built),
                    None => break,
                }
            }
        }
        let mut uploads = Vec::new();
        let mut left = match (self.started, self.jumping) {
            (false, _) => usize::MAX,
            (true, true) => JUMP_BUDGET_BYTES,
            (true, false) => self.settings.budget_bytes,
        };
        let changed_bytes = self.flip_change(&mut uploads);
        left = left.saturating_sub(changed_bytes);
        let before = left;
        self.switch_rings(speed_mps, &mut uploads, &mut left);
        self.fill(&mut uploads, &mut left);
        self.relight(&mut uploads, &mut left);
        self.begin_change();
        self.started = true;
        self.counters.upload_bytes = changed_bytes + before - left;
        self.counters.upload_bytes_total += self.counters.upload_bytes as u64;
        self.quiet = self.settled(speed_mps);
        uploads
    }

    /// Bytes of built things that wait for their upload.
    pub fn waiting_bytes(&self) -> usize {
        self.ready.values().map(|p| p.upload_bytes()).sum::<usize>()
            + self.meshes.values().map(indices_bytes).sum::<usize>()
            + self.lights.values().map(|l| l.1.len()).sum::<usize>()
    }

    fn n(&self) -> i32 {
        self.settings.blocks as i32
    }
}

#[cfg(test)]
mod tests;
