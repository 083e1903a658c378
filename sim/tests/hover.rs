//! The hover model of assets/aircraft: it stands in the air by itself, goes where it is asked, and lands.

use glam::DVec3;
use sim::aircraft::{AircraftState, Condition};
use sim::rigid::builtin;
use sim::scene::{BodyStart, Catalogue, Command, SceneGround, Surroundings};
use sim::{Controls, Scene, UtcTime};
use std::sync::Arc;
use terrain::{Grid, Ground, synthetic};

const GROUND_M: f64 = 1_700.0;

fn ground() -> SceneGround {
    Ground::new(Arc::new(synthetic::flat(Grid::centred(200.0, 40, 40).unwrap(), GROUND_M as f32))).whole().into()
}

/// The model as the own aircraft so high over the ground, trimmed where it is.
fn over(height_m: f64, turbulence_mps: f64) -> Scene {
    let mut catalogue = Catalogue::new();
    catalogue.add_model("hover", builtin::named("hover").unwrap().unwrap()).unwrap();
    let mut around = Surroundings::default();
    (around.turbulence_mps, around.seed) = (turbulence_mps, 5);
    let position_m = DVec3::new(0.0, GROUND_M + height_m, 0.0);
    let far = AircraftState::level(position_m, 0.0, 0.0);
    let mut scene = Scene::furnished(far, UtcTime { unix_ns: 0 }, 120, around, Arc::new(catalogue)).unwrap();
    let start = BodyStart {
        model: "hover".to_owned(),
        position_m,
        velocity_mps: DVec3::ZERO,
        attitude: sim::frame::attitude(sim::frame::Angles::default()),
        rates_radps: DVec3::ZERO,
        fuel: None,
    };
    let id = scene.add_body(&start).unwrap();
    scene.order(Command::FlyBody { id }).unwrap();
    scene.trim_flown().unwrap();
    scene
}

/// Flies on; what the pilot does is asked ten times a second.
fn fly(scene: &mut Scene, seconds: u32, mut pilot: impl FnMut(&AircraftState, Controls) -> Controls) {
    let ground = ground();
    for _ in 0..seconds * 10 {
        let (now, held) = (scene.aircraft(), scene.controls());
        scene.set_controls(pilot(&now, held));
        for _ in 0..12 {
            scene.step(&ground);
        }
        assert_ne!(scene.aircraft().condition, Condition::Crashed, "{:?}", scene.snapshot().events);
    }
}

fn hands_off(_: &AircraftState, held: Controls) -> Controls {
    held
}

/// Collective that goes for a rate of climb: a thirtieth a second for each m/s that is missing, less where that is coming.
fn climbing(rate_mps: f64) -> impl FnMut(&AircraftState, Controls) -> Controls {
    let mut before_mps = None;
    move |now, held| {
        let climbs_mps = now.velocity_mps.y;
        let faster_mps = climbs_mps - before_mps.replace(climbs_mps).unwrap_or(climbs_mps);
        Controls { throttle: held.throttle + 0.003 * (rate_mps - climbs_mps) - 0.03 * faster_mps, ..held }
    }
}

#[test]
fn hands_off_it_stands_in_the_air_for_a_minute() {
    let mut scene = over(100.0, 0.0);
    let start = scene.aircraft();
    println!("collective {:.3}", scene.controls().throttle);
    fly(&mut scene, 60, hands_off);
    let off = scene.aircraft().position_m - start.position_m;
    println!("{off} m off after a minute");
    // In plan nothing moves it. It burns 1.4 kg, 14 N, which its damping of 400 N s/m turns into 0.035 m/s in the end.
    assert!(off.x.hypot(off.z) < 0.1 && off.y.abs() < 2.0, "{off}");
}

