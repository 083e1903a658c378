//! A light aircraft with linear derivatives, written out by hand and for any float: the subject of the integrator trade.
//!
//! Like a Cessna 182: constant coefficients, constant density, constant gravity, a plane that does not turn, and pulses
//! of elevator, aileron and rudder on whole seconds. `assets/flight` holds the same body and flight as
//! files for [`sim::rigid`]; both must fly alike to rounding, so each checks the other.
//!
//! State: position north, east, down (m); quaternion w, x, y, z from body to north, east, down; velocity north, east,
//! down (m/s); rates about the body's axes (rad/s). SI and radians. Invariant others rely on: the quaternion is
//! normalised after each step, and every step of one second has the same controls, so no pulse falls inside a step.
//!
//! Source: the derivatives are of the size that J. Roskam, Airplane Flight Dynamics, 1995, appendix B, gives for that
//! class; the model and its reference solution (`sim/tests/data/lin182_scipy.csv`, SciPy's DOP853 at 1e-11) are our own.

use num_traits::Float;
use sim::integrate::{Before, Integrator, Motion, step};

/// Numbers of a state.
pub const N: usize = 13;
/// Length of the flight, seconds.
pub const SECONDS: u32 = 60;
/// Speed at the start, m/s: 220.1 ft/s.
pub const START_MPS: f64 = 67.086_48;
/// Height at the start, metres: 5,000 ft.
pub const START_M: f64 = 1_524.0;

/// Kilograms in a slug.
const SLUG: f64 = 14.593_902_937_206_364;
const FOOT: f64 = 0.3048;
const GRAVITY_MPS2: f64 = 9.806_65;
/// 2,650 lb.
const MASS_KG: f64 = 2_650.0 * 0.453_592_37;
const INERTIA_KGM2: [f64; 3] = [948.0 * SLUG * FOOT * FOOT, 1_346.0 * SLUG * FOOT * FOOT, 1_967.0 * SLUG * FOOT * FOOT];
const AREA_M2: f64 = 174.0 * FOOT * FOOT;
const SPAN_M: f64 = 36.0 * FOOT;
const CHORD_M: f64 = 4.9 * FOOT;
const DENSITY_KGPM3: f64 = 0.002_048 * SLUG / (FOOT * FOOT * FOOT);
/// 250 lbf.
const THRUST_N: f64 = 250.0 * 0.453_592_37 * GRAVITY_MPS2;
const ELEVATOR_RAD: f64 = 0.04 / 1.122;

/// Elevator, aileron and rudder, radians, during a second of the flight.
pub fn controls(second: u32) -> [f64; 3] {
    let elevator = match second {
        1 => 0.02,
        2 => -0.02,
        _ => 0.0,
    };
    let aileron = match second {
        5 => 0.02,
        6 => -0.02,
        _ => 0.0,
    };
    [ELEVATOR_RAD + elevator, aileron, if second == 10 { 0.02 } else { 0.0 }]
}

/// The aircraft with its controls as they stand.
#[derive(Debug, Clone, Copy)]
pub struct Lin182<T> {
    controls: [T; 3],
}

/// A constant in the precision that is flown in.
fn of<T: Float>(value: f64) -> T {
    T::from(value).unwrap_or_else(T::nan)
}

impl<T: Float> Lin182<T> {
    /// With the controls of a second of the flight.
    pub fn in_second(second: u32) -> Self {
        Self { controls: controls(second).map(of) }
    }

