//! What every flight model takes and gives: plain data.
//!
//! A model is a function `step(state, controls, air, dt_s) -> state`; it knows neither ground nor screen nor time.
//! [`point_mass`] is the one that flies now; a model with forces and moments takes its place with the same arguments.
//! Contact with the ground is added after the step by [`meet_ground`].
//!
//! Invariant others rely on: every number of a state that leaves [`checked`] is finite and within the stated bounds.

pub mod point_mass;

use crate::{GEAR_HEIGHT_M, HeightAt, frame};
use glam::{DMat3, DQuat, DVec3};

/// Lowest and highest altitude of an aircraft above mean sea level, metres: below every ocean floor, above every model.
pub const ALTITUDE_M: (f64, f64) = (-12_000.0, 120_000.0);
/// Farthest from the world's origin, metres, so that differences of positions stay exact to a micrometre.
pub const FARTHEST_M: f64 = 10_000_000.0;
/// Highest speed, m/s.
pub const MAX_SPEED_MPS: f64 = 12_000.0;
/// A touch faster than this, across the surface, is a crash, m/s. Naval jets are built for some 7.
pub const CRASH_CLOSING_MPS: f64 = 10.0;

/// Whether the aircraft flies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Condition {
    /// In the air.
    #[default]
    Flying,
    /// Sliding or standing on the ground.
    OnGround,
    /// Broken; stays where it is until reset.
    Crashed,
}

/// An aircraft's state, in the world's frame unless said otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AircraftState {
    /// Position, metres; Y is altitude above mean sea level.
    pub position_m: DVec3,
    /// Velocity over the ground, m/s.
    pub velocity_mps: DVec3,
    /// Body axes to the world's.
    pub attitude: DQuat,
    /// Roll, pitch and yaw rate about body axes, rad/s.
    pub rates_radps: DVec3,
    /// Lift over weight; 1 in level flight.
    pub load_factor: f64,
    /// Angle of attack, radians.
    pub alpha_rad: f64,
    /// Speed through the air, m/s.
    pub airspeed_mps: f64,
    /// Throttle as set, 0..1.
    pub throttle: f64,
    /// Whether it flies.
    pub condition: Condition,
}

impl AircraftState {
    /// Straight flight without wind at a heading from grid north, metres, radians, m/s.
    pub fn level(position_m: DVec3, grid_heading_rad: f64, speed_mps: f64) -> Self {
        let velocity_mps = terrain::frame::direction(grid_heading_rad, 0.0) * speed_mps;
        Self {
            position_m,
            velocity_mps,
            attitude: frame::attitude(frame::Angles { heading_rad: grid_heading_rad, ..Default::default() }),
            rates_radps: DVec3::ZERO,
            load_factor: 1.0,
            alpha_rad: 0.0,
            airspeed_mps: speed_mps,
            throttle: 0.5,
            condition: Condition::Flying,
        }
    }

    /// Heading, pitch and roll.
    pub fn angles(&self) -> frame::Angles {
        frame::angles(self.attitude)
    }

    /// Rate of climb, m/s.
    pub fn climb_mps(&self) -> f64 {
        self.velocity_mps.y
    }

    /// Whether every number is finite.
    pub fn is_finite(&self) -> bool {
        self.position_m.is_finite()
            && self.velocity_mps.is_finite()
            && self.attitude.is_finite()
            && self.rates_radps.is_finite()
            && self.load_factor.is_finite()
            && self.alpha_rad.is_finite()
            && self.airspeed_mps.is_finite()
            && self.throttle.is_finite()
    }
}

/// The state after a step if it is sound, held within bounds; else the state before, crashed: NaN goes no further.
pub fn checked(before: &AircraftState, after: AircraftState) -> AircraftState {
    if !after.is_finite() || after.attitude.length_squared() < 0.25 {
        return crashed(before);
    }
    let far = DVec3::new(FARTHEST_M, ALTITUDE_M.1, FARTHEST_M);
    let low = DVec3::new(-FARTHEST_M, ALTITUDE_M.0, -FARTHEST_M);
    let inside = after.position_m.clamp(low, far);
    if inside.y != after.position_m.y && after.position_m.y < ALTITUDE_M.0 {
        return crashed(&AircraftState { position_m: inside, ..after });
    }
    AircraftState {
        position_m: inside,
        velocity_mps: after.velocity_mps.clamp_length_max(MAX_SPEED_MPS),
        attitude: after.attitude.normalize(),
        ..after
    }
}

fn crashed(at: &AircraftState) -> AircraftState {
    AircraftState {
        velocity_mps: DVec3::ZERO,
        rates_radps: DVec3::ZERO,
        airspeed_mps: 0.0,
        condition: Condition::Crashed,
        ..*at
    }
}

