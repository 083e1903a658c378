//! The own aircraft as a rigid body: the pilot's controls go to the body by name, and the own aircraft is where it is.
//!
//! Stick, pedals and throttle go to `elevator_norm`, `aileron_norm`, `rudder_norm`, `throttle_norm` (back, right and right
//! positive); levers to `mixture_norm`, `flaps_*`, `gear_norm`, `brake_left_norm`, `brake_right_norm`, `parking_brake_norm`,
//! `elevator_trim_norm`, `starter_norm`: each a part of the way from 0 to the control's end. On a track or slewed the body is
//! carried along, and flies on from where it is let go.
//!
//! Invariant others rely on: between two steps the own aircraft is where the body is.

use super::body::{Body, Rig};
use super::{Refused, Scene, found};
use crate::aircraft::AircraftState;
use crate::frame::world_from_ned;
use crate::input::{Controls, Levers};
use crate::planet::STANDARD_GRAVITY_MPS2;
use crate::rigid::motion;
use crate::rigid::quantity::without_unit;
use crate::snapshot::{Mode, StableId};
use glam::DVec3;
use std::f64::consts::TAU;

/// What an aircraft with an engine of its own shows its pilot, beside its flight.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Instruments {
    /// Speed of the engine's shaft and its rated one, turns a minute; 0 without one.
    pub rpm: [f64; 2],
    /// Fuel that is left and what the tanks hold, kg; 0 where none is counted.
    pub fuel_kg: [f64; 2],
    /// Throttle as it is commanded, by the pilot or what flies for him, 0..1.
    pub throttle: f64,
    /// Gear that retracts, as it stands: 0 up, 1 down.
    pub gear: Option<f64>,
    /// Flaps as they stand and full out, in the unit of their control; 0 without any.
    pub flaps: [f64; 2],
    /// Force to the right over weight, as the slip ball shows it.
    pub side_g: f64,
    /// Whether the stall warning sounds.
    pub stall_warning: bool,
    /// How much the airframe shakes before and in the stall, 0..1.
    pub buffet: f64,
}

impl Instruments {
    /// The shake at a time, radians: nose up and right wing down. A picture of it only: the flight does not shake.
    pub fn shake_rad(&self, time_s: f64) -> [f64; 2] {
        // Two tones that do not beat in step; a light airframe's is felt at some ten a second.
        let tone = |hz: f64| (TAU * (hz * time_s).fract()).sin();
        [0.004 * self.buffet * tone(11.3), 0.006 * self.buffet * tone(8.7)]
    }
}

/// The part of a control's way that pilot and levers ask for, by the control's name; `None` for another control.
fn asked(name: &str, controls: &Controls, levers: &Levers) -> Option<f64> {
    let (stem, _) = without_unit(name)?;
    if stem == "flaps" {
        return Some(levers.flaps);
    }
    if !name.ends_with("_norm") {
        return None;
    }
    Some(match stem {
        "elevator" => controls.pitch,
        "aileron" => controls.roll,
        "rudder" => controls.yaw,
        "throttle" => controls.throttle,
        "mixture" => levers.mixture,
        "gear" => levers.gear,
        "brake_left" => levers.brakes[0],
        "brake_right" => levers.brakes[1],
        "parking_brake" => levers.parking_brake,
        "elevator_trim" => levers.trim,
        "starter" => levers.starter,
        _ => return None,
    })
}

/// The own aircraft of a body that it is, and the force to its right over weight; `before` was it a step earlier.
fn seen(body: &Body, rig: &Rig, before: &AircraftState, throttle: f64, dt_s: f64) -> (AircraftState, f64) {
    let planet = &rig.motion.planet;
    let at = body.carriage(planet);
    let (y, turned) = (&body.state, motion::attitude(&body.state));
    let wind = rig.motion.wind.ned_mps(planet.altitude_m(motion::position(y)));
    let through_air = turned.inverse() * (motion::velocity(y) - wind);
    // What a pilot feels: the change of velocity less what a free fall has.
    let change = (at.velocity_mps - before.velocity_mps) / dt_s;
    let fall = world_from_ned(planet.fall_mps2(motion::position(y), motion::velocity(y)));
    let felt = at.attitude.inverse() * (change - fall);
    let whole = body.ended.is_none();
    let state = AircraftState {
        position_m: at.position_m,
        velocity_mps: at.velocity_mps,
        attitude: at.attitude,
        rates_radps: at.rates_radps,
        load_factor: if whole { -felt.z / STANDARD_GRAVITY_MPS2 } else { 1.0 },
        alpha_rad: if through_air.length() > 1.0 { through_air.z.atan2(through_air.x) } else { 0.0 },
        airspeed_mps: through_air.length(),
        throttle,
        condition: body.condition(),
    };
    (state, if whole { felt.y / STANDARD_GRAVITY_MPS2 } else { 0.0 })
}

