//! A firing range for tests: the embedded weapons and targets, an own aircraft that flies straight.

// Each test binary uses a part of it.
#![allow(dead_code)]

use glam::DVec3;
use sim::aircraft::AircraftState;
use sim::rigid::Model;
use sim::scene::{BodyStart, Catalogue, Command, Event, Happening, Scene, SceneGround, Surroundings};
use sim::snapshot::StableId;
use sim::weapons::{Aim, Fuze, Score, builtin};
use sim::{Snapshot, UtcTime};
use std::path::Path;
use std::sync::Arc;

/// Seed of the scenario.
pub const SEED: u64 = 20_261_126;

const BRICK: &str = "[body]\nmass_kg = 100.0\ninertia_kgm2 = [[50.0, 0.0, 0.0], [0.0, 50.0, 0.0], [0.0, 0.0, 50.0]]\n\
    [reference]\narea_m2 = 1.0\nspan_m = 1.0\nchord_m = 1.0\n[[aero.term]]\nto = \"CD\"\nvalue = 0.3\n";

pub fn catalogue() -> Arc<Catalogue> {
    let mut all = Catalogue::new();
    all.add_model("brick", Model::from_text(Path::new("brick.toml"), BRICK).unwrap()).unwrap();
    builtin::add_all(&mut all).unwrap();
    Arc::new(all)
}

/// A body of 100 kg with drag alone, northward at 100 m/s.
pub fn brick(position_m: DVec3) -> BodyStart {
    BodyStart {
        model: "brick".to_owned(),
        position_m,
        velocity_mps: DVec3::NEG_Z * 100.0,
        attitude: sim::frame::attitude(sim::frame::Angles::default()),
        rates_radps: DVec3::ZERO,
        fuel: None,
    }
}

/// A scene whose own aircraft flies north, 120 steps a second, in standard still air.
pub fn armed(position_m: DVec3, speed_mps: f64) -> Scene {
    let mut around = Surroundings::over(0.74).unwrap();
    around.seed = SEED;
    within(around, position_m, speed_mps)
}

pub fn within(around: Surroundings, position_m: DVec3, speed_mps: f64) -> Scene {
    let start = AircraftState::level(position_m, 0.0, speed_mps);
    Scene::furnished(start, UtcTime::parse("2026-06-21T06:00:00Z").unwrap(), 120, around, catalogue()).unwrap()
}

pub fn load(owner: StableId, weapon: &str, rounds: u32, at_m: DVec3) -> Command {
    Command::Load { owner, weapon: weapon.to_owned(), rounds, at_m }
}

pub fn arm(owner: StableId, weapon: &str, fuze: Option<Fuze>) -> Command {
    Command::Arm { owner, master: true, weapon: Some(weapon.to_owned()), fuze }
}

pub fn release(owner: StableId, weapon: &str, rounds: u32, together: u32, interval_s: f64, aim: Aim) -> Command {
    Command::Release { owner, weapon: weapon.to_owned(), rounds, together, interval_s, aim }
}

/// Runs a scene and keeps all events.
pub fn run(scene: &mut Scene, ground: &SceneGround, steps: u32) -> (Snapshot, Vec<Event>) {
    let (mut last, mut events) = (scene.snapshot(), Vec::new());
    for _ in 0..steps {
        scene.step(ground);
        let next = scene.snapshot();
        events.extend_from_slice(next.events_since(&last));
        last = next;
    }
    (last, events)
}

pub fn scores(events: &[Event]) -> Vec<Score> {
    let score = |event: &Event| if let Happening::Score(score) = event.what { Some(score) } else { None };
    events.iter().filter_map(score).collect()
}

/// The events of bombs that are released one after the other over a ground.
pub fn bombs_over(ground: &SceneGround, position_m: DVec3, fuze: Fuze, rounds: u32) -> Vec<Event> {
    let mut scene = armed(position_m, 150.0);
    let own = scene.own_id();
    scene.order(load(own, "mk82", rounds, DVec3::ZERO)).unwrap();
    scene.order(arm(own, "mk82", Some(fuze))).unwrap();
    scene.order(release(own, "mk82", rounds, 1, 0.1, Aim::Nearest)).unwrap();
    run(&mut scene, ground, 120 * 30).1
}
