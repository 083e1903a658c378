//! Lakes from a file into the ground, at bake.
//!
//! A lake's posts are set to its level ([`burn`]): elevation rasters show noise on water. Between the outline and
//! [`TAPER_POSTS`] posts beyond it the ground is blended from the level to the raster by the square of the distance,
//! because the noise does not end at the outline either; it is the one place where the bake departs from its source. The
//! square keeps water level at a steep shore: where a cell's edge crosses the outline, the ground there rises above the
//! level by at most 4 % of what the next post on land does in the raster (7 % along a diagonal), in proportion by 13 %.
//! Without a level of its own a lake has the median of the posts inside.

use super::lakes::{Lake, Lakes, LakesNear, bounds_m, crossing_x, edges};
use crate::grid::Grid;
use glam::DVec2;
use rayon::prelude::*;

/// Width of the blended shore outside an outline, posts.
pub const TAPER_POSTS: f64 = 2.0;

/// Levels are whole millimetres: so few digits that text keeps them to the bit.
const PER_METRE: f64 = 1000.0;

/// An outline read from a file, before its level is known.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// As the file calls it; may be empty.
    pub name: String,
    /// The level if the file says it, metres.
    pub level_m: Option<f64>,
    /// World x and z in metres.
    pub rings: Vec<Vec<DVec2>>,
}

/// The lake of an outline: its own level, or the median of the posts inside, or `None` if there are none.
pub fn with_level(outline: Outline, grid: &Grid, heights_m: &[f32]) -> Option<Lake> {
    let level_m = outline.level_m.or_else(|| {
        let mut found = Vec::new();
        for (row, mut columns) in rows_inside(&outline.rings, grid) {
            found
                .extend(columns.by_ref().map(|c| heights_m[row * grid.columns() as usize + c]).filter(|h| !h.is_nan()));
        }
        let middle = found.len() / 2;
        (!found.is_empty()).then(|| f64::from(*found.select_nth_unstable_by(middle, f32::total_cmp).1))
    })?;
    Some(Lake { name: outline.name, level_m: (level_m * PER_METRE).round() / PER_METRE, rings: outline.rings })
}

/// Sets the posts on lakes to their level and blends the shore; posts without data stay without. Returns how many
/// posts lie on each lake.
pub fn burn(lakes: &Lakes, grid: &Grid, heights_m: &mut [f32]) -> Vec<usize> {
    /// Posts along a side of the squares worked on.
    const SIDE: usize = 64;
    let columns = grid.columns() as usize;
    let reach_m = TAPER_POSTS * grid.step_m;
    heights_m.par_chunks_mut(columns * SIDE).enumerate().for_each(|(band, heights)| {
        let at = |column: usize, row: usize| DVec2::new(grid.x_m(column as i64), grid.z_m((band * SIDE + row) as i64));
        let rows = heights.len() / columns;
        for first in (0..columns).step_by(SIDE) {
            let last = (first + SIDE).min(columns) - 1;
            let near = lakes.near(at(first, 0), at(last, rows - 1), reach_m);
            if near.is_dry() {
                continue;
            }
            for row in 0..rows {
                for column in first..=last {
                    set_post(&near, at(column, row), &mut heights[row * columns + column]);
                }
            }
        }
    });
    lakes.lakes().iter().map(|lake| rows_inside(&lake.rings, grid).map(|(_, columns)| columns.count()).sum()).collect()
}

fn set_post(near: &LakesNear, at: DVec2, height_m: &mut f32) {
    if height_m.is_nan() {
        return;
    }
    if let Some(level_m) = near.level_at(at) {
        *height_m = level_m as f32;
    } else if let Some((distance_m, level_m)) = near.shore_at(at) {
        let share = (distance_m / near.reach_m()).powi(2);
        *height_m = (level_m + (f64::from(*height_m) - level_m) * share) as f32;
    }
}

/// Each row of posts that the rings touch, with the columns inside.
fn rows_inside<'a>(
    rings: &'a [Vec<DVec2>],
    grid: &'a Grid,
) -> impl Iterator<Item = (usize, Box<dyn Iterator<Item = usize> + 'a>)> + 'a {
    let (low, high) = bounds_m(rings);
    let row = |z: f64| ((z - grid.north_m) / grid.step_m).clamp(0.0, f64::from(grid.rows()));
    let rows = row(low.y).floor() as usize..(row(high.y).ceil() as usize + 1).min(grid.rows() as usize);
    rows.map(move |row| {
        let z = grid.z_m(row as i64);
        // Where the row crosses the rings, from west to east: inside between the odd and the even.
        let mut crossings: Vec<f64> = edges(rings).filter_map(|edge| crossing_x(edge, z)).collect();
        crossings.sort_by(f64::total_cmp);
        let column = |x: f64| ((x - grid.west_m) / grid.step_m).ceil().clamp(0.0, f64::from(grid.columns())) as usize;
        let runs: Vec<(usize, usize)> = crossings.chunks_exact(2).map(|c| (column(c[0]), column(c[1]))).collect();
        let columns: Box<dyn Iterator<Item = usize>> = Box::new(runs.into_iter().flat_map(|(from, to)| from..to));
        (row, columns)
    })
}

#[cfg(test)]
mod tests {
    use super::super::lakes::{inside, tests::lakes};
    use super::*;

    #[test]
    fn posts_on_a_lake_get_its_level_and_the_shore_is_blended() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let lakes = lakes();
        let mut heights = vec![300.0; grid.posts()];
        heights[0] = f32::NAN;
        let posts = burn(&lakes, &grid, &mut heights);
        let at = |x: f64, z: f64| {
            let (column, row) = ((x - grid.west_m) / grid.step_m, (z - grid.north_m) / grid.step_m);
            heights[row as usize * grid.columns() as usize + column as usize]
        };
        assert_eq!((at(-600.0, 0.0), at(-1_200.0, 0.0), at(-1_400.0, 0.0)), (100.0, 150.0, 300.0));
        assert!(heights[0].is_nan());
        // By the even-odd rule in the plain double loop.
        for (number, lake) in lakes.lakes().iter().enumerate() {
            let all = (0..grid.posts()).map(|i| (i % grid.columns() as usize, i / grid.columns() as usize));
            let slow =
                all.filter(|&(c, r)| inside(edges(&lake.rings), DVec2::new(grid.x_m(c as i64), grid.z_m(r as i64))));
            assert_eq!(slow.count(), posts[number]);
        }
    }
}
