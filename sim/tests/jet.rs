//! The jet of assets/aircraft: its tables beside NASA's own encoding of them, its handling, its edges.
//!
//! NASA's files lie in `../shared`, outside the repository; without them a test says so and counts as skipped.

use glam::{DQuat, DVec3};
use sim::atmosphere::Atmosphere;
use sim::daveml::Document;
use sim::handling::{Fixed, level, modes};
use sim::integrate::{Motion as _, rk4};
use sim::planet::Planet;
use sim::random::Stream;
use sim::rigid::Model;
use sim::rigid::builtin;
use sim::rigid::motion::{self, RigidMotion, State};
use sim::wind::Wind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

const F16: &str = "../../shared/data/physics/nesc/NESC_data/All_models/F16_package/F16_S119_source";

fn jet() -> Arc<Model> {
    Arc::new(builtin::named("jet").unwrap().unwrap())
}

/// One of NASA's files.
fn nasa(file: &str) -> Option<Document> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(F16).join(file);
    let text =
        std::fs::read_to_string(&path).inspect_err(|error| println!("skipped: {}: {error}", path.display())).ok()?;
    Some(Document::parse(&text).unwrap())
}

/// Numbers within -1..1, the same each time.
fn draws(seed: u64) -> impl FnMut() -> f64 {
    let mut stream = Stream::new(&[seed]);
    move || 2.0 * stream.uniform() - 1.0
}

/// A state that meets the air so.
fn state(speed_mps: f64, alpha_rad: f64, beta_rad: f64, rates: DVec3, down_m: f64) -> State {
    let (ca, sa, cb, sb) = (alpha_rad.cos(), alpha_rad.sin(), beta_rad.cos(), beta_rad.sin());
    let velocity = DVec3::new(ca * cb, sb, sa * cb) * speed_mps;
    motion::state(DVec3::new(0.0, 0.0, down_m), DQuat::IDENTITY, 0.0, velocity, rates)
}

#[test]
fn its_coefficients_are_those_of_nasas_own_file() {
    /// Breakpoints are printed to 1e-10 rad and the tables rise by at most 7 a radian; NASA's file turns radians into degrees
    /// with a pi of nine digits, which is 1e-9 of a coefficient of 2.3.
    const PRINTED: f64 = 5e-9;
    let Some(document) = nasa("F16_aero.dml") else { return };
    let names = ["vt", "alpha", "beta", "p", "q", "r", "el", "ail", "rdr"];
    let outputs = ["cx", "cy", "cz", "cl", "cm", "cn"];
    let program = document.program(&[], &names, &outputs).unwrap();
    let mut memory = program.memory();
    // Without the limiter, so that every elevator meets every angle of attack.
    let text = builtin::ALL.iter().find(|(name, _)| *name == "jet").unwrap().1;
    let free = text.replace("[-37.5, 0.0, 0.0, 45.0]", "[0.0, 0.0, 0.0, 0.0]");
    assert_ne!(text, free);
    let model = Arc::new(Model::from_text(Path::new("jet.toml"), &free).unwrap());
    let mut of = RigidMotion::new(model.clone(), Planet::flat(), Atmosphere::standard(), Wind::still());
    of.thrust_share = 0.0;
    let mut draw = draws(16);
    let mut furthest = [0.0f64; 6];
    let (mut least_el, mut most_el) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..20_000 {
        let (alpha_deg, beta_deg) = (17.5 + 27.5 * draw(), 30.0 * draw());
        let speed_mps = 80.0 + 55.0 * draw();
        let rates = DVec3::new(3.0 * draw(), 1.0 * draw(), 1.0 * draw());
        for (place, control) in model.controls.iter().enumerate() {
            of.controls[place] = match control.name.as_str() {
                "gear_norm" => 0.0,
                _ => 0.5 * (control.min + control.max) + 0.5 * (control.max - control.min) * draw(),
            };
        }
        let y = state(speed_mps, alpha_deg.to_radians(), beta_deg.to_radians(), rates, 0.0);
        let sample = of.sample(&y, true);
        let surface = |name: &str| sample.slots[model.signal_slot(name).unwrap()];
        let [el, ail, rdr] = ["elevator_deg", "aileron_deg", "rudder_deg"].map(surface);
        (least_el, most_el) = (least_el.min(el), most_el.max(el));
        let mut theirs = [0.0; 6];
        let [p, q, r] = rates.to_array();
        program.run(&[speed_mps / 0.3048, alpha_deg, beta_deg, p, q, r, el, ail, rdr], &mut memory, &mut theirs);
        let pressed = 0.5 * sample.air.density_kgpm3 * speed_mps * speed_mps * model.area_m2;
        let force = sample.loads.force_n / pressed;
        let arm = model.moment_point_m - model.cg_m;
        let moment = sample.loads.moment_nm / pressed - arm.cross(force);
        let (b, c) = (model.span_m, model.chord_m);
        let ours = [force.x, force.y, force.z, moment.x / b, moment.y / c, moment.z / b];
        for ((furthest, ours), theirs) in furthest.iter_mut().zip(ours).zip(theirs) {
            *furthest = furthest.max((ours - theirs).abs());
        }
    }
    println!("CX CY CZ Cl Cm Cn apart at most: {furthest:?}; elevator {least_el:.1} to {most_el:.1} degrees");
    assert!(least_el < -24.0 && most_el > 15.0, "the elevator must have been moved: {least_el} {most_el}");
    assert!(furthest.iter().all(|apart| *apart < PRINTED), "{furthest:?}");
}

