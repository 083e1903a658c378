//! The ground under airfields set to their level.
//!
//! A cell that a surface (runway, taxiway, apron) may touch, with [`MARGIN_M`] about it, has all its posts at the
//! airfield's level, so each surface is one plane; so has the cell of its reference point. Whether a cell is touched is
//! told from its middle and half its diagonal: too many rather than too few. From there the ground returns to what it was
//! over a width of at least three posts and twelve times the largest difference: a smooth step is at most 1.5 times as
//! steep as a straight one, so the taper adds no more than 1:8. Lakes keep their level in tapers, not under surfaces. Posts
//! without data stay so: an airfield that needs one is left out.

use super::airfields::{line_distance_m, segment_distance_m};
use super::relations::holds;
use crate::features::lakes::Lakes;
use crate::features::model::Airfield;
use crate::grid::Grid;
use glam::DVec2;
use std::collections::HashMap;

/// Half the width of a runway of 45 m.
const MARGIN_M: f64 = 22.5;

/// Narrowest taper, posts.
const TAPER_POSTS: f64 = 3.0;

/// Widths of the taper for a difference of one: 1.5 x 8.
const TAPER_SLOPE: f64 = 12.0;

/// Widest taper: mountains beside a runway are not dug away.
const MOST_TAPER_M: f64 = 3_000.0;

/// Sets the ground; returns the airfields that could not be, by their place in the list, and why.
pub fn flatten(
    airfields: &[Airfield],
    lakes: &Lakes,
    grid: &Grid,
    heights_m: &mut [f32],
) -> Vec<(usize, &'static str)> {
    let mut owner: HashMap<usize, usize> = HashMap::new();
    let mut refused = Vec::new();
    let mut set: Vec<(usize, Vec<usize>, f64)> = Vec::new();
    for (number, airfield) in airfields.iter().enumerate() {
        let posts = posts_under(airfield, grid);
        if posts.iter().any(|post| heights_m[*post].is_nan()) {
            refused.push((number, "ground without data under its surfaces"));
        } else if posts.iter().any(|post| owner.contains_key(post)) {
            refused.push((number, "its surfaces meet those of another"));
        } else if posts.is_empty() {
            refused.push((number, "outside the world"));
        } else {
            let apart = |post: &usize| (f64::from(heights_m[*post]) - airfield.level_m).abs();
            let most_m = posts.iter().map(apart).fold(0.0, f64::max);
            owner.extend(posts.iter().map(|post| (*post, number)));
            set.push((number, posts, most_m));
        }
    }
    for (number, posts, most_m) in &set {
        taper(&airfields[*number], posts, *most_m, &owner, lakes, grid, heights_m);
    }
    for (number, posts, _) in &set {
        posts.iter().for_each(|post| heights_m[*post] = airfields[*number].level_m as f32);
    }
    refused
}

/// All posts that a level is set at, in order.
fn posts_under(airfield: &Airfield, grid: &Grid) -> Vec<usize> {
    let mut posts = Vec::new();
    let half_diagonal_m = grid.step_m * std::f64::consts::FRAC_1_SQRT_2;
    let mut cells = |low: DVec2, high: DVec2, reach_m: f64, distance_m: &dyn Fn(DVec2) -> f64| {
        let reach_m = reach_m + half_diagonal_m;
        for (column, row) in cells_in(low - reach_m, high + reach_m, grid) {
            let middle = DVec2::new(grid.x_m(column) + 0.5 * grid.step_m, grid.z_m(row) + 0.5 * grid.step_m);
            if distance_m(middle) <= reach_m {
                let first = row as usize * grid.columns() as usize + column as usize;
                posts.extend([first, first + 1, first + grid.columns() as usize, first + grid.columns() as usize + 1]);
            }
        }
    };
    for runway in &airfield.runways {
        let [a, b] = runway.ends;
        let reach_m = f64::from(runway.width_m) * 0.5 + MARGIN_M;
        cells(a.min(b), a.max(b), reach_m, &|at| segment_distance_m(at, [a, b]));
    }
    for (line, width_m) in &airfield.taxiways {
        let (low, high) = bounds(line);
        cells(low, high, f64::from(*width_m) * 0.5 + MARGIN_M, &|at| line_distance_m(at, line));
    }
    for ring in &airfield.aprons {
        let (low, high) = bounds(ring);
        let closed: Vec<DVec2> = ring.iter().chain(ring.first()).copied().collect();
        cells(low, high, MARGIN_M, &|at| if holds(ring, at) { 0.0 } else { line_distance_m(at, &closed) });
    }
    let at = airfield.reference;
    for (column, row) in cells_in(at, at, grid) {
        let first = row as usize * grid.columns() as usize + column as usize;
        posts.extend([first, first + 1, first + grid.columns() as usize, first + grid.columns() as usize + 1]);
    }
    posts.sort_unstable();
    posts.dedup();
    posts
}

