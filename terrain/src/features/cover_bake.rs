//! The cover of a world, at bake: by rule, then what files say burnt in.
//!
//! Order, each over those before: the rules of [`super::cover_rules`], areas from the largest to the smallest, built-up
//! ground where buildings stand close, lakes, airfields (mown strips, then what is paved). A cell belongs to an area if
//! its centre is inside by the even-odd rule. Roads and running water do not burn in: a cell is far wider than they.
//! What a file decides carries [`FROM_FEATURES`].
//!
//! The raster is cut into bands of block rows; every band is made alone, so the result does not depend on threads.

use super::cover::{CLASSES, Cover, CoverClass, FROM_FEATURES};
use super::cover_rules::{Climate, belts, sea_m, site_at, sites};
use super::lakes::{Lakes, bounds_m, crossing_x, edges};
use super::model::{Airfield, Building, Features, LandArea, Runway, RunwaySurface};
use crate::field::Field;
use crate::grid::{BlockIndex, CELLS, Grid};
use crate::store::CoverInfo;
use glam::DVec2;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Width of a cell that is aimed at, metres.
const CELL_M: f64 = 50.0;

/// Cells that a world has at most, as long as a post step holds at least one.
const MAX_CELLS: u64 = 20_000_000;

/// How far from water the rules ask for it, metres.
const SHORE_REACH_M: f64 = 5_000.0;

/// Share of the ground under roofs from which it counts as built up: a street of houses in gardens.
const BUILT_UP_SHARE: f32 = 0.05;

/// Half the width of the mown strip of a runway for jets, metres (ICAO Annex 14, code numbers 3 and 4), of others, and how far it
/// goes beyond the thresholds.
const STRIP_M: f64 = 140.0;
const SMALL_STRIP_M: f64 = 40.0;
const STRIP_BEYOND_M: f64 = 60.0;

/// Cells along a post step of a world.
pub fn cells_per_step(grid: &Grid) -> u32 {
    let cells = u64::from(grid.columns() - 1) * u64::from(grid.rows() - 1);
    let most = (MAX_CELLS / cells.max(1)).isqrt().max(1) as u32;
    ((grid.step_m / CELL_M).round() as u32).clamp(1, most)
}

/// The cover of a world.
pub fn bake_cover(field: &Field, lakes: &Lakes, features: &Features, climate: &Climate) -> Cover {
    let grid = field.grid();
    let per_step = cells_per_step(grid);
    let raster = Raster::new(grid, per_step);
    let mut cells = vec![0; raster.columns * raster.rows];
    let band_rows = (CELLS * per_step) as usize;
    let areas = by_size(&features.areas);
    let built_up = BuiltUp::new(&raster, &features.buildings);
    cells.par_chunks_mut(raster.columns * band_rows).enumerate().for_each(|(number, cells)| {
        by_rule(field, lakes, climate, number as u32, per_step, cells);
        let mut band = Band { raster: &raster, first_row: number * band_rows, cells };
        for area in &areas {
            band.fill(&area.rings, area.cover);
        }
        band.build_up(&built_up);
        for lake in lakes.lakes() {
            band.fill(&lake.rings, CoverClass::Water);
        }
        for airfield in &features.airfields {
            band.lay(airfield);
        }
    });
    Cover::new(grid, per_step, cells).unwrap_or_else(|| Cover::unknown(grid))
}

/// What a cover is made of, for a world's description; `None` if nothing is known.
pub fn described(cover: &Cover) -> Option<CoverInfo> {
    let counts = cover.cells().par_chunks(1 << 16).map(|cells| {
        cells.iter().fold([0_u64; 256], |mut counts, cell| {
            counts[usize::from(*cell)] += 1;
            counts
        })
    });
    let counts = counts.reduce(|| [0; 256], |a, b| std::array::from_fn(|i| a[i] + b[i]));
    let marked = usize::from(FROM_FEATURES);
    let known = counts.iter().sum::<u64>() - counts[0];
    if known == 0 {
        return None;
    }
    let known = known as f64;
    let share = |class: CoverClass| (counts[class as usize] + counts[marked + class as usize]) as f64 / known;
    let shares = CLASSES[1..].iter().map(|class| (format!("{class:?}"), share(*class)));
    Some(CoverInfo {
        cell_m: cover.cell_m(),
        from_features: counts[marked..].iter().sum::<u64>() as f64 / known,
        shares: shares.filter(|(_, share)| *share > 0.0).collect(),
    })
}