#[test]
fn in_turbulence_it_stays_about_where_it_is() {
    let mut scene = over(150.0, 1.5);
    let start = scene.aircraft();
    let mut most_rad = 0.0f64;
    fly(&mut scene, 60, |now, held| {
        let angles = now.angles();
        most_rad = most_rad.max(angles.pitch_rad.abs()).max(angles.roll_rad.abs());
        held
    });
    let off = scene.aircraft().position_m - start.position_m;
    println!("{off} m off after a minute, {most_rad:.3} rad at most");
    // Gusts of 1.5 m/s carry it along by at most themselves: 90 m in a minute; its attitude is held.
    assert!(off.length() < 90.0 && most_rad < 0.2, "{off} {most_rad}");
}

#[test]
fn it_climbs_sinks_and_turns_where_it_stands() {
    let mut scene = over(100.0, 0.0);
    for rate_mps in [4.0, -4.0] {
        fly(&mut scene, 20, climbing(rate_mps));
        let found = scene.aircraft().velocity_mps;
        assert!((found.y - rate_mps).abs() < 0.3 && found.x.hypot(found.z) < 0.5, "{found}");
    }
    let before = scene.aircraft().position_m;
    let mut level = climbing(0.0);
    fly(&mut scene, 10, |now, held| Controls { yaw: 0.5, ..level(now, held) });
    let now = scene.aircraft();
    // Half pedal asks for half a radian a second.
    assert!((now.rates_radps.z - 0.5).abs() < 0.01, "{}", now.rates_radps);
    assert!(now.position_m.distance(before) < 15.0);
    fly(&mut scene, 5, |now, held| Controls { yaw: 0.0, ..level(now, held) });
    assert!(scene.aircraft().rates_radps.length() < 0.01);
}

#[test]
fn it_flies_forward_at_fifty_metres_a_second_and_stops_again() {
    let mut scene = over(100.0, 0.0);
    let mut level = climbing(0.0);
    fly(&mut scene, 50, |now, held| Controls { pitch: -0.38, ..level(now, held) });
    let fast = scene.aircraft();
    println!("{:.1} m/s, {:.0} m lower or higher", fast.airspeed_mps, fast.position_m.y - GROUND_M - 100.0);
    assert!(fast.airspeed_mps > 50.0 && (fast.position_m.y - GROUND_M - 100.0).abs() < 30.0, "{}", fast.airspeed_mps);
    // Turns as it banks: 20 degrees at 50 m/s are 0.07 rad/s.
    let before_rad = fast.angles().heading_rad;
    fly(&mut scene, 10, |now, held| Controls { pitch: -0.35, roll: 0.5, ..level(now, held) });
    let turned_rad = (scene.aircraft().angles().heading_rad - before_rad).rem_euclid(std::f64::consts::TAU);
    assert!((0.4..1.2).contains(&turned_rad), "{turned_rad}");
    fly(&mut scene, 40, |now, held| {
        let ahead_mps = (now.attitude.inverse() * now.velocity_mps).x;
        Controls { pitch: (0.05 * ahead_mps).clamp(-0.5, 0.5), roll: 0.0, ..level(now, held) }
    });
    assert!(scene.aircraft().velocity_mps.length() < 3.0, "{}", scene.aircraft().velocity_mps);
}

#[test]
fn it_lands_on_its_skids_and_stands_still() {
    let mut scene = over(12.0, 0.0);
    let mut down = false;
    let mut sinking = climbing(-0.8);
    fly(&mut scene, 30, |now, held| {
        down |= now.condition == Condition::OnGround;
        if down { Controls { throttle: 0.0, ..held } } else { sinking(now, held) }
    });
    let landed = scene.aircraft();
    assert_eq!(landed.condition, Condition::OnGround);
    fly(&mut scene, 20, hands_off);
    let now = scene.aircraft();
    println!("stands {:.3} m over the ground, {:.2e} m/s", now.position_m.y - GROUND_M, now.velocity_mps.length());
    assert!(now.velocity_mps.length() < 1e-3 && now.position_m.distance(landed.position_m) < 0.01);
    assert!((1.0..1.25).contains(&(now.position_m.y - GROUND_M)), "{}", now.position_m.y - GROUND_M);
    // And up again.
    fly(&mut scene, 25, climbing(2.0));
    assert!(scene.aircraft().position_m.y - GROUND_M > 10.0);
}
