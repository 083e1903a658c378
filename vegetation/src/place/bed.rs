//! Placing the plants of one tile: all that its hash cells ask is made ready once, then each cell is looked at once.
//!
//! Whatever can leave a cell empty is asked in the order of its price: the hash, what covers the ground, the noise, the ground
//! itself, what grows there, clearings and lakes. All only ever leave out, so the order does not show.
//!
//! Invariant: the answer is to the bit that of the twin in the tests, which asks everything afresh at every cell.

use super::{Nursery, PARTS, Plant, Planted, SQUARES, Square, Tier, corner_m};
use crate::clearings::ClearingsNear;
use crate::noise::Lattice;
use crate::scatter::{hash, uniform};
use crate::species::Site;
use glam::DVec2;
use terrain::features::cover::{CLASSES, CoverClass};
use terrain::features::lakes::LakesNear;
use terrain::near::TileIndex;

/// Ground nearer to 0 m than this is the sea, as [`terrain::block::ground_map`] has it, metres.
pub(super) const SEA_M: f64 = 0.5;

/// Kept free beside a lake, metres.
pub(super) const SHORE_M: f64 = 8.0;

/// Sides of the squares of the noises that glades and thickets are made of, metres, and their salts.
pub(super) const NOISES: [(f64, u32); 2] = [(310.0, 101), (87.0, 102)];

/// A tile's ground, ready to be planted.
pub(super) struct Bed<'a> {
    nursery: &'a Nursery,
    tier: &'a Tier,
    share: f32,
    corner: DVec2,
    /// Hash cell at the corner.
    first: [i32; 2],
    /// What a cover's class holds, by its number.
    covers: [Option<Soil>; CLASSES.len()],
    /// How far off a cover is looked up, metres: its edge is as ragged as its cells are wide.
    blur_m: f64,
    noises: [Lattice; 2],
    clearings: ClearingsNear<'a>,
    lakes: LakesNear,
}

/// What plants find under a cover.
#[derive(Debug, Clone, Copy)]
struct Soil {
    site: Site,
    cover: CoverClass,
    /// Share of cells that hold a plant.
    dense: f32,
    /// That share where the noise is most kind.
    densest: f32,
}

/// Lists that a tile's plants are sorted into: for each square conifers and others, each by when they leave.
const LISTS: usize = (SQUARES * SQUARES) as usize * LISTS_A_SQUARE;
const LISTS_A_SQUARE: usize = 2 * 256;

impl<'a> Bed<'a> {
    /// Of a tile.
    pub(super) fn new(nursery: &'a Nursery, tier: &'a Tier, tile: TileIndex, share: f32) -> Self {
        let corner = corner_m(nursery.area.grid(), tier.side_m, tile);
        let far = corner + tier.side_m;
        let cells = tier.cells as i32;
        let covers = CLASSES.map(|cover| {
            let dense = density(tier, cover);
            let site = Site::of(cover)?;
            Some(Soil { site, cover, dense, densest: dense * MOST_THICKET[usize::from(cover.is_forest())] })
        });
        Self {
            nursery,
            tier,
            share,
            corner,
            first: [tile.x.wrapping_mul(cells), tile.z.wrapping_mul(cells)],
            covers,
            blur_m: nursery.cover().cell_m() * 0.7,
            noises: NOISES.map(|(side_m, salt)| Lattice::new(corner, far, side_m, salt)),
            clearings: nursery.clearings().near(corner, far),
            lakes: nursery.landscape.lakes.near(corner, far, SHORE_M + 2.0),
        }
    }

    /// All plants, sorted.
    pub(super) fn planted(&self) -> Planted {
        let mut found: Vec<(Plant, u16)> = Vec::new();
        let mut counts = [0u32; LISTS];
        let nothing = Square { conifers_end: 0, end: 0, feet_m: [f32::INFINITY, f32::NEG_INFINITY] };
        let mut squares = vec![nothing; (SQUARES * SQUARES) as usize];
        for row in 0..self.tier.cells {
            for column in 0..self.tier.cells {
                let Some(plant) = self.plant(column, row) else { continue };
                let part = |at: u16| u32::from(at) * SQUARES / 65_536;
                let square = (part(plant.at[1]) * SQUARES + part(plant.at[0])) as usize;
                let feet_m = &mut squares[square].feet_m;
                *feet_m = [feet_m[0].min(plant.height_m), feet_m[1].max(plant.height_m)];
                // Those that leave last come first, so that a part far away is the beginning of its list.
                let leaves = usize::from(!plant.is_conifer()) * 256 + usize::from(u8::MAX - plant.turn);
                let list = square * LISTS_A_SQUARE + leaves;
                counts[list] += 1;
                found.push((plant, list as u16));
            }
        }
        // Where each list begins; then each plant goes to the next free place of its list.
        let mut starts = counts;
        let mut total = 0;
        for (list, start) in starts.iter_mut().enumerate() {
            let square = &mut squares[list / LISTS_A_SQUARE];
            let count = std::mem::replace(start, total);
            total += count;
            if list % LISTS_A_SQUARE < 256 {
                square.conifers_end = total;
            }
            square.end = total;
        }
        let mut plants = vec![Plant::default(); found.len()];
        for (plant, list) in found {
            let place = &mut starts[usize::from(list)];
            plants[*place as usize] = plant;
            *place += 1;
        }
        Planted { plants, squares, took_ms: 0.0 }
    }

