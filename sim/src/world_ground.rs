//! A world's ground under the frame of a case.
//!
//! A flat frame *is* the world's plane: it is laid on it at the start, with its north along true north there, so that
//! distances of a flight are distances of the picture. Latitudes and longitudes are then the world's own, and `height`
//! answers for them what was met. A start in metres counts from the world's centre. On a round Earth or the
//! ellipsoid a place is looked up on the world's map by its latitude and longitude; heights are taken as they are,
//! without a geoid between ellipsoid and sea level.
//!
//! World: X east, Y up, Z south, metres.

use crate::ballistics::impact::{self, Impact};
use crate::ballistics::path::StepPath;
use crate::case::Case;
use crate::planet::{Place, Planet, Shape};
use glam::{DMat2, DVec2, DVec3};
use std::sync::Arc;
use terrain::features::index::ObjectIndex;
use terrain::store::World;
use terrain::{Area, Geodetic, Ground, Projection};

/// Half of the time over which a velocity on the map is a difference, seconds: rounding gives 1e-6 m/s.
const HALF_S: f64 = 1e-3;

/// The ground, and how the frame lies on it.
#[derive(Debug, Clone)]
pub struct WorldGround {
    area: Area,
    /// What stands on it.
    objects: Option<Arc<ObjectIndex>>,
    projection: Projection,
    planet: Planet,
    /// For a flat frame.
    laid: Option<Laid>,
}

/// A flat frame on the world's plane.
#[derive(Debug, Clone, Copy)]
struct Laid {
    /// North and east of the start in the frame.
    start_m: DVec2,
    /// World x and z of the start.
    world_m: DVec2,
    /// From north and east to world x and z.
    turn: DMat2,
}

impl WorldGround {
    /// The ground of a world under a case.
    pub fn new(world: &World, case: &Case) -> Self {
        let area = Ground::new(world.field.clone()).whole();
        let objects = ObjectIndex::new(world.features.clone(), &area);
        let objects = (!objects.is_empty()).then(|| Arc::new(objects));
        Self { objects, ..Self::over(area, world.projection.clone(), case) }
    }

    /// The same of any bare ground with its map.
    pub fn over(area: Area, projection: Projection, case: &Case) -> Self {
        let laid = matches!(case.planet.shape, Shape::Flat { .. }).then(|| match case.initial.flat_m {
            Some(at) => Laid {
                start_m: at.truncate(),
                world_m: DVec2::new(at.y, -at.x),
                turn: DMat2::from_cols(DVec2::NEG_Y, DVec2::X),
            },
            None => {
                let place = case.initial.place;
                let at = Geodetic { lat_rad: place.lat_rad, lon_rad: place.lon_rad };
                // A true bearing less the convergence is the bearing on the map.
                let (sin, cos) = projection.grid_convergence_rad(at).sin_cos();
                Laid {
                    start_m: case.planet.position_m(place).truncate(),
                    world_m: projection.to_world(at),
                    turn: DMat2::from_cols(DVec2::new(-sin, -cos), DVec2::new(cos, -sin)),
                }
            }
        });
        Self { area, objects: None, projection, planet: case.planet, laid }
    }

    /// A position of the frame in the world.
    pub fn world_m(&self, position_m: DVec3) -> DVec3 {
        let (plan, altitude_m) = match &self.laid {
            Some(laid) => (laid.world_m + laid.turn * (position_m.truncate() - laid.start_m), -position_m.z),
            None => {
                let place = self.planet.place(position_m);
                let at = Geodetic { lat_rad: place.lat_rad, lon_rad: place.lon_rad };
                (self.projection.to_world(at), place.altitude_m)
            }
        };
        DVec3::new(plan.x, altitude_m, plan.y)
    }

    fn world_mps(&self, position_m: DVec3, velocity_mps: DVec3) -> DVec3 {
        match &self.laid {
            Some(laid) => {
                let plan = laid.turn * velocity_mps.truncate();
                DVec3::new(plan.x, -velocity_mps.z, plan.y)
            }
            None => {
                let way = velocity_mps * HALF_S;
                (self.world_m(position_m + way) - self.world_m(position_m - way)) / (2.0 * HALF_S)
            }
        }
    }

    /// The place of a position in the frame, by the world's map where the frame is flat.
    pub fn place(&self, position_m: DVec3) -> Place {
        if self.laid.is_none() {
            return self.planet.place(position_m);
        }
        let at = self.world_m(position_m);
        let place = self.projection.to_geodetic(DVec2::new(at.x, at.z));
        Place { lat_rad: place.lat_rad, lon_rad: place.lon_rad, altitude_m: at.y }
    }

    /// Height of the ground under a position of the frame, metres; `None` over void and beyond the world.
    pub fn height_m(&self, position_m: DVec3) -> Option<f64> {
        let at = self.world_m(position_m);
        self.area.height_m(at.x, at.z)
    }

