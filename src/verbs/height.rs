//! `poligon height`: height, normal and surface of the ground at the points of a CSV file.
//!
//! A point is answered wherever it lies: beyond the world and over voids height, normal and surface are null. So are
//! the latitude and longitude of world coordinates so far out that the world's map does not reach them.

use crate::args::HeightArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::{self, Output};
use crate::points::{self, Points};
use crate::report::{HeightPoint, Heights};
use glam::DVec2;
use std::path::Path;
use terrain::store::World;
use terrain::{Geodetic, Grid, Ground, Projection};

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &HeightArgs, output: Output) -> Result<(), Failure> {
    let points = read(&args.points)?;
    let world = open_world::open(args.world.as_deref())?;
    let mut points = answer(&world, &points);
    if output == Output::Table && points.len() > output::SHOWN_ROWS {
        // A table shows no more, and to lay out a million rows first would take a gigabyte.
        let more = points.len() - output::SHOWN_ROWS;
        output::tell(format_args!("poligon: {more} more points are not shown; --json prints all"));
        points.truncate(output::SHOWN_ROWS);
    }
    output.print(&Heights { points })
}

fn read(path: &Path) -> Result<Points, Failure> {
    let bytes =
        std::fs::read(path).map_err(|error| Failure::while_doing(format!("reading {}", path.display()), error))?;
    points::parse(&bytes).map_err(|error| Failure::while_doing(path.display(), error))
}

/// The ground at each point, in their order.
fn answer(world: &World, points: &Points) -> Vec<HeightPoint> {
    let grid = world.field.grid();
    let mut answers: Vec<HeightPoint> = match points {
        Points::Geodetic(all) => all.iter().map(|&[lat, lon]| from_geodetic(&world.projection, lat, lon)).collect(),
        Points::World(all) => all.iter().map(|&[x, z]| from_world(&world.projection, grid, x, z)).collect(),
    };

    // Block by block: the posts of one are near each other in memory, and so are the shores that its points ask for.
    let block_of = |point: &HeightPoint| {
        let block = grid.block_at(point.x_m, point.z_m);
        // The last posts belong to the last blocks.
        (block.z.min(grid.blocks_z as i32 - 1), block.x.min(grid.blocks_x as i32 - 1))
    };
    let mut order: Vec<((i32, i32), usize)> =
        answers.iter().enumerate().filter(|(_, p)| inside(grid, p.x_m, p.z_m)).map(|(i, p)| (block_of(p), i)).collect();
    order.sort_unstable();
    let area = Ground::new(world.field.clone()).whole();
    for group in order.chunk_by(|a, b| a.0 == b.0) {
        let places = group.iter().map(|&(_, i)| DVec2::new(answers[i].x_m, answers[i].z_m));
        let (low, high) =
            places.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let shores = world.lakes.near(low, high, 0.0);
        for &(_, i) in group {
            let point = &mut answers[i];
            let Some((height_m, normal)) = area.height_and_normal(point.x_m, point.z_m) else { continue };
            let water = !shores.is_dry() && shores.level_at(DVec2::new(point.x_m, point.z_m)).is_some();
            point.height_m = Some(height_m);
            point.normal = Some(normal.to_array());
            point.surface = Some(if water { "water" } else { "ground" });
        }
    }
    answers
}

fn from_geodetic(projection: &Projection, lat_deg: f64, lon_deg: f64) -> HeightPoint {
    // Zero is added so that no -0 is printed at the centre.
    let at = projection.to_world(Geodetic::from_degrees(lat_deg, lon_deg)) + DVec2::ZERO;
    HeightPoint { lat_deg, lon_deg, x_m: at.x, z_m: at.y, ..HeightPoint::default() }
}

fn from_world(projection: &Projection, grid: &Grid, x_m: f64, z_m: f64) -> HeightPoint {
    let place = projection.to_geodetic(DVec2::new(x_m, z_m));
    // Far out the map wraps around the Earth: a place that does not lead back is none.
    let leads_back = || (projection.to_world(place) - DVec2::new(x_m, z_m)).length() < 1.0;
    let (lat_deg, lon_deg) =
        if inside(grid, x_m, z_m) || leads_back() { (place.lat_deg(), place.lon_deg()) } else { (f64::NAN, f64::NAN) };
    HeightPoint { lat_deg, lon_deg, x_m, z_m, ..HeightPoint::default() }
}

fn inside(grid: &Grid, x_m: f64, z_m: f64) -> bool {
    (grid.west_m..=grid.east_m()).contains(&x_m) && (grid.north_m..=grid.south_m()).contains(&z_m)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_are_none_have_no_latitude() {
        let projection = Projection::new(Geodetic::from_degrees(42.0, 78.0)).unwrap();
        let grid = Grid::centred(200.0, 2, 2).unwrap();
        let near = from_world(&projection, &grid, 0.0, -111_000.0);
        assert!((near.lat_deg - 43.0).abs() < 0.01 && (near.lon_deg - 78.0).abs() < 1e-9);
        for (x, z) in [(1e300, 0.0), (-f64::MAX, f64::MAX), (1e9, 1e9), (0.0, 5e7)] {
            let far = from_world(&projection, &grid, x, z);
            assert!(far.lat_deg.is_nan() && far.lon_deg.is_nan() && far.height_m.is_none(), "{far:?}");
        }
    }
}