    /// The plant of a hash cell.
    #[inline]
    fn plant(&self, column: u32, row: u32) -> Option<Plant> {
        let nursery = self.nursery;
        let cell = |salt: u32| {
            let (x, z) = (self.first[0].wrapping_add(column as i32), self.first[1].wrapping_add(row as i32));
            hash(x, z, self.tier.number * 8 + salt)
        };
        let kinds = cell(1);
        if uniform(kinds[0]) >= self.share {
            return None;
        }
        let places = cell(0);
        // Whole parts: the cell's corner and a share of the cell, in sixteenths of a part.
        let parts = |at: u32, word: u32| (((at << 16) + (word >> 16)) / self.tier.cells).min(65_535) as u16;
        let at = [parts(column, places[0]), parts(row, places[1])];
        let plan = self.corner + DVec2::new(f64::from(at[0]), f64::from(at[1])) * (self.tier.side_m / PARTS);
        let edges = cell(2);
        let off = DVec2::new(f64::from(uniform(edges[0])) - 0.5, f64::from(uniform(edges[1])) - 0.5) * self.blur_m;
        let cover = nursery.cover().class_at(plan.x + off.x, plan.y + off.y);
        let soil = self.covers[cover as usize]?;
        let rank = uniform(places[2]);
        if rank >= soil.densest {
            return None;
        }
        // A ragged edge ends at the water, at sand and at tarmac.
        let here = nursery.cover().class_at(plan.x, plan.y);
        if matches!(here, CoverClass::Water | CoverClass::Sand | CoverClass::Paved) {
            return None;
        }
        let dense = soil.dense * thicket(cover, [0, 1].map(|i: usize| self.noises[i].at(plan)));
        if rank >= dense {
            return None;
        }
        let (height_m, normal) = nursery.area.height_and_normal(plan.x, plan.y)?;
        // Level ground at 0 m is the sea, as the ground map has it.
        if height_m.abs() < SEA_M || rank >= dense * nursery.moisture(soil.cover, height_m as f32) {
            return None;
        }
        let steep = (1.0 - normal.y * normal.y).max(0.0).sqrt() as f32;
        let height_m = height_m as f32;
        let species = nursery.flora.choose(soil.site, height_m, steep, uniform(kinds[1]))?;
        if self.clearings.holds(plan) || (!self.lakes.is_dry() && self.lakes.signed_distance_m(plan) < SHORE_M) {
            return None;
        }
        // Few are the tallest; towards the tree line all stay low.
        let [a, b] = [uniform(kinds[2]), uniform(edges[2])];
        let high = ((height_m / nursery.flora.tree_line_m - 0.8) / 0.3).clamp(0.0, 1.0);
        let grown = (0.5 * a + 0.5 * b) * (1.0 - 0.75 * high);
        let looks = cell(3);
        Some(Plant {
            at,
            height_m,
            species: species as u8,
            size: (grown * 255.0) as u8,
            turn: (looks[0] >> 24) as u8,
            tint: (looks[1] >> 24) as u8,
        })
    }
}

impl Nursery {
    /// Share of the plants that open ground has water for: few in dry lands down low, where streams alone have trees.
    pub(super) fn moisture(&self, cover: CoverClass, height_m: f32) -> f32 {
        let kept = match cover {
            CoverClass::Grass => 0.06,
            CoverClass::Field => 0.25,
            CoverClass::Scrub => 0.5,
            _ => return 1.0,
        };
        let wet = ((height_m / self.flora.tree_line_m - 0.35) * 4.0).clamp(0.0, 1.0);
        1.0 - self.flora.dryness * (1.0 - kept) * (1.0 - wet)
    }
}

/// Share of a tier's cells that hold a plant on a cover.
pub(super) fn density(tier: &Tier, cover: CoverClass) -> f32 {
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

/// Greatest [`thicket`] on open ground and in a forest.
const MOST_THICKET: [f32; 2] = [3.0, 1.0];

/// Forests have glades, open ground has thickets: noises over some 300 and 90 m that spare or drop plants.
pub(super) fn thicket(cover: CoverClass, noises: [f32; 2]) -> f32 {
    let noise = 0.6 * noises[0] + 0.4 * noises[1];
    if cover.is_forest() {
        // Full but for the lowest fifth of the noise.
        ((noise - 0.22) * 6.0).clamp(0.12, MOST_THICKET[1])
    } else {
        // None in most places, dense in few.
        ((noise - 0.42) * 6.0).clamp(0.05, MOST_THICKET[0])
    }
}