    /// Specific force and angular acceleration, body axes, of the velocity in body axes and the rates.
    fn air(&self, [u, v, w]: [T; 3], [p, q, r]: [T; 3]) -> ([T; 3], [T; 3]) {
        let [de, da, dr] = self.controls;
        let c = of::<T>;
        let plan = (u * u + w * w).sqrt();
        let speed = (u * u + v * v + w * w).sqrt();
        let (alpha, beta) = (w.atan2(u), v.atan2(plan));
        let pressed = c(0.5 * DENSITY_KGPM3 * AREA_M2) * speed * speed;
        let half = c(0.5) / speed;
        let (ph, qh, rh) = (p * c(SPAN_M) * half, q * c(CHORD_M) * half, r * c(SPAN_M) * half);
        let lift = c(0.307) + c(4.41) * alpha + c(3.9) * qh + c(0.43) * de;
        let drag = c(0.027) + c(0.121) * alpha;
        let side = c(-0.393) * beta + c(-0.075) * ph + c(0.214) * rh + c(0.187) * dr;
        let roll = c(-0.0923) * beta + c(-0.484) * ph + c(0.0798) * rh + c(0.229) * da + c(0.0147) * dr;
        let pitch = c(0.04) + c(-0.613) * alpha + c(-12.4) * qh + c(-1.122) * de;
        let yaw = c(0.0587) * beta + c(-0.0278) * ph + c(-0.0937) * rh + c(-0.0216) * da + c(-0.0645) * dr;
        // Cosines and sines of the two angles without a look at the angles.
        let (ca, sa, cb, sb) = (u / plan, w / plan, plan / speed, v / speed);
        let (ahead, across) = (-drag * cb - side * sb, side * cb - drag * sb);
        let force =
            [pressed * (ahead * ca + lift * sa) + c(THRUST_N), pressed * across, pressed * (ahead * sa - lift * ca)];
        let moment = [pressed * c(SPAN_M) * roll, pressed * c(CHORD_M) * pitch, pressed * c(SPAN_M) * yaw];
        let [ix, iy, iz] = INERTIA_KGM2.map(c);
        (
            force.map(|newton| newton / c(MASS_KG)),
            [
                (moment[0] - (iz - iy) * q * r) / ix,
                (moment[1] - (ix - iz) * p * r) / iy,
                (moment[2] - (iy - ix) * p * q) / iz,
            ],
        )
    }

    /// Rate of the quaternion.
    fn turning(y: &[T; N]) -> [T; 4] {
        let ([w, x, yy, z], [p, q, r], half) = ([y[3], y[4], y[5], y[6]], [y[10], y[11], y[12]], of::<T>(0.5));
        [
            -half * (x * p + yy * q + z * r),
            half * (w * p + yy * r - z * q),
            half * (w * q - x * r + z * p),
            half * (w * r + x * q - yy * p),
        ]
    }
}

/// Columns: the body's axes in north, east, down, of a quaternion of any length.
fn body_axes<T: Float>(q: [T; 4]) -> [[T; 3]; 3] {
    let squared = q.iter().fold(T::zero(), |sum, &part| sum + part * part);
    let two = of::<T>(2.0) / squared;
    let [w, x, y, z] = q;
    let one = T::one();
    [
        [one - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)],
        [two * (x * y - w * z), one - two * (x * x + z * z), two * (y * z + w * x)],
        [two * (x * z + w * y), two * (y * z - w * x), one - two * (x * x + y * y)],
    ]
}

impl<T: Float> Motion<T, N> for Lin182<T> {
    #[inline]
    fn rate(&self, _: T, y: &[T; N]) -> [T; N] {
        let axes = body_axes([y[3], y[4], y[5], y[6]]);
        let velocity = [y[7], y[8], y[9]];
        let in_body = axes.map(|axis| axis[0] * velocity[0] + axis[1] * velocity[1] + axis[2] * velocity[2]);
        let (pull, turn) = self.air(in_body, [y[10], y[11], y[12]]);
        let along = |i: usize| axes[0][i] * pull[0] + axes[1][i] * pull[1] + axes[2][i] * pull[2];
        let [qw, qx, qy, qz] = Self::turning(y);
        let down = along(2) + of(GRAVITY_MPS2);
        [y[7], y[8], y[9], qw, qx, qy, qz, along(0), along(1), down, turn[0], turn[1], turn[2]]
    }

    #[inline]
    fn drift(&self, y: &[T; N]) -> [T; N] {
        let [qw, qx, qy, qz] = Self::turning(y);
        let o = T::zero();
        [y[7], y[8], y[9], qw, qx, qy, qz, o, o, o, o, o, o]
    }
}

/// The state at the start.
pub fn start<T: Float>() -> [T; N] {
    let mut y = [0.0; N];
    (y[2], y[3], y[7]) = (-START_M, 1.0, START_MPS);
    y.map(of)
}

