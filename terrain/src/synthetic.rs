//! Made-up terrain for tests, benches and proofs at the extremes. Deterministic: the same seed gives the same posts.
//!
//! Frame and units as in [`crate::field`].

use crate::block::ground_map::unit;
use crate::field::Field;
use crate::grid::Grid;

/// Heights from a function of column and row, metres. What is not finite becomes void.
pub fn from_fn(grid: Grid, mut height_m: impl FnMut(u32, u32) -> f32) -> Field {
    let mut heights = Vec::with_capacity(grid.posts());
    for row in 0..grid.rows() {
        for column in 0..grid.columns() {
            let h = height_m(column, row);
            heights.push(if h.abs() <= crate::field::MAX_HEIGHT_M { h } else { f32::NAN });
        }
    }
    Field::new(grid, heights).expect("as many heights as posts, none infinite")
}

/// A level plain.
pub fn flat(grid: Grid, height_m: f32) -> Field {
    from_fn(grid, |_, _| height_m)
}

/// A plain with one post raised.
pub fn spike(grid: Grid, column: u32, row: u32, height_m: f32) -> Field {
    from_fn(grid, |c, r| if (c, r) == (column, row) { height_m } else { 0.0 })
}

/// Low in the west, high in the east, all within one cell.
pub fn cliff(grid: Grid, column: u32, height_m: f32) -> Field {
    from_fn(grid, |c, _| if c > column { height_m } else { 0.0 })
}

/// Mountains with valleys: five octaves of ridged value noise, 0 to about 5,000 m.
pub fn ridges(grid: Grid, seed: u32) -> Field {
    from_fn(grid, |column, row| {
        let (mut height, mut reach, mut scale) = (0.0, 2_600.0, 1.0 / 48.0);
        for octave in 0..5 {
            let n = value_noise(column as f32 * scale, row as f32 * scale, seed.wrapping_add(octave));
            height += reach * (1.0 - (2.0 * n - 1.0).abs());
            reach *= 0.45;
            scale *= 2.1;
        }
        height
    })
}

/// Independent noise at every post, 0 to `height_m`: the roughest field there is.
pub fn rough(grid: Grid, seed: u32, height_m: f32) -> Field {
    from_fn(grid, |column, row| height_m * unit(column as i32, row as i32, seed))
}

fn value_noise(x: f32, y: f32, seed: u32) -> f32 {
    let (x0, y0) = (x.floor(), y.floor());
    let smooth = |t: f32| t * t * (3.0 - 2.0 * t);
    let (u, v) = (smooth(x - x0), smooth(y - y0));
    let at = |i: i32, j: i32| unit(x0 as i32 + i, y0 as i32 + j, seed);
    let top = at(0, 0) + u * (at(1, 0) - at(0, 0));
    let bottom = at(0, 1) + u * (at(1, 1) - at(0, 1));
    top + v * (bottom - top)
}
