//! Places of the Earth on a world's map.
//!
//! Latitude and longitude in degrees (WGS84) to the world's plan (x east, z south), metres; headings from true north to
//! the map's by the convergence at the own aircraft's start.

use crate::scene::Refused;
use glam::DVec2;
use terrain::store::World;
use terrain::{Area, Geodetic, Ground};

/// A world under a situation: its map, its ground, and how its grid is turned.
pub(super) struct Laid<'a> {
    pub world: &'a World,
    pub area: Area,
    pub convergence_rad: f64,
}

impl<'a> Laid<'a> {
    /// About a place.
    pub fn new(world: &'a World, about: Geodetic) -> Self {
        let area = Ground::new(world.field.clone()).whole();
        Self { world, area, convergence_rad: world.projection.grid_convergence_rad(about) }
    }

    /// Plan place of a latitude and a longitude in degrees, and the height there: the ground's, or on water its level.
    pub fn place(&self, [lat_deg, lon_deg]: [f64; 2], on_water: bool) -> Result<(DVec2, f64), Refused> {
        if !(lat_deg.abs() < 90.0 && lon_deg.abs() <= 180.0) {
            return Err(Refused::new(format_args!("expected degrees on the Earth, found {lat_deg}, {lon_deg}")));
        }
        let plan = self.world.projection.to_world(Geodetic::from_degrees(lat_deg, lon_deg));
        let ground_m = self.area.height_m(plan.x, plan.y).ok_or_else(|| {
            Refused::new(format_args!("expected a place on the world's ground, found {lat_deg}, {lon_deg}"))
        })?;
        if !on_water {
            return Ok((plan, ground_m));
        }
        let lake = self.world.lakes.lake_at(plan);
        let dry = || Refused::new(format_args!("expected a place on a lake of the world, found {lat_deg}, {lon_deg}"));
        lake.map(|lake| (plan, lake.level_m)).ok_or_else(dry)
    }
}
