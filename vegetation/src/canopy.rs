//! The closed forest: a surface over the crowns, where single trees are too many to draw.
//!
//! A tile is [`CELLS`] x [`CELLS`] cells on the lattice of the posts, each cut as the ground is from south-west to north-east.
//! Where posts are more than 50 m apart a cell is no larger than the posts', so the canopy follows the ground and never dips
//! below it. With closer posts a cell spans two and more of them, asks the ground at its corners alone, and rough ground
//! between them may come nearer to the canopy or stand out of it. Over a corner it stands as high as most trees do (two
//! thirds of theirs, so that trees rise from it) times the share of forest around; where there is none it comes down to the ground.
//!
//! Invariant: a tile is a function of the world and the tile alone; neighbours agree on their border.

use crate::noise::noise;
use crate::place::{Nursery, corner_m};
use crate::species::Site;
use glam::DVec2;
use terrain::Grid;
use terrain::features::cover::CoverClass;
use terrain::near::TileIndex;

/// Cells along a tile.
pub const CELLS: u32 = 60;

/// Stems a hectare that the closed forest stands for. The Swiss National Forest Inventory counts 500 to 550 million stems
/// of 12 cm and more on 1.2 million hectares of accessible forest, some 430 a hectare; mountain forests are thinner.
pub const STEMS_PER_HA: f64 = 400.0;

/// Height of the canopy over closed forest, metres: two thirds of a tree of the upper half.
const HIGH_M: [f32; 3] = [14.0, 13.0, 13.5];

/// A corner of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    /// Cells east and south of the tile's corner.
    pub at: [u16; 2],
    /// The ground, metres above sea level.
    pub ground_m: f32,
    /// Of the canopy above the ground, metres.
    pub high_m: f32,
    /// Share of forest around, share of conifers in it, a shade: 0..=255.
    pub looks: [u8; 4],
}

/// A tile's surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Canopy {
    /// Corners that triangles have.
    pub corners: Vec<Corner>,
    /// Triangles, counter-clockwise from above.
    pub indices: Vec<u16>,
    /// Least and greatest height, metres above sea level.
    pub range_m: [f32; 2],
    /// Stems that it stands for.
    pub stands_for: f64,
}

/// Side of a canopy cell over a grid, metres: a whole part of a post step or a whole number of steps, near 100 m.
pub fn cell_m(grid: &Grid) -> f64 {
    let step = grid.step_m;
    if step >= 100.0 { step / (step / 100.0).round() } else { step * (100.0 / step).floor() }
}

/// Side of a canopy tile, metres.
pub fn side_m(grid: &Grid) -> f64 {
    cell_m(grid) * f64::from(CELLS)
}

/// The surface of a tile.
pub fn canopy(nursery: &Nursery, tile: TileIndex) -> Canopy {
    let grid = *nursery.area().grid();
    let (cell_m, corner) = (cell_m(&grid), corner_m(&grid, side_m(&grid), tile));
    let side = CELLS as usize + 1;
    // Forest in the cells, one more around.
    let wide = side + 1;
    let cover = nursery.cover();
    let kind = |column: usize, row: usize| {
        let at = corner + (DVec2::new(column as f64, row as f64) - 0.5) * cell_m;
        let class = cover.class_at(at.x, at.y);
        if class.is_forest() { Some(class) } else { None }
    };
    let kinds: Vec<Option<CoverClass>> = (0..wide * wide).map(|i| kind(i % wide, i / wide)).collect();
    if kinds.iter().all(Option::is_none) {
        return Canopy::default();
    }
    let tree_line_m = nursery.flora().tree_line_m;
    let mut corners = Vec::with_capacity(side * side);
    for row in 0..side {
        for column in 0..side {
            let around = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dc, dr)| kinds[(row + dr) * wide + column + dc]);
            let forest = around.iter().flatten().count();
            let at = corner + DVec2::new(column as f64, row as f64) * cell_m;
            let ground_m = nursery.area().height_m(at.x, at.y).map_or(f32::NAN, |height| height as f32);
            let conifers: u32 = around.iter().flatten().map(|class| conifers(*class)).sum();
            let conifers = if forest == 0 { 0 } else { conifers / forest as u32 };
            // Only whole forest stands at its height: edges slope down within a cell.
            let share = [0.0, 0.05, 0.2, 0.55, 1.0][forest];
            let low = ((ground_m / tree_line_m - 0.8) / 0.3).clamp(0.0, 1.0);
            let tall =
                HIGH_M[if conifers > 170 { Site::Conifer } else { Site::Broadleaf } as usize] * (1.0 - 0.6 * low);
            // Stands differ over some 600 and 200 m.
            let shade = 0.55 * noise(at / 610.0, 61) + 0.45 * noise(at / 190.0, 62);
            let looks = [(forest * 255 / 4) as u8, conifers.min(255) as u8, (shade * 255.0) as u8, 0];
            corners.push(Corner { at: [column as u16, row as u16], ground_m, high_m: share * tall, looks });
        }
    }
    let mut made = Canopy { range_m: [f32::INFINITY, f32::NEG_INFINITY], ..Canopy::default() };
    let mut numbers = vec![u16::MAX; side * side];
    let mut area_m2 = 0.0;
    for row in 0..side - 1 {
        for column in 0..side - 1 {
            let [nw, ne] = [0, 1].map(|dc| row * side + column + dc);
            let [sw, se] = [nw + side, ne + side];
            for triangle in [[nw, sw, ne], [sw, se, ne]] {
                let whole = triangle.iter().all(|i| !corners[*i].ground_m.is_nan());
                if !whole || triangle.iter().all(|i| corners[*i].looks[0] == 0) {
                    continue;
                }
                area_m2 +=
                    0.5 * cell_m * cell_m * triangle.iter().map(|i| f64::from(corners[*i].looks[0])).sum::<f64>()
                        / 765.0;
                for index in triangle {
                    if numbers[index] == u16::MAX {
                        numbers[index] = made.corners.len() as u16;
                        let corner = corners[index];
                        made.range_m[0] = made.range_m[0].min(corner.ground_m);
                        made.range_m[1] = made.range_m[1].max(corner.ground_m + corner.high_m);
                        made.corners.push(corner);
                    }
                    made.indices.push(numbers[index]);
                }
            }
        }
    }
    made.stands_for = area_m2 * 1e-4 * STEMS_PER_HA;
    made
}

fn conifers(class: CoverClass) -> u32 {
    match class {
        CoverClass::Conifer => 255,
        CoverClass::MixedForest => 128,
        _ => 0,
    }
}