/// The cells that a rectangle meets.
fn cells_in(low: DVec2, high: DVec2, grid: &Grid) -> impl Iterator<Item = (i64, i64)> + use<> {
    let (columns, rows) = (i64::from(grid.columns()) - 1, i64::from(grid.rows()) - 1);
    let range = |low: f64, high: f64, number: i64| {
        let first = (low.floor() as i64).clamp(0, number);
        // A point on the last post belongs to the last cell.
        let last = (high.floor() as i64).saturating_add(1).clamp(0, number);
        if low > number as f64 || high < 0.0 { 0..0 } else { first.min(number - 1)..last }
    };
    let across = range((low.x - grid.west_m) / grid.step_m, (high.x - grid.west_m) / grid.step_m, columns);
    let down = range((low.y - grid.north_m) / grid.step_m, (high.y - grid.north_m) / grid.step_m, rows);
    down.flat_map(move |row| across.clone().map(move |column| (column, row)))
}

/// Blends the ground about the posts that are set from the level to what it is.
fn taper(
    airfield: &Airfield,
    posts: &[usize],
    most_m: f64,
    owner: &HashMap<usize, usize>,
    lakes: &Lakes,
    grid: &Grid,
    heights_m: &mut [f32],
) {
    let columns = grid.columns() as usize;
    let place = |post: usize| DVec2::new((post % columns) as f64, (post / columns) as f64);
    let least_m = TAPER_POSTS * grid.step_m;
    let width_m = (TAPER_SLOPE * most_m).clamp(least_m, MOST_TAPER_M.max(least_m));
    let width = width_m / grid.step_m;
    // Only posts at the edge can be nearest to one outside.
    let inner = |post: &usize| {
        [-1, 1, -(columns as i64), columns as i64].iter().all(|to| {
            let beside = *post as i64 + to;
            beside >= 0 && owner.get(&(beside as usize)) == owner.get(post)
        })
    };
    let edge: Vec<DVec2> = posts.iter().filter(|post| !inner(post)).map(|post| place(*post)).collect();
    let (low, high) = bounds(&edge);
    let last = DVec2::new((columns - 1) as f64, f64::from(grid.rows() - 1));
    let (low, high) = ((low - width).max(DVec2::ZERO).ceil(), (high + width).min(last).floor());
    let world = |at: DVec2| DVec2::new(grid.x_m(at.x as i64), grid.z_m(at.y as i64));
    let near = lakes.near(world(low), world(high), grid.step_m);
    for row in low.y as usize..=high.y as usize {
        for column in low.x as usize..=high.x as usize {
            let post = row * columns + column;
            let at = place(post);
            if owner.contains_key(&post) || heights_m[post].is_nan() {
                continue;
            }
            let square = edge.iter().map(|edge| edge.distance_squared(at)).fold(f64::INFINITY, f64::min);
            if square >= width * width || near.level_at(world(at)).is_some() {
                continue;
            }
            let share = square.sqrt() / width;
            let share = share * share * (3.0 - 2.0 * share);
            let height_m = f64::from(heights_m[post]);
            heights_m[post] = (airfield.level_m + (height_m - airfield.level_m) * share) as f32;
        }
    }
}