    /// Where a step first meets the ground or a thing that stands on it; its ends are position and velocity in the frame.
    pub fn impact(&self, from: (DVec3, DVec3), to: (DVec3, DVec3), step_s: f64) -> Option<Impact> {
        let ((from_r, from_v), (to_r, to_v)) = (from, to);
        let path = StepPath {
            from_m: self.world_m(from_r),
            from_mps: self.world_mps(from_r, from_v),
            to_m: self.world_m(to_r),
            to_mps: self.world_mps(to_r, to_v),
            step_s,
        };
        impact::standing_impact(&path, &self.area, self.objects.as_deref())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ballistics::column::Column;
    use crate::ballistics::projectile::Projectile;
    use crate::ballistics::trajectory::{Trajectory, fly};
    use std::path::Path;
    use std::sync::Arc;
    use terrain::{Grid, synthetic};

    fn case(frame: &str, more: &str) -> Case {
        let text =
            format!("[frame]\nkind = '{frame}'\n[initial]\nlat_deg = 42.2\nlon_deg = 78.3\naltitude_m = 3000\n{more}");
        Case::from_text(Path::new("c.toml"), &text).unwrap()
    }

    fn hills(case: &Case) -> WorldGround {
        let field = Arc::new(synthetic::rough(Grid::centred(200.0, 12, 12).unwrap(), 5, 900.0));
        let projection = Projection::new(Geodetic::from_degrees(42.0, 78.0)).unwrap();
        WorldGround::over(Ground::new(field).whole(), projection, case)
    }

    fn shot(case: &Case, ground: &WorldGround) -> Trajectory {
        let shell = "mass_kg = 43\ndiameter_m = 0.155\ndrag = 'G7'\nform_factor = 1";
        fly(&Projectile::from_text(Path::new("p.toml"), shell).unwrap(), case, Some(ground)).unwrap()
    }

    #[test]
    fn a_shot_ends_on_the_ground_that_its_latitude_and_longitude_name() {
        for frame in ["flat", "ellipsoid"] {
            for azimuth in [0, 77, 160, 285] {
                let aimed = |dt: f64| {
                    let more = format!(
                        "[run]\ndt_s = {dt}\n[shot]\nspeed_mps = 350\nelevation_deg = 8\nazimuth_deg = {azimuth}"
                    );
                    let case = case(frame, &more);
                    let ground = hills(&case);
                    (shot(&case, &ground), ground)
                };
                let ((coarse, ground), (fine, _)) = (aimed(0.02), aimed(0.002));
                let end = coarse.end();
                let value = |column| end.get(column).unwrap();
                assert_eq!(end.event, "ground", "{frame} {azimuth}");
                let at = ground.projection.to_world(Geodetic::from_degrees(value(Column::Lat), value(Column::Lon)));
                let under_m = ground.area.height_m(at.x, at.y).unwrap();
                // A height of 3 km, a map of some 20 km to and fro: roundings of a nanometre; the cubic of the step is
                // h4 / 384 of its fourth derivative (1 m/s4 at the most) off, a tenth of that.
                assert!((under_m - value(Column::Altitude)).abs() < 1e-6, "{frame} {azimuth}: {under_m}");
                let apart = |column| value(column) - fine.end().get(column).unwrap();
                let apart_m = [Column::X, Column::Y, Column::Z].map(apart).iter().map(|d| d * d).sum::<f64>().sqrt();
                assert!(apart_m < 1e-5, "{frame} {azimuth}: {apart_m} m from a shot of a tenth of the step");
            }
        }
    }

    #[test]
    fn a_gun_that_stands_on_its_ground_fires_and_one_in_it_does_not() {
        for frame in ["flat", "ellipsoid"] {
            for (azimuth, elevation) in [(0, 45), (90, 10), (200, 80), (300, 1), (45, 89)] {
                let fired = |over_m: f64| {
                    let here = case(frame, "");
                    let ground = hills(&here);
                    let ground_m = ground.height_m(here.planet.position_m(here.initial.place)).unwrap();
                    let text = format!(
                        "[frame]\nkind = '{frame}'\n[initial]\nlat_deg = 42.2\nlon_deg = 78.3\naltitude_m = {:?}\n\
                         [shot]\nspeed_mps = 563.9\nelevation_deg = {elevation}\nazimuth_deg = {azimuth}",
                        ground_m + over_m
                    );
                    let case = Case::from_text(Path::new("c.toml"), &text).unwrap();
                    let flown = shot(&case, &hills(&case));
                    (flown.end().get(Column::Time).unwrap(), flown.end().event.clone())
                };
                // Hills of 900 m over 200 m posts are steep: a flat shot may end on the next one, but not at the muzzle.
                let (time_s, event) = fired(1.5);
                assert!(time_s > 1e-3, "{frame} {azimuth} {elevation}: {event} at {time_s} s");
                assert_eq!(fired(-0.1), (0.0, "ground".to_owned()), "{frame} {azimuth} {elevation}");
            }
        }
    }

    #[test]
    fn a_flat_frame_lies_on_the_map_with_its_north_along_true_north() {
        let case = case("flat", "");
        let ground = hills(&case);
        let muzzle = case.planet.position_m(case.initial.place);
        let place = ground.place(muzzle);
        assert!((place.lat_rad.to_degrees() - 42.2).abs() < 1e-12 && (place.lon_rad.to_degrees() - 78.3).abs() < 1e-12);
        // Along a meridian the longitude stays: 1 km of bend of the map is 2e-9 rad.
        let north = ground.place(muzzle + DVec3::X * 1_000.0);
        assert!((north.lon_rad - place.lon_rad).abs() < 1e-8 && north.lat_rad > place.lat_rad);
        let east = ground.place(muzzle + DVec3::Y * 1_000.0);
        assert!(east.lon_rad > place.lon_rad && (east.lat_rad - place.lat_rad).abs() < 1e-7);
    }

    #[test]
    fn a_muzzle_in_the_ground_ends_at_once() {
        let mut case = case("flat", "[shot]\nspeed_mps = 300\nelevation_deg = 45");
        case.initial.place.altitude_m = -500.0;
        let ended = shot(&case, &hills(&case));
        assert_eq!((ended.end().event.as_str(), ended.end().get(Column::Time)), ("ground", Some(0.0)));
    }
}
