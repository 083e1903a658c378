//! An autopilot's holds: altitude, heading, speed, a track over the ground.
//!
//! Cascaded loops with limits: altitude asks for a climb, the climb for a pitch, the pitch for elevator; a track asks for a
//! course, heading or course for a bank, the bank for aileron; speed asks for throttle. Each integral stands still while what
//! it feeds is at its limit. What is not held is left to whoever flies. The model needs `elevator_norm`, `aileron_norm` or
//! `throttle_norm` for what is held.
//!
//! World frame; headings and courses clockwise from grid north; true airspeed; SI. Gains suit light aircraft, and are scaled
//! with dynamic pressure. Invariant: commands are finite and within -1..1, throttle within 0..1.
//!
//! Source: B. L. Stevens, F. L. Lewis, Aircraft Control and Simulation, 2003, section 4.6 (autopilot loops).

use crate::frame::Angles;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Most climb and sink that an altitude hold asks for, m/s.
const CLIMB_MPS: f64 = 3.0;
/// Least and most pitch, radians.
const PITCH_RAD: (f64, f64) = (-0.17, 0.21);
/// Most bank, radians.
const BANK_RAD: f64 = 0.44;
/// Most angle at which a track is met, radians.
const INTERCEPT_RAD: f64 = 0.7;
/// Speed at which gains are as written, m/s.
const GAINS_AT_MPS: f64 = 55.0;

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
        numbers.into_iter().all(f64::is_finite) && track && !(self.heading_rad.is_some() && self.track.is_some())
    }
}

impl Autopilot {
    /// Engaged on a flight as it is: its pitch, elevator and throttle are where it starts from.
    pub fn engaged(holds: Holds, pitch_rad: f64, elevator: f64, throttle: f64) -> Self {
        Self { holds, integrals: [pitch_rad, elevator, throttle] }
    }

    /// What it moves in a step.
    pub fn step(&mut self, seen: &Seen, dt_s: f64) -> Moves {
        let slow = (GAINS_AT_MPS / seen.airspeed_mps.max(15.0)).powi(2).clamp(0.3, 4.0);
        Moves {
            elevator: self.holds.altitude_m.map(|altitude_m| self.elevator(seen, altitude_m, slow, dt_s)),
            aileron: self.bank_rad(seen).map(|bank_rad| {
                let off = bank_rad - seen.angles.roll_rad;
                (slow * (1.2 * off - 0.1 * seen.rates_radps.x)).clamp(-1.0, 1.0)
            }),
            throttle: self.holds.speed_mps.map(|speed_mps| {
                let off = speed_mps - seen.airspeed_mps;
                let sum = self.integrals[2] + 0.08 * off;
                integrate(&mut self.integrals[2], 0.012 * off, dt_s, sum, (0.0, 1.0));
                sum.clamp(0.0, 1.0)
            }),
        }
    }

    fn elevator(&mut self, seen: &Seen, altitude_m: f64, slow: f64, dt_s: f64) -> f64 {
        let climb_mps = (0.15 * (altitude_m - seen.position_m.y)).clamp(-CLIMB_MPS, CLIMB_MPS);
        let steeper = (climb_mps - seen.velocity_mps.y) / seen.airspeed_mps.max(15.0);
        let pitch = self.integrals[0] + 0.8 * steeper;
        integrate(&mut self.integrals[0], 0.4 * steeper, dt_s, pitch, PITCH_RAD);
        // In a turn the nose must rise along the horizon, not along the wings.
        let level = seen.angles.roll_rad.cos().max(0.5);
        let off = pitch.clamp(PITCH_RAD.0, PITCH_RAD.1) - seen.angles.pitch_rad;
        let damped = off - 0.4 * seen.rates_radps.y * level;
        let sum = self.integrals[1] + slow * 1.2 * damped;
        integrate(&mut self.integrals[1], slow * 0.8 * off, dt_s, sum, (-1.0, 1.0));
        sum.clamp(-1.0, 1.0)
    }

    /// The bank that heading or track ask for.
    fn bank_rad(&self, seen: &Seen) -> Option<f64> {
        let off = match (self.holds.track, self.holds.heading_rad) {
            (Some((at, course_rad)), _) => {
                let away = DVec2::new(seen.position_m.x, seen.position_m.z) - at;
                let right = DVec2::new(course_rad.cos(), course_rad.sin());
                let speed_mps = seen.velocity_mps.x.hypot(seen.velocity_mps.z);
                let back = (away.dot(right) / (6.0 * speed_mps).max(100.0)).clamp(-INTERCEPT_RAD, INTERCEPT_RAD);
                let flown = seen.velocity_mps.x.atan2(-seen.velocity_mps.z);
                turn(course_rad - back - flown)
            }
            (None, Some(heading_rad)) => turn(heading_rad - seen.angles.heading_rad),
            (None, None) => return None,
        };
        // A coordinated turn of time constant 5 s: tan(bank) = V / g x rate.
        let rate = off / 5.0;
        Some((seen.airspeed_mps * rate / 9.81).atan().clamp(-BANK_RAD, BANK_RAD))
    }
}
