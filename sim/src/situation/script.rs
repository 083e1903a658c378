//! What is done when, in the place of a pilot: axes, levers, switches, what the autopilot holds. Times are scene seconds.
//!
//! A step sets what it names and leaves the rest as it was. `hold` engages the autopilot of the own aircraft, which must
//! then be a rigid body: an altitude above the sea or over the runway's level, a heading from true north or from the
//! runway's course, a speed, the runway's line itself or one between two places, the aim of the selected weapon at a target;
//! `fly = true` takes it out.

use super::laid::Laid;
use super::own::Line;
use crate::autopilot::Holds;
use crate::input;
use crate::scene::{Command, Refused, Scene, Stamped};
use crate::snapshot::StableId;
use serde::Deserialize;

/// `[[script]]`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Step {
    pub at_s: f64,
    pitch: Option<f64>,
    roll: Option<f64>,
    yaw: Option<f64>,
    throttle: Option<f64>,
    mixture: Option<f64>,
    flaps: Option<f64>,
    gear: Option<f64>,
    brakes: Option<f64>,
    parking_brake: Option<f64>,
    trim: Option<f64>,
    hold: Option<Hold>,
    #[serde(default)]
    fly: bool,
    command: Option<String>,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Hold {
    altitude_m: Option<f64>,
    over_runway_m: Option<f64>,
    heading_deg: Option<f64>,
    from_runway_deg: Option<f64>,
    speed_mps: Option<f64>,
    #[serde(default)]
    runway: bool,
    /// A line over the ground: latitude and longitude of two places on it.
    #[serde(default, deserialize_with = "crate::file::rows")]
    line: Vec<[f64; 2]>,
    /// Kind of the target that the selected weapon is laid on: the nearest of it to the own aircraft's start that stands.
    attack: Option<String>,
}

impl Step {
    /// What can be told without a world.
    pub fn check(&self) -> Result<(), String> {
        if !(0.0..=1e6).contains(&self.at_s) {
            return Err(format!("at_s: expected seconds, found {}", self.at_s));
        }
        if let Some(name) = &self.command
            && input::Command::named(name).is_none()
        {
            let known: Vec<&str> = input::Command::names().collect();
            return Err(format!("command: expected one of {}, found {name}", known.join(" ")));
        }
        Ok(())
    }

    /// Schedules it, after the steps before it.
    pub fn schedule(
        &self,
        scene: &mut Scene,
        owner: StableId,
        laid: &Laid<'_>,
        runway: Option<&Line>,
    ) -> Result<(), Refused> {
        let step = (self.at_s * f64::from(scene.clock.step_hz())).round() as u64;
        // As the steps before this one leave them.
        let (mut controls, mut levers) = (scene.controls(), scene.levers());
        for Stamped { command, .. } in scene.pending() {
            match command {
                Command::Controls(then) => controls = *then,
                Command::Levers(then) => levers = *then,
                _ => {}
            }
        }
        let (controls_before, levers_before) = (controls, levers);
        let axes = [
            (self.pitch, &mut controls.pitch),
            (self.roll, &mut controls.roll),
            (self.yaw, &mut controls.yaw),
            (self.throttle, &mut controls.throttle),
            (self.mixture, &mut levers.mixture),
            (self.flaps, &mut levers.flaps),
            (self.gear, &mut levers.gear),
            (self.parking_brake, &mut levers.parking_brake),
            (self.trim, &mut levers.trim),
        ];
        for (given, value) in axes {
            *value = given.unwrap_or(*value);
        }
        levers.brakes = self.brakes.map_or(levers.brakes, |brakes| [brakes; 2]);
        let hold = self.hold.as_ref().map(|hold| hold.holds(scene, laid, runway)).transpose()?;
        let mut order = |command| scene.schedule(Stamped { step, command });
        if controls != controls_before {
            order(Command::Controls(controls.checked()))?;
        }
        if levers != levers_before {
            order(Command::Levers(levers.checked()))?;
        }
        if let Some(holds) = hold {
            order(Command::Autopilot { id: owner, holds: Some(holds) })?;
        } else if self.fly {
            order(Command::Autopilot { id: owner, holds: None })?;
        }
        if let Some(command) = self.command.as_deref().and_then(input::Command::named) {
            order(Command::Pilot(command))?;
        }
        Ok(())
    }
}

impl Hold {
    fn holds(&self, scene: &Scene, laid: &Laid<'_>, runway: Option<&Line>) -> Result<Holds, Refused> {
        let needs = |key: &str| Refused::new(format_args!("hold.{key}: expected an aircraft that began on a runway"));
        let line = |key: &str| runway.ok_or_else(|| needs(key));
        let altitude_m = match (self.altitude_m, self.over_runway_m) {
            (None, Some(over_m)) => Some(line("over_runway_m")?.level_m + over_m),
            (altitude_m, _) => altitude_m,
        };
        let heading_rad = match (self.heading_deg, self.from_runway_deg) {
            (None, Some(off_deg)) => Some(line("from_runway_deg")?.course_rad + off_deg.to_radians()),
            (true_deg, _) => true_deg.map(|deg| deg.to_radians() - laid.convergence_rad),
        };
        let track = match (self.runway, self.line.as_slice()) {
            (true, _) => line("runway").map(|line| Some((line.threshold, line.course_rad)))?,
            (false, []) => None,
            (false, [from, to]) => {
                let (from, to) = (laid.place(*from, false)?.0, laid.place(*to, false)?.0);
                let way = to - from;
                Some((from, way.x.atan2(-way.y)))
            }
            (false, other) => {
                let found = other.len();
                return Err(Refused::new(format_args!("hold.line: expected two places, found {found}")));
            }
        };
        let attack = self.attack.as_ref().map(|kind| scene.nearest_target(kind)).transpose()?;
        let holds = Holds { altitude_m, heading_rad, speed_mps: self.speed_mps, track, attack };
        if holds.is_sound() {
            Ok(holds)
        } else {
            Err(Refused::new("hold: expected finite numbers, and one of a heading, a line and an attack"))
        }
    }
}
