//! What a flight was: each frame written down, and the report made of it.
//!
//! A jump of the aircraft (reset, slew, seek) is no distance flown and crosses no block.

use crate::report::{
    self, Adapter, BuildCpuMs, Fly, FrameMs, MemoryBytes, Sim, Terrain, Track, UpdateCpuMs, UploadBytes, quantile,
};
use crate::scenery::{Heavens, Scenery};
use crate::stage::{self, effects::Effects};
use glam::DVec3;
use sim::Snapshot;
use sim::clock::DEFAULT_STEP_HZ;
use std::time::{Duration, Instant};
use terrain::BlockIndex;
use terrain::thread_time;
use visual::camera::View;

/// Start and prime of the 64-bit FNV-1a hash (G. Fowler, L. Noll, P. Vo, 1991).
const FNV: (u64, u64) = (0xcbf2_9ce4_8422_2325, 0x0100_0000_01b3);

/// How long a picture may fill after a start or a jump before what is missing counts as late.
const FILL: Duration = Duration::from_secs(5);

/// A running hash over words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RunningHash(u64);

impl Default for RunningHash {
    fn default() -> Self {
        Self(FNV.0)
    }
}

impl RunningHash {
    /// Takes in a word.
    pub fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(FNV.1);
        }
    }

    /// As it is reported.
    pub fn shown(self) -> String {
        report::hash(self.0)
    }
}

/// What is written down of a flight.
#[derive(Debug)]
pub struct Record {
    started: Instant,
    start_ms: f64,
    frames: u64,
    frame_ms: Vec<(f64, bool)>,
    update_cpu_ms: Vec<f64>,
    late_blocks: u64,
    filling: Option<Instant>,
    holes: Option<u64>,
    upload_max: usize,
    window_full: bool,
    last: Option<(DVec3, BlockIndex, u32)>,
    distance_m: f64,
    block_crossings: u64,
    latency_ms: Vec<f64>,
    sampled_ms: Vec<f64>,
    mesh: RunningHash,
    is_repeatable: bool,
    updated: bool,
    effects: Effects,
}

/// What the record cannot know by itself.
#[derive(Debug, Clone, Default)]
pub struct Ending {
    /// `window`, `lockstep` or `paced`.
    pub mode: &'static str,
    /// Time flown: simulated in lockstep, else wall time, seconds.
    pub flown_s: f64,
    /// The simulation's steps.
    pub steps: u64,
    /// Its hash.
    pub sim_hash: String,
}

impl Record {
    /// Nothing yet; `started` is the program's start. Only where frames do not depend on the clock are meshes hashed.
    pub fn new(started: Instant, is_repeatable: bool) -> Self {
        Self {
            started,
            start_ms: 0.0,
            frames: 0,
            frame_ms: Vec::new(),
            update_cpu_ms: Vec::new(),
            late_blocks: 0,
            filling: None,
            holes: None,
            upload_max: 0,
            window_full: false,
            last: None,
            distance_m: 0.0,
            block_crossings: 0,
            latency_ms: Vec::new(),
            sampled_ms: Vec::new(),
            mesh: RunningHash::default(),
            is_repeatable,
            updated: false,
            effects: Effects::default(),
        }
    }

    /// Lets the scenery follow and writes down what that cost this thread.
    pub fn follow(&mut self, scenery: &mut Scenery, view: &View, snapshot: &Snapshot, heavens: Heavens) {
        scenery.things.set_particles(self.effects.of(snapshot, &scenery.scene_ground()));
        let before = thread_time::spent();
        scenery.follow(view, stage::ground_speed_mps(snapshot), heavens);
        let spent = thread_time::spent().saturating_sub(before);
        if self.frames > 0 {
            self.update_cpu_ms.push(milliseconds(spent));
        }
    }

    /// Writes down a frame that is complete. `took` is its time, where frames are timed.
    pub fn frame(&mut self, scenery: &Scenery, view: &View, snapshot: &Snapshot, took: Option<Duration>) {
        let window = scenery.terrain.window();
        let uploaded = window.counters().upload_bytes;
        if self.frames == 0 {
            self.start_ms = milliseconds(self.started.elapsed());
        } else {
            if let Some(took) = took {
                self.frame_ms.push((milliseconds(took), uploaded > 0));
            }
            if self.window_full && !window.is_jumping() {
                self.upload_max = self.upload_max.max(uploaded);
            }
        }
        self.updated = uploaded > 0;
        self.window_full = !window.is_jumping();
        self.add_late(scenery.late(), snapshot.jumps);
        if self.is_repeatable {
            self.mesh.add(window.mesh_hash());
        }
        let eye_m = view.eye_m;
        let block = scenery.area.grid().block_at(eye_m.x, eye_m.z);
        if let Some((from_m, from, jumps)) = self.last
            && jumps == snapshot.jumps
        {
            self.distance_m += (eye_m - from_m).length();
            self.block_crossings += u64::from(block != from);
        }
        self.last = Some((eye_m, block, snapshot.jumps));
        self.frames += 1;
    }

