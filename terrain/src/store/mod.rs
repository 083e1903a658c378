//! Where worlds are kept: a folder `NAME.world`.
//!
//! - `world.toml`: what the world is ([`WorldInfo`]), with the length and CRC-32 of every other file
//! - `heights.bin`: posts row by row, north first, each row from the west; f32 little-endian metres, NaN void
//! - `lakes.json`: outlines in world metres and levels
//! - `features.bin`: what lies on the ground but lakes ([`Features`]), postcard; absent if there is nothing
//! - `cover.bin`: what covers it ([`Cover`]): cells along a post step as u32 little-endian, then the cells, deflated; absent
//!   if nothing is known
//! - `imagery.bin`: what photographs say of its colours ([`Imagery`]), postcard; absent without photographs
//! - `masks.bin`: the block masks of the rings, as [`crate::block`] packs them; absent if none were made
//!
//! A world is written to a folder beside its place and renamed into it, so a place holds a whole world or what it held
//! before. Reading checks version, sizes and sums, so a world that reads is the one that was written.

mod cover;
mod features;
mod folder;
mod info;
mod masks;

pub use folder::StoreError;
pub use info::{
    CoverInfo, Extent, FORMAT_VERSION, FeatureCount, FileInfo, ImageryInfo, LakeInfo, Source, Statistics, Voids,
    WorldInfo,
};

use crate::block::rings::{RingMasks, Rings};
use crate::features::cover::Cover;
use crate::features::imagery::Imagery;
use crate::features::lakes::{Lake, Lakes};
use crate::features::model::Features;
use crate::field::Field;
use crate::grid::Grid;
use crate::projection::{Geodetic, Projection};
use folder::{may_be_replaced, read_checked, read_info, write_folder};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::sync::Arc;

const HEIGHTS: &str = "heights.bin";
const LAKES: &str = "lakes.json";
const MASKS: &str = "masks.bin";
const FEATURES: &str = "features.bin";
const COVER: &str = "cover.bin";
/// Postcard of [`Imagery`].
const IMAGERY: &str = "imagery.bin";

/// All that a world's folder may hold.
const FILES: [&str; 7] = [folder::INFO, HEIGHTS, LAKES, MASKS, FEATURES, COVER, IMAGERY];

/// A world in memory.
#[derive(Debug, Clone)]
pub struct World {
    /// Its name, as `info.name`.
    pub name: String,
    /// Between its plane and the Earth.
    pub projection: Projection,
    /// Its ground.
    pub field: Arc<Field>,
    /// Its lakes.
    pub lakes: Lakes,
    /// What else lies on its ground.
    pub features: Arc<Features>,
    /// What covers its ground.
    pub cover: Arc<Cover>,
    /// What photographs say of its ground, if there are any.
    pub imagery: Option<Arc<Imagery>>,
    /// The masks of its blocks, packed by [`crate::block`]; empty if none were made.
    pub masks: Vec<u8>,
    /// What `world.toml` says of it.
    pub info: WorldInfo,
}

/// A lake as `lakes.json` has it.
#[derive(Serialize, Deserialize)]
struct StoredLake {
    name: String,
    level_m: f64,
    /// World x and z, metres.
    rings: Vec<Vec<[f64; 2]>>,
}

