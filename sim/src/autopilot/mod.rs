//! An autopilot's holds: altitude, heading, speed, a track over the ground, the aim at a target.
//!
//! | file | what |
//! |---|---|
//! | `tuning.rs` | gains and limits of a model |
//!
//! Cascaded loops with limits: altitude asks for a climb, the climb for a pitch, the pitch for elevator; a track asks for a
//! course, heading or course for a bank, the bank for aileron; speed asks for throttle. Each integral stands still while what
//! it feeds is at its limit. What is not held is left to whoever flies. The model needs `elevator_norm`, `aileron_norm` or
//! `throttle_norm` for what is held.
//!
//! An attack lays the point where the selected weapon would strike on a target: its bearing asks for a bank and, unless an
//! altitude is held, its depression for a pitch. A gun is laid so in a dive, a bomb's line in level flight.
//!
//! World frame; headings and courses clockwise from grid north; true airspeed; SI. Gains are a model's, scaled with
//! dynamic pressure. Invariant: commands are finite and within -1..1, throttle within 0..1.
//!
//! Source: B. L. Stevens, F. L. Lewis, Aircraft Control and Simulation, 2003, section 4.6 (autopilot loops).

mod tuning;

pub use tuning::Tuning;

use crate::frame::Angles;
use crate::snapshot::StableId;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Most angle at which a track is met, radians.
const INTERCEPT_RAD: f64 = 0.7;
/// Time constant of a turn onto a course, and of one onto a target: there is less time for that.
const TURN_S: f64 = 5.0;
const AIM_S: f64 = 2.5;
/// Most pitch, in either direction, that an attack asks to change by at a time, radians.
const MOST_AIM_RAD: f64 = 0.1;

/// What is held.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Holds {
    /// Altitude, metres.
    pub altitude_m: Option<f64>,
    /// Heading of the nose, radians; not beside a track.
    pub heading_rad: Option<f64>,
    /// Speed through the air, m/s.
    pub speed_mps: Option<f64>,
    /// A line over the ground: a point (x, z) and the course along it, radians.
    pub track: Option<(DVec2, f64)>,
    /// The target that the selected weapon is laid on; beside no heading and no track.
    pub attack: Option<StableId>,
}

/// The aim of a selected weapon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sight {
    /// Where it would strike; where there is no such point, one along the bore.
    pub strikes_m: DVec3,
    /// Where it should.
    pub target_m: DVec3,
}

/// What an autopilot sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Position, metres.
    pub position_m: DVec3,
    /// Velocity over the ground, m/s.
    pub velocity_mps: DVec3,
    /// Heading, pitch, roll.
    pub angles: Angles,
    /// Rates about body axes, rad/s.
    pub rates_radps: DVec3,
    /// Speed through the air, m/s.
    pub airspeed_mps: f64,
    /// The aim, where an attack is held.
    pub sight: Option<Sight>,
}

/// What it moves; `None` is left alone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moves {
    /// Stick back positive.
    pub elevator: Option<f64>,
    /// Stick right positive.
    pub aileron: Option<f64>,
    /// 0..1.
    pub throttle: Option<f64>,
}

/// An autopilot that is engaged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Autopilot {
    /// What it holds.
    pub holds: Holds,
    /// Integrals: pitch that holds the climb (rad), elevator that holds the pitch, throttle that holds the speed.
    pub integrals: [f64; 3],
}

/// An angle within -pi..pi.
fn turn(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}

/// A turn of all but half a circle goes on the way that it began: else it would be begun anew from side to side.
fn onward(off_rad: f64, roll_rad: f64) -> f64 {
    const HALF_RAD: f64 = 2.6;
    let goes_on = off_rad.abs() > HALF_RAD && off_rad * roll_rad < 0.0 && roll_rad.abs() > 0.05;
    if goes_on { off_rad - TAU.copysign(off_rad) } else { off_rad }
}

/// Adds to an integral, but not further beyond a limit that the sum it is part of has reached.
fn integrate(integral: &mut f64, rate: f64, dt_s: f64, sum: f64, (low, high): (f64, f64)) {
    if (sum < high || rate < 0.0) && (sum > low || rate > 0.0) {
        *integral = (*integral + rate * dt_s).clamp(low, high);
    }
}

impl Holds {
    /// Whether every number is one.
    pub fn is_sound(&self) -> bool {
        let numbers = [self.altitude_m, self.heading_rad, self.speed_mps].into_iter().flatten();
        let track = self.track.is_none_or(|(at, course)| at.is_finite() && course.is_finite());
        let sideways = [self.heading_rad.is_some(), self.track.is_some(), self.attack.is_some()];
        numbers.into_iter().all(f64::is_finite) && track && sideways.into_iter().filter(|held| *held).count() <= 1
    }

    /// Whether it moves the elevator, the aileron and the throttle.
    pub fn moves(&self) -> [bool; 3] {
        let sideways = self.heading_rad.is_some() || self.track.is_some() || self.attack.is_some();
        [self.altitude_m.is_some() || self.attack.is_some(), sideways, self.speed_mps.is_some()]
    }
}

