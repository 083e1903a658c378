//! What is draped on the near ground: lakes and other water, roads, railways, aprons, taxiways, runways with their markings.
//!
//! Everything is cut along the ground's level-0 triangles, so it lies in them and not near them. Frame of a vertex: lattice
//! units ([`lattice`]) east and south of its block's north-west post, and metres above sea level.
//!
//! Invariants others rely on, and [`crate::verify::overlay`] proves on a world: a vertex's height is the ground's, rounded
//! once to f32; no triangle crosses a cell's edge or diagonal; a feature has no T-junction, within a block or between
//! blocks; spots that two blocks share are equal to the bit. What a block holds depends on the world and the block alone.

pub mod build;
pub mod clip;
pub mod decal;
mod glyphs;
pub mod lattice;
mod markings;
mod polygon;
pub mod region;
pub mod ribbon;
mod source;

pub use build::Overlays;

use crate::features::cover::CoverClass;
use crate::features::lakes::Lakes;
use crate::features::model::{Features, RoadClass};

/// What a triangle is, and when it is drawn: kinds are painted in this order, later ones over earlier.
#[repr(u8)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Running water.
    Water = 0,
    /// A pond, or a river that is drawn by its banks: it covers the ground and leaves its shape. Of this kind and the next
    /// [`Vertex::along_m`] and [`Vertex::across`] are distances from shores.
    WaterArea = 1,
    /// A lake or the sea, of one level.
    StillWater = 2,
    /// A footpath.
    Path = 3,
    /// A track, gravel or earth.
    Track = 4,
    /// An unsealed road.
    Gravel = 5,
    /// A sealed road without markings.
    Lane = 6,
    /// A sealed road with a line along its middle.
    Road = 7,
    /// A sealed road of two carriageways or as wide.
    Motorway = 8,
    /// A railway.
    Railway = 9,
    /// An apron, of slabs.
    Apron = 10,
    /// A taxiway with its yellow line.
    Taxiway = 11,
    /// A runway of asphalt; along counts from the nearer threshold.
    RunwayAsphalt = 12,
    /// Of concrete.
    RunwayConcrete = 13,
    /// Of gravel.
    RunwayGravel = 14,
    /// Of grass.
    RunwayGrass = 15,
    /// White paint; along and across count from the middle of the mark.
    White = 16,
    /// A crater too small for the posts, with what it threw out; half the width is its radius ([`decal`]).
    Crater = 17,
    /// Burnt ground; the same.
    Scorch = 18,
}

impl Kind {
    /// Of a road.
    pub fn of_road(class: RoadClass, paved: bool, width_m: f32) -> Self {
        match class {
            RoadClass::Railway => Self::Railway,
            RoadClass::Path => Self::Path,
            RoadClass::Track if !paved => Self::Track,
            _ if !paved => Self::Gravel,
            RoadClass::Motorway | RoadClass::Trunk if width_m > 10.0 => Self::Motorway,
            _ if width_m >= 5.5 && class <= RoadClass::Tertiary => Self::Road,
            _ => Self::Lane,
        }
    }
}

/// Bits of a lattice coordinate within a block: up to 32 cells, both ends counted.
pub const PLACE_BITS: u32 = 22;

/// Units of [`Vertex::across`] along a metre.
pub const ACROSS_PER_METRE: f64 = 256.0;

/// Distance of a vertex whose triangle has no shore, metres; of the second shore the most that fits [`Vertex::across`].
pub const NO_SHORE_M: [f64; 2] = [10_000.0, 127.0];

/// Units of a mark's half length along a metre, in the high bits of [`Vertex::south`].
pub const EXTENT_PER_METRE: f64 = 8.0;

/// Steps of a whole turn in the high bits of [`Vertex::south`].
pub const TURN_STEPS: f64 = 1_024.0;

/// A vertex as the GPU takes it: 20 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Units east of the block's north-west post in the low [`PLACE_BITS`], [`Kind`] above.
    pub east: u32,
    /// Units south of it, and above, of [`Kind::White`]: the half length of a mark in 1 / [`EXTENT_PER_METRE`] m, 0 where its
    /// ends are not smoothed; of what has a width: where its right is, clockwise from east, in 1 / [`TURN_STEPS`] turns.
    pub south: u32,
    /// Above sea level, metres.
    pub height_m: f32,
    /// Along the feature, metres; of [`Kind::WaterArea`] and [`Kind::StillWater`] the distance from the triangle's edge that
    /// is a shore, if it has one.
    pub along_m: f32,
    /// Across it from its middle, i16 in the low half, and half its width, u16 in the high half; 1 / [`ACROSS_PER_METRE`]
    /// m. A half width of 0 has no edge to be smoothed. Of water as above the distance from a second shore.
    pub across: u32,
}

impl Vertex {
    /// East and south of the block's north-west post, lattice units.
    pub fn place(&self) -> (i64, i64) {
        let mask = (1 << PLACE_BITS) - 1;
        (i64::from(self.east & mask), i64::from(self.south & mask))
    }

    /// What it is.
    pub fn kind(&self) -> u8 {
        (self.east >> PLACE_BITS) as u8
    }

    /// Its bits, in the order of its fields.
    pub fn words(&self) -> [u32; 5] {
        [self.east, self.south, self.height_m.to_bits(), self.along_m.to_bits(), self.across]
    }
}

/// The triangles of one feature, or of one painted mark, in a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Which feature: equal in all blocks.
    pub source: u32,
    /// Which of its marks, that lie on one another as paint does; 0 of what has none.
    pub piece: u32,
    /// Its indices.
    pub first: u32,
    /// Number of indices.
    pub count: u32,
}

/// What lies on a block.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Overlay {
    /// See [`Vertex`].
    pub vertices: Vec<Vertex>,
    /// Triangles, in the order they are painted.
    pub indices: Vec<u32>,
    /// Which feature made which.
    pub parts: Vec<Part>,
}

impl Overlay {
    /// Bytes that go to the GPU.
    pub fn upload_bytes(&self) -> usize {
        size_of_val(&*self.vertices) + size_of_val(&*self.indices)
    }
}

/// Whether a world has anything to drape.
pub fn any(features: &Features, lakes: &Lakes) -> bool {
    !lakes.lakes().is_empty()
        || features.areas.iter().any(|area| area.cover == CoverClass::Water)
        || features.roads.iter().any(|road| !road.tunnel)
        || features.waterways.iter().any(|water| !water.tunnel)
        || features
            .airfields
            .iter()
            .any(|field| !field.runways.is_empty() || !field.taxiways.is_empty() || !field.aprons.is_empty())
}