impl Scene {
    /// The body that is the own aircraft, if it is one.
    pub fn flown(&self) -> Option<StableId> {
        self.flown
    }

    /// Levers as they stand.
    pub fn levers(&self) -> Levers {
        self.levers
    }

    /// Makes a body the own aircraft; the own aircraft's id makes it the point mass again.
    pub(super) fn fly(&mut self, id: StableId) -> Result<(), Refused> {
        let missing = || Refused::new(format_args!("id: expected a rigid body of the scene, found {}", id.0));
        let entity = found(&self.bodies, id);
        if entity.is_none() && id != self.own_id {
            return Err(missing());
        }
        let left = self.flown.take();
        if let Some(left) = left.filter(|left| *left != id) {
            self.weigh(left);
        }
        let Some(entity) = entity else { return Ok(()) };
        self.flown = Some(id);
        self.weigh(id);
        if self.clock.step() == 0 {
            self.command_flown(entity);
            if let Ok(mut body) = self.ecs.get::<&mut Body>(entity) {
                let model = self.catalogue.models[body.model as usize].thing.clone();
                body.settle_controls(&model);
            }
        }
        let state = {
            let body = self.ecs.get::<&Body>(entity).map_err(|_| missing())?;
            let at = body.carriage(&self.surroundings.planet());
            // No step was taken: nothing but its weight is felt.
            let rest = AircraftState { velocity_mps: at.velocity_mps, ..self.aircraft() };
            let (now, _) = seen(&body, &self.rigs[body.model as usize], &rest, self.controls.throttle, 1.0);
            AircraftState { load_factor: 1.0, ..now }
        };
        (self.mode, self.track) = (Mode::Pilot, None);
        self.start = state;
        self.jumps = self.jumps.wrapping_add(1);
        self.set_aircraft(state);
        Ok(())
    }

    /// Trims the own body for level flight as it goes, with its fuel and its stores: pitch, elevator trim, throttle, the
    /// mixture at best power; the pilot's controls and levers are set with it. To be asked before the first step.
    ///
    /// # Errors
    /// [`Refused`] says that the own aircraft is no body, or what of the balance is missing; all is then as it was.
    pub fn trim_flown(&mut self) -> Result<(), Refused> {
        let none = || Refused::new("trim: expected an own aircraft that is a rigid body, found none");
        let entity = self.flown.and_then(|id| found(&self.bodies, id)).ok_or_else(none)?;
        let planet = self.surroundings.planet();
        let (part, at) = {
            let mut body = self.ecs.get::<&mut Body>(entity).map_err(|_| none())?;
            let rig = &mut self.rigs[body.model as usize];
            body.load(rig);
            let (controls, angles_rad) =
                crate::handling::level_from(&mut rig.motion, &body.state).map_err(Refused::new)?;
            let model = rig.motion.model.clone();
            let at = body.carriage(&planet);
            let turned = crate::frame::attitude(angles_rad);
            body.relocate(at.position_m, at.velocity_mps, turned, DVec3::ZERO, &planet)?;
            let part = move |stem: &str| {
                crate::handling::control(&model, stem).map(|place| {
                    let (of, value) = (&model.controls[place], controls[place]);
                    let most = if value < 0.0 { -of.min } else { of.max };
                    if most > 0.0 { value / most } else { 0.0 }
                })
            };
            (part, AircraftState { attitude: turned, ..self.aircraft() })
        };
        self.controls.throttle = part("throttle").unwrap_or(self.controls.throttle);
        self.levers.trim = part("elevator_trim").unwrap_or(0.0);
        self.levers.mixture = part("mixture").unwrap_or(self.levers.mixture);
        self.levers = self.levers.checked();
        if part("elevator_trim").is_none() {
            self.controls.pitch = part("elevator").unwrap_or(0.0);
        }
        self.set_aircraft(at);
        self.command_flown(entity);
        if let Ok(mut body) = self.ecs.get::<&mut Body>(entity) {
            let rig = &mut self.rigs[body.model as usize];
            body.settle_controls(&rig.motion.model.clone());
            body.start_engine(rig);
        }
        self.fly(self.flown.unwrap_or(self.own_id))
    }

    /// The body that the pilot flies now.
    pub(super) fn piloted(&self) -> Option<hecs::Entity> {
        self.flown.filter(|_| self.mode == Mode::Pilot).and_then(|id| found(&self.bodies, id))
    }