impl World {
    /// Reads a world.
    ///
    /// # Errors
    /// [`StoreError`] names the file that is missing, of another version or size, or damaged.
    pub fn read(path: &Path) -> Result<Self, StoreError> {
        let info = read_info(path)?;
        let wrong = |expected: &str, found: String| StoreError::damaged(&path.join("world.toml"), expected, found);
        let projection = Projection::new(Geodetic::from_degrees(info.centre_lat_deg, info.centre_lon_deg))
            .map_err(|e| wrong("a centre", e.to_string()))?;
        let grid = Grid {
            west_m: info.extent.west_m,
            north_m: info.extent.north_m,
            step_m: info.step_m,
            blocks_x: info.blocks_x,
            blocks_z: info.blocks_z,
        }
        .checked()
        .map_err(|e| wrong("a grid", e.to_string()))?;
        let (east_m, south_m) = (info.extent.east_m, info.extent.south_m);
        if (east_m, south_m, info.statistics.posts) != (grid.east_m(), grid.south_m(), grid.posts()) {
            let expected = format!(
                "east_m {}, south_m {} and {} posts, as the step and the blocks say",
                grid.east_m(),
                grid.south_m(),
                grid.posts()
            );
            return Err(wrong(&expected, format!("{east_m}, {south_m} and {}", info.statistics.posts)));
        }

        let bytes = read_checked(path, &info, HEIGHTS, Some(4 * grid.posts() as u64))?;
        let heights = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let field = Field::new(grid, heights)
            .map_err(|e| StoreError::damaged(&path.join(HEIGHTS), "heights", e.to_string()))?;
        let bytes = read_checked(path, &info, LAKES, None)?;
        let lakes: Vec<StoredLake> = serde_json::from_slice(&bytes)
            .map_err(|e| StoreError::damaged(&path.join(LAKES), "lakes", e.to_string()))?;
        let masks = match info.file(MASKS) {
            Some(_) => read_checked(path, &info, MASKS, None)?,
            None => Vec::new(),
        };
        let features = match info.file(FEATURES) {
            Some(_) => features::from_bytes(&read_checked(path, &info, FEATURES, None)?)
                .map_err(|found| StoreError::damaged(&path.join(FEATURES), "features", found))?,
            None => Features::default(),
        };
        let cover = match info.file(COVER) {
            Some(_) => cover::from_bytes(&read_checked(path, &info, COVER, None)?, &grid)
                .map_err(|found| StoreError::damaged(&path.join(COVER), "a cover of the world's size", found))?,
            None => Cover::unknown(&grid),
        };
        let imagery = match info.file(IMAGERY) {
            Some(_) => {
                let damaged =
                    |found: String| StoreError::damaged(&path.join(IMAGERY), "imagery of the world's size", found);
                let imagery: Imagery = postcard::from_bytes(&read_checked(path, &info, IMAGERY, None)?)
                    .map_err(|error| damaged(error.to_string()))?;
                if !imagery.fits(&grid) {
                    return Err(damaged("another size".into()));
                }
                Some(Arc::new(imagery))
            }
            None => None,
        };
        Ok(Self {
            name: info.name.clone(),
            imagery,
            features: Arc::new(features),
            cover: Arc::new(cover),
            projection,
            field: Arc::new(field),
            lakes: Lakes::new(lakes.into_iter().map(Lake::from).collect()),
            masks,
            info,
        })
    }

    /// The masks that came with the world, if any did and they fit it.
    pub fn ring_masks(&self) -> Option<RingMasks> {
        masks::from_bytes(&self.masks, self.field.grid().blocks().count())
    }

    /// Makes the masks that belong to the world, for the long window at one pixel, to be written with it.
    pub fn make_ring_masks(&mut self) {
        let rings = Rings::new(self.field.grid(), 24, 1.0);
        self.masks = masks::to_bytes(&RingMasks::new(&self.field, rings.limits_m));
    }

    /// Whether a world may be written there: nothing is there, or a world and nothing else. To be asked before a long
    /// bake; [`World::write`] asks again.
    ///
    /// # Errors
    /// [`StoreError::NotAWorld`] says what is there that would be lost.
    pub fn may_be_written(path: &Path) -> Result<(), StoreError> {
        may_be_replaced(path)
    }

    /// Writes the world; what was there is replaced if it was a world and nothing else.
    ///
    /// # Errors
    /// [`StoreError`] if something else is there, or the disk refuses.
    pub fn write(&self, path: &Path) -> Result<(), StoreError> {
        let heights: Vec<u8> = self.field.heights_m().iter().flat_map(|h| h.to_le_bytes()).collect();
        let lakes: Vec<StoredLake> = self.lakes.lakes().iter().map(StoredLake::from).collect();
        let lakes = serde_json::to_vec(&lakes).map_err(|e| StoreError::io(path, e.into()))?;
        let features = features::to_bytes(&self.features).map_err(|e| StoreError::io(path, e))?;
        let cover = cover::to_bytes(&self.cover, self.field.grid()).map_err(|e| StoreError::io(path, e))?;
        let mut files = vec![(HEIGHTS, heights.as_slice()), (LAKES, lakes.as_slice())];
        if *self.features != Features::default() {
            files.push((FEATURES, &features));
        }
        if !self.cover.cells().is_empty() {
            files.push((COVER, &cover));
        }
        let imagery = self.imagery.as_deref().map(postcard::to_stdvec).transpose();
        let imagery = imagery.map_err(|e| StoreError::io(path, std::io::Error::other(e)))?;
        if let Some(imagery) = &imagery {
            files.push((IMAGERY, imagery));
        }
        if !self.masks.is_empty() {
            files.push((MASKS, &self.masks));
        }
        write_folder(path, &self.info, &files)
    }
}

impl From<StoredLake> for Lake {
    fn from(stored: StoredLake) -> Self {
        let rings = stored.rings.into_iter().map(|ring| ring.into_iter().map(DVec2::from).collect()).collect();
        Self { name: stored.name, level_m: stored.level_m, rings }
    }
}

impl From<&Lake> for StoredLake {
    fn from(lake: &Lake) -> Self {
        let rings = lake.rings.iter().map(|ring| ring.iter().map(DVec2::to_array).collect()).collect();
        Self { name: lake.name.clone(), level_m: lake.level_m, rings }
    }
}
