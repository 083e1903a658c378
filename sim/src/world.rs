//! The scene: its entities and its time.
//!
//! Entities live in a hecs world; each has a [`StableId`] that does not depend on how hecs stores it. [`Scene::step`]
//! takes one fixed step; [`Scene::snapshot`] is what the rest of the program gets to see.

use crate::aircraft::point_mass::PointMass;
use crate::aircraft::{self, AircraftState, Condition};
use crate::atmosphere::Air;
use crate::clock::{Clock, DEFAULT_STEP_HZ};
use crate::input::{Command, Controls};
use crate::slew::{SlewRates, slew};
use crate::snapshot::{Flags, Mode, Snapshot, StableId};
use crate::track::Track;
use crate::utc::UtcTime;
use crate::{GEAR_HEIGHT_M, HeightAt};
use glam::DVec3;

/// A scene and its time.
pub struct Scene {
    ecs: hecs::World,
    own: hecs::Entity,
    own_id: StableId,
    /// Time.
    pub clock: Clock,
    model: PointMass,
    start: AircraftState,
    controls: Controls,
    track: Option<Track>,
    track_m: f64,
    mode: Mode,
    frozen: bool,
    height_above_ground_m: Option<f64>,
    jumps: u32,
}

impl Scene {
    /// A scene with one aircraft, flown by the pilot.
    pub fn new(start: AircraftState, date: UtcTime) -> Self {
        Self::with_step_hz(start, date, DEFAULT_STEP_HZ)
    }

    /// The same with another number of steps a second.
    pub fn with_step_hz(start: AircraftState, date: UtcTime, step_hz: u32) -> Self {
        let safe = AircraftState::level(DVec3::new(0.0, 5_000.0, 0.0), 0.0, 150.0);
        let start = if start.is_finite() { aircraft::checked(&safe, start) } else { safe };
        let mut ecs = hecs::World::new();
        let own_id = StableId(1);
        let own = ecs.spawn((own_id, start));
        let controls = Controls { throttle: start.throttle, ..Controls::default() }.checked();
        Self {
            ecs,
            own,
            own_id,
            clock: Clock::new(step_hz, date),
            model: PointMass::default(),
            start,
            controls,
            track: None,
            track_m: 0.0,
            mode: Mode::Pilot,
            frozen: false,
            height_above_ground_m: None,
            jumps: 0,
        }
    }

    /// Gives the scene a track and puts the aircraft at its start, flying it.
    pub fn fly_track(&mut self, track: Track) {
        self.start = track.state(0.0, self.controls.throttle);
        self.track = Some(track);
        self.track_m = 0.0;
        self.mode = Mode::Track;
        self.place(self.start);
    }

    /// Moves along the track to a distance from its start, metres; nothing without a track or if not finite.
    pub fn seek_track(&mut self, distance_m: f64) {
        if let Some(track) = self.track.as_ref().filter(|_| distance_m.is_finite()) {
            let state = track.state(distance_m, self.controls.throttle);
            (self.track_m, self.mode) = (distance_m, Mode::Track);
            self.place(state);
        }
    }

    /// The track, if there is one.
    pub fn track(&self) -> Option<&Track> {
        self.track.as_ref()
    }

    /// Puts the aircraft into a state at once; one that is not finite is ignored.
    pub fn place(&mut self, state: AircraftState) {
        if state.is_finite() {
            let state = aircraft::checked(&self.aircraft(), state);
            self.jumps = self.jumps.wrapping_add(1);
            self.set_aircraft(state);
        }
    }

    /// What the pilot commands from now on.
    pub fn set_controls(&mut self, controls: Controls) {
        self.controls = controls.checked();
    }