/// Where the cells lie.
struct Raster {
    corner: DVec2,
    cell_m: f64,
    columns: usize,
    rows: usize,
}

impl Raster {
    fn new(grid: &Grid, per_step: u32) -> Self {
        Self {
            corner: DVec2::new(grid.west_m, grid.north_m),
            cell_m: grid.step_m / f64::from(per_step),
            columns: ((grid.columns() - 1) * per_step) as usize,
            rows: ((grid.rows() - 1) * per_step) as usize,
        }
    }

    /// Centre of a cell.
    fn centre(&self, column: usize, row: usize) -> DVec2 {
        self.corner + self.cell_m * (DVec2::new(column as f64, row as f64) + 0.5)
    }

    /// The first column (row) whose centre is not west (north) of a coordinate, within the raster's.
    fn first_not_before(&self, at_m: f64, corner_m: f64, cells: usize) -> usize {
        // A cast saturates, so what lies outside ends at the edge.
        (((at_m - corner_m) / self.cell_m - 0.5).ceil() as usize).min(cells)
    }
}

/// Rows of cells that one task makes.
struct Band<'a> {
    raster: &'a Raster,
    first_row: usize,
    cells: &'a mut [u8],
}

impl Band<'_> {
    /// Its own rows among those whose centres lie between two coordinates.
    fn rows(&self, north_m: f64, south_m: f64) -> std::ops::Range<usize> {
        let row = |z| self.raster.first_not_before(z, self.raster.corner.y, self.raster.rows);
        let last = self.first_row + self.cells.len() / self.raster.columns;
        row(north_m).clamp(self.first_row, last)..row(south_m).clamp(self.first_row, last)
    }

    /// Those and one more on either side: two roundings of a row's middle need not agree, so who asks must look.
    fn rows_about(&self, north_m: f64, south_m: f64) -> std::ops::Range<usize> {
        let rows = self.rows(north_m, south_m);
        let last = self.first_row + self.cells.len() / self.raster.columns;
        rows.start.saturating_sub(1).max(self.first_row)..(rows.end + 1).min(last)
    }

    fn row_mut(&mut self, row: usize) -> &mut [u8] {
        let at = (row - self.first_row) * self.raster.columns;
        &mut self.cells[at..at + self.raster.columns]
    }

    /// Sets the cells whose centres lie inside rings.
    fn fill(&mut self, rings: &[Vec<DVec2>], class: CoverClass) {
        let raster = self.raster;
        let (low, high) = bounds_m(rings);
        if self.rows_about(low.y, high.y).is_empty() || high.x < raster.corner.x {
            return;
        }
        let mut crossings: Vec<(usize, f64)> = Vec::new();
        for (a, b) in edges(rings) {
            for row in self.rows_about(a.y.min(b.y), a.y.max(b.y)) {
                crossings.extend(crossing_x((a, b), raster.centre(0, row).y).map(|x| (row, x)));
            }
        }
        crossings.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        for pair in crossings.chunks_exact(2) {
            let column = |x| raster.first_not_before(x, raster.corner.x, raster.columns);
            let (first, end) = (column(pair[0].1), column(pair[1].1));
            if pair[0].0 == pair[1].0 && first < end {
                self.row_mut(pair[0].0)[first..end].fill(class as u8 | FROM_FEATURES);
            }
        }
    }

    /// Sets the cells whose centres lie within a distance of a line.
    fn fill_line(&mut self, line: &[DVec2], reach_m: f64, class: CoverClass) {
        let raster = self.raster;
        for ends in line.windows(2) {
            let (low, high) = (ends[0].min(ends[1]) - reach_m, ends[0].max(ends[1]) + reach_m);
            let column = |x| raster.first_not_before(x, raster.corner.x, raster.columns);
            let columns = column(low.x)..column(high.x);
            for row in self.rows(low.y, high.y) {
                for column in columns.clone() {
                    let at = raster.centre(column, row);
                    let along = ends[1] - ends[0];
                    let t = ((at - ends[0]).dot(along) / along.length_squared().max(1e-9)).clamp(0.0, 1.0);
                    if at.distance(ends[0] + t * along) <= reach_m {
                        self.row_mut(row)[column] = class as u8 | FROM_FEATURES;
                    }
                }
            }
        }
    }

    fn build_up(&mut self, built_up: &BuiltUp) {
        let rows = self.first_row..self.first_row + self.cells.len() / self.raster.columns;
        for row in rows {
            let Some(columns) = built_up.columns.get(&row) else { continue };
            let cells = self.row_mut(row);
            for &column in columns {
                let class = CoverClass::of(cells[column]);
                // Woods, water and quarries among the houses stay what a file calls them.
                let open = matches!(class, CoverClass::Grass | CoverClass::Field | CoverClass::Unknown);
                if cells[column] & FROM_FEATURES == 0 || open {
                    cells[column] = CoverClass::BuiltUp as u8 | FROM_FEATURES;
                }
            }
        }
    }

    fn lay(&mut self, airfield: &Airfield) {
        for runway in &airfield.runways {
            self.fill(&[strip(runway)], CoverClass::Grass);
        }
        for runway in airfield.runways.iter().filter(|runway| runway.surface != RunwaySurface::Grass) {
            self.fill_line(&runway.ends, 0.5 * f64::from(runway.width_m), CoverClass::Paved);
        }
        for (line, width_m) in &airfield.taxiways {
            self.fill_line(line, 0.5 * f64::from(*width_m), CoverClass::Paved);
        }
        for apron in &airfield.aprons {
            self.fill(std::slice::from_ref(apron), CoverClass::Paved);
        }
    }
}

