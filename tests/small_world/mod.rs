//! A small made-up world in a folder, so that a test flies without baking.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::features::cover::Cover;
use terrain::features::lakes::Lakes;
use terrain::store::{Extent, FORMAT_VERSION, Statistics, Voids, World, WorldInfo};
use terrain::{Geodetic, Grid, Projection, synthetic};

/// Writes the world into a folder of the test's own and says where.
pub fn write(test: &str) -> PathBuf {
    let (lat_deg, lon_deg) = (42.0, 77.0);
    let grid = Grid::centred(200.0, 14, 14).expect("a grid");
    let field = synthetic::ridges(grid, 7);
    let heights_m = field.heights_m();
    let sound = || heights_m.iter().map(|h| f64::from(*h));
    let statistics = Statistics {
        posts: grid.posts(),
        min_m: sound().fold(f64::MAX, f64::min),
        max_m: sound().fold(f64::MIN, f64::max),
        mean_m: sound().sum::<f64>() / grid.posts() as f64,
    };
    let mut world = World {
        features: Default::default(),
        imagery: None,
        cover: Arc::new(Cover::unknown(&grid)),
        name: "Ridges".into(),
        projection: Projection::new(Geodetic::from_degrees(lat_deg, lon_deg)).expect("a projection"),
        info: WorldInfo {
            format_version: FORMAT_VERSION,
            name: "Ridges".into(),
            projection: "transverse Mercator".into(),
            centre_lat_deg: lat_deg,
            centre_lon_deg: lon_deg,
            step_m: grid.step_m,
            blocks_x: grid.blocks_x,
            blocks_z: grid.blocks_z,
            kernel: "none".into(),
            extent: Extent {
                west_m: grid.west_m,
                north_m: grid.north_m,
                east_m: grid.east_m(),
                south_m: grid.south_m(),
            },
            statistics,
            voids: Voids { posts: 0, share: 0.0, largest_posts: 0, beyond_posts: 0 },
            sources: Vec::new(),
            cover: None,
            imagery: Vec::new(),
            lakes: Vec::new(),
            features: std::collections::BTreeMap::new(),
            files: Vec::new(),
        },
        field: Arc::new(field),
        lakes: Lakes::new(Vec::new()),
        masks: Vec::new(),
    };
    world.make_ring_masks();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{test}.world"));
    let _ = std::fs::remove_dir_all(&path);
    world.write(&path).expect("the world is written");
    path
}
