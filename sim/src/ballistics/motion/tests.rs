//! The motion against closed forms, and at its extremes.

use super::super::drag::DragCurve;
use super::*;
use crate::integrate::{rk4, step};
use crate::planet::{Place, STANDARD_GRAVITY_MPS2};
use crate::table::Interpolation;
use std::path::Path;

fn projectile(text: &str) -> Projectile {
    Projectile::from_text(Path::new("p.toml"), text).unwrap()
}

/// The state after so many steps.
fn flown(motion: &ShellMotion, start: State, seconds: f64, steps: u32) -> State {
    let dt = seconds / f64::from(steps);
    let (mut y, mut before) = (start, None);
    for i in 0..steps {
        y = advance(Integrator::Rk4, motion, f64::from(i) * dt, &y, dt, &mut before).unwrap().0;
    }
    y
}

/// Orders of the error between neighbouring halvings of the step, where the coarser error is within 1e-10 and 1e-3.
fn orders(error: impl Fn(u32) -> f64) -> Vec<f64> {
    let errors: Vec<f64> = (3..14).map(|halving| error(1 << halving)).collect();
    errors.windows(2).filter(|e| e[0] < 1e-3 && e[1] > 1e-10).map(|e| (e[0] / e[1]).log2()).collect()
}

#[test]
fn a_fall_with_quadratic_drag_is_met_with_the_fourth_order() {
    // v = vt tanh(g t / vt), y = vt2 / g ln cosh(g t / vt), with terminal speed 60 m/s: k rho cd = g / vt2.
    let (g, terminal) = (STANDARD_GRAVITY_MPS2, 60.0);
    let drag_area = 2.0 * g / (terminal * terminal);
    let mut shell = projectile(&format!("mass_kg = 1\ndrag = 'G1'\ndrag_area_m2 = {drag_area}"));
    // A curve of Cd = 1 everywhere, and air of 1 kg/m3.
    shell.drag.as_mut().unwrap().curve = DragCurve::new(&[[0.0, 1.0]], Interpolation::Pchip).unwrap();
    let (air, wind) = (Atmosphere::constant(1.0), Wind::still());
    let motion = ShellMotion::new(&shell, Planet::flat(), &air, &wind, DVec3::X);
    // The largest error of place at every step of a minute: at one instant alone errors of both signs cancel.
    let error = |steps: u32| {
        let dt = 64.0 / f64::from(steps);
        let (mut y, mut before, mut worst): (State, _, f64) = ([0.0; 6], None, 0.0);
        for i in 0..steps {
            y = advance(Integrator::Rk4, &motion, f64::from(i) * dt, &y, dt, &mut before).unwrap().0;
            let t = f64::from(i + 1) * dt;
            worst = worst.max((y[2] - terminal * terminal / g * (g * t / terminal).cosh().ln()).abs());
        }
        worst
    };
    let orders = orders(error);
    println!("quadratic drop: orders {orders:.3?}");
    assert!(orders.len() >= 4 && orders.iter().all(|order| (order - 4.0).abs() < 0.1), "{orders:?}");
}

#[test]
fn linear_drag_is_met_with_the_fourth_order() {
    // No drag curve is linear, so this one holds the integrator and its step only.
    struct Linear;
    impl Motion<f64, 6> for Linear {
        fn rate(&self, _: f64, y: &State) -> State {
            let k = 0.05;
            [y[3], y[4], y[5], -k * y[3], -k * y[4], -k * y[5] - STANDARD_GRAVITY_MPS2]
        }
        fn drift(&self, y: &State) -> State {
            [y[3], y[4], y[5], 0.0, 0.0, 0.0]
        }
    }
    let (k, seconds) = (0.05, 40.0);
    let terminal = STANDARD_GRAVITY_MPS2 / k;
    let fade = f64::exp(-k * seconds);
    let exact = [200.0 / k * (1.0 - fade), (300.0 + terminal) / k * (1.0 - fade) - terminal * seconds];
    let error = |steps: u32| {
        let dt = seconds / f64::from(steps);
        let mut y = [0.0, 0.0, 0.0, 200.0, 0.0, 300.0];
        for i in 0..steps {
            y = step(Integrator::Rk4, &Linear, f64::from(i) * dt, &y, dt, &mut None);
        }
        (y[0] - exact[0]).hypot(y[2] - exact[1])
    };
    let orders = orders(error);
    println!("linear drag: orders {orders:.3?}");
    assert!(orders.len() >= 4 && orders.iter().all(|order| (order - 4.0).abs() < 0.1), "{orders:?}");
}

