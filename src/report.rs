//! What the verbs report. The field names are a contract: add, don't rename.
//!
//! Units stand in the names. `None` and numbers that are not finite are printed as null: "not measured here" is never
//! a made-up number. Hashes are 16 hexadecimal digits, as JSON numbers lose the last bits of 64. Printing is
//! [`crate::output`]'s.

use serde::Serialize;
use std::collections::BTreeMap;

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
    /// Visibility drawn, after it was clamped to the range of the window.
    pub visibility_m: f64,
    /// The ground as drawn.
    pub terrain: Terrain,
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

/// The simulation.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Sim {
    /// Steps taken.
    pub steps: u64,
    /// Over the state after every step.
    pub hash: String,
}

/// `verify`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Verify {
    /// Vertices inside a neighbour's edge. Must be 0.
    pub t_junctions: u64,
    /// Shared vertices that are not equal to the bit. Must be 0.
    pub position_mismatches: u64,
    /// How much was looked at.
    pub edges_checked: EdgesChecked,
    /// Windows looked at, each around another eye.
    pub eyes: u64,
    /// Beyond the near radius.
    pub far: Far,
    /// What a switch of level shows.
    pub pop: Pop,
    /// Within the near radius.
    pub near: Near,
    /// The picture against the ground; null without an adapter.
    pub gpu: Option<Gpu>,
}

/// Edges looked at.
#[derive(Debug, Clone, Default, Serialize)]
pub struct EdgesChecked {
    /// Of templates beside templates.
    pub templates: u64,
    /// Of pairs of blocks.
    pub pairs: u64,
    /// Of windows on this world.
    pub window: u64,
}

/// The far surface against the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Far {
    /// Largest distance found.
    pub error_max_m: f64,
    /// Largest distance found in each ring.
    pub errors_max_m: Vec<f64>,
    /// Largest allowed in each ring.
    pub limits_m: Vec<f64>,
    /// Places beyond their ring's limit. Must be 0.
    pub violations: u64,
}

/// What a switch of level shows, over a track.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Pop {
    /// Largest move of a point, on axis.
    pub max_px: f64,
    /// Largest vertical move of a point, metres.
    pub max_move_m: f64,
    /// Largest mean change of grey over a block's surface at a switch, of 255; null without an adapter.
    pub max_grey: Option<f64>,
    /// The same with blocks that show in fewer; null without an adapter.
    pub max_grey_any: Option<f64>,
    /// Largest change of grey of one pixel, of 255; null without an adapter.
    pub worst_pixel_grey: Option<f64>,
    /// Switches whose grey was looked at; null without an adapter.
    pub grey_switches: Option<u64>,
    /// Switches looked at.
    pub switches: u64,
    /// Length of the track.
    pub track_km: f64,
}

/// Heights within the near radius while the eye moves.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Near {
    /// Heights that changed. Must be 0.
    pub height_changes: u64,
    /// Largest difference from the ground. Must be 0.
    pub max_difference_m: f64,
    /// Places where the drawn surface was compared with the ground.
    pub places: u64,
}

/// The picture against the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Gpu {
    /// Heights read back.
    pub vertices_checked: u64,
    /// Heights that are not the posts to the bit. Must be 0.
    pub height_mismatches: u64,
    /// Posts that two blocks place differently on the device. Must be 0.
    pub position_mismatches: u64,
    /// Pixels whose depth was compared.
    pub pixels_checked: u64,
    /// Pixels whose depth is outside its bounds. Must be 0.
    pub pixels_outside: u64,
    /// Pixels on silhouettes, left out.
    pub pixels_excluded: u64,
}

/// `bake` and `info`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct WorldReport {
    /// Its name.
    pub name: String,
    /// Blocks from west to east and from north to south.
    pub blocks: [u32; 2],
    /// Posts.
    pub posts: u64,
    /// Distance between posts.
    pub step_m: f64,
    /// Where it lies.
    pub extent: Extent,
    /// Posts without data in the sources.
    pub voids: Voids,
    /// Where it comes from, finest first.
    pub sources: Vec<Source>,
    /// Time that the bake took; null in `info`.
    pub wall_s: Option<f64>,
    /// Most memory the process held.
    pub peak_rss_mib: Option<f64>,
    /// What was made of the feature files, by kind.
    pub features: BTreeMap<String, FeatureCount>,
    /// Lakes set to one level.
    pub lakes: Vec<Lake>,
}