fn bounds(points: &[DVec2]) -> (DVec2, DVec2) {
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    points.iter().fold(none, |(low, high), at| (low.min(*at), high.max(*at)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::model::{Origin, Runway, RunwaySurface};

    fn airfield(level_m: f64) -> Airfield {
        let ends = [DVec2::new(-800.0, 50.0), DVec2::new(700.0, -350.0)];
        let runway = Runway {
            ends,
            width_m: 45.0,
            designators: ["08".into(), "26".into()],
            surface: RunwaySurface::Asphalt,
            lit: false,
            from: Origin::Assumed,
        };
        Airfield {
            code: "TEST".into(),
            name: String::new(),
            reference: DVec2::new(100.0, 0.0),
            level_m,
            runways: vec![runway],
            taxiways: vec![(vec![DVec2::ZERO, DVec2::new(0.0, 300.0)], 15.0)],
            aprons: vec![vec![DVec2::new(-100.0, 200.0), DVec2::new(100.0, 200.0), DVec2::new(0.0, 330.0)]],
        }
    }

    #[test]
    fn surfaces_are_planes_and_the_ground_returns_gently() {
        for (step_m, level_m) in [(200.0, 140.0), (50.0, 140.0), (50.0, 100.0)] {
            let grid = Grid::centred(step_m, 4, 4).unwrap();
            let mut heights = vec![100.0_f32; grid.posts()];
            let airfield = airfield(level_m);
            assert!(flatten(std::slice::from_ref(&airfield), &Lakes::default(), &grid, &mut heights).is_empty());
            let columns = grid.columns() as usize;
            let at = |p: DVec2| {
                let (u, v) = ((p.x - grid.west_m) / step_m, (p.y - grid.north_m) / step_m);
                let first = v.floor() as usize * columns + u.floor() as usize;
                [first, first + 1, first + columns, first + columns + 1].map(|post| heights[post])
            };
            // Every corner of the runway's ground, at a metre: the plane is the level to the bit.
            let [a, b] = airfield.runways[0].ends;
            let across = (b - a).normalize().perp() * 22.5;
            for i in 0..=1_600 {
                let middle = a.lerp(b, f64::from(i) / 1_600.0);
                for p in [middle - across, middle, middle + across] {
                    assert_eq!(at(p), [level_m as f32; 4], "{p}");
                }
            }
            assert_eq!(at(airfield.reference), [level_m as f32; 4]);
            // On level ground the taper is the only slope, and it ends inside the world.
            let steepest = heights
                .chunks_exact(columns)
                .flat_map(|row| row.windows(2).map(|pair| f64::from((pair[0] - pair[1]).abs()) / step_m))
                .fold(0.0, f64::max);
            assert!(steepest <= 0.1251, "{steepest}");
            assert_eq!(heights[0], 100.0);
        }
    }

    #[test]
    fn lakes_and_voids_are_respected() {
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let corner = |x, z| DVec2::new(x, z);
        let rings =
            vec![vec![corner(-900.0, 700.0), corner(900.0, 700.0), corner(900.0, 2_000.0), corner(-900.0, 2_000.0)]];
        let lakes = Lakes::new(vec![crate::features::lakes::Lake { name: String::new(), level_m: 90.0, rings }]);
        let mut heights = vec![90.0_f32; grid.posts()];
        assert!(flatten(&[airfield(140.0)], &lakes, &grid, &mut heights).is_empty());
        for (post, height_m) in heights.iter().enumerate() {
            let columns = grid.columns() as usize;
            let at = DVec2::new(grid.x_m((post % columns) as i64), grid.z_m((post / columns) as i64));
            if lakes.lake_at(at).is_some() {
                assert_eq!(*height_m, 90.0, "{at}");
            }
        }
        let mut heights = vec![f32::NAN; grid.posts()];
        assert_eq!(flatten(&[airfield(140.0)], &lakes, &grid, &mut heights).len(), 1);
        assert!(heights.iter().all(|h| h.is_nan()));
    }
}
