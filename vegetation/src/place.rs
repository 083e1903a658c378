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
use crate::scatter::{hash, uniform};
use crate::species::{Flora, SPECIES, Shape, Site};
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
#[derive(Debug, Clone, Copy, PartialEq)]
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

    /// Whether anything may grow at all.
    pub fn is_bare(&self) -> bool {
        self.landscape.cover.cells().is_empty()
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
        let clearings = self.clearings();
        let before = thread_time::spent();
        let corner = corner_m(self.area.grid(), tier.side_m, tile);
        let far = corner + tier.side_m;
        let lakes = self.landscape.lakes.near(corner, far, 10.0);
        let mut squares: Vec<Vec<Plant>> = vec![Vec::new(); (SQUARES * SQUARES) as usize];
        for row in 0..tier.cells {
            for column in 0..tier.cells {
                let Some(plant) = self.plant(tier, tile, corner, column, row, share) else { continue };
                let at = plant.plan_m(tier, corner);
                if clearings.holds(at) || (!lakes.is_dry() && lakes.signed_distance_m(at) < 8.0) {
                    continue;
                }
                let part = |at: u16| u32::from(at) * SQUARES / 65_536;
                squares[(part(plant.at[1]) * SQUARES + part(plant.at[0])) as usize].push(plant);
            }
        }
        let mut planted = Planted::default();
        for mut square in squares {
            // Those that leave last come first, so that a part far away is the beginning of its list.
            square.sort_by_key(|plant| (!plant.is_conifer(), u8::MAX - plant.turn));
            let feet_m = square.iter().fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], plant| {
                [low.min(plant.height_m), high.max(plant.height_m)]
            });
            let conifers_end = (planted.plants.len() + square.partition_point(Plant::is_conifer)) as u32;
            planted.plants.extend(square);
            planted.squares.push(Square { conifers_end, end: planted.plants.len() as u32, feet_m });
        }
        planted.took_ms = thread_time::spent().saturating_sub(before).as_secs_f64() * 1e3;
        planted
    }

    /// Share of the plants that open ground has water for: few in dry lands down low, where streams alone have trees.
    fn moisture(&self, cover: CoverClass, height_m: f32) -> f32 {
        let kept = match cover {
            CoverClass::Grass => 0.06,
            CoverClass::Field => 0.25,
            CoverClass::Scrub => 0.5,
            _ => return 1.0,
        };
        let wet = ((height_m / self.flora.tree_line_m - 0.35) * 4.0).clamp(0.0, 1.0);
        1.0 - self.flora.dryness * (1.0 - kept) * (1.0 - wet)
    }

    /// The plant of a hash cell, before clearings and lakes.
    fn plant(&self, tier: &Tier, tile: TileIndex, corner: DVec2, column: u32, row: u32, share: f32) -> Option<Plant> {
        let cells = tier.cells as i32;
        let (cell_x, cell_z) = (tile.x.wrapping_mul(cells), tile.z.wrapping_mul(cells));
        let (cell_x, cell_z) = (cell_x.wrapping_add(column as i32), cell_z.wrapping_add(row as i32));
        let salt = tier.number * 8;
        let places = hash(cell_x, cell_z, salt);
        // Whole parts: the cell's corner and a share of the cell, in sixteenths of a part.
        let parts = |at: u32, word: u32| {
            let cell = u64::from(word >> 16) + (u64::from(at) << 16);
            (cell / u64::from(tier.cells)).min(65_535) as u16
        };
        let at = [parts(column, places[0]), parts(row, places[1])];
        let kinds = hash(cell_x, cell_z, salt + 1);
        let rank = uniform(places[2]);
        if uniform(kinds[0]) >= share {
            return None;
        }
        let mut plant = Plant { at, height_m: 0.0, species: 0, size: 0, turn: 0, tint: 0 };
        let plan = plant.plan_m(tier, corner);
        // A cover's edge is as ragged as its cells are wide.
        let edges = hash(cell_x, cell_z, salt + 2);
        let blur_m = self.cover().cell_m() * 0.7;
        let off = DVec2::new(f64::from(uniform(edges[0])) - 0.5, f64::from(uniform(edges[1])) - 0.5) * blur_m;
        let cover = self.cover().class_at(plan.x + off.x, plan.y + off.y);
        let site = Site::of(cover)?;
        let dense = density(tier, cover) * thicket(cover, plan);
        if rank >= dense {
            return None;
        }
        // A ragged edge ends at the water, at sand and at tarmac.
        let here = self.cover().class_at(plan.x, plan.y);
        if matches!(here, CoverClass::Water | CoverClass::Sand | CoverClass::Paved) {
            return None;
        }
        let (height_m, normal) = self.area.height_and_normal(plan.x, plan.y)?;
        // Level ground at 0 m is the sea, as the ground map has it.
        if height_m.abs() < SEA_M || rank >= dense * self.moisture(cover, height_m as f32) {
            return None;
        }
        let steep = (1.0 - normal.y * normal.y).max(0.0).sqrt() as f32;
        plant.height_m = height_m as f32;
        let species = self.flora.choose(site, plant.height_m, steep, uniform(kinds[1]))?;
        plant.species = species as u8;
        // Few are the tallest; towards the tree line all stay low.
        let [a, b] = [uniform(kinds[2]), uniform(edges[2])];
        let high = ((plant.height_m / self.flora.tree_line_m - 0.8) / 0.3).clamp(0.0, 1.0);
        let grown = (0.5 * a + 0.5 * b) * (1.0 - 0.75 * high);
        plant.size = (grown * 255.0) as u8;
        let looks = hash(cell_x, cell_z, salt + 3);
        plant.turn = (looks[0] >> 24) as u8;
        plant.tint = (looks[1] >> 24) as u8;
        Some(plant)
    }
}

