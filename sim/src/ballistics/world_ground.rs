//! A world's ground under the frame of a case.
//!
//! A flat frame *is* the world's plane: it is laid on it at the muzzle, with its north along true north there, so that
//! distances of a shot are distances of the picture. Latitudes and longitudes are then the world's own, and `height`
//! answers for them what the shell has met. A muzzle in metres counts from the world's centre. On a round Earth or the
//! ellipsoid a place is looked up on the world's map by its latitude and longitude; heights are taken as they are,
//! without a geoid between ellipsoid and sea level.
//!
//! World: X east, Y up, Z south, metres.

use super::impact::{self, Impact};
use super::motion::{State, parts};
use super::path::StepPath;
use crate::case::Case;
use crate::planet::{Place, Planet, Shape};
use glam::{DMat2, DVec2, DVec3};
use terrain::store::World;
use terrain::{Area, Geodetic, Ground, Projection};

/// Half of the time over which a velocity on the map is a difference, seconds: rounding gives 1e-6 m/s.
const HALF_S: f64 = 1e-3;

/// The ground, and how the frame lies on it.
#[derive(Debug, Clone)]
pub struct WorldGround {
    area: Area,
    projection: Projection,
    planet: Planet,
    /// For a flat frame.
    laid: Option<Laid>,
}

/// A flat frame on the world's plane.
#[derive(Debug, Clone, Copy)]
struct Laid {
    /// North and east of the muzzle in the frame.
    muzzle_m: DVec2,
    /// World x and z of the muzzle.
    world_m: DVec2,
    /// From north and east to world x and z.
    turn: DMat2,
}

impl WorldGround {
    /// The ground of a world under a case.
    pub fn new(world: &World, case: &Case) -> Self {
        let projection = world.projection.clone();
        let laid = matches!(case.planet.shape, Shape::Flat { .. }).then(|| match case.initial.flat_m {
            Some(at) => Laid {
                muzzle_m: at.truncate(),
                world_m: DVec2::new(at.y, -at.x),
                turn: DMat2::from_cols(DVec2::NEG_Y, DVec2::X),
            },
            None => {
                let place = case.initial.place;
                let at = Geodetic { lat_rad: place.lat_rad, lon_rad: place.lon_rad };
                // A true bearing less the convergence is the bearing on the map.
                let (sin, cos) = projection.grid_convergence_rad(at).sin_cos();
                Laid {
                    muzzle_m: case.planet.position_m(place).truncate(),
                    world_m: projection.to_world(at),
                    turn: DMat2::from_cols(DVec2::new(-sin, -cos), DVec2::new(cos, -sin)),
                }
            }
        });
        Self { area: Ground::new(world.field.clone()).whole(), projection, planet: case.planet, laid }
    }

    /// A position of the frame in the world.
    pub fn world_m(&self, position_m: DVec3) -> DVec3 {
        let (plan, altitude_m) = match &self.laid {
            Some(laid) => (laid.world_m + laid.turn * (position_m.truncate() - laid.muzzle_m), -position_m.z),
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

    /// Where a step from one state to another first meets the ground.
    pub fn impact(&self, from: &State, to: &State, step_s: f64) -> Option<Impact> {
        let ((from_r, from_v), (to_r, to_v)) = (parts(from), parts(to));
        let path = StepPath {
            from_m: self.world_m(from_r),
            from_mps: self.world_mps(from_r, from_v),
            to_m: self.world_m(to_r),
            to_mps: self.world_mps(to_r, to_v),
            step_s,
        };
        impact::ground_impact(&path, &self.area)
    }
}
