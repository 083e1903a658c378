//! How a model flies, measured by flying it: its modes from its own inputs, and its figures beside a handbook's.
//!
//! | file | what |
//! |---|---|
//! | `linear.rs` | a linear system fitted to a response, and its eigenvalues |
//! | `modes.rs` | short period, phugoid, Dutch roll, roll and spiral |
//! | `performance.rs` | stall, level speeds, climb |
//! | `runway.rs` | take-off and landing on a level runway |
//!
//! Controls are found by their names without the unit: `elevator`, `aileron`, `rudder`, `throttle`, `mixture`, `flaps`,
//! `brake_left`, `brake_right`. SI; standard air over a plane without rotation; the model's mass with full tanks.

pub mod linear;
pub mod modes;
pub mod performance;
pub mod runway;

use crate::atmosphere::Atmosphere;
use crate::case::{Attitude, Initial, RatesFrame, Setting, Trim, Velocity};
use crate::frame::{Angles, world_attitude_from_ned};
use crate::planet::{Place, Planet};
use crate::rigid::Model;
use crate::rigid::motion::{self, RigidMotion, State};
use crate::rigid::quantity::without_unit;
use crate::rigid::{start, trim};
use crate::wind::Wind;
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A body held in a state.
#[derive(Debug, Clone)]
pub struct Held {
    /// The body with its controls as found.
    pub motion: RigidMotion,
    /// The state.
    pub y: State,
}

/// The place of a control by its name without the unit.
pub fn control(model: &Model, stem: &str) -> Option<usize> {
    model.controls.iter().position(|one| without_unit(&one.name).is_some_and(|(bare, _)| bare == stem))
}

/// The same where it must be there.
///
/// # Errors
/// A sentence that says what was expected and what was found.
pub(crate) fn needed(model: &Model, stem: &str) -> Result<usize, String> {
    control(model, stem).ok_or_else(|| {
        let known: Vec<&str> = model.controls.iter().map(|one| one.name.as_str()).collect();
        format!("expected a control {stem} with its unit, found [{}]", known.join(", "))
    })
}

/// What is fixed of a level flight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fixed {
    /// The speed, m/s; the throttle is found.
    Speed(f64),
    /// The throttle; the speed is found, from this one on, m/s.
    Throttle(f64, f64),
}

/// Level flight northward, trimmed, with the mixture at best power.
///
/// # Errors
/// A sentence: a control is missing, or there is no balance.
pub fn level(model: &Arc<Model>, altitude_m: f64, fixed: Fixed) -> Result<Held, String> {
    let name = |stem: &str| needed(model, stem).map(|place| model.controls[place].name.clone());
    let mut set = BTreeMap::new();
    let (third, speed_mps) = match fixed {
        Fixed::Speed(speed_mps) => (name("throttle")?, speed_mps),
        Fixed::Throttle(throttle, speed_mps) => {
            set.insert(name("throttle")?, Setting::Number(throttle));
            ("speed_mps".to_owned(), speed_mps)
        }
    };
    let mut motion = RigidMotion::new(model.clone(), Planet::flat(), Atmosphere::standard(), Wind::still());
    lean(&mut motion, altitude_m);
    if let Fixed::Speed(_) = fixed {
        let place = needed(model, "throttle")?;
        motion.controls[place] = 0.6 * model.controls[place].max;
    }
    let initial = initial(altitude_m, DVec3::X * speed_mps);
    // Hands off: by the trim where there is one.
    let pitch = name("elevator_trim").or_else(|_| name("elevator"))?;
    let wanted = Trim { vary: vec![pitch, third, "pitch_deg".to_owned()], set };
    let found = trim::trim(&mut motion, &initial, &wanted)?;
    let y = start::state(&motion.planet, &found.initial);
    motion.settle_shaft(&y);
    Ok(Held { motion, y })
}

/// What a body needs to fly on level as it goes, loaded as it is: its controls, and how it then points (world frame).
///
/// # Errors
/// A sentence: a control is missing, or there is no balance.
pub(crate) fn level_from(motion: &mut RigidMotion, y: &State) -> Result<(Vec<f64>, Angles), String> {
    let model = motion.model.clone();
    let name = |stem: &str| needed(&model, stem).map(|place| model.controls[place].name.clone());
    let pitch = name("elevator_trim").or_else(|_| name("elevator"))?;
    let position = motion::position(y);
    lean(motion, motion.planet.altitude_m(position));
    let throttle = needed(&model, "throttle")?;
    motion.controls[throttle] = 0.6 * model.controls[throttle].max;
    let heading_rad = motion::angles_of(&glam::DMat3::from_quat(motion::attitude(y)))[2];
    let from = Initial {
        flat_m: Some(position),
        // What stands in the air is held as if it crept ahead: trim takes no path without a direction.
        velocity: Velocity::Ned(motion::velocity(y) + DVec3::X * 1e-9),
        attitude: Attitude::Angles([0.0, 0.0, heading_rad]),
        ..initial(0.0, DVec3::ZERO)
    };
    let wanted = Trim { vary: vec![pitch, name("throttle")?, "pitch_deg".to_owned()], set: BTreeMap::new() };
    let found = trim::trim(motion, &from, &wanted)?;
    let turned = motion::attitude(&start::state(&motion.planet, &found.initial));
    Ok((motion.controls.clone(), crate::frame::angles(world_attitude_from_ned(turned))))
}

/// A start over a plane, level, northward.
pub(crate) fn initial(altitude_m: f64, velocity_ned_mps: DVec3) -> Initial {
    Initial {
        place: Place { altitude_m, ..Place::default() },
        flat_m: Some(DVec3::new(0.0, 0.0, -altitude_m)),
        velocity: Velocity::Ned(velocity_ned_mps),
        attitude: Attitude::Angles([0.0; 3]),
        rates_radps: DVec3::ZERO,
        rates_frame: RatesFrame::Earth,
    }
}

/// Sets the mixture for best power at an altitude, but full rich where that gives the same.
pub(crate) fn lean(motion: &mut RigidMotion, altitude_m: f64) {
    let model = motion.model.clone();
    if let Some(power) = &model.power
        && let Some(place) = power.mixture
    {
        let ratio = motion.atmosphere.at(altitude_m).density_kgpm3 / crate::atmosphere::SEA_LEVEL_DENSITY_KGPM3;
        motion.controls[place] = power.engine.best_mixture(ratio);
    }
}
