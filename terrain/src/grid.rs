//! Where posts, cells and blocks lie.
//!
//! Frame: X east, Z south, metres, origin at the world's centre. Row 0 is the northernmost, as in a raster, so a row is
//! +Z and a column +X and no axis is ever flipped. A *post* is a height sample, a *cell* the square between four posts,
//! a *block* [`CELLS`] x [`CELLS`] cells. Neighbouring blocks share the posts of their border.
//!
//! Invariant others rely on: a grid is a whole number of blocks, and a post's position is `origin + index * step` with
//! one rounding, so two blocks that share a post agree on where it is to the bit.

use std::fmt;

/// Cells along a block's side. Even, so that 2 x 2 cells make a sub-block. Tests also run 32 (feature `cells32`).
pub const CELLS: u32 = if cfg!(feature = "cells32") { 32 } else { 30 };

/// Posts along a block's side.
pub const POSTS: u32 = CELLS + 1;

/// Most posts a grid may have along a side: 400 km at 25 m and then some; a post index stays exact in an f32.
pub const MAX_POSTS_PER_SIDE: u32 = 1 << 15;

/// A regular grid of posts that is whole blocks in both directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// X of column 0, metres.
    pub west_m: f64,
    /// Z of row 0, metres.
    pub north_m: f64,
    /// Distance between neighbouring posts, metres.
    pub step_m: f64,
    /// Blocks from west to east.
    pub blocks_x: u32,
    /// Blocks from north to south.
    pub blocks_z: u32,
}

/// A block's place in the grid; may lie outside it, as a window near the world's edge does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BlockIndex {
    /// Blocks from the west edge.
    pub x: i32,
    /// Blocks from the north edge.
    pub z: i32,
}

/// A rectangle of posts, `columns` x `rows` from (`column`, `row`); may reach beyond the grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PostRect {
    /// First column.
    pub column: i64,
    /// First row.
    pub row: i64,
    /// Posts from west to east.
    pub columns: u32,
    /// Posts from north to south.
    pub rows: u32,
}

/// Why a grid cannot be made.
#[derive(Debug, Clone, PartialEq)]
pub enum GridError {
    /// The step is not within 1..=10,000 m.
    Step(f64),
    /// No block, or more posts along a side than [`MAX_POSTS_PER_SIDE`].
    Blocks(u32, u32),
    /// The origin is not finite.
    Origin(f64, f64),
}

impl fmt::Display for GridError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Step(step_m) => write!(f, "a post step must be within 1..=10000 m, got {step_m}"),
            Self::Blocks(x, z) => write!(
                f,
                "a world needs 1..={} blocks along each side, got {x} x {z}",
                (MAX_POSTS_PER_SIDE - 1) / CELLS
            ),
            Self::Origin(x, z) => write!(f, "a grid's origin must be finite, got ({x}, {z})"),
        }
    }
}

impl std::error::Error for GridError {}

impl Grid {
    /// A grid of `blocks_x` x `blocks_z` blocks centred on the origin.
    ///
    /// # Errors
    /// [`GridError`] names the number that is out of range.
    pub fn centred(step_m: f64, blocks_x: u32, blocks_z: u32) -> Result<Self, GridError> {
        let half = 0.5 * step_m * f64::from(CELLS);
        let (west_m, north_m) = (-half * f64::from(blocks_x), -half * f64::from(blocks_z));
        Self { west_m, north_m, step_m, blocks_x, blocks_z }.checked()
    }

    /// The grid itself if its numbers are within range.
    ///
    /// # Errors
    /// [`GridError`] names the number that is out of range.
    pub fn checked(self) -> Result<Self, GridError> {
        if !(1.0..=10_000.0).contains(&self.step_m) {
            return Err(GridError::Step(self.step_m));
        }
        let most = (MAX_POSTS_PER_SIDE - 1) / CELLS;
        if !(1..=most).contains(&self.blocks_x) || !(1..=most).contains(&self.blocks_z) {
            return Err(GridError::Blocks(self.blocks_x, self.blocks_z));
        }
        if !self.west_m.is_finite() || !self.north_m.is_finite() {
            return Err(GridError::Origin(self.west_m, self.north_m));
        }
        Ok(self)
    }

    /// Posts from west to east.
    pub fn columns(&self) -> u32 {
        self.blocks_x * CELLS + 1
    }

    /// Posts from north to south.
    pub fn rows(&self) -> u32 {
        self.blocks_z * CELLS + 1
    }

