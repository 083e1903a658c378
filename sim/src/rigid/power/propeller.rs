//! A fixed-pitch propeller by its coefficients over the advance ratio.
//!
//! thrust = CT rho n2 D4, torque = CP rho n2 D5 / 2 pi, J = V / n D, n turns a second. Beyond the table's last J both
//! coefficients go with J2, so that a propeller that stands has a drag with V2 and no division by its speed; below the first
//! they are held.
//!
//! Source: H. Glauert, Airplane Propellers, in W. F. Durand, Aerodynamic Theory IV, 1935 (coefficients and signs).

use crate::table::Table;
use std::f64::consts::TAU;

/// See the module.
#[derive(Debug, Clone, PartialEq)]
pub struct Propeller {
    /// Diameter, metres.
    pub diameter_m: f64,
    /// CT by J.
    pub thrust: Table,
    /// CP by J.
    pub power: Table,
    /// The last J of the table.
    pub most_advance: f64,
}

impl Propeller {
    /// Thrust, newtons, and torque that it takes, N m, at a speed of the air along the shaft.
    pub fn thrust_and_torque(&self, density_kgpm3: f64, speed_mps: f64, radps: f64) -> (f64, f64) {
        let (turns, d) = (radps.max(0.0) / TAU, self.diameter_m);
        let blade_mps = turns * d;
        let advance = speed_mps / blade_mps;
        // n2 CT; where the table ends n2 J2 is (V / D)2, whatever n.
        let (at, squared) = if advance <= self.most_advance || speed_mps <= 0.0 {
            (if blade_mps > 0.0 { advance } else { 0.0 }, turns * turns)
        } else {
            let over = speed_mps / (d * self.most_advance);
            (self.most_advance, over * over)
        };
        let scale = density_kgpm3 * squared * d.powi(4);
        (self.thrust.at(&[at]) * scale, self.power.at(&[at]) * scale * d / TAU)
    }
}
