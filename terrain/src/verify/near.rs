//! Within the near radius: what is drawn is the ground, and nothing of it changes while the eye moves.
//!
//! Every block whose nearest point lies within the near radius must be there, with the heights and the triangles that it
//! had when it was first seen; and the drawn surface must be the ground of the queries.

use super::flight::{Flight, Piece};
use super::surface::{Surface, greatest_difference_m};
use crate::block::mesh::TILE;
use crate::grid::{BlockIndex, CELLS};
use crate::ground::Area;
use glam::DVec2;
use std::collections::HashMap;

/// Parts of a cell that places are multiples of: a power of two, so that heights at them are exact in f64 where the post
/// step is a whole number of metres, and the difference from the ground is 0 and not a rounding.
const PARTS: f64 = 32.0;

/// A block's heights, as bits, and its triangles.
type Seen = (Box<[u32]>, Box<[u16]>);

/// Watches a flight; see the module.
pub struct Near {
    /// Heights, triangles or blocks that were not as they were when first seen.
    pub height_changes: u64,
    /// Largest difference from the ground, metres.
    pub max_difference_m: f64,
    /// Places where the drawn surface was compared with the ground.
    pub places: u64,
    /// Blocks looked at, over all looks.
    pub blocks: u64,
    first: HashMap<BlockIndex, Seen>,
    area: Area,
}

impl Near {
    /// Nothing seen yet.
    pub fn new(area: Area) -> Self {
        Self { height_changes: 0, max_difference_m: 0.0, places: 0, blocks: 0, first: HashMap::new(), area }
    }

    /// Looks at all near blocks of a flight from its eye, and compares `places` places in each with the ground.
    pub fn look(&mut self, flight: &Flight, eye: DVec2, places: u32) {
        let radius_m = flight.window().settings().rings.radii_m[0];
        let mut near = 0;
        for draw in flight.draws() {
            if draw.distance_m >= radius_m {
                break;
            }
            near += 1;
            match flight.drawn(&draw) {
                Some(piece) => self.compare(piece, draw.block, places),
                None => self.height_changes += 1,
            }
        }
        self.blocks += near;
        let wanted = self.wanted(eye, radius_m);
        self.height_changes += wanted.abs_diff(near);
    }

    /// Blocks of the world with any ground whose nearest point is nearer than the radius.
    fn wanted(&self, eye: DVec2, radius_m: f64) -> u64 {
        let grid = self.area.grid();
        let (from, to) = (eye - radius_m, eye + radius_m);
        let (first, last) = (grid.block_at(from.x, from.y), grid.block_at(to.x, to.y));
        let mut wanted = 0;
        // One more on each side: the distance decides, not a rounding.
        for z in (first.z - 1).max(0)..=(last.z + 1).min(grid.blocks_z as i32 - 1) {
            for x in (first.x - 1).max(0)..=(last.x + 1).min(grid.blocks_x as i32 - 1) {
                let block = BlockIndex { x, z };
                let near = grid.distance_to_block_m(eye.x, eye.y, block) < radius_m;
                wanted += u64::from(near && self.has_ground(block));
            }
        }
        wanted
    }

    fn has_ground(&self, block: BlockIndex) -> bool {
        let (column, row, cells) = (block.first_column(), block.first_row(), i64::from(CELLS));
        (0..=cells).any(|r| (0..=cells).any(|c| !self.area.field().post_m(column + c, row + r).is_nan()))
    }

    fn compare(&mut self, piece: Piece<'_>, block: BlockIndex, places: u32) {
        let (first_column, first_row) = (block.first_column(), block.first_row());
        if piece.block != block {
            self.height_changes += 1;
            return;
        }
        match self.first.get(&block) {
            Some((bits, indices)) => {
                let changed = bits.iter().zip(piece.heights_m).filter(|(bits, h)| **bits != h.to_bits()).count();
                self.height_changes += changed as u64 + u64::from(**indices != *piece.indices);
            }
            None => {
                let bits = piece.heights_m.iter().map(|h| h.to_bits()).collect();
                self.first.insert(block, (bits, piece.indices.into()));
                // A block that is seen for the first time has all triangles of the ground, and the posts, apron included.
                let (drawn, ground) = (Surface::of(piece.indices, piece.heights_m), Surface::ground(piece.heights_m));
                self.max_difference_m = self.max_difference_m.max(greatest_difference_m(&drawn, &ground));
                for (at, height_m) in piece.heights_m.iter().enumerate() {
                    let (column, row) = (at as i64 % i64::from(TILE), at as i64 / i64::from(TILE));
                    let post_m = self.area.field().post_m(first_column + column, first_row + row);
                    let known = |h: f32| Some(f64::from(h)).filter(|h| !h.is_nan());
                    self.differ(known(*height_m), known(post_m));
                }
            }
        }
        if places == 0 {
            return;
        }
        let surface = Surface::of(piece.indices, piece.heights_m);
        let grid = *self.area.grid();
        for _ in 0..places {
            // Steps of the plastic number's powers fill a square evenly (M. Roberts, 2018).
            let turn = self.places as f64 + 0.5;
            let place = DVec2::new(turn * 0.754_877_666_246_692_7, turn * 0.569_840_290_998_053_2).fract_gl();
            // Never on a cell's side: on the rim of a void, sides belong to whoever is asked.
            let place = ((place * f64::from(CELLS) * PARTS).floor() + 0.5) / PARTS;
            let (x_m, z_m) =
                (grid.x_m(first_column) + place.x * grid.step_m, grid.z_m(first_row) + place.y * grid.step_m);
            self.differ(surface.height_m(place), self.area.height_m(x_m, z_m));
            self.places += 1;
        }
    }

    fn differ(&mut self, drawn_m: Option<f64>, ground_m: Option<f64>) {
        let difference_m = match (drawn_m, ground_m) {
            (Some(drawn_m), Some(ground_m)) => (drawn_m - ground_m).abs(),
            (None, None) => 0.0,
            _ => f64::INFINITY,
        };
        self.max_difference_m = self.max_difference_m.max(difference_m);
    }
}