#[test]
fn a_shot_in_a_vacuum_over_a_turning_plane_is_the_exact_one() {
    // v' = g - 2 w x v with constant g and w. Along w: plain fall. Across it v turns by -2 |w| about a drift velocity u
    // with 2 w x u = g_across, so u = (g x w) / (2 w2) up to its part along w:
    // v(t) = u + R(-2 w t) (v0 - u), and its integral in closed form.
    let origin = Place { lat_rad: 0.8, ..Place::default() };
    let rotation_radps = 7.292_115e-5;
    let planet = Planet { shape: Shape::Flat { origin, radius_m: 6.4e6 }, rotation_radps, ..Planet::flat() };
    let shell = projectile("mass_kg = 1\ndrag = 'none'");
    let (air, wind) = (Atmosphere::standard(), Wind::still());
    let motion = ShellMotion::new(&shell, planet, &air, &wind, DVec3::X);
    let v0 = DVec3::new(500.0, 600.0, -700.0);
    let (g, w) = (DVec3::new(0.0, 0.0, STANDARD_GRAVITY_MPS2), planet.rotation());
    let (axis, rate) = (w.normalize(), 2.0 * w.length());
    let seconds = 142.0;
    let g_along = axis * g.dot(axis);
    let u = g.cross(w) / (2.0 * w.length_squared());
    let across = v0 - axis * v0.dot(axis) - u;
    let angle = rate * seconds;
    // The integral of R(-angle) over time: sin / rate, and (1 - cos) / rate the other way. Both parts are 7e4 m/s of
    // drift velocity that nearly cancel: 16 digits of 1e7 m are 2e-9 m.
    let exact =
        (axis * v0.dot(axis) + u) * seconds + g_along * (0.5 * seconds * seconds) + across * (angle.sin() / rate)
            - axis.cross(across) * ((1.0 - angle.cos()) / rate);
    let y = flown(&motion, state(DVec3::ZERO, v0), seconds, 71_000);
    let error_m = (parts(&y).0 - exact).length();
    let straight = v0 * seconds + g * (0.5 * seconds * seconds);
    println!("Coriolis: {error_m:e} m of {} m of deflection", (exact - straight).length());
    assert!((exact - straight).length() > 100.0 && error_m < 1e-6, "{error_m}");
}

#[test]
fn stiff_drag_neither_bounces_nor_breaks() {
    // 10 g behind a square metre at 1 km/s: |lambda| is 4e5 1/s in the first step.
    let shell = projectile("mass_kg = 0.01\ndrag = 'G1'\ndrag_area_m2 = 1");
    let (air, wind) = (Atmosphere::standard(), Wind::still());
    for integrator in Integrator::ALL {
        let motion = ShellMotion::new(&shell, Planet::flat(), &air, &wind, DVec3::X);
        let (mut y, mut before, mut pieces) = ([0.0, 0.0, 0.0, 1_000.0, 0.0, 0.0], None, 0);
        for i in 0..1_000 {
            let speed = y[3];
            let (next, taken) = advance(integrator, &motion, f64::from(i) * 0.01, &y, 0.01, &mut before).unwrap();
            pieces += taken;
            y = next;
            assert!(y[3] >= 0.0 && y[3] <= speed, "{integrator:?}: {} after {speed} m/s", y[3]);
        }
        let cd = shell.drag.as_ref().unwrap().curve.cd(0.0);
        let terminal = (STANDARD_GRAVITY_MPS2 / (50.0 * 1.225 * cd)).sqrt();
        assert!((y[5] / terminal - 1.0).abs() < 1e-3, "{integrator:?}: {} of {terminal} m/s", y[5]);
        assert!(pieces < 20_000, "{integrator:?}: {pieces}");
    }
    let worse = projectile("mass_kg = 1e-9\ndrag = 'G1'\ndrag_area_m2 = 1e-2");
    let motion = ShellMotion::new(&worse, Planet::flat(), &air, &wind, DVec3::X);
    let error = advance(Integrator::Rk4, &motion, 0.0, &[0.0, 0.0, 0.0, 1e3, 0.0, 0.0], 0.01, &mut None).unwrap_err();
    assert!(matches!(error, StepError::Stiff { .. }) && error.to_string().contains("too stiff"), "{error}");
}

