//! Photographs of the ground, as the ground map uses them.
//!
//! A photograph speaks within its own resolution. Where its pixels are about as fine as a texel of the ground map or
//! finer it *replaces* the ground's colour: texels block by block, deflated. Where they are coarser it only *tints*: a
//! grid of factors, as far apart as its pixels are wide, that brings the mean colour of the ground by rule to the
//! photograph's and leaves its detail. Water keeps its own colours in both.
//!
//! Frame: [`crate::frame`]. Invariant: `blocks` has one entry for each block of the grid, or none at all.

use crate::block::ground_map::SIDE;
use crate::grid::{BlockIndex, Grid};
use flate2::Compression;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use serde::{Deserialize, Serialize};
use std::io::{self, Read, Write};

/// Bytes of a block's texels: square roots of the linear albedo, and the share of the texel that a photograph shows.
pub const BLOCK_BYTES: usize = (SIDE * SIDE * 4) as usize;

/// Most nodes along a side of the grid of factors.
pub const MAX_NODES: u32 = 4_096;

/// Factors are powers of two, 64 steps to an octave; 128 is 1.
const STEPS_PER_OCTAVE: f32 = 64.0;

/// What photographs say of a world's ground.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Imagery {
    /// Deflated texels of each block, row by row; empty where no photograph is fine enough.
    blocks: Vec<Vec<u8>>,
    /// Factors from photographs that are coarser.
    tint: Option<Tint>,
}

/// Factors on a grid of nodes whose first lies at the world's north-west corner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tint {
    /// Between nodes, metres.
    pub spacing_m: f64,
    /// Nodes from west to east.
    pub columns: u32,
    /// Nodes from north to south.
    pub rows: u32,
    /// Red, green, blue of each node, row by row.
    pub nodes: Vec<[u8; 3]>,
}

impl Imagery {
    /// Of a grid's blocks, row by row: texels of [`BLOCK_BYTES`], or none where no photograph is fine enough.
    ///
    /// # Errors
    /// What the packing reports.
    pub fn new(blocks: Vec<Option<Vec<u8>>>, tint: Option<Tint>) -> io::Result<Self> {
        let pack = |texels: Option<Vec<u8>>| {
            let Some(texels) = texels else { return Ok(Vec::new()) };
            let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(&texels)?;
            encoder.finish()
        };
        let any = blocks.iter().any(Option::is_some);
        let blocks = if any { blocks.into_iter().map(pack).collect::<io::Result<_>>()? } else { Vec::new() };
        Ok(Self { blocks, tint })
    }

    /// Whether it fits a grid.
    pub fn fits(&self, grid: &Grid) -> bool {
        let blocks = u64::from(grid.blocks_x) * u64::from(grid.blocks_z);
        let tint = self.tint.as_ref().is_none_or(|tint| {
            tint.spacing_m.is_finite()
                && tint.spacing_m > 0.0
                && (2..=MAX_NODES).contains(&tint.columns)
                && (2..=MAX_NODES).contains(&tint.rows)
                && u64::from(tint.columns) * u64::from(tint.rows) == tint.nodes.len() as u64
        });
        tint && (self.blocks.is_empty() || self.blocks.len() as u64 == blocks)
    }

    /// Texels of a block, if a photograph replaces any of them.
    pub fn texels(&self, grid: &Grid, block: BlockIndex) -> Option<Vec<u8>> {
        let inside = (0..grid.blocks_x as i32).contains(&block.x) && (0..grid.blocks_z as i32).contains(&block.z);
        let at = inside.then(|| block.z as usize * grid.blocks_x as usize + block.x as usize)?;
        let packed = self.blocks.get(at).filter(|packed| !packed.is_empty())?;
        let mut texels = Vec::with_capacity(BLOCK_BYTES);
        DeflateDecoder::new(packed.as_slice()).take(BLOCK_BYTES as u64).read_to_end(&mut texels).ok()?;
        (texels.len() == BLOCK_BYTES).then_some(texels)
    }

    /// Factors of a place's albedo.
    pub fn factors(&self, grid: &Grid, x_m: f64, z_m: f64) -> [f32; 3] {
        let Some(tint) = &self.tint else { return [1.0; 3] };
        let place = |at_m: f64, nodes: u32| {
            let at = (at_m / tint.spacing_m).clamp(0.0, f64::from(nodes - 1));
            let first = (at as u32).min(nodes - 2);
            (first as usize, (at - f64::from(first)) as f32)
        };
        let (column, east) = place(x_m - grid.west_m, tint.columns);
        let (row, south) = place(z_m - grid.north_m, tint.rows);
        std::array::from_fn(|channel| {
            let node = |dc: usize, dr: usize| {
                let at = (row + dr) * tint.columns as usize + column + dc;
                f32::from(tint.nodes.get(at).map_or(128, |node| node[channel]))
            };
            let (north, below) =
                (node(0, 0) + east * (node(1, 0) - node(0, 0)), node(0, 1) + east * (node(1, 1) - node(0, 1)));
            ((north + south * (below - north) - 128.0) / STEPS_PER_OCTAVE).exp2()
        })
    }
}

/// A factor as a node has it: at most 1.5 octaves either way.
pub fn packed_factor(factor: f64) -> u8 {
    let octaves = if factor > 0.0 { factor.log2().clamp(-1.5, 1.5) } else { 0.0 };
    (128.0 + octaves * f64::from(STEPS_PER_OCTAVE)).round() as u8
}