/// Areas from the largest to the smallest, equal ones in the file's order.
fn by_size(areas: &[LandArea]) -> Vec<&LandArea> {
    let size_m2 = |area: &LandArea| {
        let (low, high) = bounds_m(&area.rings);
        let size = (high - low).max(DVec2::ZERO);
        size.x * size.y
    };
    let mut sized: Vec<(f64, &LandArea)> = areas.iter().map(|area| (size_m2(area), area)).collect();
    sized.sort_by(|a, b| b.0.total_cmp(&a.0));
    sized.into_iter().map(|(_, area)| area).collect()
}

/// Cells that count as built up: columns by row.
struct BuiltUp {
    columns: BTreeMap<usize, Vec<usize>>,
}

impl BuiltUp {
    /// A cell is built up if roofs cover more than [`BUILT_UP_SHARE`] of it and its neighbours within some 100 m.
    fn new(raster: &Raster, buildings: &[Building]) -> Self {
        let mut roofs_m2: BTreeMap<(i64, i64), f64> = BTreeMap::new();
        for building in buildings {
            let outline = &building.outline;
            let middle = outline.iter().sum::<DVec2>() / outline.len().max(1) as f64;
            let cell = ((middle - raster.corner) / raster.cell_m).floor();
            let twice_m2: f64 = edges(std::slice::from_ref(outline)).map(|(a, b)| a.perp_dot(b)).sum();
            if (0.0..raster.columns as f64).contains(&cell.x) && (0.0..raster.rows as f64).contains(&cell.y) {
                *roofs_m2.entry((cell.y as i64, cell.x as i64)).or_default() += 0.5 * twice_m2.abs();
            }
        }
        let reach = (100.0 / raster.cell_m).round().clamp(1.0, 4.0) as i64;
        let mut around_m2: BTreeMap<(i64, i64), f64> = BTreeMap::new();
        for (&(row, column), &area_m2) in &roofs_m2 {
            for r in row - reach..=row + reach {
                for c in column - reach..=column + reach {
                    *around_m2.entry((r, c)).or_default() += area_m2;
                }
            }
        }
        let window_m2 = (raster.cell_m * (2 * reach + 1) as f64).powi(2);
        let mut columns: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for ((row, column), area_m2) in around_m2 {
            let inside = (0..raster.rows as i64).contains(&row) && (0..raster.columns as i64).contains(&column);
            if inside && area_m2 / window_m2 > f64::from(BUILT_UP_SHARE) {
                columns.entry(row as usize).or_default().push(column as usize);
            }
        }
        Self { columns }
    }
}