/// Where a world lies: its centre on the Earth, its edges in its own plane.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Extent {
    /// Latitude of the origin.
    pub centre_lat_deg: f64,
    /// Longitude of the origin.
    pub centre_lon_deg: f64,
    /// West edge.
    pub west_m: f64,
    /// East edge.
    pub east_m: f64,
    /// North edge; Z points south.
    pub north_m: f64,
    /// South edge.
    pub south_m: f64,
    /// Lowest post; null where all is void.
    pub lowest_m: Option<f64>,
    /// Highest post; null where all is void.
    pub highest_m: Option<f64>,
}

/// Posts without data in the sources: filled inside the data, left void beyond it.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Voids {
    /// Their number.
    pub posts: u64,
    /// Their share of the posts inside the data, 0..=1.
    pub share: f64,
    /// Posts of the largest connected one.
    pub largest_posts: u64,
    /// Posts beyond the data; they stay void and are not counted above.
    pub beyond_posts: u64,
}

/// A file that a world was made from.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Source {
    /// The file's name.
    pub name: String,
    /// Its format.
    pub format: String,
    /// Whom to thank, and the licence.
    pub credit: String,
    /// Distance between its samples, on the ground.
    pub step_m: f64,
    /// Its coordinate system.
    pub system: String,
    /// Factor that its numbers were multiplied by.
    pub height_scale: f64,
    /// Its samples without data.
    pub void_samples: u64,
    /// What must be known about its accuracy; empty if nothing.
    pub note: String,
}

/// Features of one kind.
#[derive(Debug, Clone, Default, Serialize)]
pub struct FeatureCount {
    /// In the files.
    pub read: u64,
    /// In the world.
    pub kept: u64,
    /// Left out.
    pub skipped: u64,
}

/// A lake of a world.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Lake {
    /// As its file calls it.
    pub name: String,
    /// Height of the water.
    pub level_m: f64,
    /// Where that comes from.
    pub level_from: String,
    /// Posts set to it.
    pub posts: u64,
}

/// `height`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Heights {
    /// In the order they were asked.
    pub points: Vec<HeightPoint>,
}

/// The ground at one point.
#[derive(Debug, Clone, Default, Serialize)]
pub struct HeightPoint {
    /// Latitude.
    pub lat_deg: f64,
    /// Longitude.
    pub lon_deg: f64,
    /// X in the world.
    pub x_m: f64,
    /// Z in the world.
    pub z_m: f64,
    /// Above mean sea level; null where there is no data.
    pub height_m: Option<f64>,
    /// Upward, unit length, world axes; null where there is no data.
    pub normal: Option<[f64; 3]>,
    /// `ground`, or `water` inside a lake's outline; null where there is no data.
    pub surface: Option<&'static str>,
}

/// `simulate`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Simulated {
    /// How it ended: `end`, `stop: ..` or `failed`.
    pub event: String,
    /// When, seconds.
    pub time_s: f64,
    /// Rows given.
    pub rows: u64,
    /// Steps taken, pieces counted.
    pub steps: u64,
    /// How short the steps had to be.
    pub stiffness: Stiffness,
    /// What trim found.
    pub trim: Option<TrimFound>,
    /// The last row, by column, in the order of the file.
    pub last: serde_json::Map<String, serde_json::Value>,
    /// The file of the rows.
    pub out: Option<String>,
}

/// The fastest mode of a body, and what a step makes of it.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Stiffness {
    /// Speed that it was taken at.
    pub speed_mps: f64,
    /// Its greatest eigenvalue, 1/s.
    pub lambda_radps: f64,
    /// The same times the step.
    pub lambda_h: f64,
    /// The integrator's limit for it.
    pub limit: f64,
    /// Most pieces that a step was cut into.
    pub pieces: u32,
}

/// What trim found.
#[derive(Debug, Clone, Default, Serialize)]
pub struct TrimFound {
    /// The names that were varied, with their values.
    pub values: BTreeMap<String, f64>,
    /// What is left of each acceleration.
    pub residuals: BTreeMap<String, f64>,
}

