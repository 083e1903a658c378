//! The state that a case begins with.

use super::motion::{self, State};
use crate::case::{Attitude, Initial, RatesFrame, Velocity};
use crate::planet::Planet;
use glam::{DQuat, DVec3, EulerRot};

/// Body to north, east, down.
pub fn ned_from_body(attitude: &Attitude) -> DQuat {
    match *attitude {
        Attitude::Quaternion([w, x, y, z]) => DQuat::from_xyzw(x, y, z, w).normalize(),
        Attitude::Angles([roll, pitch, yaw]) => DQuat::from_euler(EulerRot::ZYX, yaw, pitch, roll).normalize(),
    }
}

/// The state of an initial condition over a planet.
pub fn state(planet: &Planet, initial: &Initial) -> State {
    let position = initial.flat_m.unwrap_or_else(|| planet.position_m(initial.place));
    let place = planet.place(position);
    let frame_from_ned = planet.frame_from_ned(place);
    let ned_from_body = ned_from_body(&initial.attitude);
    let ned_mps = match initial.velocity {
        Velocity::Ned(ned) => ned,
        Velocity::Body(body) => ned_from_body * body,
    };
    let attitude = (DQuat::from_mat3(&frame_from_ned) * ned_from_body).normalize();
    let in_body = |frame: DVec3| attitude.inverse() * frame;
    let earth = in_body(planet.rotation());
    let rates = initial.rates_radps
        + match initial.rates_frame {
            RatesFrame::Inertial => DVec3::ZERO,
            RatesFrame::Earth => earth,
            RatesFrame::Local => earth + ned_from_body.inverse() * planet.transport_radps(place, ned_mps),
        };
    motion::state(position, attitude, 0.0, frame_from_ned * ned_mps, rates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::planet::{EARTH_ROTATION_RADPS, Place};

    #[test]
    fn angles_turn_yaw_first_then_pitch_then_roll() {
        let q = ned_from_body(&Attitude::Angles([0.3, 0.2, 1.0]));
        let back = motion::angles_of(&glam::DMat3::from_quat(q));
        for (given, found) in [0.3, 0.2, 1.0].into_iter().zip(back) {
            assert!((given - found).abs() < 1e-15, "{back:?}");
        }
        let nose = ned_from_body(&Attitude::Angles([0.0, 0.5, 0.0])) * DVec3::X;
        assert!(nose.z < 0.0, "nose up is up");
        let wing = ned_from_body(&Attitude::Angles([0.5, 0.0, 0.0])) * DVec3::Y;
        assert!(wing.z > 0.0, "right wing down");
    }

    #[test]
    fn rates_are_turned_into_those_against_the_stars() {
        let initial = Initial {
            place: Place::default(),
            flat_m: None,
            velocity: Velocity::Ned(DVec3::new(0.0, 1_000.0, 0.0)),
            attitude: Attitude::Angles([0.0, 0.0, std::f64::consts::FRAC_PI_2]),
            rates_radps: DVec3::ZERO,
            rates_frame: RatesFrame::Local,
        };
        // At the equator, eastward: the local axes turn about north with the Earth and the flight, nose-down.
        let y = state(&Planet::wgs84(), &initial);
        let turn = EARTH_ROTATION_RADPS + 1_000.0 / 6_378_137.0;
        assert!((motion::rates(&y) - DVec3::new(0.0, -turn, 0.0)).length() < 1e-15, "{}", motion::rates(&y));
        let earth = state(&Planet::wgs84(), &Initial { rates_frame: RatesFrame::Earth, ..initial });
        assert!((motion::rates(&earth).y + EARTH_ROTATION_RADPS).abs() < 1e-18);
    }
}
