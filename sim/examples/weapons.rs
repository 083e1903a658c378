//! What weapons cost, and what a longer step of the prediction costs in error: two tables on stdout.
//!
//! Times are the least of several rounds on this machine: other work on it can only make a round longer.

use glam::{DVec2, DVec3};
use sim::aircraft::AircraftState;
use sim::rigid::Model;
use sim::scene::{BodyStart, Catalogue, Command, Scene, SceneGround, Surroundings, TargetStart};
use sim::snapshot::StableId;
use sim::weapons::ccip::{Leaving, Settings, predict};
use sim::weapons::{Aim, builtin};
use sim::{UtcTime, wind::Wind};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;
use terrain::{Grid, Ground, synthetic};

const BRICK: &str = "[body]\nmass_kg = 9000.0\ninertia_kgm2 = [[1.2e4, 0.0, 0.0], [0.0, 5e4, 0.0], [0.0, 0.0, 6e4]]\n\
    [reference]\narea_m2 = 20.0\nspan_m = 8.0\nchord_m = 3.0\n[[aero.term]]\nto = \"CD\"\nvalue = 0.02\n";

fn scene(bodies: u32, targets: u32, armed: bool) -> Scene {
    let mut all = Catalogue::new();
    all.add_model("brick", Model::from_text(Path::new("brick.toml"), BRICK).expect("sound")).expect("new");
    builtin::add_all(&mut all).expect("sound");
    let start = AircraftState::level(DVec3::new(0.0, 2_500.0, 2_000.0), 0.0, 200.0);
    let date = UtcTime { unix_ns: 0 };
    let around = Surroundings::over(0.74).expect("a latitude");
    let mut scene = Scene::furnished(start, date, 120, around, Arc::new(all)).expect("sound");
    for i in 0..bodies {
        let body = BodyStart {
            model: "brick".to_owned(),
            position_m: DVec3::new(300.0 * f64::from(i), 3_000.0, 2_000.0),
            velocity_mps: DVec3::NEG_Z * 200.0,
            attitude: sim::frame::attitude(sim::frame::Angles::default()),
            rates_radps: DVec3::ZERO,
            fuel: None,
        };
        scene.add_body(&body).expect("sound");
    }
    for i in 0..targets {
        let at = DVec2::new(-500.0 + 50.0 * f64::from(i), -1_000.0);
        let route_m = vec![at + DVec2::new(100.0, 300.0), at + DVec2::new(400.0, 0.0)];
        let start = TargetStart { route_m, speed_mps: 10.0, loops: true, ..TargetStart::standing("truck", at) };
        scene.add_target(&start).expect("sound");
    }
    if armed {
        let own = scene.own_id();
        arm(&mut scene, own, "mk82", 6);
    }
    scene
}

fn arm(scene: &mut Scene, owner: StableId, weapon: &str, rounds: u32) {
    let load = Command::Load { owner, weapon: weapon.to_owned(), rounds, at_m: DVec3::ZERO };
    scene.order(load).expect("sound");
    let arm = Command::Arm { owner, master: true, weapon: Some(weapon.to_owned()), fuze: None };
    scene.order(arm).expect("sound");
}

/// Least time of a step over rounds of 60 steps, microseconds.
fn step_us(make: impl Fn() -> Scene, ground: &SceneGround) -> (f64, usize) {
    let mut least = f64::INFINITY;
    let mut shells = 0;
    for _ in 0..15 {
        let mut scene = make();
        for _ in 0..30 {
            scene.step(ground);
        }
        let begun = Instant::now();
        for _ in 0..60 {
            scene.step(ground);
        }
        least = least.min(begun.elapsed().as_secs_f64() / 60.0 * 1e6);
        shells = scene.counts()[1];
    }
    (least, shells)
}

