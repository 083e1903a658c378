//! What the verbs report, one file a verb. The field names are a contract: add, don't rename.
//!
//! Units stand in the names. `None` and numbers that are not finite are printed as null: "not measured here" is never
//! a made-up number. Hashes are 16 hexadecimal digits, as JSON numbers lose the last bits of 64. Printing is
//! [`crate::output`]'s.

mod bench;
mod fly;
mod gallery;
mod height;
mod input;
mod modes;
mod shot;
mod sight;
mod simulate;
mod trade;
mod trajectory;
mod verify;
mod world;

pub use bench::{Bench, BenchResult, Skipped, Yardstick};
pub use fly::{
    Adapter, BuildCpuMs, Fly, FrameMs, Latency, MemoryBytes, Plants, Sim, Terrain, Track, UpdateCpuMs, UploadBytes,
    World, quantile,
};
pub use gallery::Gallery;
pub use height::{HeightPoint, Heights};
pub use input::{AxisSeen, ButtonSeen, Device, Input};
pub use modes::{FigureFound, LimitFound, ModeFound, ModesReport};
pub use shot::Shot;
pub use sight::{Hit, Sight};
pub use simulate::{Simulated, Stiffness, TrimFound};
pub use trade::{Knob, KnobPoint, Trade};
pub use trajectory::TrajectoryReport;
pub use verify::{EdgesChecked, Far, Gpu, Near, Verify};
pub use world::{Cover, Extent, FeatureCount, Imagery, Lake, Source, Voids, WorldReport};

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

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Serialize;
    use serde_json::{Value, json};
    use std::collections::BTreeMap;

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

    fn one(name: &str) -> BTreeMap<String, f64> {
        BTreeMap::from([(name.to_owned(), 0.0)])
    }

    /// The contract of ARCHITECTURE.md, section 8, written out a second time: a rename fails here.
    #[test]
    fn the_names_are_those_of_the_contract() {
        assert_eq!(
            names(&Fly::default()),
            "world.name world.size_km world.step_m adapter.name adapter.backend adapter.kind size mode track.speed_mps \
             track.distance_km track.block_crossings frames frame_ms.n frame_ms.median frame_ms.p99 frame_ms.max \
             frame_ms.median_update frame_ms.median_quiet start_ms latency_ms latency visibility_m terrain.window \
             terrain.view_range_min_m terrain.limits_m terrain.near_blocks terrain.level1_blocks terrain.mixed_blocks \
             terrain.triangles_drawn terrain.triangles_all_level0 terrain.draw_calls terrain.update_cpu_ms.mean \
             terrain.update_cpu_ms.p99 terrain.update_cpu_ms.max terrain.build_cpu_ms.mean terrain.build_cpu_ms.max \
             terrain.upload_bytes.max_frame terrain.upload_bytes.total terrain.memory_bytes.posts \
             terrain.memory_bytes.pyramid terrain.memory_bytes.payload_cpu terrain.memory_bytes.payload_gpu \
             terrain.late_blocks terrain.holes plants.drawn plants.canopy_stands_for plants.placed_ms_max \
             objects_drawn sim.steps sim.hash mesh_hash image_hash shots peak_rss_mib"
        );
        let verify =
            Verify { overlay: Some(verify::Draped::default()), gpu: Some(Gpu::default()), ..Verify::default() };
        assert_eq!(
            names(&verify),
            "t_junctions position_mismatches edges_checked.templates edges_checked.pairs edges_checked.window eyes \
             far.error_max_m far.errors_max_m far.limits_m far.violations pop.max_px pop.max_move_m pop.max_grey \
             pop.max_grey_any pop.worst_pixel_grey pop.grey_switches pop.switches pop.track_km near.height_changes \
             near.max_difference_m near.places overlay.blocks overlay.vertices overlay.triangles overlay.t_junctions \
             overlay.border_mismatches overlay.crossings overlay.max_height_error_m gpu.vertices_checked gpu.height_mismatches gpu.position_mismatches \
             gpu.pixels_checked gpu.pixels_outside gpu.pixels_excluded"
        );
        let one_of = |what: &str| BTreeMap::from([(what.to_owned(), 1)]);
        let count = FeatureCount { skipped_for: one_of("outside"), notes: one_of("turned"), ..FeatureCount::default() };
        let features = BTreeMap::from([("highways".to_owned(), count)]);
        let (sources, lakes) = (vec![Source::default()], vec![Lake::default()]);
        let cover = Some(Cover { shares: one("Grass"), ..Cover::default() });
        let world = WorldReport { sources, features, lakes, cover, ..WorldReport::default() };
        assert_eq!(
            names(&world),
            "name blocks posts step_m extent.centre_lat_deg extent.centre_lon_deg extent.west_m extent.east_m \
             extent.north_m extent.south_m extent.lowest_m extent.highest_m voids.posts voids.share voids.largest_posts \
             voids.beyond_posts sources[].name sources[].format sources[].credit sources[].step_m sources[].system \
             sources[].height_scale sources[].void_samples sources[].note wall_s peak_rss_mib \
             features.highways.read features.highways.kept features.highways.skipped features.highways.skipped_for.outside \
             features.highways.notes.turned lakes[].name lakes[].level_m lakes[].level_from lakes[].posts cover.cell_m \
             cover.shares.Grass cover.from_features imagery"
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
        let trim = Some(TrimFound { values: one("alpha_deg"), residuals: one("udot_mps2") });
        assert_eq!(
            names(&Simulated { trim, ..Simulated::default() }),
            "event time_s rows steps stiffness.speed_mps stiffness.lambda_radps stiffness.lambda_h stiffness.limit \
             stiffness.pieces trim.values.alpha_deg trim.residuals.udot_mps2 out"
        );
        assert_eq!(
            names(&Shot::default()),
            "out size image_hash visibility_m triangles_drawn triangles_all_level0 objects_drawn late_blocks"
        );
        let gallery = Gallery { pictures: vec![Shot::default()], ..Gallery::default() };
        assert_eq!(
            names(&gallery),
            "pictures[].out pictures[].size pictures[].image_hash pictures[].visibility_m pictures[].triangles_drawn \
             pictures[].triangles_all_level0 pictures[].objects_drawn pictures[].late_blocks contact_sheet"
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
