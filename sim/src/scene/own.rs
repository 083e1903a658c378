//! The own aircraft of a scene: flown by the pilot, along its track, or slewed.
//!
//! World frame. It is a point mass ([`crate::aircraft::point_mass`]) in the scene's wind; contact with the ground is
//! added after its step. Invariant others rely on: its state is finite and within bounds, and not under the ground.

use super::{Command, Freeze, Scene, SceneGround};
use crate::aircraft::{self, AircraftState, Condition};
use crate::atmosphere::Air;
use crate::clock::Clock;
use crate::frame::world_from_ned;
use crate::input::{self, Controls, Levers};
use crate::slew::{SlewRates, slew};
use crate::snapshot::Mode;
use crate::track::Track;
use crate::{GEAR_HEIGHT_M, HeightAt};

impl Scene {
    /// Gives the scene a track and puts the aircraft at its start, flying it.
    pub fn fly_track(&mut self, track: Track) {
        self.start = track.state(0.0, self.controls.throttle);
        self.track = Some(track);
        self.track_m = 0.0;
        self.mode = Mode::Track;
        self.put(self.start);
    }

    /// Moves along the track to a distance from its start, metres; nothing without a track or if not finite.
    pub fn seek_track(&mut self, distance_m: f64) {
        // Only a distance that is none is refused.
        let _ = self.order(Command::SeekTrack(distance_m));
    }

    pub(super) fn seek(&mut self, distance_m: f64) {
        if let Some(track) = self.track.as_ref().filter(|_| distance_m.is_finite()) {
            let state = track.state(distance_m, self.controls.throttle);
            (self.track_m, self.mode) = (distance_m, Mode::Track);
            self.put(state);
        }
    }

    /// The track, if there is one.
    pub fn track(&self) -> Option<&Track> {
        self.track.as_ref()
    }

    /// Puts the aircraft into a state at once; one that is not finite is ignored.
    pub fn place(&mut self, state: AircraftState) {
        let attitude = state.attitude.normalize();
        // What is refused is ignored, as said.
        let _ = self.order(Command::Place(Box::new(AircraftState { attitude, ..state })));
    }

    pub(super) fn put(&mut self, state: AircraftState) {
        if state.is_finite() {
            let state = aircraft::checked(&self.aircraft(), state);
            self.jumps = self.jumps.wrapping_add(1);
            self.set_aircraft(state);
            self.seat_flown();
        }
    }

    /// Axes as the pilot holds them.
    pub fn controls(&self) -> Controls {
        self.controls
    }

    /// What the pilot commands from now on.
    pub fn set_controls(&mut self, controls: Controls) {
        // Checked controls are never refused.
        let _ = self.order(Command::Controls(controls.checked()));
    }

    /// Levers of the pilot from now on.
    pub fn set_levers(&mut self, levers: Levers) {
        // Checked levers are never refused.
        let _ = self.order(Command::Levers(levers.checked()));
    }

    /// Carries out a pilot's command. Those that concern only the picture (screenshot, overlays, looking) do nothing here.
    pub fn command(&mut self, command: input::Command) {
        // A pilot's commands have no numbers to refuse.
        let _ = self.order(Command::Pilot(command));
    }

    pub(super) fn pilot(&mut self, command: input::Command) {
        const HOUR_S: f64 = 3_600.0;
        const MONTH_S: f64 = 30.0 * 24.0 * HOUR_S;
        let later = |clock: &mut Clock, seconds: f64| clock.set_date(clock.date().plus_s(seconds));
        match command {
            input::Command::Pause => self.clock.set_paused(!self.clock.paused()),
            input::Command::Freeze => {
                self.freeze = if self.freeze == Freeze::None { Freeze::Flight } else { Freeze::None }
            }
            input::Command::Reset => self.reset(),
            input::Command::Slew => {
                self.mode = if self.mode == Mode::Slew { Mode::Pilot } else { Mode::Slew };
                self.jumps = self.jumps.wrapping_add(1);
                if self.mode == Mode::Pilot {
                    self.leave_slew();
                }
            }
            input::Command::Track if self.track.is_some() => {
                if self.mode == Mode::Track {
                    self.mode = Mode::Pilot;
                } else {
                    self.seek(self.track_m);
                }
            }
            input::Command::FlapsDown
            | input::Command::FlapsUp
            | input::Command::Gear
            | input::Command::Brake
            | input::Command::BrakeEnd
            | input::Command::ParkingBrake
            | input::Command::TrimUp
            | input::Command::TrimDown
            | input::Command::MixtureRich
            | input::Command::MixtureLean
            | input::Command::AltimeterUp
            | input::Command::AltimeterDown => self.lever(command),
            input::Command::MasterArm
            | input::Command::NextWeapon
            | input::Command::NextRipple
            | input::Command::Jettison
            | input::Command::Trigger
            | input::Command::TriggerEnd => self.crew(command),
            input::Command::TimeForward => later(&mut self.clock, HOUR_S),
            input::Command::TimeBack => later(&mut self.clock, -HOUR_S),
            input::Command::DateForward => later(&mut self.clock, MONTH_S),
            input::Command::DateBack => later(&mut self.clock, -MONTH_S),
            input::Command::RateUp => self.clock.set_rate((self.clock.rate() * 2.0).min(8.0)),
            input::Command::RateDown => self.clock.set_rate((self.clock.rate() * 0.5).max(0.125)),
            _ => {}
        }
    }