impl Sight {
    /// How far right and how far up the target is of where the weapon would strike, as seen from a place, radians.
    pub fn off_rad(&self, from_m: DVec3) -> [f64; 2] {
        let bearing = |to: DVec3| to.x.atan2(-to.z);
        let elevation = |to: DVec3| to.y.atan2(to.x.hypot(to.z));
        let [target, strikes] = [self.target_m, self.strikes_m].map(|point| point - from_m);
        [turn(bearing(target) - bearing(strikes)), elevation(target) - elevation(strikes)]
    }
}

impl Autopilot {
    /// Engaged on a flight as it is: its pitch, elevator and throttle are where it starts from.
    pub fn engaged(holds: Holds, pitch_rad: f64, elevator: f64, throttle: f64) -> Self {
        Self { holds, integrals: [pitch_rad, elevator, throttle] }
    }

    /// What it moves in a step.
    pub fn step(&mut self, seen: &Seen, tuning: &Tuning, dt_s: f64) -> Moves {
        let slow = (tuning.gains_at_mps / seen.airspeed_mps.max(15.0)).powi(2).clamp(0.3, 4.0);
        let pitch_off = match (self.holds.altitude_m, self.holds.attack) {
            (Some(altitude_m), _) => Some(self.pitch_off_rad(seen, tuning, altitude_m, dt_s)),
            (None, Some(_)) => {
                let up_rad = seen.sight.map_or(0.0, |sight| sight.off_rad(seen.position_m)[1]);
                Some(up_rad.clamp(-MOST_AIM_RAD, MOST_AIM_RAD))
            }
            (None, None) => None,
        };
        Moves {
            elevator: pitch_off.map(|off| self.elevator(seen, tuning, off, slow, dt_s)),
            aileron: self.bank_rad(seen, tuning).map(|bank_rad| {
                let off = bank_rad - seen.angles.roll_rad;
                (slow * (tuning.roll * off - tuning.roll / 12.0 * seen.rates_radps.x)).clamp(-1.0, 1.0)
            }),
            throttle: self.holds.speed_mps.map(|speed_mps| {
                let off = speed_mps - seen.airspeed_mps;
                let sum = self.integrals[2] + tuning.throttle * off;
                integrate(&mut self.integrals[2], 0.15 * tuning.throttle * off, dt_s, sum, (0.0, 1.0));
                sum.clamp(0.0, 1.0)
            }),
        }
    }

    /// How far the pitch is below the one that goes to an altitude.
    fn pitch_off_rad(&mut self, seen: &Seen, tuning: &Tuning, altitude_m: f64, dt_s: f64) -> f64 {
        let most_mps = tuning.climb_mps;
        let [low, high] = tuning.pitch_limits_rad;
        let climb_mps = (0.15 * (altitude_m - seen.position_m.y)).clamp(-most_mps, most_mps);
        let steeper = (climb_mps - seen.velocity_mps.y) / seen.airspeed_mps.max(15.0);
        let pitch = self.integrals[0] + 0.8 * steeper;
        integrate(&mut self.integrals[0], 0.4 * steeper, dt_s, pitch, (low, high));
        pitch.clamp(low, high) - seen.angles.pitch_rad
    }

    fn elevator(&mut self, seen: &Seen, tuning: &Tuning, off: f64, slow: f64, dt_s: f64) -> f64 {
        // In a turn the nose must rise along the horizon, not along the wings.
        let level = seen.angles.roll_rad.cos().max(0.5);
        let damped = off - tuning.pitch_damping_s * seen.rates_radps.y * level;
        let sum = self.integrals[1] + slow * tuning.pitch * damped;
        integrate(&mut self.integrals[1], slow * tuning.pitch / 1.5 * off, dt_s, sum, (-1.0, 1.0));
        sum.clamp(-1.0, 1.0)
    }

    /// The bank that heading, track or aim ask for.
    fn bank_rad(&self, seen: &Seen, tuning: &Tuning) -> Option<f64> {
        let (off, over_s) = match (self.holds.attack, self.holds.track, self.holds.heading_rad) {
            (Some(_), ..) => (seen.sight.map_or(0.0, |sight| sight.off_rad(seen.position_m)[0]), AIM_S),
            (None, Some((at, course_rad)), _) => {
                let away = DVec2::new(seen.position_m.x, seen.position_m.z) - at;
                let right = DVec2::new(course_rad.cos(), course_rad.sin());
                let speed_mps = seen.velocity_mps.x.hypot(seen.velocity_mps.z);
                let back = (away.dot(right) / (6.0 * speed_mps).max(100.0)).clamp(-INTERCEPT_RAD, INTERCEPT_RAD);
                let flown = seen.velocity_mps.x.atan2(-seen.velocity_mps.z);
                (onward(turn(course_rad - back - flown), seen.angles.roll_rad), TURN_S)
            }
            (None, None, Some(heading_rad)) => {
                (onward(turn(heading_rad - seen.angles.heading_rad), seen.angles.roll_rad), TURN_S)
            }
            (None, None, None) => return None,
        };
        // A coordinated turn: tan(bank) = V / g x rate.
        let rate = off / over_s;
        Some((seen.airspeed_mps * rate / 9.81).atan().clamp(-tuning.bank_rad, tuning.bank_rad))
    }
}
