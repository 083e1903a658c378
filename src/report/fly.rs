//! What `fly` reports: over what and by what it was drawn, the times of its frames, the terrain, the simulation.

use serde::Serialize;

/// `fly`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Fly {
    /// Over what.
    pub world: World,
    /// Drawn by what.
    pub adapter: Adapter,
    /// Picture size, `WxH` in pixels.
    pub size: String,
    /// `window`, `lockstep` or `paced`.
    pub mode: String,
    /// What was flown.
    pub track: Track,
    /// Frames drawn.
    pub frames: u64,
    /// Time of a frame, milliseconds.
    pub frame_ms: FrameMs,
    /// From the program's start to its first frame.
    pub start_ms: f64,
    /// From a control input to the picture that shows it.
    pub latency_ms: Option<f64>,
    /// Where the time goes from an input to the picture that shows it; none without an input.
    pub latency: Option<Latency>,
    /// Visibility drawn, after it was clamped to the range of the window.
    pub visibility_m: f64,
    /// The ground as drawn.
    pub terrain: Terrain,
    /// The plants as drawn.
    pub plants: Plants,
    /// Buildings and other standing things of the last frame.
    pub objects_drawn: u32,
    /// The simulation.
    pub sim: Sim,
    /// Over every mesh drawn, in order. The same in every `--lockstep` run.
    pub mesh_hash: Option<String>,
    /// Over the pictures. The same in every `--lockstep` run on one adapter.
    pub image_hash: Option<String>,
    /// Pictures written.
    pub shots: Vec<String>,
    /// Most memory the process held.
    pub peak_rss_mib: Option<f64>,
}

/// From inputs that moved controls at rest to pictures: a stick's by the system's own time of it, keys and the mouse from when they
/// are heard of.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Latency {
    /// Inputs measured.
    pub inputs: u64,
    /// Longest until the picture was presented; the median is `latency_ms`.
    pub shown_ms_max: Option<f64>,
    /// Until the eye of the first frame that shows it was sampled: the program's own making, at most a step and a frame.
    pub sampled_ms_median: f64,
    /// Longest of these.
    pub sampled_ms_max: f64,
    /// A step of the simulation.
    pub step_ms: f64,
}

/// The world of a report.
#[derive(Debug, Clone, Default, Serialize)]
pub struct World {
    /// Its name.
    pub name: String,
    /// West to east and north to south.
    pub size_km: [f64; 2],
    /// Distance between posts.
    pub step_m: f64,
}

/// The graphics adapter of a report.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Adapter {
    /// As the driver names it.
    pub name: String,
    /// `vulkan` and so on.
    pub backend: String,
    /// `hardware`, a graphics chip, or `software`, the processor.
    pub kind: String,
}

/// What was flown.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Track {
    /// Mean speed.
    pub speed_mps: f64,
    /// Length.
    pub distance_km: f64,
    /// Times the eye entered another block.
    pub block_crossings: u64,
}

/// Times of frames.
#[derive(Debug, Clone, Default, Serialize)]
pub struct FrameMs {
    /// Frames counted: all but those before the first picture.
    pub n: u64,
    /// Half were faster.
    pub median: Option<f64>,
    /// 99 of 100 were no slower (nearest rank).
    pub p99: Option<f64>,
    /// The slowest.
    pub max: Option<f64>,
    /// Median of those in which the window changed.
    pub median_update: Option<f64>,
    /// Median of the others.
    pub median_quiet: Option<f64>,
}

/// The ground as drawn.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Terrain {
    /// Blocks along a side of the far ring.
    pub window: u32,
    /// Guaranteed in every direction.
    pub view_range_min_m: f64,
    /// Largest error allowed in each ring of distance.
    pub limits_m: Vec<f64>,
    /// Blocks at level 0, in the last frame.
    pub near_blocks: u32,
    /// Blocks at level 1, in the last frame.
    pub level1_blocks: u32,
    /// Blocks with both, in the last frame.
    pub mixed_blocks: u32,
    /// Triangles in the last frame.
    pub triangles_drawn: u64,
    /// Triangles of the same blocks at level 0.
    pub triangles_all_level0: u64,
    /// Draw calls for the ground in the last frame.
    pub draw_calls: u32,
    /// The render thread's own time on a processor, for a frame's terrain.
    pub update_cpu_ms: UpdateCpuMs,
    /// A builder's wall time for a thing made: a block's payload, a mesh or its light.
    pub build_cpu_ms: BuildCpuMs,
    /// Sent to the adapter: block textures and index lists.
    pub upload_bytes: UploadBytes,
    /// Held for terrain.
    pub memory_bytes: MemoryBytes,
    /// Blocks wanted and absent when drawn.
    pub late_blocks: u64,
    /// Pixels with cleared depth whose ray meets the ground within `view_range_min_m`.
    pub holes: Option<u64>,
}