/// `sight`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Sight {
    /// Whether nothing is between.
    pub visible: bool,
    /// The first point of the ground that is in the way.
    pub hit: Option<Hit>,
    /// Least height of the line above the ground; negative where it is cut, null where there is no data under it.
    pub clearance_min_m: Option<f64>,
    /// Where along the line that is, from its beginning.
    pub clearance_min_at_m: Option<f64>,
    /// Length of the line.
    pub distance_m: f64,
    /// Share of the line that has ground under it, 0..=1; the rest is void or beyond the world, and hides nothing.
    pub ground_share: f64,
}

/// Where a line meets the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Hit {
    /// Latitude.
    pub lat_deg: f64,
    /// Longitude.
    pub lon_deg: f64,
    /// X in the world.
    pub x_m: f64,
    /// Z in the world.
    pub z_m: f64,
    /// Above mean sea level.
    pub height_m: f64,
    /// From the line's beginning.
    pub distance_m: f64,
}

/// `shot`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Shot {
    /// The picture.
    pub out: String,
    /// Its size, `WxH` in pixels.
    pub size: String,
    /// Over its pixels.
    pub image_hash: String,
    /// Visibility drawn, after it was clamped to the range of the window.
    pub visibility_m: f64,
    /// Triangles of the ground.
    pub triangles_drawn: u64,
    /// Triangles of the same blocks at level 0.
    pub triangles_all_level0: u64,
    /// Blocks wanted and absent.
    pub late_blocks: u64,
}

/// `bench`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Bench {
    /// What was measured.
    pub results: Vec<BenchResult>,
    /// What could not be.
    pub skipped: Vec<Skipped>,
}

/// A measurement beside its yardstick.
#[derive(Debug, Clone, Default, Serialize)]
pub struct BenchResult {
    /// What was measured.
    pub name: String,
    /// Unit of `ours` and of the yardstick's value.
    pub unit: String,
    /// Median over the rounds.
    pub ours: f64,
    /// What it is compared with; null where there is none.
    pub yardstick: Option<Yardstick>,
    /// How many times better than the yardstick.
    pub ratio: Option<f64>,
    /// 95 % confidence interval of the ratio, over the rounds.
    pub ratio_ci: Option<[f64; 2]>,
    /// Rounds, each with both.
    pub rounds: u32,
    /// First and third quartile of `ours` over the rounds.
    pub quartiles: Option<[f64; 2]>,
    /// What one must know to read the figure.
    pub note: Option<String>,
}

/// What is compared with.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Yardstick {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Median over the rounds.
    pub value: f64,
}

/// What was not measured, and why.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Skipped {
    /// The measurement.
    pub name: String,
    /// The reason.
    pub reason: String,
}

/// `trade`.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Trade {
    /// Every setting that trades accuracy for cost.
    pub knobs: Vec<Knob>,
    /// How it was measured.
    pub conditions: String,
}

/// One setting, measured.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Knob {
    /// Its name.
    pub name: String,
    /// Unit of the setting.
    pub unit: String,
    /// Unit of `error`, and what it is the error against.
    pub error_unit: String,
    /// Unit of `cost`.
    pub cost_unit: String,
    /// From coarsest to finest.
    pub points: Vec<KnobPoint>,
    /// The plot that it shares with other knobs, as one curve of several.
    pub group: Option<String>,
    /// The setting with the least error, where finer is not always better.
    pub best: Option<f64>,
}

