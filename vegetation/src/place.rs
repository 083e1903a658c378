//! Where plants stand: one may stand in each hash cell, moved within it, thinned by what covers the ground.
//!
//! Three *tiers* share the ground: each has cells of its own size, and a nearer tier adds plants between those of a farther one,
//! so a forest grows denser as one comes near and no plant ever moves. A tier's tiles are squares counted from the
//! grid's north-west corner, as [`terrain::near`] has them.
//!
//! Invariants: a tile's plants are a function of the world and the tile alone, found with integer hashes and exactly rounded
//! arithmetic only (+, -, *, /, sqrt, comparisons), so they are the same on every machine; a share of the plants is a
//! subset of every larger share; a plant's `height_m` is the ground query at its own quantised place, rounded to f32.

use crate::clearings::Clearings;
use crate::species::{Flora, SPECIES, Shape, Site};
use bed::Bed;
use glam::DVec2;
use std::sync::{Arc, OnceLock};
use terrain::block::Landscape;
use terrain::features::cover::{Cover, CoverClass};
use terrain::near::TileIndex;
use terrain::{Area, Grid, thread_time};

/// Parts of a tile's side that a place is counted in.
pub const PARTS: f64 = 65_536.0;

/// Parts along a tile's side that plants are sorted into, so that they can be drawn in parts.
pub const SQUARES: u32 = 4;

/// A population.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tier {
    /// Which it is: part of every hash.
    pub number: u32,
    /// Side of its tiles, metres.
    pub side_m: f64,
    /// Hash cells along a tile.
    pub cells: u32,
    /// Farthest that one of its plants is drawn, metres.
    pub reach_m: f64,
    /// Share of reach within which all of its plants are drawn; beyond, they leave one by one.
    pub full: f32,
}

/// Far, middle and near.
pub const TIERS: [Tier; 3] = [
    // Cells of 67.4 m: 7,921 plants at most in a tile.
    Tier { number: 0, side_m: 6_000.0, cells: 89, reach_m: 10_000.0, full: 0.6 },
    // 15 m.
    Tier { number: 1, side_m: 1_500.0, cells: 100, reach_m: 5_000.0, full: 0.3 },
    // 10 m.
    Tier { number: 2, side_m: 500.0, cells: 50, reach_m: 800.0, full: 0.5 },
];

/// A plant, as it goes to the GPU.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Plant {
    /// East and south of the tile's corner, in parts of its side ([`PARTS`]).
    pub at: [u16; 2],
    /// Height of the ground under it above sea level, metres.
    pub height_m: f32,
    /// Place in [`SPECIES`].
    pub species: u8,
    /// Its height between the species' least (0) and greatest (255).
    pub size: u8,
    /// Turn, and the rank in which the tier's plants leave with distance.
    pub turn: u8,
    /// Shade of its own.
    pub tint: u8,
}

/// A tile's plants.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Planted {
    /// Square by square, row by row from the north-west; in a square conifers first, and of each those that leave last.
    pub plants: Vec<Plant>,
    /// [`SQUARES`] x [`SQUARES`].
    pub squares: Vec<Square>,
    /// Time of a processor to place them, milliseconds.
    pub took_ms: f64,
}

/// A part of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Square {
    /// Where its conifers end and the others begin.
    pub conifers_end: u32,
    /// Where its plants end.
    pub end: u32,
    /// Least and greatest height of their feet, metres.
    pub feet_m: [f32; 2],
}

/// All that plants are placed from.
#[derive(Debug)]
pub struct Nursery {
    area: Area,
    landscape: Arc<Landscape>,
    flora: Flora,
    /// Made by whoever needs it first: never the render thread.
    clearings: OnceLock<Clearings>,
}

impl Tier {
    /// Side of a hash cell, metres.
    pub fn cell_m(&self) -> f64 {
        self.side_m / f64::from(self.cells)
    }
}

impl Plant {
    /// Its foot on the plan.
    pub fn plan_m(&self, tier: &Tier, corner_m: DVec2) -> DVec2 {
        corner_m + DVec2::new(f64::from(self.at[0]), f64::from(self.at[1])) * (tier.side_m / PARTS)
    }

    /// Whether it is a cone from the ground.
    pub fn is_conifer(&self) -> bool {
        matches!(SPECIES[usize::from(self.species) % SPECIES.len()].shape, Shape::Spire | Shape::Conifer)
    }

    /// Farthest that it is drawn, metres.
    pub fn reach_m(&self, tier: &Tier) -> f32 {
        tier.reach_m as f32 * (tier.full + (1.0 - tier.full) * f32::from(self.turn) / 255.0)
    }

    /// How tall it stands, metres.
    pub fn tall_m(&self) -> f32 {
        let [low, high] = SPECIES[usize::from(self.species) % SPECIES.len()].height_m;
        low + (high - low) * f32::from(self.size) / 255.0
    }
}

/// North-west corner of a tile, metres.
pub fn corner_m(grid: &Grid, side_m: f64, tile: TileIndex) -> DVec2 {
    DVec2::new(grid.west_m, grid.north_m) + DVec2::new(f64::from(tile.x), f64::from(tile.z)) * side_m
}

impl Nursery {
    /// Of a landscape at a latitude.
    pub fn new(landscape: Arc<Landscape>, latitude_rad: f64) -> Self {
        Self {
            area: landscape.ground.whole(),
            flora: Flora::new(&landscape.climate, latitude_rad),
            landscape,
            clearings: OnceLock::new(),
        }
    }

    /// Whether nothing may grow anywhere.
    pub fn is_bare(&self) -> bool {
        !self.landscape.cover.has(|class| Site::of(class).is_some())
    }

    /// Whether there is forest anywhere.
    pub fn has_forest(&self) -> bool {
        self.landscape.cover.has(CoverClass::is_forest)
    }

    /// Its ground.
    pub fn area(&self) -> &Area {
        &self.area
    }

    /// What covers it.
    pub fn cover(&self) -> &Cover {
        &self.landscape.cover
    }

    /// What grows.
    pub fn flora(&self) -> &Flora {
        &self.flora
    }

    /// What is kept free.
    pub fn clearings(&self) -> &Clearings {
        self.clearings.get_or_init(|| Clearings::new(&self.landscape.features))
    }

    /// The plants of a tile, `share` (0..=1) of them.
    pub fn plants(&self, tier: &Tier, tile: TileIndex, share: f32) -> Planted {
        // Made once, by the first tile: no tile's own time.
        let _ = self.clearings();
        let before = thread_time::spent();
        let mut planted = Bed::new(self, tier, tile, share).planted();
        planted.took_ms = thread_time::spent().saturating_sub(before).as_secs_f64() * 1e3;
        planted
    }
}

mod bed;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod twin;
