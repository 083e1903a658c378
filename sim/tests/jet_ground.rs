//! The jet on the ground: it stands on its wheels, takes off, and lies on its belly where they are up.

use glam::DVec3;
use sim::aircraft::{AircraftState, Condition};
use sim::handling::runway::standing_height_m;
use sim::rigid::builtin;
use sim::scene::{BodyStart, Catalogue, Command, SceneGround, Surroundings};
use sim::{Controls, Levers, Scene, UtcTime};
use std::sync::Arc;
use terrain::{Grid, Ground, synthetic};

/// Stick let go, at idle.
const IDLE: Controls = Controls { pitch: 0.0, roll: 0.0, yaw: 0.0, throttle: 0.0 };

fn ground() -> SceneGround {
    Ground::new(Arc::new(synthetic::flat(Grid::centred(200.0, 60, 60).unwrap(), 0.0))).whole().into()
}

/// The jet as the own aircraft, northward, at a height of its centre of gravity and a speed, with its gear where it is told.
fn jet(height_m: f64, velocity_mps: DVec3, levers: Levers, controls: Controls) -> Scene {
    let mut catalogue = Catalogue::new();
    catalogue.add_model("jet", builtin::named("jet").unwrap().unwrap()).unwrap();
    let position_m = DVec3::new(0.0, height_m, 0.0);
    let far = AircraftState::level(position_m, 0.0, 0.0);
    let date = UtcTime { unix_ns: 0 };
    let mut scene = Scene::furnished(far, date, 120, Surroundings::default(), Arc::new(catalogue)).unwrap();
    let attitude = sim::frame::attitude(sim::frame::Angles {
        pitch_rad: if height_m > 2.5 { 0.11 } else { 0.0 },
        ..Default::default()
    });
    let start =
        BodyStart { model: "jet".to_owned(), position_m, velocity_mps, attitude, rates_radps: DVec3::ZERO, fuel: None };
    let id = scene.add_body(&start).unwrap();
    scene.set_levers(levers);
    scene.set_controls(controls);
    scene.order(Command::FlyBody { id }).unwrap();
    scene
}

fn fly(scene: &mut Scene, seconds: u32, mut pilot: impl FnMut(&AircraftState) -> Controls) {
    let ground = ground();
    for _ in 0..seconds * 10 {
        let controls = pilot(&scene.aircraft());
        scene.set_controls(controls);
        for _ in 0..12 {
            scene.step(&ground);
        }
    }
}

fn standing_m() -> f64 {
    standing_height_m(&builtin::named("jet").unwrap().unwrap())
}

#[test]
fn it_stands_on_its_wheels_and_takes_off() {
    let mut scene = jet(standing_m(), DVec3::ZERO, Levers { parking_brake: 1.0, ..Levers::default() }, IDLE);
    fly(&mut scene, 10, |_| IDLE);
    let parked = scene.aircraft();
    assert_eq!(parked.condition, Condition::OnGround);
    assert!(parked.velocity_mps.length() < 1e-3 && parked.angles().pitch_rad.abs() < 0.02, "{parked:?}");
    scene.set_levers(Levers::default());
    let (mut off_m, mut off_mps) = (None, 0.0);
    fly(&mut scene, 45, |now| {
        if now.condition == Condition::Flying && off_m.is_none() {
            (off_m, off_mps) = (Some(now.position_m.z.abs()), now.airspeed_mps);
        }
        // Ten degrees nose up from 70 m/s on, as it is flown.
        let pitch_off_rad = 0.17 - now.angles().pitch_rad;
        let pitch = if now.airspeed_mps > 70.0 {
            (8.0 * pitch_off_rad - 1.0 * now.rates_radps.y).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        Controls { throttle: 1.0, pitch, ..IDLE }
    });
    println!("off after {off_m:?} m at {off_mps:.1} m/s");
    // 20,500 lb with 12,680 lb of thrust: 0.6 of its weight less a tenth on the way; 85 m/s take 85^2 / 2 / 5 = 720 m.
    assert!(off_m.is_some_and(|m| (500.0..1_200.0).contains(&m)), "{off_m:?}");
    assert!(scene.aircraft().position_m.y > 30.0 && scene.aircraft().condition == Condition::Flying);
}

#[test]
fn its_gear_does_not_fold_under_it_and_comes_up_once_it_flies() {
    let up = Levers { gear: 0.0, parking_brake: 1.0, ..Levers::default() };
    let mut scene = jet(standing_m(), DVec3::ZERO, Levers { gear: 1.0, ..up }, IDLE);
    fly(&mut scene, 3, |_| IDLE);
    let before = scene.aircraft();
    scene.set_levers(up);
    fly(&mut scene, 10, |_| IDLE);
    let now = scene.aircraft();
    assert_eq!((now.condition, scene.snapshot().bodies[0].gear_down), (Condition::OnGround, true));
    // It settles by less than its struts travel.
    assert!((now.position_m - before.position_m).length() < 0.01, "{} {}", now.position_m, before.position_m);
    let mut flying = jet(500.0, DVec3::NEG_Z * 150.0, Levers { gear: 0.0, ..Levers::default() }, IDLE);
    assert!(!flying.snapshot().bodies[0].gear_down, "it begins as its lever stands");
    flying.set_levers(Levers::default());
    fly(&mut flying, 6, |_| Controls { throttle: 0.5, ..IDLE });
    assert!(flying.snapshot().bodies[0].gear_down, "five seconds down");
}

#[test]
fn its_gear_costs_thrust() {
    let throttle = |gear: f64| {
        let mut scene = jet(1_000.0, DVec3::NEG_Z * 120.0, Levers { gear, ..Levers::default() }, IDLE);
        scene.trim_flown().unwrap();
        scene.controls().throttle
    };
    let (down, up) = (throttle(1.0), throttle(0.0));
    // 0.022 of 28 m2 and 8 kPa are 4.9 kN; the throttle's whole way is some 50 kN.
    assert!((0.08..0.12).contains(&(down - up)), "{down} {up}");
}

#[test]
fn with_its_wheels_up_nothing_holds_it_off_its_belly() {
    let up = Levers { gear: 0.0, ..Levers::default() };
    let mut scene = jet(2.6, DVec3::new(0.0, -0.2, -110.0), up, IDLE);
    fly(&mut scene, 40, |now| Controls {
        pitch: (2.0 * (0.12 - now.angles().pitch_rad) - 0.6 * now.rates_radps.y).clamp(-1.0, 1.0),
        ..IDLE
    });
    let now = scene.aircraft();
    println!("{:?} {:.2} m over the ground, {:.1} m along", now.condition, now.position_m.y, now.position_m.z.abs());
    // Whether it slid or broke: it lies lower than on its wheels by what they are longer.
    assert!(now.velocity_mps.length() < 0.01 && now.position_m.y < standing_m() - 0.4, "{now:?}");
}