/// Keeps the gear out of the ground after a step: a gentle touch slides along the surface, a hard one is a crash.
///
/// Looks along the step's whole way, so a fast aircraft does not pass through a ridge. Where the ground is void there is
/// nothing to meet.
pub fn meet_ground(before: &AircraftState, after: AircraftState, height_at: &HeightAt, dt_s: f64) -> AircraftState {
    /// Posts stand at least 25 m apart.
    const LOOK_M: f64 = 25.0;
    let way = after.position_m - before.position_m;
    let looks = (way.length() / LOOK_M).ceil().clamp(1.0, 64.0);
    let hit = (1..=looks as u32).find_map(|look| {
        let at = before.position_m + way * (f64::from(look) / looks);
        let ground_m = height_at(at.x, at.z).filter(|h| h.is_finite())?;
        (at.y <= ground_m + GEAR_HEIGHT_M).then_some(DVec3::new(at.x, ground_m + GEAR_HEIGHT_M, at.z))
    });
    let Some(touch) = hit else {
        return AircraftState { condition: Condition::Flying, ..after };
    };
    let normal = surface_normal(height_at, touch);
    let closing_mps = -after.velocity_mps.dot(normal);
    let upright = (after.attitude * DVec3::NEG_Z).dot(normal);
    if closing_mps > CRASH_CLOSING_MPS || upright < 0.5 {
        return crashed(&AircraftState { position_m: touch, ..after });
    }
    // The part into the surface is lost, the rest slides with the friction of grass.
    let along = after.velocity_mps + normal * closing_mps.max(0.0);
    let speed_mps = along.length();
    let slowed_mps = (speed_mps - 0.05 * crate::atmosphere::GRAVITY_MPS2 * dt_s).max(0.0);
    let velocity_mps = if speed_mps > 1e-9 { along * (slowed_mps / speed_mps) } else { DVec3::ZERO };
    AircraftState {
        position_m: touch,
        velocity_mps,
        attitude: standing_attitude(after.attitude, normal),
        rates_radps: DVec3::ZERO,
        alpha_rad: 0.0,
        condition: Condition::OnGround,
        ..after
    }
}

/// The attitude of an aircraft that stands on a surface: the nose as it pointed, the wings along the slope.
fn standing_attitude(attitude: DQuat, normal: DVec3) -> DQuat {
    let down = -normal;
    let right = down.cross(attitude * DVec3::X);
    if right.length_squared() < 1e-6 {
        return attitude;
    }
    let right = right.normalize();
    DQuat::from_mat3(&DMat3::from_cols(right.cross(down), right, down)).normalize()
}

/// Upward normal of the surface about a point, from heights 5 m around; straight up where they are missing.
fn surface_normal(height_at: &HeightAt, at: DVec3) -> DVec3 {
    const REACH_M: f64 = 5.0;
    let slope = |dx: f64, dz: f64| {
        let (low, high) = (height_at(at.x - dx, at.z - dz), height_at(at.x + dx, at.z + dz));
        low.zip(high).map_or(0.0, |(low, high)| (high - low) / (2.0 * REACH_M))
    };
    let normal = DVec3::new(-slope(REACH_M, 0.0), 1.0, -slope(0.0, REACH_M));
    if normal.is_finite() { normal.normalize() } else { DVec3::Y }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 1.0 / 120.0;

    fn moved(state: &AircraftState) -> AircraftState {
        AircraftState { position_m: state.position_m + state.velocity_mps * DT_S, ..*state }
    }

    #[test]
    fn a_gentle_touch_slides_and_a_hard_one_crashes() {
        let mut state = AircraftState::level(DVec3::new(0.0, 2.01, 0.0), 0.0, 60.0);
        state.velocity_mps.y = -3.0;
        let slid = meet_ground(&state, moved(&state), &|_, _| Some(0.0), DT_S);
        assert_eq!((slid.condition, slid.position_m.y), (Condition::OnGround, GEAR_HEIGHT_M));
        assert!(slid.velocity_mps.y.abs() < 1e-12 && slid.velocity_mps.length() > 59.0);
        state.velocity_mps.y = -30.0;
        let hard = meet_ground(&state, moved(&state), &|_, _| Some(0.0), DT_S);
        assert_eq!((hard.condition, hard.velocity_mps), (Condition::Crashed, DVec3::ZERO));
    }

    #[test]
    fn a_ridge_narrower_than_a_step_is_met_at_ten_kilometres_a_second() {
        // 83 m a step, a wall of 30 m.
        let wall = |x: f64, _: f64| Some(if (20.0..50.0).contains(&x) { 500.0 } else { 0.0 });
        let state = AircraftState::level(DVec3::new(0.0, 300.0, 0.0), std::f64::consts::FRAC_PI_2, 10_000.0);
        assert_eq!(meet_ground(&state, moved(&state), &wall, DT_S).condition, Condition::Crashed);
    }

    #[test]
    fn under_the_ground_is_lifted_and_over_void_there_is_nothing_to_meet() {
        let below = AircraftState::level(DVec3::new(0.0, -500.0, 0.0), 0.0, 0.0);
        assert_eq!(meet_ground(&below, below, &|_, _| Some(100.0), DT_S).position_m.y, 102.0);
        for void in [&(|_: f64, _: f64| None) as &HeightAt, &|_, _| Some(f64::NAN)] {
            let free = meet_ground(&below, below, void, DT_S);
            assert_eq!((free.position_m.y, free.condition), (-500.0, Condition::Flying));
        }
        let fallen = checked(&below, AircraftState { position_m: DVec3::new(0.0, -13_000.0, 0.0), ..below });
        assert_eq!(fallen.condition, Condition::Crashed);
    }

    #[test]
    fn nan_in_any_number_crashes_and_goes_no_further() {
        let good = AircraftState::level(DVec3::new(0.0, 500.0, 0.0), 0.0, 100.0);
        for bad in [
            AircraftState { position_m: DVec3::NAN, ..good },
            AircraftState { velocity_mps: DVec3::INFINITY, ..good },
            AircraftState { attitude: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..good },
            AircraftState { load_factor: f64::NAN, ..good },
        ] {
            let state = checked(&good, bad);
            assert!(state.is_finite() && state.condition == Condition::Crashed);
            assert_eq!(state.position_m, good.position_m);
        }
        let far = checked(&good, AircraftState { position_m: DVec3::splat(1e300), ..good });
        assert_eq!(far.position_m, DVec3::new(FARTHEST_M, ALTITUDE_M.1, FARTHEST_M));
    }
}
