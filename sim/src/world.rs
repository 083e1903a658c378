//! The scene: its entities, its time, and what is published of it.
//!
//! Entities live in a hecs world; each has a [`StableId`] that does not depend on how hecs stores it. [`Scene::step`]
//! takes one fixed step. A [`Snapshot`] is an immutable picture of the scene between two steps: all that a renderer or
//! a report may know.
//!
//! Invariant: a snapshot's numbers are finite, and its hash depends on nothing but the state and the inputs before it.

use crate::aircraft::point_mass::PointMass;
use crate::aircraft::{self, AircraftState, Condition};
use crate::atmosphere::Air;
use crate::clock::{Clock, DEFAULT_STEP_HZ, UtcTime};
use crate::input::{Command, Controls};
use crate::slew::{SlewRates, slew};
use crate::track::Track;
use crate::{GEAR_HEIGHT_M, HeightAt};
use glam::{DQuat, DVec3};

/// A number that names an entity for as long as the scene lasts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct StableId(pub u64);

/// Who moves the aircraft.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Mode {
    /// The pilot flies.
    #[default]
    Pilot,
    /// The built-in track.
    Track,
    /// Free movement.
    Slew,
}

/// What a head-up display says beside numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Flags {
    /// Time stands still.
    pub paused: bool,
    /// The aircraft is held in place.
    pub frozen: bool,
    /// Who moves it.
    pub mode: Mode,
    /// It is broken.
    pub crashed: bool,
    /// The track is flown to its end.
    pub track_ended: bool,
}

/// An immutable picture of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapshot {
    /// Steps taken.
    pub step: u64,
    /// Simulated time, seconds.
    pub time_s: f64,
    /// Date and time of day.
    pub date: UtcTime,
    /// The own aircraft's name.
    pub aircraft_id: StableId,
    /// The own aircraft.
    pub aircraft: AircraftState,
    /// Height of the aircraft above the ground, metres; `None` where there is no ground.
    pub height_above_ground_m: Option<f64>,
    /// What the pilot commands.
    pub controls: Controls,
    /// States and modes.
    pub flags: Flags,
    /// Simulated seconds a wall second that are asked for.
    pub rate: f64,
    /// Wall time dropped so far because the machine was too slow, seconds. Not part of the hash.
    pub slowed_s: f64,
    /// Distance flown along the track, metres; 0 without one.
    pub track_m: f64,
    /// Counts jumps (reset, slew, placing), across which nothing may be interpolated.
    pub jumps: u32,
}

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

impl Flags {
    /// The states that a pilot has to know of, in capitals.
    pub fn names(&self) -> Vec<&'static str> {
        let all = [
            (self.paused, "PAUSED"),
            (self.frozen, "FROZEN"),
            (self.mode == Mode::Slew, "SLEW"),
            (self.mode == Mode::Track, "TRACK"),
            (self.crashed, "CRASHED"),
        ];
        all.into_iter().filter_map(|(on, name)| on.then_some(name)).collect()
    }
}

impl Snapshot {
    /// The scene at part `t` (0..1) of the way from `a` to `b`: places straight, attitudes along the shortest turn.
    ///
    /// Where the aircraft jumped between the two, `b` as it is.
    pub fn interpolate(a: &Self, b: &Self, t: f64) -> Self {
        if a.jumps != b.jumps || a.aircraft_id != b.aircraft_id || !t.is_finite() {
            return b.clone();
        }
        let t = t.clamp(0.0, 1.0);
        let mix = |a: f64, b: f64| a + (b - a) * t;
        let (from, to) = (&a.aircraft, &b.aircraft);
        let height = a.height_above_ground_m.zip(b.height_above_ground_m).map(|(a, b)| mix(a, b));
        let since_s = (b.date.unix_ns.saturating_sub(a.date.unix_ns)) as f64 * 1e-9;
        Self {
            time_s: mix(a.time_s, b.time_s),
            date: a.date.plus_s(since_s * t),
            height_above_ground_m: height.or(b.height_above_ground_m),
            track_m: mix(a.track_m, b.track_m),
            aircraft: AircraftState {
                position_m: from.position_m.lerp(to.position_m, t),
                velocity_mps: from.velocity_mps.lerp(to.velocity_mps, t),
                attitude: turned(from.attitude, to.attitude, t),
                rates_radps: from.rates_radps.lerp(to.rates_radps, t),
                load_factor: mix(from.load_factor, to.load_factor),
                alpha_rad: mix(from.alpha_rad, to.alpha_rad),
                airspeed_mps: mix(from.airspeed_mps, to.airspeed_mps),
                throttle: mix(from.throttle, to.throttle),
                condition: to.condition,
            },
            ..b.clone()
        }
    }

    /// FNV-1a, 64 bits, over names and bit patterns: equal for equal runs on any machine with the same arithmetic.
    ///
    /// Source: G. Fowler, L. Noll, P. Vo, FNV hash, 1991 (offset basis and prime of 64 bits).
    pub fn hash(&self) -> u64 {
        let s = &self.aircraft;
        let (p, v, q, w) = (s.position_m, s.velocity_mps, s.attitude, s.rates_radps);
        let floats = [
            p.x,
            p.y,
            p.z,
            v.x,
            v.y,
            v.z,
            q.x,
            q.y,
            q.z,
            q.w,
            w.x,
            w.y,
            w.z,
            s.load_factor,
            s.alpha_rad,
            s.airspeed_mps,
            s.throttle,
            self.controls.pitch,
            self.controls.roll,
            self.controls.yaw,
            self.controls.throttle,
            self.height_above_ground_m.unwrap_or(f64::MIN),
            self.track_m,
            self.rate,
        ];
        let flags = u64::from(self.flags.paused)
            | u64::from(self.flags.frozen) << 1
            | u64::from(self.flags.track_ended) << 2
            | (s.condition as u64) << 8
            | (self.flags.mode as u64) << 16
            | u64::from(self.jumps) << 32;
        let whole = [self.step, self.aircraft_id.0, self.date.unix_ns as u64, flags];
        let words = whole.into_iter().chain(floats.map(f64::to_bits));
        words
            .flat_map(u64::to_le_bytes)
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
    }
}

/// Part of the way from one attitude to another along the shortest turn.
fn turned(from: DQuat, to: DQuat, t: f64) -> DQuat {
    let to = if from.dot(to) < 0.0 { -to } else { to };
    from.slerp(to, t).normalize()
}
