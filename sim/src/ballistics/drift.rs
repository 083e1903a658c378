//! Spin drift: how far a spinning projectile goes aside, as an estimate by its time of flight.
//!
//! This is the tier "modified point mass" of this crate, and no more than that: a closed form beside the point mass, not
//! an integration of the yaw of repose. `drift = 1.25 (Sg + 1.2) t^1.83` inches, to the right for right-hand rifling,
//! with the gyroscopic stability Sg at the muzzle. It was fitted to rifle bullets in flat fire; for a shell at a high
//! elevation it gives the side and the order of magnitude only.
//!
//! Sg follows from mass m (grains), twist t and length l (calibres) and diameter d (inches):
//! `30 m / (t2 d3 l (1 + l2)) (v / 2800 ft/s)^(1/3) T / T0 p0 / p`, with the standard's T0 and p0 at sea level. Below 1 the
//! projectile tumbles and nothing here holds; above [`MOST_STABILITY`], in thin air, Sg is held.
//!
//! Invariant: the drift and its rate are 0 at the muzzle and grow from there.
//!
//! Source: D. Miller, A New Rule for Estimating Rifling Twist, Precision Shooting, March 2005; B. Litz, Applied
//! Ballistics for Long-Range Shooting, 2009.

use super::projectile::Projectile;
use crate::atmosphere::AirSample;

/// Largest Sg that the estimate is used with: well above that of any rifle in dense air.
pub const MOST_STABILITY: f64 = 10.0;

/// Temperature and pressure at which the rule needs no correction, K and Pa.
const RULE_AIR: (f64, f64) = (288.15, 101_325.0);
const INCH_M: f64 = 0.0254;
const GRAIN_KG: f64 = 6.479_891e-5;
/// Speed at which the rule needs no correction, m/s: 2,800 ft/s.
const RULE_MPS: f64 = 853.44;
const POWER: f64 = 1.83;

/// A shot's drift to the right.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpinDrift {
    /// Gyroscopic stability at the muzzle.
    pub stability: f64,
    /// Metres after a second.
    coefficient_m: f64,
}

impl SpinDrift {
    /// The drift of a shot through the muzzle's air; none without spin or without air.
    pub fn of(projectile: &Projectile, speed_mps: f64, air: &AirSample) -> Option<Self> {
        let (spin, diameter_m) = (projectile.spin?, projectile.diameter_m?);
        if air.pressure_pa <= 0.0 {
            return None;
        }
        let (twist, length) = (spin.twist_m / diameter_m, spin.length_m / diameter_m);
        let inches = diameter_m / INCH_M;
        let rule =
            30.0 * (projectile.mass_kg / GRAIN_KG) / (twist.powi(2) * inches.powi(3) * length * (1.0 + length.powi(2)));
        let stability =
            rule * (speed_mps / RULE_MPS).cbrt() * (air.temperature_k / RULE_AIR.0) * (RULE_AIR.1 / air.pressure_pa);
        let stability = stability.min(MOST_STABILITY);
        let right_m = 1.25 * INCH_M * (stability + 1.2);
        Some(Self { stability, coefficient_m: if spin.right { right_m } else { -right_m } })
    }

    /// Drift to the right, metres.
    pub fn right_m(&self, t_s: f64) -> f64 {
        self.coefficient_m * t_s.max(0.0).powf(POWER)
    }

    /// Its rate, m/s.
    pub fn right_mps(&self, t_s: f64) -> f64 {
        self.coefficient_m * POWER * t_s.max(0.0).powf(POWER - 1.0)
    }
}
