//! Everything one block needs to be drawn, made off the render thread and never changed afterwards.
//!
//! 28 KiB of data a block (heights 4, light 4, ground map 20) and at most 11 KiB of indices. An event that changes a
//! block makes a new payload with a higher version.

use super::ground_map::{self, Climate};
use super::light;
use super::mask::{BlockPosts, Mask, block_posts};
use super::mesh::{self, Indices, TILE};
use super::rings::{FAR_RINGS, RingMasks};
use crate::edit::{Changed, Edit, EditError};
use crate::features::by_block::StripsByBlock;
use crate::features::cover::Cover;
use crate::features::imagery::Imagery;
use crate::features::lakes::Lakes;
use crate::features::model::Features;
use crate::field::Field;
use crate::grid::{BlockIndex, PostRect};
use crate::ground::Ground;
use crate::pyramid::Range;
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// How far from a shore the ground map asks for it: beyond, neither colour nor shore line changes.
const SHORE_REACH_M: f64 = 6_000.0;

/// All that payloads are made from.
#[derive(Debug, Clone)]
pub struct Landscape {
    /// The ground.
    pub ground: Ground,
    /// Standing water.
    pub lakes: Arc<Lakes>,
    /// What else lies on the ground.
    pub features: Arc<Features>,
    /// Its roads, running water and runways by block: [`StripsByBlock::new`] of the features.
    pub strips: Arc<StripsByBlock>,
    /// What covers it.
    pub cover: Arc<Cover>,
    /// What photographs say of it.
    pub imagery: Option<Arc<Imagery>>,
    /// What the ground map's belts depend on.
    pub climate: Climate,
    /// Masks of every block and far ring.
    pub masks: RingMasks,
}

/// A block's triangles.
#[derive(Debug, Clone, PartialEq)]
pub enum Mesh {
    /// The list shared by all whole blocks at level 0.
    Level0,
    /// The list shared by all whole blocks at level 1.
    Level1,
    /// A list of its own: mixed, or with void posts left out.
    Own(Arc<Indices>),
}

/// See the module.
#[derive(Debug, Clone)]
pub struct Payload {
    /// Which block.
    pub block: BlockIndex,
    /// Version of the ground that it was made from.
    pub version: u32,
    /// Post heights of the block with an apron towards south and east, `TILE` x `TILE`, row by row; NaN is void.
    pub heights_m: Box<[f32]>,
    /// See [`light`].
    pub light: Box<[u8]>,
    /// Towards the sun that `light` was made for.
    pub light_sun: DVec3,
    /// See [`ground_map`].
    pub ground_map: Box<[u8]>,
    /// Heights of the block's own posts.
    pub range: Range,
    /// Centre of the block's box, world metres.
    pub centre_m: DVec3,
    /// Radius of the sphere around the box, metres.
    pub radius_m: f64,
    /// Whether any texel is water.
    pub has_water: bool,
    /// Triangles at level 0: all that are not void.
    pub ground_triangles: u32,
}

/// Triangles of level 0 without those that are void.
fn ground_triangles(posts: &BlockPosts) -> u32 {
    let list = if posts.iter().any(|h| h.is_nan()) {
        mesh::indices(&Mask::all(), Some(posts)).len()
    } else {
        mesh::level_0().len()
    };
    list as u32 / 3
}

impl Mesh {
    /// Fingerprint of the index list: FNV-1a by index; the shared lists are known by their level.
    pub fn hash(&self) -> u64 {
        match self {
            Self::Level0 => 0,
            Self::Level1 => 1,
            Self::Own(list) => list.iter().fold(0xcbf2_9ce4_8422_2325, |hash, index| {
                (hash ^ u64::from(*index)).wrapping_mul(0x0000_0100_0000_01b3)
            }),
        }
    }

    /// The triangle list.
    pub fn indices(&self) -> &Indices {
        match self {
            Self::Level0 => mesh::level_0(),
            Self::Level1 => mesh::level_1(),
            Self::Own(list) => list,
        }
    }

    /// Number of triangles.
    pub fn triangles(&self) -> u32 {
        self.indices().len() as u32 / 3
    }
}