/// Ground nearer to 0 m than this is the sea, as [`terrain::block::ground_map`] has it, metres.
const SEA_M: f64 = 0.5;

/// Share of a tier's cells that hold a plant on a cover.
fn density(tier: &Tier, cover: CoverClass) -> f32 {
    let [far, middle, near] = match cover {
        CoverClass::Conifer | CoverClass::MixedForest | CoverClass::Broadleaf => [0.97, 0.90, 0.75],
        CoverClass::Scrub => [0.05, 0.10, 0.30],
        CoverClass::Grass => [0.02, 0.012, 0.03],
        CoverClass::Field => [0.015, 0.004, 0.003],
        CoverClass::BuiltUp => [0.30, 0.18, 0.08],
        _ => [0.0; 3],
    };
    [far, middle, near][tier.number.min(2) as usize]
}

/// Forests have glades, open ground has thickets: a noise over some 300 and 90 m that spares or drops plants.
fn thicket(cover: CoverClass, at: DVec2) -> f32 {
    let noise = 0.6 * lattice(at / 310.0, 101) + 0.4 * lattice(at / 87.0, 102);
    if cover.is_forest() {
        // Full but for the lowest fifth of the noise.
        ((noise - 0.22) * 6.0).clamp(0.12, 1.0)
    } else {
        // None in most places, dense in few.
        ((noise - 0.42) * 6.0).clamp(0.05, 3.0)
    }
}

/// Value noise, 0..1: products and sums only.
pub(crate) fn lattice(at: DVec2, salt: u32) -> f32 {
    let (x, z) = (at.x.floor(), at.y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (ease((at.x - x) as f32), ease((at.y - z) as f32));
    let corner = |dx: i32, dz: i32| uniform(hash((x as i32).wrapping_add(dx), (z as i32).wrapping_add(dz), salt)[0]);
    let north = corner(0, 0) + u * (corner(1, 0) - corner(0, 0));
    let south = corner(0, 1) + u * (corner(1, 1) - corner(0, 1));
    north + v * (south - north)
}

#[cfg(test)]
mod tests;
