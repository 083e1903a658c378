//! The lowest ground about an eye: where a fog lies.
//!
//! The world is cut into squares of [`SQUARE_M`]; each has the least height of a few of its points, and between the
//! squares' middles the value is linear, so that it moves smoothly with the eye. Frame: `terrain::frame`.

use glam::DVec2;
use terrain::Area;

/// Side of a square, metres: what a fog bank may span.
const SQUARE_M: f64 = 6_000.0;
/// Points along a side of a square that are asked.
const POINTS: u32 = 6;

/// See the module; metres above sea level, `None` where there is no ground.
pub fn near_m(area: &Area, eye: DVec2) -> Option<f64> {
    if !eye.is_finite() {
        return None;
    }
    let at = eye / SQUARE_M - 0.5;
    let (low, share) = (at.floor(), at - at.floor());
    let (mut sum_m, mut weights) = (0.0, 0.0);
    for (east, south) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
        let weight = (1.0 - (share.x - east).abs()) * (1.0 - (share.y - south).abs());
        if let Some(least_m) = least_m(area, (low + DVec2::new(east, south)) * SQUARE_M) {
            sum_m += weight * least_m;
            weights += weight;
        }
    }
    (weights > 1e-6).then(|| sum_m / weights)
}

/// Of the square with a north-west corner.
fn least_m(area: &Area, corner: DVec2) -> Option<f64> {
    let step_m = SQUARE_M / f64::from(POINTS);
    let points = (0..POINTS * POINTS).map(|number| {
        let (column, row) = (number % POINTS, number / POINTS);
        corner + (DVec2::new(f64::from(column), f64::from(row)) + 0.5) * step_m
    });
    points.filter_map(|at| area.height_m(at.x, at.y)).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use terrain::{Field, Grid, Ground};

    #[test]
    fn it_is_the_lowest_ground_and_moves_smoothly() {
        let grid = Grid::centred(200.0, 4, 4).expect("grid");
        // A slope that rises 1 m a post to the east.
        let columns = grid.columns() as usize;
        let heights = (0..grid.posts()).map(|at| 500.0 + (at % columns) as f32).collect();
        let area = Ground::new(Arc::new(Field::new(grid, heights).expect("field"))).whole();
        let mut last_m = near_m(&area, DVec2::new(-6_000.0, 0.0)).expect("ground");
        for step in 1..120 {
            let at_m = near_m(&area, DVec2::new(-6_000.0 + 100.0 * f64::from(step), 0.0)).expect("ground");
            // A square's side is 30 posts: 0.5 m in 100 m.
            assert!((0.0..0.6).contains(&(at_m - last_m)), "{step}: {last_m} {at_m}");
            last_m = at_m;
        }
        assert_eq!(near_m(&area, DVec2::splat(1e7)), None);
        assert_eq!(near_m(&area, DVec2::NAN), None);
    }
}