    /// Carries out a command. Those that concern only the picture (screenshot, overlays, looking) do nothing here.
    pub fn command(&mut self, command: Command) {
        const HOUR_S: f64 = 3_600.0;
        const MONTH_S: f64 = 30.0 * 24.0 * HOUR_S;
        let later = |clock: &mut Clock, seconds: f64| clock.set_date(clock.date().plus_s(seconds));
        match command {
            Command::Pause => self.clock.set_paused(!self.clock.paused()),
            Command::Freeze => self.frozen = !self.frozen,
            Command::Reset => self.reset(),
            Command::Slew => {
                self.mode = if self.mode == Mode::Slew { Mode::Pilot } else { Mode::Slew };
                self.jumps = self.jumps.wrapping_add(1);
                if self.mode == Mode::Pilot {
                    self.leave_slew();
                }
            }
            Command::Track if self.track.is_some() => {
                if self.mode == Mode::Track {
                    self.mode = Mode::Pilot;
                } else {
                    self.seek_track(self.track_m);
                }
            }
            Command::TimeForward => later(&mut self.clock, HOUR_S),
            Command::TimeBack => later(&mut self.clock, -HOUR_S),
            Command::DateForward => later(&mut self.clock, MONTH_S),
            Command::DateBack => later(&mut self.clock, -MONTH_S),
            Command::RateUp => self.clock.set_rate((self.clock.rate() * 2.0).min(8.0)),
            Command::RateDown => self.clock.set_rate((self.clock.rate() * 0.5).max(0.125)),
            _ => {}
        }
    }

    /// Takes one step. Pausing is the caller's: a clock that is paused gives no steps to take.
    pub fn step(&mut self, height_at: &HeightAt) {
        let dt_s = self.clock.step_s();
        self.clock.tick();
        let before = self.aircraft();
        if !self.frozen {
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
                    let air = Air::standard(before.position_m.y);
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
            // A track is flown as given, but not under the ground.
            if let Some(ground_m) = height_at(after.position_m.x, after.position_m.z).filter(|h| h.is_finite()) {
                after.position_m.y = after.position_m.y.max(ground_m + GEAR_HEIGHT_M);
            }
            self.set_aircraft(after);
        }
        let at = self.aircraft().position_m;
        self.height_above_ground_m = height_at(at.x, at.z).filter(|h| h.is_finite()).map(|h| at.y - h);
    }

    /// Takes the height above ground anew without a step, as before the first one or after placing.
    pub fn look_down(&mut self, height_at: &HeightAt) {
        let at = self.aircraft().position_m;
        self.height_above_ground_m = height_at(at.x, at.z).filter(|h| h.is_finite()).map(|h| at.y - h);
    }

    /// The own aircraft.
    pub fn aircraft(&self) -> AircraftState {
        self.ecs.get::<&AircraftState>(self.own).map_or(self.start, |state| *state)
    }

    /// The scene as it stands.
    pub fn snapshot(&self) -> Snapshot {
        let aircraft = self.aircraft();
        let track_ended = self.mode == Mode::Track && self.track.as_ref().is_some_and(|t| self.track_m >= t.length_m());
        Snapshot {
            step: self.clock.step(),
            time_s: self.clock.time_s(),
            date: self.clock.date(),
            aircraft_id: self.own_id,
            aircraft,
            height_above_ground_m: self.height_above_ground_m,
            controls: self.controls,
            flags: Flags {
                paused: self.clock.paused(),
                frozen: self.frozen,
                mode: self.mode,
                crashed: aircraft.condition == Condition::Crashed,
                track_ended,
            },
            rate: self.clock.rate(),
            slowed_s: self.clock.slowed_s(),
            track_m: self.track_m,
            jumps: self.jumps,
        }
    }

    fn set_aircraft(&mut self, state: AircraftState) {
        // The own aircraft is spawned with the scene and never despawned.
        if let Ok(mut own) = self.ecs.get::<&mut AircraftState>(self.own) {
            *own = state;
        }
    }

    fn reset(&mut self) {
        self.track_m = 0.0;
        self.frozen = false;
        self.mode = if self.track.is_some() { Mode::Track } else { Mode::Pilot };
        self.place(self.start);
    }

    /// Flight after slewing starts at a speed that flies, along the nose.
    fn leave_slew(&mut self) {
        let now = self.aircraft();
        let speed_mps = self.start.airspeed_mps.clamp(120.0, 300.0);
        let level = AircraftState::level(now.position_m, now.angles().heading_rad, speed_mps);
        self.set_aircraft(AircraftState { throttle: now.throttle, ..level });
    }
}