/// The mown strip of a runway.
fn strip(runway: &Runway) -> Vec<DVec2> {
    let [from, to] = runway.ends;
    let along = (to - from).normalize_or(DVec2::X);
    let half_m = if runway.width_m >= 30.0 { STRIP_M } else { SMALL_STRIP_M };
    let (from, to, across) = (from - along * STRIP_BEYOND_M, to + along * STRIP_BEYOND_M, along.perp() * half_m);
    vec![from + across, to + across, to - across, from - across]
}

/// What the rules say of the cells of one row of blocks.
fn by_rule(field: &Field, lakes: &Lakes, climate: &Climate, block_row: u32, per_step: u32, cells: &mut [u8]) {
    let grid = field.grid();
    let columns = ((grid.columns() - 1) * per_step) as usize;
    let side = (CELLS * per_step) as usize;
    for block_column in 0..grid.blocks_x {
        let block = BlockIndex { x: block_column as i32, z: block_row as i32 };
        let (first_column, first_row) = (block.first_column(), block.first_row());
        let sites = sites(field, block, climate);
        let shores_m = shores_m(grid, lakes, block);
        let place = |cell: usize| (cell as f64 + 0.5) / f64::from(per_step);
        for row in 0..side {
            for column in 0..side {
                let (u, v) = (place(column), place(row));
                let post = |dc: i64, dr: i64| field.post_m(first_column + u as i64 + dc, first_row + v as i64 + dr);
                let corners = [post(0, 0), post(1, 0), post(0, 1), post(1, 1)];
                let class = if corners.iter().any(|h| h.is_nan()) {
                    CoverClass::Unknown
                } else if corners.iter().all(|h| h.abs() < 0.5) && sea_m(field, first_column, first_row, u, v) < 0.0 {
                    CoverClass::Water
                } else {
                    let x_m = grid.west_m + (first_column as f64 + u) * grid.step_m;
                    let z_m = grid.north_m + (first_row as f64 + v) * grid.step_m;
                    let shore_m = shores_m.as_ref().map_or(f32::INFINITY, |shores_m| between(shores_m, u, v));
                    belts(&site_at(&sites, u as f32, v as f32), climate, x_m, z_m, shore_m.max(0.0)).class(climate)
                };
                cells[row * columns + block_column as usize * side + column] = class as u8;
            }
        }
    }
}

/// Signed distance to the nearest shore at a block's posts; `None` if none is within reach.
fn shores_m(grid: &Grid, lakes: &Lakes, block: BlockIndex) -> Option<Vec<f32>> {
    let corner = DVec2::new(grid.x_m(block.first_column()), grid.z_m(block.first_row()));
    let near = lakes.near(corner, corner + grid.block_m(), SHORE_REACH_M);
    if near.is_dry() {
        return None;
    }
    let posts = CELLS as usize + 1;
    let at = |post: usize| corner + grid.step_m * DVec2::new((post % posts) as f64, (post / posts) as f64);
    Some((0..posts * posts).map(|post| near.signed_distance_m(at(post)) as f32).collect())
}

/// A value between four posts of a block, bilinear.
fn between(values: &[f32], u: f64, v: f64) -> f32 {
    let posts = CELLS as usize + 1;
    let (column, row) = ((u as usize).min(posts - 2), (v as usize).min(posts - 2));
    let (east, south) = ((u - column as f64) as f32, (v - row as f64) as f32);
    let at = |dc: usize, dr: usize| values[(row + dr) * posts + column + dc];
    let (north, below) = (at(0, 0) + east * (at(1, 0) - at(0, 0)), at(0, 1) + east * (at(1, 1) - at(0, 1)));
    north + south * (below - north)
}

#[cfg(test)]
#[path = "cover_bake_tests.rs"]
mod tests;
