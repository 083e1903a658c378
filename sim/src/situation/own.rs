//! The own aircraft of a situation: which model, where it begins, what it carries.
//!
//! Without `aircraft` it is the point mass; else a rigid body, an embedded one (`trainer`, `jet`, `hover`) or a file beside
//! the situation's. It begins in level flight at a place, trimmed with what it carries and its gear up, or stands on a
//! runway of the world's, `from_threshold_m` behind its threshold.

use super::laid::Laid;
use crate::aircraft::AircraftState;
use crate::frame::{Angles, attitude};
use crate::handling::runway::standing_height_m;
use crate::input::Levers;
use crate::rigid::{Model, builtin};
use crate::scene::{BodyStart, Catalogue, Command, Fuel, Refused, Scene};
use crate::snapshot::StableId;
use glam::{DVec2, DVec3};
use serde::Deserialize;
use std::path::Path;
use std::sync::Arc;
use terrain::Geodetic;
use terrain::store::World;

/// Name of the own aircraft's model in the catalogue.
const NAME: &str = "aircraft";

/// `[own]`.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Own {
    aircraft: Option<String>,
    runway: Option<RunwayStart>,
    lat_deg: Option<f64>,
    lon_deg: Option<f64>,
    altitude_m: Option<f64>,
    #[serde(default)]
    heading_deg: f64,
    #[serde(default)]
    speed_mps: f64,
    fuel_kg: Option<f64>,
    #[serde(default)]
    throttle: f64,
    #[serde(default)]
    parking_brake: bool,
    #[serde(default)]
    station: Vec<Station>,
    select: Option<String>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct RunwayStart {
    /// Code of the airfield, and what is painted at the threshold.
    airfield: String,
    designator: Option<String>,
    #[serde(default)]
    from_threshold_m: f64,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Station {
    weapon: String,
    rounds: u32,
    #[serde(deserialize_with = "crate::file::exactly")]
    at_m: [f64; 3],
}

/// A runway as it is flown from: where it begins, the way along it from grid north, its level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub threshold: DVec2,
    pub course_rad: f64,
    pub level_m: f64,
}

/// Where it begins.
pub(super) struct Start {
    pub place: Geodetic,
    pub state: AircraftState,
    pub runway: Option<Line>,
}

impl Own {
    /// Adds the model to a catalogue; `None` for the point mass.
    pub fn add_model(&self, file: &Path, catalogue: &mut Catalogue) -> Result<Option<Arc<Model>>, Refused> {
        let Some(name) = &self.aircraft else { return Ok(None) };
        let beside = || Model::read(&file.parent().unwrap_or(Path::new("")).join(name));
        let model = builtin::named(name).unwrap_or_else(beside).map_err(Refused::new)?;
        catalogue.add_model(NAME, model.clone())?;
        Ok(Some(Arc::new(model)))
    }

    /// Where it begins on a world.
    pub fn start(&self, world: &World, model: Option<&Model>) -> Result<Start, Refused> {
        if let Some(from) = &self.runway {
            return from.start(world, model);
        }
        let needed = |key: &str, value: Option<f64>| {
            value.ok_or_else(|| {
                Refused::new(format_args!("{key}: expected a number, as there is no runway, found none"))
            })
        };
        let at = [needed("lat_deg", self.lat_deg)?, needed("lon_deg", self.lon_deg)?];
        let altitude_m = needed("altitude_m", self.altitude_m)?;
        let place = Geodetic::from_degrees(at[0], at[1]);
        let laid = Laid::new(world, place);
        let plan = laid.place(at, false)?.0;
        let heading_rad = self.heading_deg.to_radians() - laid.convergence_rad;
        let state = AircraftState::level(DVec3::new(plan.x, altitude_m, plan.y), heading_rad, self.speed_mps);
        Ok(Start { place, state, runway: None })
    }

