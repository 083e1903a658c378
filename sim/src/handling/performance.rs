//! Stall, level speeds and climb of a model, and how they stand beside its handbook.
//!
//! The stall is that without power at one g: the greatest lift that the elevator can hold without pitching on. A cruise is
//! level flight at a share of the rated power, or at full throttle where that gives less. The rate of climb is the power
//! left over in level flight at full throttle, over the weight.

use super::{Fixed, Held, control, initial, level, needed};
use crate::integrate::Motion as _;
use crate::planet::STANDARD_GRAVITY_MPS2;
use crate::rigid::Model;
use crate::rigid::motion::RigidMotion;
use crate::rigid::start;
use glam::DVec3;
use std::sync::Arc;

/// A figure beside the handbook's.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// What it is.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// What the model gives.
    pub found: f64,
    /// What the handbook says.
    pub handbook: f64,
    /// Part of the handbook's that it may be off.
    pub within: f64,
}

impl Figure {
    /// How far it is off, as a part of the handbook's.
    pub fn off(&self) -> f64 {
        self.found / self.handbook - 1.0
    }

    /// Whether it is near enough.
    pub fn passes(&self) -> bool {
        self.off().abs() <= self.within
    }
}

/// Stall speed at sea level without power, m/s, with flaps in their own unit.
///
/// # Errors
/// A sentence: a control is missing.
pub fn stall_mps(model: &Arc<Model>, flaps: f64) -> Result<f64, String> {
    const TRIED_MPS: f64 = 25.0;
    let elevator = needed(model, "elevator")?;
    let mut motion = RigidMotion::new(
        model.clone(),
        crate::planet::Planet::flat(),
        crate::atmosphere::Atmosphere::standard(),
        crate::wind::Wind::still(),
    );
    if let Some(place) = control(model, "flaps") {
        motion.controls[place] = flaps;
    }
    let of = &model.controls[elevator];
    let mut most_g = 0.0f64;
    for tenth in 20..350 {
        let alpha_rad = f64::from(tenth).to_radians() * 0.1;
        let mut start = initial(0.0, DVec3::X * TRIED_MPS);
        start.attitude = crate::case::Attitude::Angles([0.0, alpha_rad, 0.0]);
        let y = start::state(&motion.planet, &start);
        motion.settle_shaft(&y);
        let mut pitching = |at: f64| {
            motion.controls[elevator] = at;
            motion.rate(0.0, &y)[12]
        };
        // Moments are linear in the elevator.
        let (none, full) = (pitching(0.0), pitching(of.max));
        let holds = -none / (full - none) * of.max;
        if !(of.min..=of.max).contains(&holds) {
            continue;
        }
        motion.controls[elevator] = holds;
        most_g = most_g.max(1.0 - motion.rate(0.0, &y)[10] / STANDARD_GRAVITY_MPS2);
    }
    if most_g > 0.0 { Ok(TRIED_MPS / most_g.sqrt()) } else { Err("expected lift at some angle, found none".to_owned()) }
}

/// Power on the shaft, watts.
fn power_w(held: &Held) -> Option<f64> {
    let power = held.motion.model.power.as_ref()?;
    let air = held.motion.sample(&held.y, true).air;
    let ratio = air.density_kgpm3 / crate::atmosphere::SEA_LEVEL_DENSITY_KGPM3;
    Some(power.engine.power_w(&power.setting(&held.motion.controls, ratio, true), held.motion.shaft_radps))
}

/// Level flight at a share of the rated power, or at full throttle where that gives less.
///
/// # Errors
/// A sentence: there is no such flight.
pub fn cruise(model: &Arc<Model>, altitude_m: f64, share: f64) -> Result<Held, String> {
    let rated_w = model.power.as_ref().ok_or("expected an engine, found none")?.engine.rated_w;
    let fastest = level(model, altitude_m, Fixed::Throttle(1.0, 60.0))?;
    if power_w(&fastest).unwrap_or(0.0) <= share * rated_w {
        return Ok(fastest);
    }
    let (mut low, mut high) =
        (0.6 * crate::rigid::motion::velocity(&fastest.y).x, crate::rigid::motion::velocity(&fastest.y).x);
    let mut held = fastest;
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        held = level(model, altitude_m, Fixed::Speed(middle))?;
        if power_w(&held).unwrap_or(0.0) < share * rated_w { low = middle } else { high = middle }
    }
    Ok(held)
}

/// Rate of climb at full throttle and a speed at sea level, m/s.
///
/// # Errors
/// A sentence: there is no level flight at that speed.
pub fn climb_mps(model: &Arc<Model>, speed_mps: f64) -> Result<f64, String> {
    let mut held = level(model, 0.0, Fixed::Speed(speed_mps))?;
    let throttle = needed(model, "throttle")?;
    held.motion.controls[throttle] = model.controls[throttle].max;
    held.motion.settle_shaft(&held.y);
    Ok(held.motion.rate(0.0, &held.y)[8] * speed_mps / STANDARD_GRAVITY_MPS2)
}

/// Every figure of the model's handbook that is flown in the air, beside what the model gives.
///
/// # Errors
/// A sentence: a control is missing, or a flight is not to be had.
pub fn figures(model: &Arc<Model>) -> Result<Vec<Figure>, String> {
    let Some(book) = &model.handbook else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    let mut add =
        |name: String, unit, found, handbook, within| all.push(Figure { name, unit, found, handbook, within });
    for [flaps, speed_mps] in &book.stall_mps {
        add(format!("stall, flaps {flaps}"), "m/s", stall_mps(model, *flaps)?, *speed_mps, 0.05);
    }
    for [altitude_m, share, speed_mps] in &book.cruise {
        let found = crate::rigid::motion::velocity(&cruise(model, *altitude_m, *share)?.y).x;
        add(format!("cruise, {:.0} % at {altitude_m:.0} m", share * 100.0), "m/s", found, *speed_mps, 0.05);
    }
    if let Some(speed_mps) = book.fastest_mps {
        let found = crate::rigid::motion::velocity(&level(model, 0.0, Fixed::Throttle(1.0, speed_mps))?.y).x;
        add("fastest at sea level".to_owned(), "m/s", found, speed_mps, 0.05);
    }
    if let Some([climb, speed_mps]) = book.climb {
        add("climb at sea level".to_owned(), "m/s", climb_mps(model, speed_mps)?, climb, 0.10);
    }
    Ok(all)
}
