//! What moves a body's controls: failures, the time that they take, an autopilot.

use super::Body;
use crate::autopilot::{Autopilot, Holds, Moves, Seen};
use crate::frame::world_attitude_from_ned;
use crate::rigid::Model;
use crate::rigid::motion::{self, RigidMotion};
use crate::scene::Refused;
use crate::scene::failure::Fault;

impl Body {
    /// Lets the failures that are due set in, and names each to `told`.
    pub fn set_in(&mut self, step: u64, mut told: impl FnMut(&str)) {
        for place in 0..self.failures.len() {
            if self.failures[place].active || self.failures[place].at_step > step {
                continue;
            }
            if let Fault::Stuck(control, _) = self.failures[place].fault {
                let held = self.acting(control);
                self.failures[place].fault = Fault::Stuck(control, held);
            }
            self.failures[place].active = true;
            self.look_anew();
            told(&self.failures[place].name);
        }
    }

    /// What a control is at, failures counted.
    pub(super) fn acting(&self, control: u32) -> f64 {
        let commanded = self.controls[control as usize];
        self.failures.iter().filter(|armed| armed.active).fold(commanded, |value, armed| match armed.fault {
            Fault::Stuck(of, held) if of == control => held,
            Fault::Free(of) if of == control => 0.0,
            _ => value,
        })
    }

    /// Moves the controls that take their time by a step.
    pub(super) fn move_controls(&mut self, model: &Model, dt_s: f64) {
        for place in 0..self.moved.len() {
            let of = &model.controls[place];
            let wanted = self.acting(place as u32).clamp(of.min, of.max);
            let most = of.per_s.map_or(f64::INFINITY, |per_s| per_s * dt_s);
            let share = of.lag_s.map_or(1.0, |lag_s| 1.0 - (-dt_s / lag_s).exp());
            self.moved[place] += ((wanted - self.moved[place]) * share).clamp(-most, most);
        }
    }

    /// Puts the controls that take their time where they are told to be, as before a flight.
    pub fn settle_controls(&mut self, model: &Model) {
        for place in 0..self.moved.len() {
            let of = &model.controls[place];
            self.moved[place] = self.acting(place as u32).clamp(of.min, of.max);
        }
    }

    /// What its autopilot sees.
    pub fn seen(&self, motion: &RigidMotion) -> Seen {
        let at = self.carriage(&motion.planet);
        let wind = motion.wind.ned_mps(motion.planet.altitude_m(motion::position(&self.state)));
        Seen {
            position_m: at.position_m,
            velocity_mps: at.velocity_mps,
            angles: crate::frame::angles(at.attitude),
            rates_radps: at.rates_radps,
            airspeed_mps: (motion::velocity(&self.state) - wind).length(),
            sight: self.sight,
        }
    }

    /// The autopilot's step.
    pub(super) fn fly_by_itself(&mut self, motion: &RigidMotion, dt_s: f64) {
        let seen = self.seen(motion);
        let Some(autopilot) = &mut self.autopilot else { return };
        let Moves { elevator, aileron, throttle } = autopilot.step(&seen, &motion.model.autopilot, dt_s);
        let moves = [("elevator_norm", elevator), ("aileron_norm", aileron), ("throttle_norm", throttle)];
        for (name, part) in moves {
            if let (Some(place), Some(part)) = (motion.model.control(name), part) {
                let of = &motion.model.controls[place];
                let value = if part < 0.0 { -part * of.min } else { part * of.max };
                self.controls[place] = value.clamp(of.min, of.max);
            }
        }
    }

    /// Engages an autopilot that starts from the flight as it is, or takes it out.
    pub fn engage(&mut self, holds: Option<Holds>, model: &Model) -> Result<(), Refused> {
        let Some(holds) = holds else {
            (self.autopilot, self.sight) = (None, None);
            return Ok(());
        };
        if !holds.is_sound() {
            return Err(Refused::new(
                "autopilot: expected finite numbers, and one of a heading, a track and an attack",
            ));
        }
        let [elevator, aileron, throttle] = holds.moves();
        let needs = [("elevator_norm", elevator), ("aileron_norm", aileron), ("throttle_norm", throttle)];
        if let Some((name, _)) = needs.iter().find(|(name, needed)| *needed && model.control(name).is_none()) {
            return Err(Refused::new(format_args!("autopilot: expected a model with a control {name}, found none")));
        }
        let part = |name: &str| model.control(name).map_or(0.0, |place| self.controls[place]);
        let pitch_rad = crate::frame::angles(world_attitude_from_ned(motion::attitude(&self.state))).pitch_rad;
        let (elevator, throttle) = (part("elevator_norm"), part("throttle_norm"));
        let [low, high] = model.autopilot.pitch_limits_rad;
        self.autopilot = Some(Autopilot::engaged(holds, pitch_rad.clamp(low, high), elevator, throttle));
        Ok(())
    }
}
