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
//!
//! Invariant others rely on: with the eye inside the window's middle two blocks, every block within `n/2 - 1` blocks is
//! there; what is drawn depends on the eye's path only, not on time, when [`Settings::wait`] is set.

use super::builder::{BuildCost, Builder, Built, Job};
use super::payload::{Landscape, Mesh, Payload};
use super::rings::Rings;
use crate::grid::BlockIndex;
use crate::pyramid::Range;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
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

/// Blocks along the squares that are culled as one.
const GROUP: usize = 4;

/// A turn of the sun that asks for new light: 0.5 degrees.
const RELIGHT_COS: f64 = 0.999_961_923;

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

#[derive(Debug, Clone, Copy, PartialEq)]
struct Shift {
    dx: i32,
    dz: i32,
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
}

/// See the module.
pub struct Window {
    landscape: Arc<Landscape>,
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
    /// Light flips up to the start of this update.
    quiet_flips: u64,
    /// The newest sun, to be lit for when the relight under way is done.
    next_sun: Option<DVec3>,
    counters: Counters,
}

/// Nothing is owed and nothing will be wanted while the eye stays within a circle: most frames are no work at all.
#[derive(Debug, Clone, Copy)]
struct Quiet {
    from: DVec2,
    reach_m: f64,
    speed_mps: f64,
    /// The sides on which the window is built ahead.
    ahead: [bool; 2],
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Asked {
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
    /// A window with nothing in it yet; the first update fills it around the eye.
    pub fn new(landscape: Arc<Landscape>, mut settings: Settings, to_sun: DVec3) -> Self {
        settings.blocks = settings.blocks.clamp(4, MAX_BLOCKS) & !1;
        let builder = Builder::new(landscape.clone(), settings.threads);
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

    /// Towards the sun, unit, world frame. Light follows when it has turned by half a degree.
    pub fn set_sun(&mut self, to_sun: DVec3) {
        if !to_sun.is_finite() || !self.started {
            if to_sun.is_finite() {
                self.suns = [to_sun; 2];
            }
            return;
        }
        if self.relighting {
            // A relight under way is finished first, or a fast clock would never see one.
            self.next_sun = Some(to_sun);
        } else if to_sun.dot(self.suns[self.front]) < RELIGHT_COS {
            let back = 1 - self.front;
            self.suns[back] = to_sun;
            self.relighting = true;
            self.quiet = None;
            self.slots.iter_mut().flatten().for_each(|resident| resident.lit[back] = false);
        }
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
        self.quiet_flips = self.counters.relights;
        self.follow();
        if !self.started {
            self.build_all();
        }
        self.ask(speed_mps);
        if self.settings.wait {
            while !self.asked.is_empty() {
                match self.builder.wait() {
                    Some(built) => self.take(built),
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
        let before = left;
        self.switch_rings(speed_mps, &mut uploads, &mut left);
        self.fill(&mut uploads, &mut left);
        self.relight(&mut uploads, &mut left);
        self.started = true;
        self.counters.upload_bytes = before - left;
        self.counters.upload_bytes_total += self.counters.upload_bytes as u64;
        self.quiet = self.settled(speed_mps);
        uploads
    }

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

    /// Bytes of built things that wait for their upload.
    pub fn waiting_bytes(&self) -> usize {
        self.ready.values().map(|p| p.upload_bytes()).sum::<usize>()
            + self.meshes.values().map(indices_bytes).sum::<usize>()
            + self.lights.values().map(|l| l.1.len()).sum::<usize>()
    }

    fn n(&self) -> i32 {
        self.settings.blocks as i32
    }

    /// Whether a block belongs to the committed window and is not on its way out.
    fn is_shown(&self, block: BlockIndex) -> bool {
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
    fn target(&self) -> BlockIndex {
        let shift = self.shift.unwrap_or(Shift { dx: 0, dz: 0 });
        BlockIndex { x: self.origin.x + shift.dx, z: self.origin.z + shift.dz }
    }

    fn in_target(&self, block: BlockIndex) -> bool {
        let target = self.target();
        (0..self.n()).contains(&(block.x - target.x)) && (0..self.n()).contains(&(block.z - target.z))
    }

    /// Offset of the eye from the window's middle, blocks.
    fn offset(&self) -> DVec2 {
        let grid = self.landscape.ground.field().grid();
        let eye = (self.eye - DVec2::new(grid.west_m, grid.north_m)) / grid.block_m();
        eye - DVec2::new(f64::from(self.origin.x), f64::from(self.origin.z)) - DVec2::splat(f64::from(self.n()) / 2.0)
    }

    /// Starts a shift, or all over after a jump.
    fn follow(&mut self) {
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
    fn forget_outside(&mut self, origin: BlockIndex) {
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
    fn build_all(&mut self) {
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

    /// Asks for all that is wanted and neither there, ready nor asked for; forgets what is no longer near.
    fn ask(&mut self, speed_mps: f64) {
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
        let gone = self.builder.withdraw(|job| !near(job.block()));
        gone.iter().for_each(|job| {
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
        self.builder.request(jobs);
    }

    fn collect(&mut self) {
        while let Some(built) = self.builder.try_take() {
            self.take(built);
            self.quiet = None;
        }
    }

    /// Whether the last look at every block still holds.
    fn is_quiet(&self, speed_mps: f64) -> bool {
        self.quiet.is_some_and(|quiet| {
            let offset = self.offset();
            self.eye.distance(quiet.from) < quiet.reach_m
                && speed_mps == quiet.speed_mps
                && [offset.x > 0.0, offset.y > 0.0] == quiet.ahead
                && offset.abs().max_element() <= 0.5
        })
    }

    /// How far the eye may go before any block wants another ring; `None` while anything is owed.
    fn settled(&self, speed_mps: f64) -> Option<Quiet> {
        // A flip of the light in this very update has emptied what was built ahead.
        let flipped = self.quiet_flips != self.counters.relights;
        if flipped || !self.asked.is_empty() || self.shift.is_some() || self.jumping || self.relighting {
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

    fn take(&mut self, built: Built) {
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

    /// Puts ring switches into effect whose mesh is there.
    fn switch_rings(&mut self, speed_mps: f64, uploads: &mut Vec<Upload>, left: &mut usize) {
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

    /// Uploads the blocks of the target window that are ready, nearest first; commits the shift when all are there.
    fn fill(&mut self, uploads: &mut Vec<Upload>, left: &mut usize) {
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
            uploads.push(Upload::Block { slot, layer: self.front, payload });
            let Some(level) = place(&mesh, slot, uploads, left) else { continue };
            let list_hash = mesh.hash();
            self.ranges[slot] = range;
            self.slots[slot] =
                Some(Resident { block, ring, level, range, has_water, ground_triangles, list_hash, lit });
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
    fn wanted_blocks(&self) -> impl Iterator<Item = BlockIndex> + use<> {
        let (target, n) = (self.target(), self.n());
        let grid = self.landscape.ground.field().grid();
        let (wide, high) = (grid.blocks_x as i32, grid.blocks_z as i32);
        (target.z.max(0)..(target.z + n).min(high))
            .flat_map(move |z| (target.x.max(0)..(target.x + n).min(wide)).map(move |x| BlockIndex { x, z }))
    }

    /// Uploads light for the new sun; flips when every block has it.
    fn relight(&mut self, uploads: &mut Vec<Upload>, left: &mut usize) {
        if !self.relighting {
            return;
        }
        let back = 1 - self.front;
        let mut done = true;
        for slot in 0..self.slots.len() {
            let Some(resident) = &self.slots[slot] else { continue };
            if resident.lit[back] {
                continue;
            }
            let block = resident.block;
            match self.lights.remove(&block) {
                Some((_, light)) if light.len() <= *left => {
                    *left -= light.len();
                    uploads.push(Upload::Light { slot, layer: back, light });
                    if let Some(resident) = &mut self.slots[slot] {
                        resident.lit[back] = true;
                    }
                }
                kept => {
                    done = false;
                    if let Some(light) = kept {
                        self.lights.insert(block, light);
                    }
                }
            }
        }
        if done && !self.jumping && self.shift.is_none() {
            self.front = back;
            self.relighting = false;
            self.counters.relights += 1;
            self.lights.clear();
            self.ready.clear();
            self.slots.iter_mut().flatten().for_each(|resident| resident.lit[1 - back] = false);
            if let Some(to_sun) = self.next_sun.take() {
                self.set_sun(to_sun);
            }
        }
    }
}

/// How far before a ring's radius a block turns finer, and how far behind it coarser again, metres.
fn margins(speed_mps: f64) -> (f64, f64) {
    // A builder answers within a frame or two, and meshes go before all else; a fifth of a second of flight is ample.
    let margin_m = 60.0 + 0.2 * speed_mps.abs().min(20_000.0);
    (margin_m, margin_m + 60.0)
}

/// The ring a block should be drawn for: finer a margin early, coarser a little behind that.
fn wanted_ring(rings: &Rings, ring: usize, distance_m: f64, speed_mps: f64) -> usize {
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

fn indices_bytes(mesh: &Mesh) -> usize {
    match mesh {
        Mesh::Own(list) => size_of_val(list.as_slice()),
        Mesh::Level0 | Mesh::Level1 => 0,
    }
}

/// Makes a mesh the slot's, uploading its own list if it has one; `None` if that is over budget.
fn place(mesh: &Mesh, slot: usize, uploads: &mut Vec<Upload>, left: &mut usize) -> Option<Level> {
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

#[cfg(test)]
mod tests;