/// The heights of a block's posts and apron, `TILE` x `TILE`, row by row; NaN is void or beyond the world.
pub fn tile_heights_m(field: &Field, block: BlockIndex) -> Box<[f32]> {
    let (column, row) = (block.first_column(), block.first_row());
    field.read(PostRect { column, row, columns: TILE, rows: TILE }).into_boxed_slice()
}

impl Landscape {
    /// Ground with nothing on it.
    pub fn bare(field: Arc<Field>, limits_m: [f64; FAR_RINGS], climate: Climate) -> Self {
        Self {
            masks: RingMasks::new(&field, limits_m),
            lakes: Arc::default(),
            features: Arc::default(),
            strips: Arc::default(),
            imagery: None,
            cover: Arc::new(Cover::unknown(field.grid())),
            climate,
            ground: Ground::new(field),
        }
    }

    /// The landscape over the next version of its ground, and what changed. What lies on the ground (water, cover,
    /// photographs) stays as it was baked.
    ///
    /// # Errors
    /// [`EditError`] says which edit cannot be made; none is then.
    pub fn edited(&self, edits: &[Edit]) -> Result<(Self, Changed), EditError> {
        let (ground, changed) = self.ground.edited(edits)?;
        let masks = self.masks.edited(ground.field(), &changed);
        Ok((Self { ground, masks, ..self.clone() }, changed))
    }

    /// The mesh of a block for a ring.
    pub fn mesh(&self, block: BlockIndex, ring: usize) -> Mesh {
        let field = self.ground.field();
        let mask = self.masks.mask(field.grid(), block, ring);
        let posts = block_posts(field, block);
        if posts.iter().any(|h| h.is_nan()) {
            Mesh::Own(Arc::new(mesh::indices(&mask, Some(&posts))))
        } else if mask == Mask::all() {
            Mesh::Level0
        } else if mask == Mask::NONE {
            Mesh::Level1
        } else {
            Mesh::Own(Arc::new(mesh::indices(&mask, None)))
        }
    }

    /// Makes a block's payload, lit from `to_sun` (unit, world frame).
    pub fn payload(&self, block: BlockIndex, to_sun: DVec3) -> Payload {
        let field = self.ground.field();
        let grid = field.grid();
        let (first_column, first_row) = (block.first_column(), block.first_row());
        let heights_m = tile_heights_m(field, block);
        let posts = block_posts(field, block);
        let range = posts.iter().fold(Range::VOID, |range, h| range.include(*h));
        let side = grid.block_m();
        let (low, high) = if range.is_void() { (0.0, 0.0) } else { (range.least_m.into(), range.greatest_m.into()) };
        let (west, north) = (grid.x_m(first_column), grid.z_m(first_row));
        let centre_m = DVec3::new(west + 0.5 * side, 0.5 * (low + high), north + 0.5 * side);
        let (north_west, south_east) = (DVec2::new(west, north), DVec2::new(west + side, north + side));
        let water = self.lakes.near(north_west, south_east, SHORE_REACH_M);
        let shore_m = |x_m: f64, z_m: f64| water.signed_distance_m(DVec2::new(x_m, z_m));
        let dress =
            ground_map::Dress { cover: &self.cover, strips: self.strips.of(block), imagery: self.imagery.as_deref() };
        let sea_known = |x_m: f64, z_m: f64| water.knows_the_sea(DVec2::new(x_m, z_m));
        let ground_map = ground_map::ground_map(field, block, &self.climate, &dress, &shore_m, &sea_known);
        Payload {
            block,
            version: self.ground.version(),
            heights_m,
            light: light::light_map(field, self.ground.pyramid(), block, to_sun),
            light_sun: to_sun,
            range,
            centre_m,
            radius_m: 0.5 * DVec3::new(side, high - low, side).length(),
            has_water: ground_map[..ground_map::MAP_BYTES].chunks_exact(4).any(|texel| texel[3] > 127),
            ground_triangles: ground_triangles(&posts),
            ground_map,
        }
    }
}

impl Payload {
    /// Lowest ground of its tile, apron included, metres; infinite if all is void.
    pub fn lowest_m(&self) -> f32 {
        // min ignores NaN.
        self.heights_m.iter().copied().fold(f32::INFINITY, f32::min)
    }

    /// Bytes that go to the GPU, without indices.
    pub fn upload_bytes(&self) -> usize {
        size_of_val(&*self.heights_m) + self.light.len() + self.ground_map.len()
    }
}