    /// Adds what was late. After a start and after a jump the picture fills, which is not lateness, for [`FILL`] at most.
    fn add_late(&mut self, late: u64, jumps: u32) {
        if self.last.is_none_or(|(.., before)| before != jumps) {
            self.filling = Some(Instant::now());
        }
        if late == 0 || self.filling.is_some_and(|since| since.elapsed() > FILL) {
            self.filling = None;
        }
        if self.filling.is_none() {
            self.late_blocks += late;
        }
    }

    /// Adds the time of the last frame written down, where it is known only when the next begins.
    pub fn add_interval(&mut self, took: Duration) {
        if self.frames > 1 {
            self.frame_ms.push((milliseconds(took), self.updated));
        }
    }

    /// Adds holes found in a frame that was searched.
    pub fn add_holes(&mut self, found: u64) {
        self.holes = Some(self.holes.unwrap_or(0) + found);
    }

    /// Adds the time from an input to the picture that shows it.
    pub fn add_latency(&mut self, took: Duration) {
        self.latency_ms.push(milliseconds(took));
    }

    /// Adds the time from an input to the sampling of the first frame that shows it.
    pub fn add_sampled(&mut self, took: Duration) {
        self.sampled_ms.push(milliseconds(took));
    }

    /// Frames so far.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// The report, but for pictures and their hash.
    pub fn report(&self, scenery: &Scenery, ending: &Ending) -> Fly {
        let (world, window) = (&scenery.world, scenery.terrain.window());
        let grid = *world.field.grid();
        let counts = scenery.terrain.counts();
        let (plants, canopy) = scenery.things.plants_drawn();
        let landscape = window.landscape();
        let build = window.build_cost();
        let sorted = |of: &[f64]| {
            let mut of = of.to_vec();
            of.sort_by(f64::total_cmp);
            of
        };
        let (latency_ms, sampled_ms) = (sorted(&self.latency_ms), sorted(&self.sampled_ms));
        let mut update_ms = self.update_cpu_ms.clone();
        update_ms.sort_by(f64::total_cmp);
        let [width_px, height_px] = scenery.look.size_px;
        Fly {
            world: report::World {
                name: world.name.clone(),
                size_km: [(grid.east_m() - grid.west_m) / 1e3, (grid.south_m() - grid.north_m) / 1e3],
                step_m: grid.step_m,
            },
            adapter: Adapter {
                name: scenery.gpu.report.name.clone(),
                backend: scenery.gpu.report.backend.clone(),
                kind: scenery.gpu.report.kind.to_string(),
            },
            size: format!("{width_px}x{height_px}"),
            mode: ending.mode.to_owned(),
            track: Track {
                speed_mps: if ending.flown_s > 0.0 { self.distance_m / ending.flown_s } else { 0.0 },
                distance_km: self.distance_m / 1e3,
                block_crossings: self.block_crossings,
            },
            frames: self.frames,
            frame_ms: FrameMs::of(&self.frame_ms),
            start_ms: self.start_ms,
            latency_ms: quantile(&latency_ms, 0.5),
            latency: quantile(&sampled_ms, 0.5).map(|median| report::Latency {
                inputs: sampled_ms.len() as u64,
                shown_ms_max: latency_ms.last().copied(),
                sampled_ms_median: median,
                sampled_ms_max: sampled_ms.last().copied().unwrap_or(median),
                step_ms: 1e3 / f64::from(DEFAULT_STEP_HZ),
            }),
            visibility_m: scenery.visibility_m(),
            terrain: Terrain {
                window: window.settings().blocks,
                view_range_min_m: window.view_range_min_m(),
                limits_m: window.settings().rings.limits_m.to_vec(),
                near_blocks: counts.near_blocks,
                level1_blocks: counts.level1_blocks,
                mixed_blocks: counts.mixed_blocks,
                triangles_drawn: counts.triangles,
                triangles_all_level0: counts.triangles_all_level0,
                draw_calls: scenery.terrain.draws(0).len() as u32,
                update_cpu_ms: UpdateCpuMs {
                    mean: update_ms.iter().sum::<f64>() / update_ms.len().max(1) as f64,
                    p99: quantile(&update_ms, 0.99).unwrap_or(0.0),
                    max: update_ms.last().copied().unwrap_or(0.0),
                },
                build_cpu_ms: BuildCpuMs { mean: build.mean_ms, max: build.max_ms },
                upload_bytes: UploadBytes {
                    max_frame: self.upload_max as u64,
                    total: window.counters().upload_bytes_total,
                },
                memory_bytes: MemoryBytes {
                    posts: world.field.bytes() as u64,
                    pyramid: landscape.ground.pyramid().bytes() as u64,
                    payload_cpu: (landscape.masks.bytes() + window.waiting_bytes()) as u64,
                    payload_gpu: scenery.terrain.gpu_bytes() as u64,
                },
                late_blocks: self.late_blocks,
                holes: self.holes,
            },
            plants: report::Plants {
                drawn: plants.drawn as u64,
                canopy_stands_for: canopy.stands_for.round() as u64,
                placed_ms_max: scenery.things.plants_placed_ms_max(),
            },
            objects_drawn: scenery.things.object_counts().all(),
            sim: Sim { steps: ending.steps, hash: ending.sim_hash.clone() },
            mesh_hash: self.is_repeatable.then(|| self.mesh.shown()),
            image_hash: None,
            shots: Vec::new(),
            peak_rss_mib: report::peak_rss_mib(),
        }
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}
