//! Craters that the posts can show: whoever steps a scene edits its ground, step by step and on a thread of its own alike.

mod firing_range;

use firing_range::{SEED, arm, load, release};
use glam::DVec3;
use sim::aircraft::AircraftState;
use sim::scene::{Catalogue, Event, Scene, SceneGround, Surroundings};
use sim::weapons::{Aim, Fuze, Trigger, Weapon, builtin};
use sim::{SimThread, UtcTime};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrain::{Grid, Ground, synthetic};

/// Posts of a plain, 25 m apart: a charge of 500 t leaves a crater of 32 m.
fn ground() -> SceneGround {
    Ground::new(Arc::new(synthetic::flat(Grid::centred(25.0, 8, 8).unwrap(), 0.0))).whole().into()
}

/// A scene that has just let go of two bombs, 300 m over the plain.
fn bombing() -> Scene {
    let mut all = Catalogue::new();
    builtin::add_all(&mut all).unwrap();
    let text = include_str!("../../assets/weapons/mk82.toml").replace("tnt_kg = 95.0", "tnt_kg = 5e5");
    all.add_weapon("large", Weapon::from_text(Path::new("large.toml"), &text).unwrap()).unwrap();
    let mut around = Surroundings::over(0.74).unwrap();
    around.seed = SEED;
    let start = AircraftState::level(DVec3::new(0.0, 300.0, 800.0), 0.0, 100.0);
    let mut scene = Scene::furnished(start, UtcTime { unix_ns: 0 }, 120, around, Arc::new(all)).unwrap();
    let own = scene.own_id();
    scene.order(load(own, "large", 2, DVec3::Z)).unwrap();
    scene.order(arm(own, "large", Some(Fuze { trigger: Trigger::Impact, arming_s: 0.0 }))).unwrap();
    scene.order(release(own, "large", 2, 1, 0.5, Aim::Nearest)).unwrap();
    scene
}

fn craters<'a>(events: impl IntoIterator<Item = &'a Event>) -> Vec<terrain::edit::Crater> {
    events.into_iter().filter_map(sim::run::crater).collect()
}

#[test]
fn a_crater_is_in_the_ground_of_the_step_after_also_on_a_thread() {
    let (mut scene, mut after) = (bombing(), ground());
    let mut stepped = Vec::new();
    for _ in 0..120 * 12 {
        let (before, counted) = (after.version(), scene.events_counted());
        let now = sim::advance(&mut scene, &mut after);
        let new = craters(now.events.iter().filter(|event| event.number >= counted));
        // The step itself met the ground as it was; the next meets one more version a crater.
        assert_eq!((now.ground_version, after.version()), (before, before + new.len() as u32));
        stepped.extend(new);
    }
    assert_eq!((stepped.len(), after.version()), (2, 2));
    for crater in &stepped {
        let bottom_m = after.height_m(crater.centre_m.x, crater.centre_m.y).unwrap();
        assert!(bottom_m < -1.0, "{bottom_m}");
    }

    // The thread has the same craters to the bit, though nobody asked until they were there.
    let mut scene = bombing();
    scene.clock.set_rate(8.0);
    let thread = SimThread::start(scene, ground()).unwrap();
    let begun = Instant::now();
    while thread.last_two().1.ground_version < 2 && begun.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(craters(&thread.take_events()), stepped);
    assert!(thread.take_events().iter().all(|event| sim::run::crater(event).is_none()), "an event is given once");
    assert_eq!(thread.stop().unwrap().snapshot().ground_version, 2);
}