    /// Makes the body, if it is one, the own aircraft, with its levers as they begin and its altimeter set; gives the id that a script orders.
    pub fn seat(&self, scene: &mut Scene, start: &Start, altimeter_pa: f64) -> Result<StableId, Refused> {
        let throttle = if self.throttle.is_finite() { self.throttle } else { 0.0 };
        scene.set_controls(crate::input::Controls { throttle, ..Default::default() });
        let down = |is_down: bool| f64::from(u8::from(is_down));
        let (gear, parking_brake) = (down(self.aircraft.is_none() || start.runway.is_some()), down(self.parking_brake));
        scene.set_levers(Levers { gear, parking_brake, altimeter_pa, ..Levers::default() });
        if self.aircraft.is_none() {
            return Ok(scene.own_id());
        }
        let AircraftState { position_m, velocity_mps, attitude, rates_radps, .. } = start.state;
        let fuel = self.fuel_kg.map(|fuel_kg| Fuel { fuel_kg, flow_kgps: 0.0 });
        let model = NAME.to_owned();
        let id = scene.add_body(&BodyStart { model, position_m, velocity_mps, attitude, rates_radps, fuel })?;
        scene.order(Command::FlyBody { id })?;
        Ok(id)
    }

    /// Hangs the stores and selects one.
    pub fn arm(&self, scene: &mut Scene) -> Result<(), (String, Refused)> {
        let owner = scene.own_id();
        for (at, station) in self.station.iter().enumerate() {
            let Station { weapon, rounds, at_m } = station.clone();
            let load = Command::Load { owner, weapon, rounds, at_m: DVec3::from_array(at_m) };
            scene.order(load).map_err(|why| (format!("station[{at}]"), why))?;
        }
        if self.select.is_some() {
            let arm = Command::Arm { owner, master: false, weapon: self.select.clone(), fuze: None };
            scene.order(arm).map_err(|why| ("select".to_owned(), why))?;
        }
        if self.aircraft.is_some() && self.runway.is_none() {
            // A start that nothing can hold level is flown as it is given.
            let _ = scene.trim_flown();
        }
        Ok(())
    }
}

impl RunwayStart {
    fn start(&self, world: &World, model: Option<&Model>) -> Result<Start, Refused> {
        let airfields = &world.features.airfields;
        let airfield = airfields.iter().find(|airfield| airfield.code == self.airfield).ok_or_else(|| {
            let known: Vec<&str> = airfields.iter().map(|airfield| airfield.code.as_str()).collect();
            let known = known.join(", ");
            Refused::new(format_args!("runway.airfield: expected one of [{known}], found {}", self.airfield))
        })?;
        let both = airfield.runways.iter().flat_map(|runway| [(runway, 0), (runway, 1)]);
        let fits = |(runway, end): &(&terrain::features::model::Runway, usize)| {
            self.designator.as_ref().is_none_or(|painted| runway.designators[*end] == *painted)
        };
        let (runway, end) = both.clone().find(fits).ok_or_else(|| {
            let known: Vec<&str> = both.map(|(runway, end)| runway.designators[end].as_str()).collect();
            let found = self.designator.as_deref().unwrap_or("none");
            let known = known.join(", ");
            Refused::new(format_args!("runway.designator: expected one of [{known}], found {found}"))
        })?;
        let (threshold, far) = (runway.ends[end], runway.ends[1 - end]);
        let length_m = threshold.distance(far);
        if !(0.0..length_m).contains(&self.from_threshold_m) {
            let found = self.from_threshold_m;
            return Err(Refused::new(format_args!(
                "runway.from_threshold_m: expected 0..{length_m:.0} m, found {found}"
            )));
        }
        let along = (far - threshold) / length_m;
        let plan = threshold + along * self.from_threshold_m;
        let heading_rad = along.x.atan2(-along.y);
        let standing_m = model.map_or(crate::GEAR_HEIGHT_M, standing_height_m);
        let position_m = DVec3::new(plan.x, airfield.level_m + standing_m, plan.y);
        let state = AircraftState {
            velocity_mps: DVec3::ZERO,
            attitude: attitude(Angles { heading_rad, ..Angles::default() }),
            airspeed_mps: 0.0,
            throttle: 0.0,
            condition: crate::Condition::OnGround,
            ..AircraftState::level(position_m, heading_rad, 0.0)
        };
        let line = Line { threshold, course_rad: heading_rad, level_m: airfield.level_m };
        Ok(Start { place: world.projection.to_geodetic(plan), state, runway: Some(line) })
    }
}
