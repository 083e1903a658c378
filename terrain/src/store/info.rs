//! What `world.toml` holds: all that a person or a program may want to know before reading a world.
//!
//! Field names are the format: change one and raise [`FORMAT_VERSION`]. Lengths in metres, angles in degrees because a
//! person reads them.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the folder's format that this program writes and reads.
pub const FORMAT_VERSION: u32 = 2;

/// A world, described.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorldInfo {
    /// [`FORMAT_VERSION`] of the writer.
    pub format_version: u32,
    /// As a person would call it.
    pub name: String,
    /// How the plane is made from the Earth.
    pub projection: String,
    /// Latitude of the centre.
    pub centre_lat_deg: f64,
    /// Longitude of the centre.
    pub centre_lon_deg: f64,
    /// Distance between posts.
    pub step_m: f64,
    /// Blocks from west to east.
    pub blocks_x: u32,
    /// Blocks from north to south.
    pub blocks_z: u32,
    /// Which kernel made posts from samples.
    pub kernel: String,
    /// Plan rectangle of the posts.
    pub extent: Extent,
    /// Heights over all posts that have one.
    pub statistics: Statistics,
    /// What was missing in the sources.
    pub voids: Voids,
    /// What the heights came from, finest first.
    #[serde(default)]
    pub sources: Vec<Source>,
    /// What was made of the files of features, by kind.
    #[serde(default)]
    pub features: BTreeMap<String, FeatureCount>,
    /// What covers the ground.
    #[serde(default)]
    pub cover: Option<CoverInfo>,
    /// Photographs of the ground.
    #[serde(default)]
    pub imagery: Vec<ImageryInfo>,
    /// Lakes set to one level.
    #[serde(default)]
    pub lakes: Vec<LakeInfo>,
    /// The other files of the folder; filled in by writing.
    #[serde(default)]
    pub files: Vec<FileInfo>,
}

/// A plan rectangle, metres in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Extent {
    /// Least x.
    pub west_m: f64,
    /// Least z.
    pub north_m: f64,
    /// Greatest x.
    pub east_m: f64,
    /// Greatest z.
    pub south_m: f64,
}

/// Heights, metres.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// All posts.
    pub posts: usize,
    /// Lowest.
    pub min_m: f64,
    /// Highest.
    pub max_m: f64,
    /// Mean.
    pub mean_m: f64,
}

/// Posts without a sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Voids {
    /// Voids inside the data, filled.
    pub posts: usize,
    /// Their share of the posts inside the data.
    pub share: f64,
    /// Posts of the largest one.
    pub largest_posts: usize,
    /// Posts beyond the data, left void.
    pub beyond_posts: usize,
}

/// A source of heights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// File name.
    pub file: String,
    /// Format.
    pub format: String,
    /// Coordinate system.
    pub system: String,
    /// Samples along a row.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
    /// Samples that are void.
    pub void_samples: usize,
    /// Size of a pixel along rows and columns.
    pub pixel_m: [f64; 2],
    /// Factor that heights were multiplied by.
    pub height_scale: f64,
    /// Who must be credited; empty if the file does not say.
    pub credit: String,
    /// What must be known about its accuracy; empty if nothing.
    pub note: String,
}

/// Features of one kind.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FeatureCount {
    /// In the files.
    pub read: usize,
    /// In the world.
    pub kept: usize,
    /// Left out: `read` is the sum of both.
    pub skipped: usize,
    /// The same by reason.
    #[serde(default)]
    pub skipped_for: BTreeMap<String, usize>,
    /// What was done with how many of those kept, where that is worth knowing.
    #[serde(default)]
    pub notes: BTreeMap<String, usize>,
}

/// What covers the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CoverInfo {
    /// Side of a cell.
    pub cell_m: f64,
    /// Share of the known cells that files of features decided; rules decided the others.
    pub from_features: f64,
    /// Share of the known cells by class.
    pub shares: BTreeMap<String, f64>,
}

/// A photograph of the ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ImageryInfo {
    /// File name.
    pub file: String,
    /// Format.
    pub format: String,
    /// Coordinate system.
    pub system: String,
    /// Pixels along a row.
    pub columns: usize,
    /// Rows.
    pub rows: usize,
    /// Size of a pixel along rows and columns.
    pub pixel_m: [f64; 2],
    /// Who must be credited; empty if the file does not say.
    pub credit: String,
}

/// A lake.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LakeInfo {
    /// As the file calls it.
    pub name: String,
    /// Height of the water.
    pub level_m: f64,
    /// Whether that is the file's or the median of the raster inside the outline.
    pub level_from: String,
    /// Posts set to it.
    pub posts: usize,
    /// Width of the shore that was blended outside the outline.
    pub taper_m: f64,
}

/// A file of the folder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileInfo {
    /// Its name.
    pub name: String,
    /// Its length.
    pub bytes: u64,
    /// CRC-32 (IEEE) of its bytes, eight hexadecimal digits.
    pub crc32: String,
}

impl WorldInfo {
    /// The entry of a file.
    pub fn file(&self, name: &str) -> Option<&FileInfo> {
        self.files.iter().find(|file| file.name == name)
    }
}
