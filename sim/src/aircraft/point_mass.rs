//! A point mass that flies pleasantly: stick to load factor and roll rate, always coordinated.
//!
//! Forces: thrust along the path, drag with its induced part, lift across the path, weight. With the stick let go the
//! path is held, also in a turn, as far as wing and structure allow; slow flight runs out of lift and the nose falls
//! until speed is back. Attitude follows from path, bank and the angle of attack that the lift takes.
//!
//! State of the integration: position, speed, a quaternion of path axes (x along the path, y right, z down), roll rate
//! and load factor with their lags. Still air; wind moves the whole frame. Equations of a coordinated point mass: B.
//! Etkin, Dynamics of Atmospheric Flight, 1972, chapter 4, with the side force nil.

use super::{AircraftState, Condition, MAX_SPEED_MPS};
use crate::atmosphere::{Air, GRAVITY_MPS2, SEA_LEVEL_DENSITY_KGPM3};
use crate::input::Controls;
use crate::integrate::rk4;
use glam::{DMat3, DQuat, DVec3};

/// A jet trainer's numbers, rounded, with more thrust than one has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointMass {
    /// Mass, kg.
    pub mass_kg: f64,
    /// Wing area, m2.
    pub wing_m2: f64,
    /// Greatest lift coefficient.
    pub lift_max: f64,
    /// Lift coefficient a radian of angle of attack.
    pub lift_slope: f64,
    /// Drag coefficient without lift, and what the square of the lift coefficient adds.
    pub drag: (f64, f64),
    /// Thrust at sea level, newtons.
    pub thrust_n: f64,
    /// Load factor at full stick forward and back.
    pub load: (f64, f64),
    /// Roll rate at full stick, rad/s.
    pub roll_radps: f64,
    /// Time constants of roll rate and load factor, seconds.
    pub lag_s: (f64, f64),
}

impl Default for PointMass {
    fn default() -> Self {
        Self {
            mass_kg: 4_300.0,
            wing_m2: 18.8,
            lift_max: 1.5,
            lift_slope: 5.0,
            drag: (0.022, 0.06),
            thrust_n: 32_000.0,
            load: (-2.5, 6.0),
            roll_radps: 1.9,
            lag_s: (0.15, 0.22),
        }
    }
}

/// Below this the path's direction turns as if flown at it: a body at rest has no path to turn, m/s.
const SLOWEST_PATH_MPS: f64 = 15.0;
/// Cosine of the bank up to which the path is held with the stick let go: 65 degrees, 2.4 times weight.
const HOLD_BANK_COS: f64 = 0.42;

/// Numbers of the integrated state, in order.
const N: usize = 10;

impl PointMass {
    /// The state after `dt_s`; a crashed aircraft stays as it is.
    pub fn step(&self, state: &AircraftState, controls: &Controls, air: &Air, dt_s: f64) -> AircraftState {
        if state.condition == Condition::Crashed {
            return *state;
        }
        let controls = controls.checked();
        let through_air = state.velocity_mps - air.wind_mps;
        let path = path_axes(state, through_air);
        let y: [f64; N] = [
            state.position_m.x,
            state.position_m.y,
            state.position_m.z,
            through_air.length().min(MAX_SPEED_MPS),
            path.x,
            path.y,
            path.z,
            path.w,
            state.rates_radps.x,
            state.load_factor,
        ];
        let y = rk4(0.0, &y, dt_s, |_, y| self.rates(y, &controls, air));
        let speed_mps = y[3].clamp(0.0, MAX_SPEED_MPS);
        let path = DQuat::from_xyzw(y[4], y[5], y[6], y[7]).normalize();
        let alpha_rad = self.alpha_rad(y[9], speed_mps, air);
        let attitude = (path * DQuat::from_rotation_y(alpha_rad)).normalize();
        // Body rates from how far the body turned in the step.
        let turned = (state.attitude.inverse() * attitude).normalize();
        let turned = if turned.w < 0.0 { -turned } else { turned };
        let mean_rates = if dt_s > 0.0 { turned.to_scaled_axis() / dt_s } else { state.rates_radps };
        AircraftState {
            position_m: DVec3::new(y[0], y[1], y[2]),
            velocity_mps: path * DVec3::X * speed_mps + air.wind_mps,
            attitude,
            // The roll rate is the integrated one: it carries the lag from step to step.
            rates_radps: DVec3::new(y[8], mean_rates.y, mean_rates.z),
            load_factor: y[9],
            alpha_rad,
            airspeed_mps: speed_mps,
            throttle: controls.throttle,
            condition: state.condition,
        }
    }