/// The state after so many whole seconds at so many steps a second.
pub fn fly<T: Float>(integrator: Integrator, steps_hz: u32, seconds: u32) -> [T; N] {
    let dt_s = T::one() / of(f64::from(steps_hz));
    let mut y = start::<T>();
    let mut before: Before<T, N> = None;
    for second in 0..seconds {
        let motion = Lin182::in_second(second);
        if second > 0 && controls(second) != controls(second - 1) {
            before = None;
        }
        // Nothing depends on the time within a second.
        for _ in 0..steps_hz {
            y = step(integrator, &motion, T::zero(), &y, dt_s, &mut before);
            let squared = y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6];
            let scale = T::one() / squared.sqrt();
            y[3..7].iter_mut().for_each(|part| *part = *part * scale);
        }
    }
    y
}

/// Distance between the positions of two states, metres.
pub fn apart_m<T: Float>(y: &[T; N], reference: &[f64; N]) -> f64 {
    let gap = |i: usize| y[i].to_f64().unwrap_or(f64::NAN) - reference[i];
    (gap(0) * gap(0) + gap(1) * gap(1) + gap(2) * gap(2)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim::case::Case;
    use sim::rigid::{Inputs, Model, Simulation};
    use std::path::Path;

    /// North, east, down at the end of the same flight by the general core, from its files.
    fn simulated() -> [f64; 3] {
        let model = include_str!("../../../assets/flight/models/lin182.toml");
        let case = include_str!("../../../assets/flight/cases/lin182.toml");
        let inputs = include_str!("../../../assets/flight/inputs/lin182.csv");
        let model = Model::from_text(Path::new("lin182.toml"), model).unwrap();
        let inputs = Inputs::from_text(Path::new("lin182.csv"), inputs, &model.controls).unwrap();
        let case = Case::from_text(Path::new("case.toml"), case).unwrap();
        assert_eq!((case.run.dt_s, case.run.seconds), (Some(1.0 / 60.0), Some(f64::from(SECONDS))));
        let mut flight = Simulation::new(model, &case, inputs, None).unwrap();
        flight.run(f64::from(SECONDS), 1e6, &[], |_, _| ());
        let y = flight.state();
        [y[0], y[1], y[2]]
    }

    #[test]
    fn the_general_core_flies_it_alike_to_rounding() {
        let written: [f64; N] = fly(Integrator::Rk4, 60, SECONDS);
        let [north, east, down] = simulated();
        let gap_m = (written[0] - north).hypot(written[1] - east).hypot(written[2] - down);
        println!("hand-written and general core after 60 s at 60 Hz: {gap_m:.2e} m apart");
        // Four kilometres have a rounding of 5e-13 m; 3,600 steps may add up to 2e-9 m but scatter.
        assert!(gap_m < 1e-9, "{gap_m}");
    }

    #[test]
    fn both_agree_with_an_independent_solution() {
        const ROWS: &str = include_str!("../../../sim/tests/data/lin182_scipy.csv");
        let mut worst_m = 0f64;
        for line in ROWS.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
            let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
            let mut reference = [0.0; N];
            (reference[0], reference[1], reference[2]) = (row[1] * FOOT, row[2] * FOOT, -row[3] * FOOT);
            worst_m = worst_m.max(apart_m(&fly::<f64>(Integrator::Rk4, 60, row[0] as u32), &reference));
        }
        println!("rk4 at 60 Hz against DOP853 over 60 s: {worst_m:.2e} m at worst");
        assert!(worst_m < 5e-5, "{worst_m}");
    }

    #[test]
    fn every_integrator_has_its_order_in_pulsed_flight() {
        // Rounding of 1e-9 m is far below all of these errors.
        let reference = fly::<f64>(Integrator::Rk4, 960, SECONDS);
        for (integrator, order, coarse) in [
            (Integrator::Rk4, 4.0, 60),
            (Integrator::Rk2, 2.0, 120),
            (Integrator::Ab2, 2.0, 120),
            (Integrator::SemiEuler, 1.0, 120),
        ] {
            let error = |steps_hz| apart_m(&fly::<f64>(integrator, steps_hz, SECONDS), &reference);
            let observed = (error(coarse) / error(2 * coarse)).log2();
            println!("{}: order {observed:.3} from {coarse} Hz", integrator.name());
            assert!((observed - order).abs() < 0.1, "{}: {observed}", integrator.name());
        }
    }
}
