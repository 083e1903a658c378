//! Scenes at their extremes: the far corner of a large world, long flights, stalls, guns in the ground.

mod proving_ground;

use glam::{DQuat, DVec2, DVec3};
use proving_ground::{busy, empty, fire, gun, light, mountains};
use sim::aircraft::AircraftState;
use sim::scene::{Command, Happening, Muzzle, Scene, SceneGround, Surroundings, TargetStart};
use sim::snapshot::StableId;
use sim::{Clock, UtcTime, lockstep};
use std::sync::Arc;
use terrain::{Grid, Ground, synthetic};

#[test]
fn at_the_far_corner_of_a_400_km_world_shells_meet_the_very_triangle() {
    let grid = Grid::centred(400.0, 34, 34).unwrap();
    let corner = DVec2::new(grid.east_m() - 2_000.0, grid.south_m() - 2_000.0);
    assert!(corner.x > 200_000.0);
    let area = Ground::new(Arc::new(synthetic::rough(grid, 7, 600.0))).whole();
    let ground = SceneGround::from(area.clone());
    let mut scene = empty(Surroundings::over(0.74).unwrap());
    let target = scene.add_target(&TargetStart::standing("ball", corner)).unwrap();
    let up = Muzzle { offset_m: DVec3::Y * 4.0, direction: DVec3::new(-0.7, 1.5, -0.4), sigma_rad: 0.2, ..gun() };
    scene.order(fire(target, "shell", up, 100, 6_000.0)).unwrap();
    let (mut last, mut met) = (Arc::new(scene.snapshot()), 0);
    for _ in 0..120 * 90 {
        let next = lockstep(&mut scene, &ground, 1);
        for event in next.events_since(&last) {
            let Happening::Impact(strike) = &event.what else { continue };
            let height_m = area.height_m(strike.point_m.x, strike.point_m.z).unwrap();
            // The figure asked of every impact.
            assert!((strike.point_m.y - height_m).abs() < 1e-6, "{strike:?}");
            met += 1;
        }
        last = next;
    }
    // What fell over the world's edge falls on; nothing is in the air over the ground or under it.
    assert!(met > 90 && met + last.projectiles.len() == 100, "{met} met the ground");
    assert!(last.projectiles.iter().all(|view| area.height_m(view.position_m.x, view.position_m.z).is_none()));
}

#[test]
fn an_hour_keeps_the_quaternion_at_length_1() {
    let start = AircraftState::level(DVec3::new(0.0, 9_000.0, 0.0), 0.3, 180.0);
    let date = UtcTime::parse("2026-06-21T06:00:00Z").unwrap();
    let around = Surroundings::default().weightless();
    let mut scene = Scene::furnished(start, date, 20, around, proving_ground::catalogue()).unwrap();
    let mut tumbling = light(DVec3::Y * 5_000.0);
    (tumbling.velocity_mps, tumbling.rates_radps) = (DVec3::ZERO, DVec3::new(0.9, 0.4, -0.6));
    scene.add_body(&tumbling).unwrap();
    let mut worst = 0.0f64;
    for _ in 0..3_600 {
        let now = lockstep(&mut scene, &SceneGround::void(), 20);
        worst = worst.max((now.bodies[0].attitude.length() - 1.0).abs());
    }
    // Normalised each step: a few roundings of 1.1e-16, whatever the time; asked is 1e-12.
    assert!(worst < 8.0 * f64::EPSILON, "{worst:e}");
}

#[test]
fn a_stall_of_ten_seconds_takes_twelve_steps_and_loses_no_shell() {
    let ground = mountains();
    let (mut stalled, mut smooth) = (busy(), busy());
    let mut clock = Clock::new(120, UtcTime { unix_ns: 0 });
    let due = clock.advance(10.0);
    assert_eq!(due, 12);
    lockstep(&mut stalled, &ground, due);
    for _ in 0..12 {
        smooth.step(&ground);
    }
    assert_eq!(stalled.hash(), smooth.hash());
    assert!(stalled.counts()[1] > 0);
}

#[test]
fn a_muzzle_in_the_ground_strikes_at_once_and_a_shot_straight_up_comes_back() {
    let ground = SceneGround::heights(|_, _| Some(100.0));
    let mut scene = empty(Surroundings::default());
    let target = scene.add_target(&TargetStart::standing("ball", DVec2::ZERO)).unwrap();
    scene.step(&ground);
    let up = Muzzle { direction: DVec3::Y, ..Muzzle::ahead(300.0) };
    let buried = Muzzle { offset_m: DVec3::Y * -1.0, ..up };
    scene.order(fire(target, "shell", buried, 1, 0.0)).unwrap();
    let now = lockstep(&mut scene, &ground, 1);
    let Happening::Impact(strike) = &now.events[0].what else { panic!("{:?}", now.events) };
    assert_eq!((strike.target, strike.point_m.y), (None, 99.0));
    scene.order(fire(target, "shell", Muzzle { offset_m: DVec3::Y, ..up }, 1, 0.0)).unwrap();
    let mut back = 0;
    for _ in 0..120 * 60 {
        let now = lockstep(&mut scene, &ground, 1);
        back += usize::from(now.events_counted == 2);
        assert!(now.projectiles.iter().all(|view| view.position_m.is_finite() && view.attitude.is_finite()));
    }
    assert!(back > 0 && scene.counts()[1] == 0);
}

#[test]
fn what_leaves_the_world_is_told_and_gone() {
    let mut scene = empty(Surroundings::default().weightless());
    let id = scene.add_body(&light(DVec3::new(9.999e6, 5_000.0, 0.0))).unwrap();
    let go = |id, x_m: f64| Command::Reposition {
        id,
        position_m: DVec3::new(x_m, 5_000.0, 0.0),
        velocity_mps: DVec3::X * 12_000.0,
        attitude: DQuat::IDENTITY,
    };
    scene.order(fire(id, "shell", Muzzle::ahead(100.0), 1, 0.0)).unwrap();
    scene.step(&SceneGround::void());
    let shell = StableId(3);
    scene.order(go(id, 9.9999e6)).unwrap();
    scene.order(go(shell, 9.9999e6)).unwrap();
    let last = lockstep(&mut scene, &SceneGround::void(), 12);
    let lost = |event: &sim::scene::Event| matches!(event.what, Happening::Lost { id, .. } if id == shell);
    let ended = |event: &sim::scene::Event| matches!(event.what, Happening::Crash { id: of, .. } if of == id);
    assert!(last.events.iter().any(lost) && last.events.iter().any(ended), "{:?}", last.events);
    assert!(last.projectiles.is_empty() && last.bodies[0].position_m.is_finite());
}