    /// Lift over weight that the wing can give at most; none where the speed is not a number.
    fn load_available(&self, speed_mps: f64, air: &Air) -> f64 {
        let lift_n = 0.5 * air.density_kgpm3 * speed_mps * speed_mps * self.wing_m2 * self.lift_max;
        // `max` takes the other of NaN and a number.
        (lift_n / (self.mass_kg * GRAVITY_MPS2)).max(0.0)
    }

    /// Speed at which the wing just carries the weight, m/s.
    pub fn stall_mps(&self, air: &Air) -> f64 {
        let density = air.density_kgpm3.max(1e-9);
        (2.0 * self.mass_kg * GRAVITY_MPS2 / (density * self.wing_m2 * self.lift_max)).sqrt()
    }

    /// Angle of attack of a load factor, radians, never more than the wing's greatest.
    fn alpha_rad(&self, load_factor: f64, speed_mps: f64, air: &Air) -> f64 {
        let pressure_pa = 0.5 * air.density_kgpm3 * speed_mps * speed_mps;
        let force_n = pressure_pa * self.wing_m2;
        let lift = load_factor * self.mass_kg * GRAVITY_MPS2 / force_n.max(1.0);
        lift.clamp(-self.lift_max, self.lift_max) / self.lift_slope
    }

    fn rates(&self, y: &[f64; N], controls: &Controls, air: &Air) -> [f64; N] {
        let speed_mps = y[3].max(0.0);
        let path = DQuat::from_xyzw(y[4], y[5], y[6], y[7]).normalize();
        let (roll_radps, load_factor) = (y[8], y[9]);
        let along = path * DVec3::X;
        // Weight over mass in path axes.
        let weight = path.inverse() * DVec3::new(0.0, -GRAVITY_MPS2, 0.0);

        let available = self.load_available(speed_mps, air);
        let load = load_factor.clamp(-available, available);
        let pressure_pa = 0.5 * air.density_kgpm3 * speed_mps * speed_mps;
        let lift = load * self.mass_kg * GRAVITY_MPS2 / (pressure_pa * self.wing_m2).max(1.0);
        let drag_n = pressure_pa * self.wing_m2 * (self.drag.0 + self.drag.1 * lift * lift);
        // Thrust falls with the air, as a jet's does.
        let thrust_n =
            controls.throttle * self.thrust_n * (air.density_kgpm3 / SEA_LEVEL_DENSITY_KGPM3).max(0.0).powf(0.7);
        let mut speed_rate = (thrust_n - drag_n) / self.mass_kg + weight.x;
        if speed_mps <= 0.0 {
            speed_rate = speed_rate.max(0.0);
        }

        // Acceleration across the path over speed is the path's turn.
        let turning_mps = speed_mps.max(SLOWEST_PATH_MPS);
        let mut pitch = (load * GRAVITY_MPS2 - weight.z) / turning_mps;
        let mut yaw = weight.y / turning_mps + 0.12 * controls.yaw;
        if available < 1.0 && along.y > 0.9 {
            // Out of lift and pointing up, weight hardly turns the path: tip over forward.
            pitch -= 0.8 * (1.0 - available);
            yaw *= available;
        }
        let turn = DVec3::new(roll_radps, pitch, yaw);
        let spin = path * DQuat::from_xyzw(0.5 * turn.x, 0.5 * turn.y, 0.5 * turn.z, 0.0);

        let up = -(path * DVec3::Z).y; // cosine of climb times cosine of bank
        let level = along.x.hypot(along.z);
        let bank_cos = if level > 1e-6 { (up / level).clamp(-1.0, 1.0) } else { 1.0 };
        let hold = level * bank_cos / (bank_cos * bank_cos).max(HOLD_BANK_COS * HOLD_BANK_COS);
        let wanted = if controls.pitch >= 0.0 {
            hold + controls.pitch * (self.load.1 - hold)
        } else {
            hold + controls.pitch * (hold - self.load.0)
        };
        let wanted = wanted.clamp(self.load.0, self.load.1).clamp(-available, available);

        // A bank of a few degrees that nobody asked for goes away by itself.
        let side = -(path * DVec3::Y).y;
        let level_out = if controls.roll == 0.0 && side.abs() < 0.1 && up > 0.5 { -0.6 * side } else { 0.0 };
        // Little air over the ailerons, little roll.
        let bite = (speed_mps / 60.0).min(1.0);
        let roll_wanted = controls.roll * self.roll_radps * bite + level_out;

        let v = along * speed_mps + air.wind_mps;
        [
            v.x,
            v.y,
            v.z,
            speed_rate,
            spin.x,
            spin.y,
            spin.z,
            spin.w,
            (roll_wanted - roll_radps) / self.lag_s.0,
            (wanted - load_factor) / self.lag_s.1,
        ]
    }
}

