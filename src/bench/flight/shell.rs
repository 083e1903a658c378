//! The step of a shell: ours with a smooth drag curve and air by height, beside a point mass as one would write it first.
//!
//! Both take rk4 steps of 1/120 s; every 600 steps they start anew, so that neither falls through the floor.

use crate::failure::Failure;
use glam::DVec3;
use sim::ballistics::motion::{ShellMotion, State, advance, state};
use sim::ballistics::projectile::Projectile;
use sim::case::Case;
use sim::integrate::{Integrator, rk4};
use std::hint::black_box;
use std::path::Path;

const STEP_S: f64 = 1.0 / 120.0;
/// Steps from a start on: five seconds.
const FLIGHT: u32 = 600;
/// 700 m/s, half a right angle up.
const START: State = [0.0, 0.0, 0.0, 495.0, 0.0, -495.0];
/// Drag area over twice the mass, times density, of a 155 mm shell, 1/m.
const PLAIN_PM: f64 = 0.3 * 1.225 * 0.018_869 / (2.0 * 43.09);

/// A shell and its surroundings.
pub struct Shell {
    projectile: Projectile,
    case: Case,
}

impl Shell {
    /// The example shell of 155 mm over a flat Earth with standard air.
    ///
    /// # Errors
    /// [`Failure::Failed`] if the built-in files cannot be read.
    pub fn new() -> Result<Self, Failure> {
        let failed = |error: sim::file::FileError| Failure::while_doing("reading a built-in shell", error);
        let text = include_str!("../../../assets/ballistics/projectiles/155mm_m107.toml");
        Ok(Self {
            projectile: Projectile::from_text(Path::new("155mm_m107.toml"), text).map_err(failed)?,
            case: Case::from_text(Path::new("shell"), "").map_err(failed)?,
        })
    }

    /// Nanoseconds a step.
    ///
    /// # Errors
    /// [`Failure::Failed`] if a step cannot be taken.
    pub fn step_ns(&self, steps: u32) -> Result<f64, Failure> {
        let case = &self.case;
        let motion = ShellMotion::new(&self.projectile, case.planet, &case.atmosphere, &case.wind, DVec3::X);
        let (mut y, mut at, mut wrong) = (START, 0u32, None);
        let ns = super::each_ns(steps, || {
            if at == FLIGHT {
                (y, at) = (START, 0);
            }
            match advance(Integrator::Rk4, &motion, f64::from(at) * STEP_S, &y, STEP_S, &mut None) {
                Ok((next, _)) => y = next,
                Err(error) => wrong = Some(error),
            }
            at += 1;
        });
        match wrong {
            None => Ok(ns),
            Some(error) => Err(Failure::while_doing("flying a built-in shell", error)),
        }
    }
}

/// Nanoseconds a step of the plain point mass.
pub fn plain_step_ns(steps: u32) -> f64 {
    let (mut y, mut at) = (START, 0);
    super::each_ns(steps, || {
        if at == FLIGHT {
            (y, at) = (START, 0);
        }
        y = rk4(0.0, black_box(&y), STEP_S, |_, y| {
            let velocity = DVec3::new(y[3], y[4], y[5]);
            let a = DVec3::new(0.0, 0.0, 9.806_65) - velocity * (PLAIN_PM * velocity.length());
            let [.., vx, vy, vz] = *y;
            [vx, vy, vz, a.x, a.y, a.z]
        });
        at += 1;
    })
}

/// A flight's place as this file counts it, for the swept step: position and velocity.
pub fn stepped(position_m: DVec3, velocity_mps: DVec3) -> State {
    let gravity = DVec3::new(0.0, -9.806_65, 0.0);
    rk4(0.0, &state(position_m, velocity_mps), STEP_S, |_, y| {
        let velocity = DVec3::new(y[3], y[4], y[5]);
        let a = gravity - velocity * (PLAIN_PM * velocity.length());
        [y[3], y[4], y[5], a.x, a.y, a.z]
    })
}

/// Length of a step, seconds.
pub const fn step_s() -> f64 {
    STEP_S
}