/// One value of a setting.
#[derive(Debug, Clone, Default, Serialize)]
pub struct KnobPoint {
    /// The value.
    pub setting: f64,
    /// How wrong the picture or the ground is.
    pub error: f64,
    /// What it costs.
    pub cost: f64,
    /// Triangles of a frame, where the knob changes them.
    pub triangles: Option<u64>,
    /// Bytes held, where the knob changes them.
    pub bytes: Option<u64>,
    /// The largest error, in the unit of `error`.
    pub error_max: Option<f64>,
    /// Root mean square difference of the picture from the reference's, grey of 255.
    pub image_rms_grey: Option<f64>,
    /// Time to make the world anew, where the knob needs it.
    pub bake_s: Option<f64>,
    /// The value in words, where `setting` is only its place in a row of models.
    pub label: Option<String>,
    /// The part of `error` that is height.
    pub error_height: Option<f64>,
    /// The part of `error` that is not.
    pub error_horizontal: Option<f64>,
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

/// A 64-bit hash as it is reported.
pub fn hash(value: u64) -> String {
    format!("{value:016x}")
}

/// Most memory the process has held so far, MiB; `None` where the system does not tell (all but Linux).
pub fn peak_rss_mib() -> Option<f64> {
    peak_in(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn peak_in(status: &str) -> Option<f64> {
    let kib = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?.trim().strip_suffix("kB")?;
    kib.trim().parse::<f64>().ok().map(|kib| kib / 1024.0)
}

/// `trajectory`: the end of a shot.
#[derive(Debug, Clone, Default, Serialize)]
pub struct TrajectoryReport {
    /// Way over the ground along the azimuth.
    pub range_m: f64,
    /// Time of flight.
    pub time_s: f64,
    /// Speed over the Earth at the end.
    pub speed_mps: f64,
    /// Descent under the horizontal of the place.
    pub fall_deg: f64,
    /// To the right of the azimuth.
    pub aside_m: f64,
    /// Under the line of the bore.
    pub drop_m: f64,
    /// Mach number; 0 where there is no air.
    pub mach: f64,
    /// Where it ended.
    pub lat_deg: f64,
    /// Where it ended.
    pub lon_deg: f64,
    /// Where it ended.
    pub altitude_m: f64,
    /// The greatest altitude.
    pub apex_altitude_m: f64,
    /// What ended it.
    pub event: String,
    /// `vacuum`, `drag table` or `modified point mass` (an estimate of spin drift beside the point mass).
    pub tier: &'static str,
    /// Bore over the horizon, the sight's zero included.
    pub elevation_deg: f64,
    /// Clockwise from north.
    pub azimuth_deg: f64,
    /// Gyroscopic stability at the muzzle; null without spin.
    pub stability: Option<f64>,
    /// `rk4` and so on.
    pub integrator: &'static str,
    /// Length of a step.
    pub dt_s: f64,
    /// Steps taken.
    pub steps: u64,
    /// Rows of the trajectory.
    pub rows: usize,
    /// Where they were written.
    pub out: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    /// Every name of a report, nested ones with dots, in the order they are printed.
    fn names(report: &impl Serialize) -> String {
        fn walk(prefix: &str, value: &Value, all: &mut Vec<String>) {
            match value {
                Value::Object(fields) => {
                    fields.iter().for_each(|(key, value)| walk(&format!("{prefix}.{key}"), value, all))
                }
                Value::Array(entries) if entries.first().is_some_and(Value::is_object) => {
                    walk(&format!("{prefix}[]"), &entries[0], all);
                }
                _ => all.push(prefix.trim_start_matches('.').to_owned()),
            }
        }
        let mut all = Vec::new();
        walk("", &serde_json::to_value(report).unwrap(), &mut all);
        all.join(" ")
    }

    /// The contract of ARCHITECTURE.md, section 8, written out a second time: a rename fails here.
    #[test]
    fn the_names_are_those_of_the_contract() {
        assert_eq!(
            names(&Fly::default()),
            "world.name world.size_km world.step_m adapter.name adapter.backend adapter.kind size mode track.speed_mps \
             track.distance_km track.block_crossings frames frame_ms.n frame_ms.median frame_ms.p99 frame_ms.max \
             frame_ms.median_update frame_ms.median_quiet start_ms latency_ms visibility_m terrain.window \
             terrain.view_range_min_m terrain.limits_m terrain.near_blocks terrain.level1_blocks terrain.mixed_blocks \
             terrain.triangles_drawn terrain.triangles_all_level0 terrain.draw_calls terrain.update_cpu_ms.mean \
             terrain.update_cpu_ms.p99 terrain.update_cpu_ms.max terrain.build_cpu_ms.mean terrain.build_cpu_ms.max \
             terrain.upload_bytes.max_frame terrain.upload_bytes.total terrain.memory_bytes.posts \
             terrain.memory_bytes.pyramid terrain.memory_bytes.payload_cpu terrain.memory_bytes.payload_gpu \
             terrain.late_blocks terrain.holes sim.steps sim.hash mesh_hash image_hash shots peak_rss_mib"
        );
        let verify = Verify { gpu: Some(Gpu::default()), ..Verify::default() };
        assert_eq!(
            names(&verify),
            "t_junctions position_mismatches edges_checked.templates edges_checked.pairs edges_checked.window eyes \
             far.error_max_m far.errors_max_m far.limits_m far.violations pop.max_px pop.max_move_m pop.max_grey \
             pop.max_grey_any pop.worst_pixel_grey pop.grey_switches pop.switches pop.track_km near.height_changes \
             near.max_difference_m near.places gpu.vertices_checked gpu.height_mismatches gpu.position_mismatches \
             gpu.pixels_checked gpu.pixels_outside gpu.pixels_excluded"
        );
        let features = BTreeMap::from([("highways".to_owned(), FeatureCount::default())]);
        let (sources, lakes) = (vec![Source::default()], vec![Lake::default()]);
        let world = WorldReport { sources, features, lakes, ..WorldReport::default() };
        assert_eq!(
            names(&world),
            "name blocks posts step_m extent.centre_lat_deg extent.centre_lon_deg extent.west_m extent.east_m \
             extent.north_m extent.south_m extent.lowest_m extent.highest_m voids.posts voids.share voids.largest_posts \
             voids.beyond_posts sources[].name sources[].format sources[].credit sources[].step_m sources[].system \
             sources[].height_scale sources[].void_samples sources[].note wall_s peak_rss_mib \
             features.highways.read features.highways.kept features.highways.skipped lakes[].name lakes[].level_m \
             lakes[].level_from lakes[].posts"
        );
        let heights = Heights { points: vec![HeightPoint::default()] };
        assert_eq!(
            names(&heights),
            "points[].lat_deg points[].lon_deg points[].x_m points[].z_m points[].height_m points[].normal points[].surface"
        );
        assert_eq!(
            names(&TrajectoryReport::default()),
            "range_m time_s speed_mps fall_deg aside_m drop_m mach lat_deg lon_deg altitude_m apex_altitude_m event tier \
             elevation_deg azimuth_deg stability integrator dt_s steps rows out"
        );
        assert_eq!(names(&Sight::default()), "visible hit clearance_min_m clearance_min_at_m distance_m ground_share");
        let result = BenchResult { yardstick: Some(Yardstick::default()), ..BenchResult::default() };
        assert_eq!(
            names(&Bench { results: vec![result], skipped: vec![Skipped::default()] }),
            "results[].name results[].unit results[].ours results[].yardstick.name results[].yardstick.version \
             results[].yardstick.value results[].ratio results[].ratio_ci results[].rounds results[].quartiles results[].note skipped[].name skipped[].reason"
        );
        let knob = Knob { points: vec![KnobPoint::default()], ..Knob::default() };
        assert_eq!(
            names(&Trade { knobs: vec![knob], ..Trade::default() }),
            "knobs[].name knobs[].unit knobs[].error_unit knobs[].cost_unit knobs[].points[].setting \
             knobs[].points[].error knobs[].points[].cost knobs[].points[].triangles knobs[].points[].bytes \
             knobs[].points[].error_max knobs[].points[].image_rms_grey knobs[].points[].bake_s \
             knobs[].points[].label knobs[].points[].error_height knobs[].points[].error_horizontal \
             knobs[].group knobs[].best conditions"
        );
    }

    #[test]
    fn what_is_unknown_is_null() {
        let value = serde_json::to_value(Verify::default()).unwrap();
        assert_eq!((&value["gpu"], &value["pop"]["max_grey"]), (&json!(null), &json!(null)));
        let point = HeightPoint { lat_deg: f64::NAN, ..HeightPoint::default() };
        assert_eq!(serde_json::to_value(point).unwrap()["lat_deg"], json!(null));
    }

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

    #[test]
    fn the_peak_of_memory_is_read_where_the_system_tells() {
        assert_eq!(peak_in("Name:\tx\nVmPeak:\t 1 kB\nVmHWM:\t   20480 kB\n"), Some(20.0));
        for status in ["", "VmHWM:", "VmHWM:\tkB", "VmHWM:\t12 MB"] {
            assert_eq!(peak_in(status), None);
        }
        if cfg!(target_os = "linux") {
            assert!(peak_rss_mib().is_some_and(|mib| mib > 0.5));
        }
        assert_eq!(hash(0xab), "00000000000000ab");
    }
}
