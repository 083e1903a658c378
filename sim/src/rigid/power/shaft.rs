//! The shaft that an engine and a propeller turn.

use super::engine::{Engine, Setting};
use super::propeller::Propeller;
use glam::DVec3;

/// An engine with its propeller.
#[derive(Debug, Clone, PartialEq)]
pub struct PowerPlant {
    /// The engine.
    pub engine: Engine,
    /// The propeller.
    pub propeller: Propeller,
    /// Inertia of what turns, kg m2.
    pub inertia_kgm2: f64,
    /// Where the thrust acts, metres from the reference point.
    pub at_m: DVec3,
    /// Places of the controls: throttle, mixture, starter.
    pub throttle: usize,
    /// None: always full rich.
    pub mixture: Option<usize>,
    /// None: no starter.
    pub starter: Option<usize>,
}

impl PowerPlant {
    /// What the controls tell the engine.
    pub fn setting(&self, controls: &[f64], density_ratio: f64, fires: bool) -> Setting {
        Setting {
            throttle: controls[self.throttle],
            mixture: self.mixture.map_or(1.0, |place| controls[place]),
            starter: self.starter.map_or(0.0, |place| controls[place]),
            density_ratio,
            fires,
        }
    }

    /// Torque left over, N m.
    fn left_nm(&self, set: &Setting, density_kgpm3: f64, speed_mps: f64, radps: f64) -> f64 {
        self.engine.torque_nm(set, radps) - self.propeller.thrust_and_torque(density_kgpm3, speed_mps, radps).1
    }

    /// The shaft's speed after a step, rad/s, by the implicit rule of Euler.
    pub fn stepped_radps(&self, set: &Setting, density_kgpm3: f64, speed_mps: f64, radps: f64, dt_s: f64) -> f64 {
        let gain = dt_s / self.inertia_kgm2;
        let off = |x: f64| x - radps - gain * self.left_nm(set, density_kgpm3, speed_mps, x);
        let mut x = radps;
        // Newton's rule: the torques are smooth; three passes leave less than a millionth of a step.
        for _ in 0..3 {
            let small = 1e-3;
            let slope = (off(x + small) - off(x)) / small;
            x = (x - off(x) / slope.max(1.0)).clamp(0.0, 2.0 * self.engine.rated_radps);
        }
        x
    }

    /// The speed at which the shaft settles, rad/s: the greatest.
    pub fn settled_radps(&self, set: &Setting, density_kgpm3: f64, speed_mps: f64) -> f64 {
        let left = |x: f64| self.left_nm(set, density_kgpm3, speed_mps, x);
        // From the top down to where it is driven; there a root lies between.
        let top = 2.0 * self.engine.rated_radps;
        let steps = 64;
        let at = |i: u32| top * f64::from(i) / f64::from(steps);
        let Some(driven) = (0..steps).rev().find(|i| left(at(*i)) > 0.0) else { return 0.0 };
        let (mut low, mut high) = (at(driven), at(driven + 1));
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if left(middle) > 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}
