//! How an autopilot flies a model: its gains and limits. `[autopilot]` of `M.toml`.
//!
//! Gains are parts of the stick's or throttle's way for what is off, as at `gains_at_mps`: they fall with the dynamic
//! pressure above it and rise below it. Radians, metres, seconds.

use serde::Deserialize;

/// Gains and limits; by default those of a light aircraft.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Tuning {
    /// Speed at which gains are as written, m/s.
    pub gains_at_mps: f64,
    /// Stick back for a pitch that is too low, 1/rad.
    pub pitch: f64,
    /// Time over which the rate of pitch counts against it, seconds.
    pub pitch_damping_s: f64,
    /// Stick right for a bank that is too far left, 1/rad.
    pub roll: f64,
    /// Throttle for a speed that is too low, s/m.
    pub throttle: f64,
    /// Most climb and sink that an altitude hold asks for, m/s.
    pub climb_mps: f64,
    /// Least and most pitch of an altitude hold, radians.
    pub pitch_limits_rad: [f64; 2],
    /// Most bank, radians.
    pub bank_rad: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            gains_at_mps: 55.0,
            pitch: 1.2,
            pitch_damping_s: 0.4,
            roll: 1.2,
            throttle: 0.08,
            climb_mps: 3.0,
            pitch_limits_rad: [-0.17, 0.21],
            bank_rad: 0.44,
        }
    }
}

impl Tuning {
    /// What a model's file may ask for.
    ///
    /// # Errors
    /// A sentence: the key, what was expected and what was found.
    pub fn check(&self) -> Result<(), String> {
        let positive = [
            ("gains_at_mps", self.gains_at_mps, 1e4),
            ("pitch", self.pitch, 1e3),
            ("roll", self.roll, 1e3),
            ("throttle", self.throttle, 1e3),
            ("climb_mps", self.climb_mps, 1e3),
            ("bank_rad", self.bank_rad, 1.4),
        ];
        if let Some((key, found, most)) = positive.into_iter().find(|(_, value, most)| !(*value > 0.0 && value <= most))
        {
            return Err(format!("autopilot.{key}: expected a number above 0, at most {most}, found {found}"));
        }
        if !(0.0..100.0).contains(&self.pitch_damping_s) {
            let found = self.pitch_damping_s;
            return Err(format!("autopilot.pitch_damping_s: expected 0 to 100 s, found {found}"));
        }
        let [low, high] = self.pitch_limits_rad;
        if !(-1.5 < low && low < high && high < 1.5) {
            return Err(format!("autopilot.pitch_limits_rad: expected -1.5 < least < most < 1.5, found {low}, {high}"));
        }
        Ok(())
    }
}
