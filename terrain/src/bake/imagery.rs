//! Photographs onto the ground map's texels, or into factors where they are too coarse for that.
//!
//! The finest counts where several lie over a texel. What is meant by too coarse: a pixel wider than one and a half
//! texels (143 m at a step of 200 m).

use super::mosaic::{bounds_m, pixel_m};
use super::photo::Photo;
use crate::block::ground_map::{self, Climate, Dress, MAP_BYTES, SIDE};
use crate::features::by_block::StripsByBlock;
use crate::features::imagery::{BLOCK_BYTES, Imagery, MAX_NODES, Tint, packed_factor};
use crate::grid::{BlockIndex, Grid};
use crate::projection::Projection;
use crate::store::World;
use glam::DVec2;
use rayon::prelude::*;

/// Widest pixel that still replaces, in texels.
const FINE_TEXELS: f64 = 1.5;

/// Most samples along a texel's side.
const MAX_TAPS: u32 = 6;

/// A photograph ready to be asked.
struct Sheet<'a> {
    photo: &'a Photo,
    pixel_m: f64,
    low: DVec2,
    high: DVec2,
}

/// What photographs say of a world's ground; `None` if they lie elsewhere.
pub(super) fn imagery(world: &World, climate: &Climate, photos: &[Photo]) -> Option<Imagery> {
    let grid = world.field.grid();
    let texel_m = grid.block_m() / f64::from(SIDE - 1);
    let world_high = DVec2::new(grid.east_m(), grid.south_m());
    let mut sheets: Vec<Sheet> = photos
        .iter()
        .map(|photo| {
            let (low, high) = bounds_m(&world.projection, &photo.place);
            Sheet { photo, pixel_m: pixel_m(&world.projection, &photo.place).element_product().sqrt(), low, high }
        })
        .filter(|sheet| {
            sheet.low.cmple(world_high).all() && sheet.high.cmpge(DVec2::new(grid.west_m, grid.north_m)).all()
        })
        .collect();
    sheets.sort_by(|a, b| a.pixel_m.total_cmp(&b.pixel_m));
    let (fine, coarse): (Vec<Sheet>, Vec<Sheet>) =
        sheets.into_iter().partition(|sheet| sheet.pixel_m <= FINE_TEXELS * texel_m);
    if fine.is_empty() && coarse.is_empty() {
        return None;
    }
    let blocks: Vec<BlockIndex> = grid.blocks().collect();
    let texels = blocks.par_iter().map(|block| block_texels(grid, &world.projection, *block, &fine)).collect();
    let tint = (!coarse.is_empty()).then(|| tint(world, climate, &blocks, &coarse));
    Imagery::new(texels, tint).ok()
}

/// Texels of a block under the fine sheets.
fn block_texels(grid: &Grid, projection: &Projection, block: BlockIndex, sheets: &[Sheet]) -> Option<Vec<u8>> {
    let corner = DVec2::new(grid.x_m(block.first_column()), grid.z_m(block.first_row()));
    let side_m = grid.block_m();
    let texel_m = side_m / f64::from(SIDE - 1);
    let mut texels = vec![0; BLOCK_BYTES];
    let mut any = false;
    // The coarser first: the finer lie over them.
    for sheet in sheets.iter().rev() {
        if sheet.low.cmpgt(corner + side_m + texel_m).any() || sheet.high.cmplt(corner - texel_m).any() {
            continue;
        }
        let inverse = sheet.photo.place.inverse();
        let pixel = |at: DVec2| sheet.photo.place.pixel(&inverse, projection.to_geodetic(at));
        let taps = ((texel_m / sheet.pixel_m).ceil() as u32).clamp(1, MAX_TAPS);
        for row in 0..SIDE {
            for column in 0..SIDE {
                let middle = corner + texel_m * DVec2::new(f64::from(column), f64::from(row));
                let (at, east, south) = {
                    let at = pixel(middle);
                    (at, pixel(middle + DVec2::X * texel_m) - at, pixel(middle + DVec2::Y * texel_m) - at)
                };
                let (mut sum, mut seen) = ([0.0_f32; 3], 0_u32);
                for tap in 0..taps * taps {
                    let part = |k: u32| (f64::from(k) + 0.5) / f64::from(taps) - 0.5;
                    if let Some(colour) = sheet.albedo(at + part(tap % taps) * east + part(tap / taps) * south) {
                        sum = std::array::from_fn(|c| sum[c] + colour[c]);
                        seen += 1;
                    }
                }
                if seen > 0 {
                    any = true;
                    let share = seen as f32 / (taps * taps) as f32;
                    let to = &mut texels[((row * SIDE + column) * 4) as usize..][..4];
                    let before = f32::from(to[3]) / 255.0;
                    for channel in 0..3 {
                        let new = (sum[channel] / seen as f32).sqrt() * 255.0;
                        // What a coarser sheet has already put there shows through where the finer has nothing.
                        let old = if before > 0.0 { f32::from(to[channel]) } else { new };
                        to[channel] = (old + share * (new - old)).round() as u8;
                    }
                    to[3] = (before.max(share) * 255.0).round() as u8;
                }
            }
        }
    }
    any.then_some(texels)
}