/// Path axes of a state: x along the velocity through the air, the wings as the body has them.
fn path_axes(state: &AircraftState, through_air: DVec3) -> DQuat {
    let nominal = state.attitude * DQuat::from_rotation_y(-state.alpha_rad);
    let speed_mps = through_air.length();
    // Too slow to have a direction: the body's own.
    if speed_mps < 0.1 {
        return nominal.normalize();
    }
    let x = through_air / speed_mps;
    let z = x.cross(nominal * DVec3::Y);
    if z.length_squared() < 1e-6 {
        return nominal.normalize();
    }
    let z = z.normalize();
    DQuat::from_mat3(&DMat3::from_cols(x, z.cross(x), z)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT_S: f64 = 1.0 / 120.0;

    fn fly(state: AircraftState, controls: Controls, seconds: f64, dt_s: f64) -> AircraftState {
        let model = PointMass::default();
        let air = Air::standard(state.position_m.y);
        (0..(seconds / dt_s).round() as u32).fold(state, |state, _| model.step(&state, &controls, &air, dt_s))
    }

    fn level(speed_mps: f64) -> AircraftState {
        AircraftState::level(DVec3::new(0.0, 3_000.0, 0.0), 0.7, speed_mps)
    }

    #[test]
    fn hands_off_it_flies_straight_and_level() {
        let end = fly(level(180.0), Controls { throttle: 0.6, ..Controls::default() }, 60.0, DT_S);
        assert!((end.position_m.y - 3_000.0).abs() < 5.0, "{end:?}");
        assert!((end.angles().heading_rad - 0.7).abs() < 1e-6 && end.angles().roll_rad.abs() < 1e-6);
        assert!((end.load_factor - 1.0).abs() < 1e-3);
    }

    #[test]
    fn a_turn_is_the_coordinated_one() {
        // Rate of a level coordinated turn, g tan(bank) / v, and its load factor, 1 / cos(bank).
        let bank = 1.0f64;
        let mut start = level(150.0);
        start.attitude =
            crate::frame::attitude(crate::frame::Angles { heading_rad: 0.0, pitch_rad: 0.0, roll_rad: bank });
        start.velocity_mps = DVec3::new(0.0, 0.0, -150.0);
        let controls = Controls { throttle: 0.6, ..Controls::default() };
        let early = fly(start, controls, 3.0, DT_S);
        let late = fly(early, controls, 2.0, DT_S);
        let rate =
            (late.velocity_mps.x.atan2(-late.velocity_mps.z) - early.velocity_mps.x.atan2(-early.velocity_mps.z)) / 2.0;
        let speed = 0.5 * (late.airspeed_mps + early.airspeed_mps);
        let expected = GRAVITY_MPS2 * bank.tan() / speed;
        // Speed and bank drift by a percent or so within the two seconds.
        assert!((rate / expected - 1.0).abs() < 0.03, "{rate} against {expected}");
        assert!((late.load_factor * bank.cos() - 1.0).abs() < 0.03, "{}", late.load_factor);
    }

    #[test]
    fn a_climb_costs_speed_and_energy_is_only_lost_to_drag() {
        let controls = Controls { pitch: 0.4, throttle: 0.0, ..Controls::default() };
        let (start, end) = (level(250.0), fly(level(250.0), controls, 4.0, DT_S));
        let energy = |s: &AircraftState| GRAVITY_MPS2 * s.position_m.y + 0.5 * s.airspeed_mps * s.airspeed_mps;
        assert!(end.position_m.y > start.position_m.y + 100.0 && end.airspeed_mps < start.airspeed_mps - 10.0);
        assert!(energy(&end) < energy(&start));
        // Without air there is neither lift nor drag: what is left keeps its energy to the integrator's error.
        let model = PointMass::default();
        let vacuum = Air { density_kgpm3: 0.0, wind_mps: DVec3::ZERO };
        let mut free = start;
        free.load_factor = 0.0;
        for _ in 0..1_200 {
            free = model.step(&free, &Controls { throttle: 0.0, ..Controls::default() }, &vacuum, DT_S);
        }
        assert!((energy(&free) / energy(&start) - 1.0).abs() < 1e-9);
        // The vacuum parabola.
        assert!((free.position_m.y - (3_000.0 - 0.5 * GRAVITY_MPS2 * 100.0)).abs() < 1e-3, "{}", free.position_m.y);
    }

    #[test]
    fn the_step_is_of_fourth_order() {
        // Less than 65 degrees of bank in the 4 s: there the law that holds the path has a corner.
        let controls = Controls { pitch: 0.3, roll: 0.12, yaw: 0.0, throttle: 0.8 };
        let end = |dt_s: f64| fly(level(200.0), controls, 4.0, dt_s).position_m;
        let exact = end(1.0 / 1_024.0);
        let (coarse, fine) = ((end(1.0 / 16.0) - exact).length(), (end(1.0 / 32.0) - exact).length());
        let order = (coarse / fine).log2();
        assert!((order - 4.0).abs() < 0.3, "order {order}: {coarse} m, {fine} m");
    }

    #[test]
    fn slow_and_vertical_flight_recovers_by_itself() {
        let idle = Controls { throttle: 0.3, ..Controls::default() };
        let mut vertical = level(20.0);
        vertical.attitude = crate::frame::attitude(crate::frame::Angles { pitch_rad: 1.57, ..Default::default() });
        vertical.velocity_mps = DVec3::new(0.0, 20.0, 0.0);
        for start in [level(0.0), level(20.0), vertical] {
            let end = fly(start, idle, 40.0, DT_S);
            assert!(end.is_finite());
            assert!(end.airspeed_mps > 60.0, "flies again: {end:?}");
            assert!((end.attitude.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn ten_kilometres_a_second_and_wild_sticks_stay_finite() {
        for speed_mps in [0.0, 1e-12, 340.0, 10_000.0] {
            for stick in [-1.0, 1.0, f64::NAN, f64::INFINITY] {
                let controls = Controls { pitch: stick, roll: stick, yaw: stick, throttle: stick };
                let end = fly(level(speed_mps), controls, 20.0, DT_S);
                assert!(end.is_finite(), "{speed_mps} m/s, {stick}: {end:?}");
                assert!((-2.6..6.1).contains(&end.load_factor), "{end:?}");
            }
        }
    }
}
