//! What is published of a scene: an immutable picture of it between two steps.
//!
//! It is all that a renderer or a report may know. Invariant: its numbers are finite, and its hash depends on nothing
//! but the state and the inputs before it.

use crate::air_data::AirData;
use crate::aircraft::AircraftState;
use crate::input::{Controls, Levers};
use crate::scene::{EntityView, Event, FNV_BASIS, Instruments, WeaponPage, fnv, interpolated};
use crate::utc::UtcTime;
use glam::DQuat;
use std::sync::Arc;

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
    /// Version of the ground that the last step met ([`crate::SceneGround::version`]). Not part of the hash.
    pub ground_version: u32,
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
    /// Rigid bodies, by id.
    pub bodies: Arc<[EntityView]>,
    /// Projectiles in the air, by id.
    pub projectiles: Arc<[EntityView]>,
    /// Targets, by id.
    pub targets: Arc<[EntityView]>,
    /// What lies about, by id.
    pub loose: Arc<[EntityView]>,
    /// The own aircraft's weapons; `None` without any. Follows from the rest, so it is no part of the hash.
    pub weapons: Option<Arc<WeaponPage>>,
    /// What happened of late, by number (see [`crate::scene::KEPT_S`]).
    pub events: Arc<[Event]>,
    /// Events since the scene began.
    pub events_counted: u64,
    /// A hash over all of them.
    pub events_chain: u64,
    /// The body that is the own aircraft, if it is one.
    pub flown: Option<StableId>,
    /// Levers as the pilot has set them. Not part of the hash: what they do is.
    pub levers: Levers,
    /// Instruments of an own aircraft that is a rigid body. Not part of the hash: they follow from the rest.
    pub instruments: Option<Instruments>,
    /// What the own aircraft's air tells it. Not part of the hash.
    pub air_data: AirData,
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
    /// What happened since an earlier snapshot, as far as it is still told.
    pub fn events_since(&self, earlier: &Self) -> &[Event] {
        let first = self.events.partition_point(|event| event.number < earlier.events_counted);
        &self.events[first..]
    }

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
            bodies: interpolated(&a.bodies, &b.bodies, t),
            projectiles: interpolated(&a.projectiles, &b.projectiles, t),
            targets: interpolated(&a.targets, &b.targets, t),
            loose: interpolated(&a.loose, &b.loose, t),
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
        let entities = self.bodies.iter().chain(&*self.projectiles).chain(&*self.targets).chain(&*self.loose);
        let entities = entities.flat_map(EntityView::words);
        let words = whole.into_iter().chain(floats.map(f64::to_bits));
        let words = words.chain([self.events_counted, self.events_chain]).chain(entities);
        words.fold(FNV_BASIS, |hash, word| fnv(hash, &word.to_le_bytes()))
    }
}

/// Part of the way from one attitude to another along the shortest turn.
pub(crate) fn turned(from: DQuat, to: DQuat, t: f64) -> DQuat {
    let to = if from.dot(to) < 0.0 { -to } else { to };
    from.slerp(to, t).normalize()
}
