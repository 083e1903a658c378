//! `poligon sight`: whether two points see each other.
//!
//! The line is straight and the world flat, as the picture is: neither the Earth's curvature nor refraction bends it. An
//! end that lies on the ground (`0:agl`) is no obstacle to itself.

use crate::args::SightArgs;
use crate::failure::Failure;
use crate::open_world;
use crate::output::{self, Output};
use crate::report::{Hit, Sight};
use crate::scenery;
use glam::{DVec2, DVec3};
use terrain::store::World;
use terrain::{Area, Ground};

/// An end this near the ground lies on it, metres: f64 rounds a height above ground to 1e-11 m, and no one stands
/// nearer. For being seen it is lifted so far.
const ON_GROUND_M: f64 = 1e-3;

/// Runs the verb.
///
/// # Errors
/// [`Failure`] says what was expected and what was found.
pub fn run(args: &SightArgs, output: Output) -> Result<(), Failure> {
    let world = open_world::open(args.world.as_deref())?;
    let area = Ground::new(world.field.clone()).whole();
    let from = scenery::position(&world, &area, args.from)?;
    let to = scenery::position(&world, &area, args.to)?;
    for (flag, end) in [("--from", from), ("--to", to)] {
        if let Some(under_m) = above_m(&area, end).map(|above_m| -above_m).filter(|under_m| *under_m > ON_GROUND_M) {
            output::tell(format_args!("poligon: {flag} is {under_m:.1} m under the ground"));
        }
    }
    let sight = look(&world, &area, from, to);
    if sight.ground_share < 1.0 {
        let share = 100.0 * (1.0 - sight.ground_share);
        output::tell(format_args!("poligon: {share:.1} % of the line has no ground under it, which hides nothing"));
    }
    output.print(&sight)
}

fn look(world: &World, area: &Area, from: DVec3, to: DVec3) -> Sight {
    let distance_m = (to - from).length();
    let hit = area.segment(lifted(area, from), lifted(area, to));
    let clearance = area.clearance(from, to);
    let known = clearance.least_m.is_finite();
    Sight {
        visible: hit.is_none(),
        hit: hit.map(|hit| {
            let place = world.projection.to_geodetic(DVec2::new(hit.point.x, hit.point.z));
            Hit {
                lat_deg: place.lat_deg(),
                lon_deg: place.lon_deg(),
                x_m: hit.point.x,
                z_m: hit.point.z,
                height_m: hit.point.y,
                distance_m: hit.fraction * distance_m,
            }
        }),
        clearance_min_m: known.then_some(clearance.least_m),
        clearance_min_at_m: known.then_some(clearance.fraction * distance_m),
        distance_m,
        ground_share: clearance.share,
    }
}

fn above_m(area: &Area, end: DVec3) -> Option<f64> {
    area.height_m(end.x, end.z).map(|ground_m| end.y - ground_m)
}

/// An end that lies on the ground, just above it.
fn lifted(area: &Area, end: DVec3) -> DVec3 {
    let on_ground = above_m(area, end).is_some_and(|above_m| above_m.abs() <= ON_GROUND_M);
    if on_ground { end + DVec3::Y * ON_GROUND_M * 2.0 } else { end }
}