fn main() {
    let rough = synthetic::rough(Grid::centred(25.0, 12, 12).expect("a grid"), 11, 20.0);
    let ground = SceneGround::from(Ground::new(Arc::new(rough)).whole());
    println!("scene,step_us,shells");
    let busy = || {
        let mut scene = scene(5, 20, true);
        let bodies: Vec<StableId> = (2..7).map(StableId).collect();
        for id in bodies {
            arm(&mut scene, id, "m61", 400);
            let weapon = "m61".to_owned();
            let fire =
                Command::Release { owner: id, weapon, rounds: 40, together: 40, interval_s: 0.01, aim: Aim::Nearest };
            scene.order(fire).expect("armed");
        }
        scene
    };
    for (name, make) in [
        ("empty", Box::new(|| scene(0, 0, false)) as Box<dyn Fn() -> Scene>),
        ("own aircraft armed with the point of impact", Box::new(|| scene(0, 0, true))),
        ("20 vehicles", Box::new(|| scene(0, 20, false))),
        ("20 vehicles and 200 shells and 5 aircraft and the point of impact", Box::new(busy)),
    ] {
        let (us, shells) = step_us(make, &ground);
        println!("{name},{us:.2},{shells}");
    }
    println!("weapon,step_s,error_max_m,error_median_m,steps_max,cost_us_median,cost_us_max");
    let mut around = Surroundings::over(0.74).expect("a latitude");
    let rows = vec![(0.0, DVec3::new(8.0, -4.0, 0.0)), (4_000.0, DVec3::new(20.0, 9.0, 0.0))];
    around.wind = Wind::new(rows).expect("rising");
    for name in ["mk82", "hydra70", "gsh23"] {
        let weapon = builtin::weapon(name).expect("embedded");
        let leavings: Vec<Leaving> = (0..60)
            .map(|i| {
                let share = f64::from(i) / 60.0;
                let heading = std::f64::consts::TAU * (share * 7.0).fract();
                let dive = if name == "mk82" { -0.4 + 1.2 * share } else { 0.1 + 0.8 * share };
                let way = terrain::frame::direction(heading, -dive);
                let position_m = DVec3::new(0.0, if name == "mk82" { 300.0 + 6_000.0 * share } else { 1_200.0 }, 0.0);
                let owner_mps = way * 200.0;
                let push = if name == "mk82" { DVec3::NEG_Y } else { way } * weapon.speed_mps;
                Leaving { position_m, velocity_mps: owner_mps + push, bore: way, owner_m: position_m, owner_mps }
            })
            .collect();
        let usual = Settings::of(&weapon, weapon.fuze);
        let exact: Vec<_> = leavings
            .iter()
            .map(|leaving| {
                predict(
                    &weapon.projectile,
                    &around,
                    &ground,
                    leaving,
                    &Settings { step_s: 0.02, most_steps: u32::MAX, ..usual },
                )
            })
            .collect();
        for step_s in [2.0, 1.0, 0.4, 0.2, 0.1] {
            let settings = Settings { step_s, most_steps: 10_000, ..usual };
            let (mut errors, mut costs, mut steps) = (Vec::new(), Vec::new(), 0);
            for (leaving, exact) in leavings.iter().zip(&exact) {
                let mut least = f64::INFINITY;
                let mut found = None;
                for _ in 0..9 {
                    let begun = Instant::now();
                    found = Some(predict(&weapon.projectile, &around, &ground, leaving, &settings));
                    least = least.min(begun.elapsed().as_secs_f64() * 1e6);
                }
                costs.push(least);
                if let (Some(Ok(found)), Ok(exact)) = (found, exact) {
                    errors.push(found.point_m.distance(exact.point_m));
                    steps = steps.max(found.steps);
                }
            }
            errors.sort_by(f64::total_cmp);
            costs.sort_by(f64::total_cmp);
            let (Some(worst), Some(dearest)) = (errors.last(), costs.last()) else { continue };
            let (middle, cost) = (errors[errors.len() / 2], costs[costs.len() / 2]);
            let mark = if step_s == usual.step_s { " (used)" } else { "" };
            println!("{name},{step_s}{mark},{worst:.4},{middle:.5},{steps},{cost:.1},{dearest:.1}");
        }
    }
}