/// The render thread's own time for terrain.
#[derive(Debug, Clone, Default, Serialize)]
pub struct UpdateCpuMs {
    /// Over all frames.
    pub mean: f64,
    /// 99 of 100 frames took no longer.
    pub p99: f64,
    /// The longest.
    pub max: f64,
}

/// A builder's wall time for a thing made: on a busy machine it includes waiting for a processor.
#[derive(Debug, Clone, Default, Serialize)]
pub struct BuildCpuMs {
    /// Over all things made.
    pub mean: f64,
    /// The longest.
    pub max: f64,
}

/// Bytes sent to the adapter for blocks: textures and index lists, not the table of blocks, uniforms, sky or HUD.
#[derive(Debug, Clone, Default, Serialize)]
pub struct UploadBytes {
    /// Most in a frame, without the filling after a start or a jump.
    pub max_frame: u64,
    /// All.
    pub total: u64,
}

/// Bytes held for terrain.
#[derive(Debug, Clone, Default, Serialize)]
pub struct MemoryBytes {
    /// The world's posts, f32.
    pub posts: u64,
    /// The pyramid of least and greatest heights.
    pub pyramid: u64,
    /// In the processor's memory: masks of all rings, and built textures and index lists that wait for their upload.
    pub payload_cpu: u64,
    /// In the adapter's memory: the window's textures and index lists, the detail texture, the table of blocks and the
    /// ground's uniforms.
    pub payload_gpu: u64,
}

/// The plants as drawn, in the last frame.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Plants {
    /// Single plants in sight.
    pub drawn: u64,
    /// Stems that the closed forest in sight stands for.
    pub canopy_stands_for: u64,
    /// Longest that a tile's plants took to place, of the placing thread's own time.
    pub placed_ms_max: f64,
}

/// The simulation.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Sim {
    /// Steps taken.
    pub steps: u64,
    /// Over the state after every step.
    pub hash: String,
}

impl FrameMs {
    /// Summary of frames: the time of each in milliseconds, and whether the window changed in it.
    pub fn of(frames: &[(f64, bool)]) -> Self {
        let sorted = |kept: &dyn Fn(bool) -> bool| {
            let mut times: Vec<f64> = frames.iter().filter(|frame| kept(frame.1)).map(|frame| frame.0).collect();
            times.sort_by(f64::total_cmp);
            times
        };
        let all = sorted(&|_| true);
        Self {
            n: all.len() as u64,
            median: quantile(&all, 0.5),
            p99: quantile(&all, 0.99),
            max: all.last().copied(),
            median_update: quantile(&sorted(&|update| update), 0.5),
            median_quiet: quantile(&sorted(&|update| !update), 0.5),
        }
    }
}

/// The least value that at least the given share (0..=1) of the sorted values does not exceed: the nearest rank.
pub fn quantile(sorted: &[f64], share: f64) -> Option<f64> {
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_times_are_summed_up_by_nearest_rank() {
        let frames: Vec<(f64, bool)> = (1..=200).rev().map(|ms| (f64::from(ms), ms % 4 == 0)).collect();
        let summary = FrameMs::of(&frames);
        assert_eq!((summary.n, summary.median, summary.p99, summary.max), (200, Some(100.0), Some(198.0), Some(200.0)));
        // The 25th multiple of four, and the 75th number that is none: 24 fours, and three more.
        assert_eq!((summary.median_update, summary.median_quiet), (Some(100.0), Some(99.0)));
        let none = FrameMs::of(&[]);
        assert_eq!((none.n, none.median, none.p99, none.max), (0, None, None, None));
        assert_eq!(FrameMs::of(&[(3.0, true)]).p99, Some(3.0));
    }
}
