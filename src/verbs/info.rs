//! `poligon info`: what a world is.
//!
//! The world is read whole, so its version, sizes and sums are checked: a world that `info` describes can be flown.

use crate::args::InfoArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::Output;
use crate::report::{self, WorldReport};
use std::collections::BTreeMap;
use terrain::store::WorldInfo;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &InfoArgs, output: Output) -> Result<(), Failure> {
    let world = open_world::open(args.world.as_deref())?;
    output.print(&describe(&world.info))
}

/// The report of a world that took no time to make.
pub fn describe(info: &WorldInfo) -> WorldReport {
    let known = |height_m: f64| height_m.is_finite().then_some(height_m);
    WorldReport {
        name: info.name.clone(),
        blocks: [info.blocks_x, info.blocks_z],
        posts: info.statistics.posts as u64,
        step_m: info.step_m,
        extent: report::Extent {
            centre_lat_deg: info.centre_lat_deg,
            centre_lon_deg: info.centre_lon_deg,
            west_m: info.extent.west_m,
            east_m: info.extent.east_m,
            north_m: info.extent.north_m,
            south_m: info.extent.south_m,
            lowest_m: known(info.statistics.min_m),
            highest_m: known(info.statistics.max_m),
        },
        voids: report::Voids {
            posts: info.voids.posts as u64,
            share: info.voids.share,
            largest_posts: info.voids.largest_posts as u64,
            beyond_posts: info.voids.beyond_posts as u64,
        },
        sources: info
            .sources
            .iter()
            .map(|source| report::Source {
                name: source.file.clone(),
                format: source.format.clone(),
                credit: source.credit.clone(),
                // The side of a square of a pixel's area.
                step_m: (source.pixel_m[0] * source.pixel_m[1]).sqrt(),
                system: source.system.clone(),
                height_scale: source.height_scale,
                void_samples: source.void_samples as u64,
                note: source.note.clone(),
            })
            .collect(),
        wall_s: None,
        peak_rss_mib: report::peak_rss_mib(),
        features: info
            .features
            .iter()
            .map(|(kind, count)| {
                let [read, kept, skipped] = [count.read, count.kept, count.skipped].map(|n| n as u64);
                let by = |numbers: &BTreeMap<String, usize>| {
                    numbers.iter().map(|(what, number)| (what.clone(), *number as u64)).collect()
                };
                let (skipped_for, notes) = (by(&count.skipped_for), by(&count.notes));
                (kind.clone(), report::FeatureCount { read, kept, skipped, skipped_for, notes })
            })
            .collect(),
        cover: info.cover.as_ref().map(|cover| report::Cover {
            cell_m: cover.cell_m,
            shares: cover.shares.clone(),
            from_features: cover.from_features,
        }),
        imagery: info
            .imagery
            .iter()
            .map(|photo| report::Imagery {
                name: photo.file.clone(),
                format: photo.format.clone(),
                credit: photo.credit.clone(),
                system: photo.system.clone(),
                size_px: [photo.columns as u64, photo.rows as u64],
                pixel_m: photo.pixel_m,
            })
            .collect(),
        lakes: info
            .lakes
            .iter()
            .map(|lake| report::Lake {
                name: lake.name.clone(),
                level_m: lake.level_m,
                level_from: lake.level_from.clone(),
                posts: lake.posts as u64,
            })
            .collect(),
    }
}