#[test]
fn its_thrust_is_that_of_nasas_own_file_without_the_afterburner() {
    let Some(document) = nasa("F16_prop.dml") else { return };
    let program = document.program(&[], &["PWR", "ALT", "RMACH"], &["FEX"]).unwrap();
    let mut memory = program.memory();
    let model = jet();
    let mut of = RigidMotion::new(model.clone(), Planet::flat(), Atmosphere::standard(), Wind::still());
    let throttle = model.control("throttle_norm").unwrap();
    let mut draw = draws(12);
    for _ in 0..2_000 {
        let (altitude_m, mach) = (6_000.0 + 6_000.0 * draw(), 0.5 + 0.5 * draw());
        let part = 0.5 + 0.5 * draw();
        let sound_mps = of.atmosphere.at(altitude_m).sound_mps;
        let y = state(mach * sound_mps, 0.0, 0.0, DVec3::ZERO, -altitude_m);
        of.controls[throttle] = part;
        let whole = of.sample(&y, true).loads.force_n.x;
        of.thrust_share = 0.0;
        let bare = of.sample(&y, true).loads.force_n.x;
        of.thrust_share = 1.0;
        let mut pounds = [0.0];
        // Military power is half of their lever's way.
        program.run(&[50.0 * part, altitude_m / 0.3048, mach], &mut memory, &mut pounds);
        let theirs = pounds[0] * 4.448_221_615_260_5;
        // Drag of up to 200 kN is taken off again: a billionth of it, and as much of altitude and Mach number.
        assert!((whole - bare - theirs).abs() < 1e-3, "{mach} {altitude_m} {part}: {} {theirs}", whole - bare);
    }
}

#[test]
fn handling_is_of_level_1() {
    let model = jet();
    for (altitude_m, speed_mps) in [(0.0, 120.0), (1_524.0, 150.0), (3_000.0, 200.0), (1_000.0, 250.0)] {
        let held = level(&model, altitude_m, Fixed::Speed(speed_mps)).unwrap();
        let found = modes::measure(&held).unwrap();
        println!("{speed_mps} m/s at {altitude_m} m");
        for one in found.judged() {
            println!("  {} {:.4}", one.name, one.found);
            assert!(one.passes(), "{speed_mps} m/s: {one:?}");
        }
    }
}

fn fly(of: &mut RigidMotion, y: &State, seconds: u32) -> State {
    let (mut y, dt_s) = (*y, 1.0 / 120.0);
    for step in 0..seconds * 120 {
        y = motion::normalised(rk4(f64::from(step) * dt_s, &y, dt_s, |t, y: &State| of.rate(t, y)));
    }
    y
}

#[test]
fn trimmed_and_hands_off_it_stays_for_a_minute() {
    let mut held = level(&jet(), 3_000.0, Fixed::Speed(200.0)).unwrap();
    let straight = motion::position(&held.y) + motion::velocity(&held.y) * 60.0;
    let after = fly(&mut held.motion, &held.y, 60);
    let off_m = motion::position(&after).distance(straight);
    println!("{off_m} m off after a minute");
    assert!(off_m < 10.0, "{off_m} m");
}

/// From tumbling, backward, sideways or straight down, hands off and at idle, it comes back to an angle of attack of the
/// tables; all the while its state is one that a body can have.
#[test]
fn whatever_it_is_thrown_into_it_flies_out_of() {
    let model = jet();
    let held = level(&model, 8_000.0, Fixed::Speed(180.0)).unwrap();
    let (mut draw, mut stuck, mut latest_s) = (draws(99), 0, 0);
    for case in 0..200 {
        let mut of = held.motion.clone();
        let speed_mps = 120.0 + 100.0 * draw();
        let rates = DVec3::new(2.0 * draw(), 2.0 * draw(), 2.0 * draw());
        let mut y = state(speed_mps, std::f64::consts::PI * draw(), 1.5 * draw(), rates, -8_000.0);
        let mut out_s = None;
        for second in 0..60 {
            y = fly(&mut of, &y, 1);
            assert!(motion::is_flight(&y), "case {case} after {second} s");
            let sample = of.sample(&y, true);
            let alpha_deg = sample.slots[0].to_degrees();
            let beta_deg = sample.slots[1].to_degrees();
            if (-15.0..30.0).contains(&alpha_deg) && beta_deg.abs() < 15.0 && motion::rates(&y).length() < 1.5 {
                out_s = out_s.or(Some(second));
            }
        }
        latest_s = latest_s.max(out_s.unwrap_or(99));
        stuck += u32::from(out_s.is_none());
        if out_s.is_none() {
            println!("case {case}: {:?} {:?}", of.sample(&y, true).through_air, motion::rates(&y));
        }
    }
    println!("out after {latest_s} s at the latest");
    assert_eq!(stuck, 0, "of 200");
}