    /// A step of the own aircraft.
    pub(super) fn step_own(&mut self, height_at: &HeightAt, dt_s: f64) {
        let before = self.aircraft();
        let after = match (self.mode, &self.track) {
            (Mode::Slew, _) => {
                let height_m = self.height_above_ground_m.unwrap_or(1_000.0);
                slew(&before, SlewRates::from_controls(&self.controls, height_m), height_at, dt_s)
            }
            (Mode::Track, Some(track)) => {
                self.track_m += track.speed_mps() * dt_s;
                track.state(self.track_m, self.controls.throttle)
            }
            _ => {
                let altitude_m = before.position_m.y;
                let density_kgpm3 = self.surroundings.atmosphere.at(altitude_m).density_kgpm3;
                let air = Air { density_kgpm3, wind_mps: world_from_ned(self.surroundings.wind.ned_mps(altitude_m)) };
                let flown = self.model.step(&before, &self.controls, &air, dt_s);
                let met = if before.condition == Condition::Crashed {
                    flown
                } else {
                    aircraft::meet_ground(&before, aircraft::checked(&before, flown), height_at, dt_s)
                };
                AircraftState { throttle: self.controls.throttle, ..met }
            }
        };
        let mut after = aircraft::checked(&before, after);
        if self.freeze == Freeze::Position {
            (after.position_m.x, after.position_m.z) = (before.position_m.x, before.position_m.z);
        }
        // A track is flown as given, but not under the ground.
        if let Some(ground_m) = height_at(after.position_m.x, after.position_m.z).filter(|h| h.is_finite()) {
            after.position_m.y = after.position_m.y.max(ground_m + GEAR_HEIGHT_M);
        }
        self.set_aircraft(after);
    }

    /// Takes the height above ground anew without a step, as before the first one or after placing.
    ///
    /// Targets that were just added take theirs.
    pub fn look_down(&mut self, ground: &SceneGround) {
        self.settle(ground);
        let at = self.aircraft().position_m;
        self.height_above_ground_m = ground.height_m(at.x, at.z).filter(|h| h.is_finite()).map(|h| at.y - h);
        self.look_at_arms(ground);
    }

    /// The own aircraft.
    pub fn aircraft(&self) -> AircraftState {
        self.ecs.get::<&AircraftState>(self.own).map_or(self.start, |state| *state)
    }

    pub(super) fn set_aircraft(&mut self, state: AircraftState) {
        // The own aircraft is spawned with the scene and never despawned.
        if let Ok(mut own) = self.ecs.get::<&mut AircraftState>(self.own) {
            *own = state;
        }
    }

    fn reset(&mut self) {
        self.track_m = 0.0;
        self.freeze = Freeze::None;
        self.mode = if self.track.is_some() { Mode::Track } else { Mode::Pilot };
        self.put(self.start);
    }

    /// Flight after slewing starts at a speed that flies, along the nose.
    fn leave_slew(&mut self) {
        let now = self.aircraft();
        let speed_mps = self.start.airspeed_mps.clamp(120.0, 300.0);
        let level = AircraftState::level(now.position_m, now.angles().heading_rad, speed_mps);
        self.set_aircraft(AircraftState { throttle: now.throttle, ..level });
        self.seat_flown();
    }
}
