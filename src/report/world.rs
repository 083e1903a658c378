//! What `bake` and `info` report of a world: where it lies, what it was made of, what was void.

use serde::Serialize;
use std::collections::BTreeMap;

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
    /// What covers the ground; null where nothing is known.
    pub cover: Option<Cover>,
    /// Photographs of the ground.
    pub imagery: Vec<Imagery>,
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

/// A photograph that a world was made with.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Imagery {
    /// The file's name.
    pub name: String,
    /// Its format.
    pub format: String,
    /// Whom to thank, and the licence.
    pub credit: String,
    /// Its coordinate system.
    pub system: String,
    /// Pixels along a row, and rows.
    pub size_px: [u64; 2],
    /// Size of a pixel on the ground, along rows and columns.
    pub pixel_m: [f64; 2],
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
    /// The same by reason.
    pub skipped_for: BTreeMap<String, u64>,
    /// What was done with how many of those kept, where that is worth knowing.
    pub notes: BTreeMap<String, u64>,
}

/// What covers the ground.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Cover {
    /// Side of a cell.
    pub cell_m: f64,
    /// Share of the known cells by class.
    pub shares: BTreeMap<String, f64>,
    /// Share of the known cells that files of features decided; rules decided the others.
    pub from_features: f64,
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
