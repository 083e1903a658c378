//! How short a step must be: the fastest mode of a body, and its spin, against what an integrator holds.
//!
//! The accelerations are differentiated by the body's velocity and rates (6 x 6, differences over a twentieth of the speed;
//! of the two sides the flatter one, so that the jump of the angle of attack at +-180 degrees is no mode). The greatest
//! size of an eigenvalue comes from a high power of the matrix (Gelfand's formula). This is done at load at the
//! never-exceed speed or the initial one, whichever is greater, for the report; and in flight at the state, every
//! [`STEPS_A_MODE`] steps. In between the mode grows with density times speed, as aerodynamic modes do.
//!
//! Spin is no mode: a quaternion is turned by so many radians a step, and the error of fourth order grows with them. A
//! piece of a step turns the body by at most a quarter radian.
//!
//! Source: I. Gelfand, Normierte Ringe, 1941 (spectral radius); stability limits: see [`crate::integrate`].

use super::motion::{self, N, RigidMotion, State};
use crate::integrate::{Integrator, Motion};
use glam::DVec3;

/// Part of an integrator's limit that a step may use: beyond it errors no longer die out quickly.
const SHARE: f64 = 0.7;
/// Most pieces that a step is cut into.
pub const MOST_PIECES: u32 = 1_000;
/// Steps between two computations of the mode in flight.
pub const STEPS_A_MODE: u32 = 256;
/// Most turn of a piece of a step: at it rk4 errs by 2e-6 of the angle turned.
const MOST_TURN_RAD: f64 = 0.25;

/// The fastest mode of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiffness {
    /// Speed that it was taken at, m/s.
    pub speed_mps: f64,
    /// Greatest size of an eigenvalue there, 1/s.
    pub lambda_radps: f64,
    /// The same over density and speed.
    pub per_flow: f64,
}

impl Stiffness {
    /// Of a body at a state, but at the never-exceed speed if that is greater.
    pub fn of(motion: &RigidMotion, y: &State) -> Self {
        let sample = motion.sample(y, true);
        let airspeed = sample.through_air.length();
        let speed_mps = airspeed.max(motion.model.never_exceed_mps.unwrap_or(0.0)).max(10.0);
        let along = if airspeed > 1.0 { sample.through_air / airspeed } else { DVec3::X };
        // The same attitude to the air at the greater speed.
        let velocity = motion::velocity(y) + sample.frame_from_body * (along * speed_mps - sample.through_air);
        let mut base = *y;
        (base[8], base[9], base[10]) = (velocity.x, velocity.y, velocity.z);
        let lambda_radps = spectral_radius(&jacobian(motion, &base, speed_mps));
        let flow = sample.air.density_kgpm3 * speed_mps;
        Self { speed_mps, lambda_radps, per_flow: if flow > 0.0 { lambda_radps / flow } else { 0.0 } }
    }
}

/// The mode of a state in flight, and how it grows until it is taken anew.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mode {
    pub(crate) lambda_radps: f64,
    pub(crate) flow: f64,
}

impl Mode {
    /// Of a state in a flow (density times speed).
    pub fn of(motion: &RigidMotion, y: &State, flow: f64, airspeed_mps: f64) -> Self {
        Self { lambda_radps: spectral_radius(&jacobian(motion, y, airspeed_mps.max(1.0))), flow }
    }

    /// Size of the mode in a flow, 1/s: what it was, and what more flow adds by the body's stiffness.
    pub fn lambda_radps(&self, stiffness: &Stiffness, flow: f64) -> f64 {
        self.lambda_radps + stiffness.per_flow * (flow - self.flow).max(0.0)
    }
}

/// Pieces that a step is cut into so that a mode and a spin are held; `None` if that takes more than [`MOST_PIECES`].
pub fn pieces(integrator: Integrator, lambda_radps: f64, spin_radps: f64, dt_s: f64) -> Option<u32> {
    let mode = lambda_radps * dt_s / (SHARE * integrator.damping_limit());
    let pieces = mode.max(spin_radps * dt_s / MOST_TURN_RAD).ceil().max(1.0);
    (pieces <= f64::from(MOST_PIECES)).then_some(pieces as u32)
}

/// Derivative of the accelerations by velocity and rates; lengths are scaled by the body's so that all units are 1/s.
fn jacobian(motion: &RigidMotion, base: &State, speed_mps: f64) -> [[f64; 6]; 6] {
    let first = N - 6;
    let length = motion.model.span_m.max(motion.model.chord_m).max(1e-3);
    let unit = |place: usize| if place < 3 { 1.0 } else { 1.0 / length };
    let centre = motion.rate(0.0, base);
    let mut all = [[0.0; 6]; 6];
    for place in 0..6 {
        let small = 0.05 * speed_mps * unit(place);
        let side = |by: f64| {
            let mut y = *base;
            y[first + place] += by;
            motion.rate(0.0, &y)
        };
        let (above, below) = (side(small), side(-small));
        for (row, entries) in all.iter_mut().enumerate() {
            let i = first + row;
            let (up, down) = (above[i] - centre[i], centre[i] - below[i]);
            let flatter = if up.abs() < down.abs() { up } else { down };
            entries[place] = flatter / small * unit(place) / unit(row);
        }
    }
    all
}

/// The greatest size of an eigenvalue: the 2^8th root of the norm of the 2^8th power.
fn spectral_radius(matrix: &[[f64; 6]; 6]) -> f64 {
    let norm = |m: &[[f64; 6]; 6]| m.iter().flatten().map(|x| x * x).sum::<f64>().sqrt();
    let (mut power, mut log, mut exponent) = (*matrix, 0.0, 1.0);
    for _ in 0..8 {
        let size = norm(&power);
        if !(size > 0.0 && size.is_finite()) {
            return 0.0;
        }
        log += size.ln() / exponent;
        let scaled = power.map(|row| row.map(|x| x / size));
        power = std::array::from_fn(|i| std::array::from_fn(|j| (0..6).map(|k| scaled[i][k] * scaled[k][j]).sum()));
        exponent *= 2.0;
    }
    (log + norm(&power).max(f64::MIN_POSITIVE).ln() / exponent).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spectral_radius_is_the_greatest_eigenvalue() {
        let mut m = [[0.0; 6]; 6];
        for (i, row) in m.iter_mut().enumerate() {
            row[i] = -(i as f64);
        }
        m[0][5] = 300.0;
        // A matrix of condition 300: the 256th root of it is 1.02.
        assert!((spectral_radius(&m) / 5.0 - 1.0).abs() < 0.03, "{}", spectral_radius(&m));
        let mut turn = [[0.0; 6]; 6];
        (turn[0][1], turn[1][0]) = (-4.0, 4.0);
        assert!((spectral_radius(&turn) / 4.0 - 1.0).abs() < 0.01);
        assert_eq!(spectral_radius(&[[0.0; 6]; 6]), 0.0);
    }
}