    /// Gives the pilot's controls to the body.
    pub(super) fn command_flown(&mut self, entity: hecs::Entity) {
        let Ok(mut body) = self.ecs.get::<&mut Body>(entity) else { return };
        let model = &self.catalogue.models[body.model as usize].thing;
        for (place, of) in model.controls.iter().enumerate() {
            if let Some(part) = asked(&of.name, &self.controls, &self.levers) {
                let value = if part < 0.0 { -part * of.min } else { part * of.max };
                body.controls[place] = value.clamp(of.min, of.max);
            }
        }
    }

    /// Puts the own aircraft where the body went in a step.
    pub(super) fn follow_flown(&mut self, entity: hecs::Entity, dt_s: f64) {
        let before = self.aircraft();
        let Some((state, side_g)) = self
            .ecs
            .get::<&Body>(entity)
            .ok()
            .map(|body| seen(&body, &self.rigs[body.model as usize], &before, self.controls.throttle, dt_s))
        else {
            return;
        };
        self.side_g = side_g;
        self.set_aircraft(state);
    }

    /// Puts the own aircraft where the body's centre of gravity went between two steps.
    pub(super) fn join_flown(&mut self) {
        let Some(entity) = self.flown.and_then(|id| found(&self.bodies, id)) else { return };
        let at = self.ecs.get::<&Body>(entity).map(|body| body.carriage(&self.surroundings.planet()));
        if let Ok(at) = at {
            let own = self.aircraft();
            self.set_aircraft(AircraftState { position_m: at.position_m, velocity_mps: at.velocity_mps, ..own });
        }
    }

    /// Puts the body where the own aircraft was put, whole and with its engine running.
    pub(super) fn seat_flown(&mut self) {
        let own = self.aircraft();
        let Some(entity) = self.flown.and_then(|id| found(&self.bodies, id)) else { return };
        let Ok(mut body) = self.ecs.get::<&mut Body>(entity) else { return };
        let rig = &mut self.rigs[body.model as usize];
        let planet = self.surroundings.planet();
        let (broken, jumps) = (body.ended.is_some(), body.jumps);
        // Within its bounds an own aircraft is a body's too.
        let moved = body.relocate(own.position_m, own.velocity_mps, own.attitude, own.rates_radps, &planet);
        if moved.is_ok() && broken {
            body.start_engine(rig);
        }
        if own.velocity_mps == DVec3::ZERO || self.mode != Mode::Pilot {
            body.jumps = jumps;
        }
        self.views.bodies.take();
    }

    /// What the own aircraft's instruments show; `None` for the point mass.
    pub fn instruments(&self) -> Option<Instruments> {
        let body = self.ecs.get::<&Body>(found(&self.bodies, self.flown?)?).ok()?;
        let model = &self.catalogue.models[body.model as usize].thing;
        let own = self.aircraft();
        let flaps = crate::handling::control(model, "flaps");
        let at = |place: usize| body.moved.get(place).or_else(|| body.controls.get(place)).copied().unwrap_or(0.0);
        let airborne = own.airspeed_mps > 10.0;
        let buffet = model.stall.filter(|_| airborne).map_or(0.0, |cues| {
            ((own.alpha_rad - cues.buffet_rad) / (cues.full_buffet_rad - cues.buffet_rad)).clamp(0.0, 1.0)
        });
        let turns = body.shaft_radps / TAU;
        let share = |place: usize, value: f64| {
            let most = model.controls[place].max;
            if most > 0.0 { (value / most).clamp(0.0, 1.0) } else { 0.0 }
        };
        let throttle = crate::handling::control(model, "throttle");
        let gear = model.contacts.iter().find_map(|contact| contact.lowered_by);
        Some(Instruments {
            rpm: [60.0 * turns, model.power.as_ref().map_or(0.0, |power| 60.0 * power.engine.rated_radps / TAU)],
            fuel_kg: [
                body.tanks.as_ref().map_or(0.0, |tanks| tanks.fuel.fuel_kg),
                model.tank.map_or(0.0, |tank| tank.capacity_kg),
            ],
            flaps: [flaps.map_or(0.0, at), flaps.map_or(0.0, |place| model.controls[place].max)],
            throttle: throttle.map_or(own.throttle, |place| share(place, body.controls[place])),
            gear: gear.map(|place| share(place, at(place))),
            side_g: self.side_g,
            stall_warning: airborne && model.stall.is_some_and(|cues| own.alpha_rad >= cues.warning_rad),
            buffet,
        })
    }
}