    /// Number of posts.
    pub fn posts(&self) -> usize {
        self.columns() as usize * self.rows() as usize
    }

    /// X of a column, metres.
    pub fn x_m(&self, column: i64) -> f64 {
        self.west_m + column as f64 * self.step_m
    }

    /// Z of a row, metres.
    pub fn z_m(&self, row: i64) -> f64 {
        self.north_m + row as f64 * self.step_m
    }

    /// X of the east edge, metres.
    pub fn east_m(&self) -> f64 {
        self.x_m(i64::from(self.columns()) - 1)
    }

    /// Z of the south edge, metres.
    pub fn south_m(&self) -> f64 {
        self.z_m(i64::from(self.rows()) - 1)
    }

    /// Side of a block, metres.
    pub fn block_m(&self) -> f64 {
        self.step_m * f64::from(CELLS)
    }

    /// The block that holds the point, also beyond the edge. Saturates where `i32` ends.
    pub fn block_at(&self, x_m: f64, z_m: f64) -> BlockIndex {
        BlockIndex {
            x: ((x_m - self.west_m) / self.block_m()).floor() as i32,
            z: ((z_m - self.north_m) / self.block_m()).floor() as i32,
        }
    }

    /// Whether the block is one of the grid's.
    pub fn contains_block(&self, block: BlockIndex) -> bool {
        (0..self.blocks_x as i32).contains(&block.x) && (0..self.blocks_z as i32).contains(&block.z)
    }

    /// All blocks, row by row from the north-west.
    pub fn blocks(&self) -> impl Iterator<Item = BlockIndex> + use<> {
        let (width, height) = (self.blocks_x as i32, self.blocks_z as i32);
        (0..height).flat_map(move |z| (0..width).map(move |x| BlockIndex { x, z }))
    }

    /// Place of a block in an array of one entry a block, row by row; `None` outside the grid.
    pub fn block_number(&self, block: BlockIndex) -> Option<usize> {
        self.contains_block(block).then(|| block.z as usize * self.blocks_x as usize + block.x as usize)
    }

    /// Plan distance from a point to the block's nearest point, metres; 0 inside.
    pub fn distance_to_block_m(&self, x_m: f64, z_m: f64, block: BlockIndex) -> f64 {
        let side = self.block_m();
        let west = self.west_m + f64::from(block.x) * side;
        let north = self.north_m + f64::from(block.z) * side;
        let dx = (west - x_m).max(x_m - (west + side)).max(0.0);
        let dz = (north - z_m).max(z_m - (north + side)).max(0.0);
        // Not hypot: its care for overflow costs more than all the rest, and a world is small.
        (dx * dx + dz * dz).sqrt()
    }
}

impl BlockIndex {
    /// Column of the block's western posts.
    pub fn first_column(self) -> i64 {
        i64::from(self.x) * i64::from(CELLS)
    }

    /// Row of the block's northern posts.
    pub fn first_row(self) -> i64 {
        i64::from(self.z) * i64::from(CELLS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_centred_grid_is_symmetric_and_whole() {
        let grid = Grid::centred(200.0, 67, 3).unwrap();
        assert_eq!((grid.columns(), grid.rows()), (67 * CELLS + 1, 3 * CELLS + 1));
        assert_eq!((grid.west_m, grid.north_m), (-grid.east_m(), -grid.south_m()));
        if CELLS == 30 {
            assert_eq!((grid.columns(), grid.east_m(), grid.south_m()), (2011, 201_000.0, 9_000.0));
        }
        assert_eq!(grid.blocks().count(), 201);
        for (number, block) in grid.blocks().enumerate() {
            assert_eq!(grid.block_number(block), Some(number));
        }
    }

    #[test]
    fn block_distance_is_to_the_nearest_point() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let block = BlockIndex { x: 1, z: 1 };
        assert_eq!(grid.distance_to_block_m(10.0, 10.0, block), 0.0);
        assert_eq!(grid.distance_to_block_m(-30.0, -40.0, block), 50.0);
        assert_eq!(grid.distance_to_block_m(grid.east_m() + 100.0, 100.0, block), 100.0);
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        assert_eq!(Grid::centred(0.0, 1, 1), Err(GridError::Step(0.0)));
        assert!(matches!(Grid::centred(f64::NAN, 1, 1), Err(GridError::Step(_))));
        assert_eq!(Grid::centred(200.0, 0, 1), Err(GridError::Blocks(0, 1)));
        assert!(matches!(Grid::centred(200.0, 1, 5000), Err(GridError::Blocks(1, 5000))));
    }
}