impl Sheet<'_> {
    /// Linear colour at pixel coordinates, bilinear between pixel centres; `None` outside and where nothing is shown.
    fn albedo(&self, pixel: DVec2) -> Option<[f32; 3]> {
        let place = &self.photo.place;
        let (columns, rows) = (place.columns as i64, place.rows as i64);
        if !(pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < columns as f64 && pixel.y < rows as f64) {
            return None;
        }
        let (u, v) = (pixel.x - 0.5, pixel.y - 0.5);
        let (east, south) = ((u - u.floor()) as f32, (v - v.floor()) as f32);
        let (mut sum, mut weight) = ([0.0_f32; 3], 0.0);
        for (dc, dr, w) in [
            (0, 0, (1.0 - east) * (1.0 - south)),
            (1, 0, east * (1.0 - south)),
            (0, 1, (1.0 - east) * south),
            (1, 1, east * south),
        ] {
            let column = (u.floor() as i64 + dc).clamp(0, columns - 1);
            let row = (v.floor() as i64 + dr).clamp(0, rows - 1);
            let [r, g, b, a] = self.photo.pixels[(row * columns + column) as usize];
            if a >= 128 {
                sum = std::array::from_fn(|c| sum[c] + w * linear([r, g, b][c]));
                weight += w;
            }
        }
        (weight >= 0.5).then(|| sum.map(|c| c / weight))
    }
}

/// Linear light of an sRGB byte (IEC 61966-2-1).
fn linear(byte: u8) -> f32 {
    let c = f32::from(byte) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Factors that bring the mean of the ground by rule to that of coarse sheets.
fn tint(world: &World, climate: &Climate, blocks: &[BlockIndex], sheets: &[Sheet]) -> Tint {
    let grid = world.field.grid();
    let (width_m, height_m) = (grid.east_m() - grid.west_m, grid.south_m() - grid.north_m);
    let finest_m = sheets.iter().map(|sheet| sheet.pixel_m).fold(f64::INFINITY, f64::min);
    let spacing_m = finest_m.max(width_m.max(height_m) / f64::from(MAX_NODES - 2));
    let nodes = |length_m: f64| (length_m / spacing_m).ceil() as u32 + 1;
    let (columns, rows) = (nodes(width_m).max(2), nodes(height_m).max(2));
    let strips = StripsByBlock::new(grid, &world.features);
    // Each block's share in the means of the nodes about it, in the order of blocks: the same whatever the threads.
    let parts: Vec<Vec<(usize, [f64; 4])>> = blocks
        .par_iter()
        .map(|&block| {
            let dress = Dress { cover: &world.cover, strips: strips.of(block), imagery: None };
            let near = world.lakes.near(
                DVec2::new(grid.x_m(block.first_column()), grid.z_m(block.first_row())),
                DVec2::new(grid.x_m(block.first_column()), grid.z_m(block.first_row())) + grid.block_m(),
                ground_map::SHORE_RAMP_M * 2.0,
            );
            let shore_m = |x_m: f64, z_m: f64| near.signed_distance_m(DVec2::new(x_m, z_m));
            let sea_known = |x_m: f64, z_m: f64| near.knows_the_sea(DVec2::new(x_m, z_m));
            let map = ground_map::ground_map(&world.field, block, climate, &dress, &shore_m, &sea_known);
            let mut sums: std::collections::BTreeMap<usize, [f64; 4]> = std::collections::BTreeMap::new();
            for (at, texel) in map[..MAP_BYTES].chunks_exact(4).enumerate().filter(|(_, texel)| texel[3] <= 127) {
                let part = |i: usize| i as f64 * grid.block_m() / f64::from(SIDE - 1);
                let x = (grid.x_m(block.first_column()) - grid.west_m + part(at % SIDE as usize)) / spacing_m;
                let z = (grid.z_m(block.first_row()) - grid.north_m + part(at / SIDE as usize)) / spacing_m;
                let node = (z.round() as usize).min(rows as usize - 1) * columns as usize
                    + (x.round() as usize).min(columns as usize - 1);
                let sum = sums.entry(node).or_default();
                for channel in 0..3 {
                    sum[channel] += (f64::from(texel[channel]) / 255.0).powi(2);
                }
                sum[3] += 1.0;
            }
            sums.into_iter().collect()
        })
        .collect();
    let mut means = vec![[0.0; 4]; (columns * rows) as usize];
    for (node, sum) in parts.into_iter().flatten() {
        means[node] = std::array::from_fn(|c| means[node][c] + sum[c]);
    }
    let node = |at: usize| {
        let place = DVec2::new((at % columns as usize) as f64, (at / columns as usize) as f64) * spacing_m;
        let place = world.projection.to_geodetic(DVec2::new(grid.west_m, grid.north_m) + place);
        let shown = sheets.iter().find_map(|sheet| {
            let inverse = sheet.photo.place.inverse();
            sheet.albedo(sheet.photo.place.pixel(&inverse, place))
        });
        let [.., number] = means[at];
        match shown {
            Some(colour) if number > 0.0 => {
                std::array::from_fn(|c| packed_factor(f64::from(colour[c]) * number / means[at][c].max(1e-9)))
            }
            _ => [128; 3],
        }
    };
    Tint { spacing_m, columns, rows, nodes: (0..(columns * rows) as usize).into_par_iter().map(node).collect() }
}