#[test]
fn rest_costs_what_flight_costs_and_wind_carries_without_drag() {
    let shell = projectile("mass_kg = 0.01\ndrag = 'G1'\ndrag_area_m2 = 0.01");
    let (air, wind) = (Atmosphere::standard(), Wind::new(vec![(0.0, DVec3::new(30.0, -5.0, 2.0))]).unwrap());
    let still = Planet { gravity: crate::planet::Gravity::Constant(0.0), ..Planet::flat() };
    let motion = ShellMotion::new(&shell, still, &air, &wind, DVec3::X);
    let carried = flown(&motion, [0.0, 0.0, -100.0, 30.0, -5.0, 2.0], 10.0, 100);
    assert_eq!(&carried[3..], &[30.0, -5.0, 2.0], "no speed through the air, no drag");

    // A sideways velocity that decays in a steady fall: 1e6 steps, and it ends as 0, not as a denormal.
    let calm = Wind::still();
    let motion = ShellMotion::new(&shell, Planet::flat(), &air, &calm, DVec3::X);
    let mut y = [0.0, 0.0, 0.0, 10.0, 0.0, 4.0];
    let mut before = None;
    for i in 0..1_000_000 {
        // Held at one height, so that the air stays dense.
        y[2] = 0.0;
        y = advance(Integrator::Rk4, &motion, f64::from(i) * 0.01, &y, 0.01, &mut before).unwrap().0;
    }
    assert_eq!(y[3], 0.0);
    let nothing = flown(&ShellMotion::new(&shell, still, &air, &calm, DVec3::X), [0.0; 6], 1e4, 1_000_000);
    assert_eq!(nothing, [0.0; 6]);
}

#[test]
fn thrust_follows_its_rows_to_the_bit_of_an_exact_impulse() {
    // In a vacuum without gravity the speed gained is the impulse over the mass: 100 N from 0 to 1 s, then down to 0 at 3 s.
    let shell = projectile("mass_kg = 2\ndrag = 'none'\nburn = [[0, 100], [1, 100], [3, 0]]");
    let still = Planet { gravity: crate::planet::Gravity::Constant(0.0), ..Planet::flat() };
    let (air, wind) = (Atmosphere::None, Wind::still());
    let mut motion = ShellMotion::new(&shell, still, &air, &wind, DVec3::Y);
    let mut y = [0.0; 6];
    for (from, to) in [(0.0, 1.0), (1.0, 2.0), (2.0, 3.0), (3.0, 4.0)] {
        motion.burn_as_at(&shell.burn, 0.5 * (from + to));
        y = advance(Integrator::Rk4, &motion, from, &y, to - from, &mut None).unwrap().0;
    }
    // A cubic at most in time: Simpson's rule is exact, a few roundings of 100 m/s.
    assert!((y[4] - 100.0).abs() < 1e-12 && y[3] == 0.0 && y[5] == 0.0, "{y:?}: along the bore");
}

#[test]
fn a_piece_of_a_step_is_rk4_and_nothing_else() {
    let shell = projectile("mass_kg = 43.09\ndiameter_m = 0.155\ndrag = 'G7'\nform_factor = 0.9");
    let (air, wind) = (Atmosphere::standard(), Wind::still());
    let motion = ShellMotion::new(&shell, Planet::flat(), &air, &wind, DVec3::X);
    let y = [0.0, 0.0, -100.0, 500.0, 3.0, -400.0];
    let plain = rk4(0.0, &y, 0.01, |t, y| motion.rate(t, y));
    assert_eq!(advance(Integrator::Rk4, &motion, 0.0, &y, 0.01, &mut None), Ok((plain, 1)));
}
