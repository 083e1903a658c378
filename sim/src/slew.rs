//! Free movement: the stick drives the aircraft's place and heading directly, without flight.
//!
//! Never under the ground, never NaN; the attitude is level, so that what is looked at stands still.

use crate::aircraft::{ALTITUDE_M, AircraftState, Condition, FARTHEST_M};
use crate::frame;
use crate::input::Controls;
use crate::{GEAR_HEIGHT_M, HeightAt};
use glam::DVec3;

/// How fast to move.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SlewRates {
    /// Along the heading, m/s.
    pub forward_mps: f64,
    /// To the right of it, m/s.
    pub right_mps: f64,
    /// Upward, m/s.
    pub up_mps: f64,
    /// Turn to the right, rad/s.
    pub yaw_radps: f64,
}

impl SlewRates {
    /// Fastest movement along the ground, m/s.
    pub const FASTEST_MPS: f64 = 20_000.0;

    /// Rates of the pilot's controls: stick forward moves forward, sideways turns, pedals shift, throttle beyond its
    /// middle climbs. Faster with height, so that both a runway and a mountain range can be crossed.
    pub fn from_controls(controls: &Controls, height_m: f64) -> Self {
        let controls = controls.checked();
        let height_m = if height_m.is_finite() { height_m.max(0.0) } else { 1_000.0 };
        let reach_mps = (20.0 + height_m).min(5_000.0);
        let lift = 2.0 * controls.throttle - 1.0;
        // The throttle has no spring: its middle fifth holds the height.
        let lift = if lift.abs() < 0.2 { 0.0 } else { lift - 0.2f64.copysign(lift) };
        Self {
            forward_mps: -controls.pitch * reach_mps,
            right_mps: controls.yaw * 0.5 * reach_mps,
            up_mps: lift * 0.5 * reach_mps,
            yaw_radps: controls.roll * 0.8,
        }
    }

    fn checked(self) -> Self {
        let within = |v: f64, most: f64| if v.is_finite() { v.clamp(-most, most) } else { 0.0 };
        Self {
            forward_mps: within(self.forward_mps, Self::FASTEST_MPS),
            right_mps: within(self.right_mps, Self::FASTEST_MPS),
            up_mps: within(self.up_mps, Self::FASTEST_MPS),
            yaw_radps: within(self.yaw_radps, 3.0),
        }
    }
}

/// The state moved for `dt_s`; also gets a crashed aircraft going again.
pub fn slew(state: &AircraftState, rates: SlewRates, height_at: &HeightAt, dt_s: f64) -> AircraftState {
    let rates = rates.checked();
    let heading_rad = state.angles().heading_rad + rates.yaw_radps * dt_s;
    let forward = terrain::frame::direction(heading_rad, 0.0);
    let right = terrain::frame::direction(heading_rad + std::f64::consts::FRAC_PI_2, 0.0);
    let velocity_mps = forward * rates.forward_mps + right * rates.right_mps + DVec3::Y * rates.up_mps;
    let mut position_m = state.position_m + velocity_mps * dt_s;
    position_m.x = position_m.x.clamp(-FARTHEST_M, FARTHEST_M);
    position_m.z = position_m.z.clamp(-FARTHEST_M, FARTHEST_M);
    let floor_m =
        height_at(position_m.x, position_m.z).filter(|h| h.is_finite()).map_or(ALTITUDE_M.0, |h| h + GEAR_HEIGHT_M);
    position_m.y = position_m.y.max(floor_m).min(ALTITUDE_M.1);
    AircraftState {
        position_m,
        velocity_mps,
        attitude: frame::attitude(frame::Angles { heading_rad, ..Default::default() }),
        rates_radps: DVec3::new(0.0, 0.0, rates.yaw_radps),
        load_factor: 1.0,
        alpha_rad: 0.0,
        airspeed_mps: velocity_mps.length(),
        condition: Condition::Flying,
        throttle: state.throttle,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_moves_where_it_is_told_and_never_under_the_ground() {
        let start = AircraftState::level(DVec3::new(0.0, 50.0, 0.0), 0.0, 100.0);
        let rates = SlewRates { forward_mps: 100.0, up_mps: -100.0, ..SlewRates::default() };
        let end = (0..120).fold(start, |s, _| slew(&s, rates, &|_, _| Some(20.0), 1.0 / 120.0));
        assert!((end.position_m - DVec3::new(0.0, 22.0, -100.0)).length() < 1e-9, "{end:?}");
        let turned = slew(&start, SlewRates { yaw_radps: 1.0, ..SlewRates::default() }, &|_, _| None, 0.5);
        assert!((turned.angles().heading_rad - 0.5).abs() < 1e-12);
    }

    #[test]
    fn wild_rates_and_void_stay_finite() {
        let start = AircraftState::level(DVec3::ZERO, 0.0, 0.0);
        for v in [f64::NAN, f64::INFINITY, -1e300] {
            let rates = SlewRates { forward_mps: v, right_mps: v, up_mps: v, yaw_radps: v };
            assert!(slew(&start, rates, &|_, _| Some(f64::NAN), 0.1).is_finite());
            let controls = Controls { pitch: v, roll: v, yaw: v, throttle: v };
            assert!(SlewRates::from_controls(&controls, v).forward_mps.is_finite());
        }
        assert_eq!(
            SlewRates::from_controls(&Controls::default(), 100.0),
            SlewRates { forward_mps: -0.0, ..SlewRates::default() }
        );
    }
}
