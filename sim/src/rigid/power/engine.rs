//! A piston engine without a supercharger: torque and fuel flow.
//!
//! The charge goes with the air's density and the throttle; friction is a constant torque. At full throttle and best mixture
//! power = rated power x (sigma (1 + f) - f), f the friction's share of the rated torque. Fuel-air ratios are
//! over that of best power; a carburettor makes the mixture richer with the inverse root of the density ratio.
//!
//! Source: R. F. Gagg, E. V. Farrar, Altitude Performance of Aircraft Engines Equipped with Gear-Driven Superchargers, SAE
//! Transactions 29, 1934 (f = 0.132, the formula's 1 / 7.55).

use crate::table::Table;

/// Shaft speeds between which a turning engine begins to fire, rad/s: 150 and 350 rpm.
const FIRES_RADPS: (f64, f64) = (15.7, 36.7);

/// See the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Engine {
    /// Power at rated speed, sea level, full throttle and best mixture, watts.
    pub rated_w: f64,
    /// Rated speed, rad/s.
    pub rated_radps: f64,
    /// Torque of friction over the rated one.
    pub friction: f64,
    /// Charge at closed throttle over that at full.
    pub idle: f64,
    /// Fuel at rated power and best mixture, kg/s.
    pub fuel_kgps: f64,
    /// Fuel-air ratio at sea level with the mixture full rich, over that of best power.
    pub rich: f64,
    /// Indicated power over the best by fuel-air ratio over that of best power.
    pub mixture: Table,
    /// Torque of the starter over the rated one.
    pub starter: f64,
}

/// What an engine is told, and in what air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// 0..1.
    pub throttle: f64,
    /// 0 is cut off, 1 full rich.
    pub mixture: f64,
    /// Whether the starter turns it.
    pub starter: f64,
    /// Density over that at sea level.
    pub density_ratio: f64,
    /// Whether it has fuel and spark.
    pub fires: bool,
}

impl Engine {
    fn rated_nm(&self) -> f64 {
        self.rated_w / self.rated_radps
    }

    /// Fuel-air ratio over that of best power.
    pub fn fuel_air(&self, set: &Setting) -> f64 {
        self.rich * set.mixture.clamp(0.0, 1.0) / set.density_ratio.max(0.05).sqrt()
    }

    /// The mixture control at which power is best.
    pub fn best_mixture(&self, density_ratio: f64) -> f64 {
        (density_ratio.max(0.05).sqrt() / self.rich).min(1.0)
    }

    /// Charge over the rated one.
    fn charge(&self, set: &Setting) -> f64 {
        set.density_ratio * (self.idle + (1.0 - self.idle) * set.throttle.clamp(0.0, 1.0))
    }

    /// How far it fires at a shaft speed, 0..1.
    fn firing(&self, set: &Setting, radps: f64) -> f64 {
        if !set.fires {
            return 0.0;
        }
        ((radps - FIRES_RADPS.0) / (FIRES_RADPS.1 - FIRES_RADPS.0)).clamp(0.0, 1.0)
    }

    /// Torque on the shaft at a speed of 0 or more, N m; less than nil where friction is more than what fires.
    pub fn torque_nm(&self, set: &Setting, radps: f64) -> f64 {
        let indicated = (1.0 + self.friction) * self.charge(set) * self.mixture.at(&[self.fuel_air(set)]);
        // Above the rated speed the charge no longer keeps up.
        let breathing = 1.0 - 0.5 * (radps / self.rated_radps - 1.0).max(0.0);
        let starter = set.starter.clamp(0.0, 1.0) * self.starter * (1.0 - radps / FIRES_RADPS.1).max(0.0);
        // Friction comes in with the first turn, so that it turns nothing backward.
        let friction = self.friction * (radps / 5.0).min(1.0);
        self.rated_nm() * (indicated * breathing.max(0.0) * self.firing(set, radps) + starter - friction)
    }

    /// Power at a shaft speed, watts.
    pub fn power_w(&self, set: &Setting, radps: f64) -> f64 {
        self.torque_nm(set, radps) * radps
    }

    /// Fuel flow, kg/s: the charge that the strokes take, times the fuel-air ratio.
    pub fn fuel_kgps(&self, set: &Setting, radps: f64) -> f64 {
        self.fuel_kgps * self.charge(set) * (radps / self.rated_radps) * self.fuel_air(set) * self.firing(set, radps)
    }
}
