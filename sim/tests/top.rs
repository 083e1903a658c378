//! A torque-free top in the rigid-body core itself: rates against the exact solution, energy and momentum against
//! themselves, and the order of every integrator.
//!
//! Inertia (10, 20, 26) kg m2, rates (1, 15, 1) rad/s at the start: a body that swings wide of its middle axis, the
//! hardest of turns. No air, no gravity that turns, no rotation of the frame. The reference is every 0.25 s of a table
//! of our own whose rates were checked with Jacobi's elliptic functions to 3e-11.

use glam::{DQuat, DVec3};
use sim::case::Case;
use sim::integrate::Integrator;
use sim::rigid::motion::{attitude, rates};
use sim::rigid::{Inputs, Model, Simulation};
use std::path::Path;

const INERTIA_KGM2: DVec3 = DVec3::new(10.0, 20.0, 26.0);
const TABLE: &str = include_str!("data/top_10_20_26.csv");

/// The top at its start.
fn top(integrator: Integrator, step_s: f64) -> Simulation {
    let model = "[body]\nmass_kg = 1\ninertia_kgm2 = [[10, 0, 0], [0, 20, 0], [0, 0, 26]]";
    let start = DVec3::new(1.0, 15.0, 1.0) * (180.0 / std::f64::consts::PI);
    let case = format!(
        "[frame]\nkind = 'flat'\n[atmosphere]\nmodel = 'none'\n[initial]\nrates_degps = [{}, {}, {}]\n\
         [run]\ndt_s = {step_s:e}\nintegrator = '{}'",
        start.x,
        start.y,
        start.z,
        integrator.name()
    );
    let model = Model::from_text(Path::new("top.toml"), model).unwrap();
    let case = Case::from_text(Path::new("top_case.toml"), &case).unwrap();
    Simulation::new(model, &case, Inputs::default(), None).unwrap()
}

/// Time, rates and attitude of each row.
fn table() -> Vec<(f64, DVec3, DQuat)> {
    let rows = TABLE.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    rows.map(|line| {
        let row: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        let [t_s, wx, wy, wz, qw, qx, qy, qz] = row[..] else { panic!("expected eight numbers in {line}") };
        (t_s, DVec3::new(wx, wy, wz), DQuat::from_xyzw(qx, qy, qz, qw))
    })
    .collect()
}

/// Largest difference of a rate from the table, rad/s, and of the attitude, radians, over the first seconds.
fn errors(integrator: Integrator, steps_hz: u32, seconds: f64) -> (f64, f64) {
    let mut flight = top(integrator, 1.0 / f64::from(steps_hz));
    let (mut rate_error, mut turn_error, mut taken) = (0f64, 0f64, 0);
    for (t_s, expected, turn) in table().into_iter().filter(|(t_s, ..)| *t_s <= seconds) {
        let steps = (t_s * f64::from(steps_hz)).round() as u32;
        for _ in taken..steps {
            flight.step();
        }
        taken = steps;
        rate_error = rate_error.max((rates(flight.state()) - expected).abs().max_element());
        // The sign of a quaternion means nothing; for small angles the vector part is half the angle.
        let apart = turn.inverse() * attitude(flight.state());
        turn_error = turn_error.max(2.0 * apart.xyz().length().min(1.0).asin());
    }
    (rate_error, turn_error)
}

/// Energy, J, and the momentum's length, kg m2/s.
fn invariants(flight: &Simulation) -> (f64, f64) {
    let w = rates(flight.state());
    (0.5 * w.dot(INERTIA_KGM2 * w), (INERTIA_KGM2 * w).length())
}

#[test]
fn the_top_follows_the_exact_solution() {
    // The brief asks for these figures; the table itself is good to 3e-11.
    for (steps_hz, rate_limit) in [(1_000, 1e-7), (120, 1e-4)] {
        let (rate_error, turn_error) = errors(Integrator::Rk4, steps_hz, 10.0);
        println!(
            "top, rk4 at {steps_hz} Hz over 10 s: rates within {rate_error:.2e} rad/s, attitude {turn_error:.2e} rad"
        );
        assert!(rate_error < rate_limit, "{steps_hz} Hz: {rate_error} rad/s");
    }
}

#[test]
fn energy_and_momentum_stay_for_an_hour() {
    for (steps_hz, limit) in [(1_000, 2e-8), (120, 1e-4)] {
        let mut flight = top(Integrator::Rk4, 1.0 / f64::from(steps_hz));
        let (energy, momentum) = invariants(&flight);
        for _ in 0..3_600 * steps_hz {
            flight.step();
        }
        let (energy_after, momentum_after) = invariants(&flight);
        let energy_drift = (energy_after / energy - 1.0).abs();
        let momentum_drift = (momentum_after / momentum - 1.0).abs();
        let length = attitude_length(&flight);
        println!(
            "top, rk4 at {steps_hz} Hz, drift in an hour: energy {energy_drift:.2e}, momentum {momentum_drift:.2e}"
        );
        assert!(energy_drift < limit && momentum_drift < limit, "{steps_hz} Hz: {energy_drift} {momentum_drift}");
        assert!((length - 1.0).abs() < 1e-12, "{length}");
    }
}

fn attitude_length(flight: &Simulation) -> f64 {
    let y = flight.state();
    (y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6]).sqrt()
}

#[test]
fn every_integrator_shows_its_order_while_errors_are_neither_large_nor_rounding() {
    // One second, two swings. Over longer flights the leading term of the error of the second-order rules passes near
    // zero, and the next term shows until steps are shorter than anyone would take.
    const SECONDS: f64 = 1.0;
    for (integrator, order) in
        [(Integrator::Rk4, 4.0), (Integrator::Rk2, 2.0), (Integrator::Ab2, 2.0), (Integrator::SemiEuler, 1.0)]
    {
        let mut told = Vec::new();
        let mut coarser: Option<f64> = None;
        for steps_hz in (0..14).map(|doubling| 100 << doubling) {
            let (error, _) = errors(integrator, steps_hz, SECONDS);
            // The table is good to 3e-11: below 1e-9 it would be seen in the ratio.
            if let Some(before) = coarser.filter(|before| *before < 1e-3 && error > 1e-9) {
                told.push((steps_hz, (before / error).log2()));
            }
            coarser = Some(error);
            if told.len() == 3 || error < 1e-9 {
                break;
            }
        }
        println!("top, {}: order by steps a second {told:.4?}", integrator.name());
        assert!(!told.is_empty(), "{}: no error below 1e-3", integrator.name());
        for (steps_hz, observed) in told {
            assert!((observed - order).abs() < 0.1, "{} at {steps_hz} Hz: order {observed}", integrator.name());
        }
    }
}
