//! Loose things in scenes: debris of what bombs destroy, saves in the middle of it, and a parked lorry that stays parked.

mod firing_range;

use firing_range::{arm, armed, brick, catalogue, load, release, run};
use glam::{DQuat, DVec2, DVec3};
use sim::loose::{LooseKind, MOST_LOOSE};
use sim::scene::{Event, Happening, LooseStart, Scene, SceneGround, TargetStart};
use sim::weapons::{Aim, Damage, Fuze, Trigger};
use std::sync::Arc;
use terrain::{Grid, Ground, synthetic};

fn slope(per_m: f64) -> SceneGround {
    let grid = Grid::centred(100.0, 2, 2).unwrap();
    let field = synthetic::from_fn(grid, |column, _| (500.0 + per_m * 100.0 * f64::from(column)) as f32);
    Ground::new(Arc::new(field)).whole().into()
}

fn put(kind: LooseKind, plan_m: DVec2) -> LooseStart {
    LooseStart { kind, plan_m, over_ground_m: 0.0, attitude: DQuat::IDENTITY }
}

/// A lorry with barrels and poles about it, and bombs on their way: some near enough to hurt, one that strikes.
fn under_fire(aside_m: f64) -> Scene {
    let mut scene = armed(DVec3::new(aside_m, 1_000.0, 900.0), 150.0);
    let own = scene.own_id();
    scene.add_target(&TargetStart::standing("truck", DVec2::new(0.0, -50.0))).unwrap();
    for number in 0..8 {
        let at = DVec2::new(4.0 + f64::from(number), -50.0 + f64::from(number % 3));
        scene.add_loose(&put(LooseKind::ALL[number as usize % 4], at)).unwrap();
    }
    let fuze = Fuze { trigger: Trigger::Impact, arming_s: 0.5 };
    scene.order(load(own, "mk82", 4, DVec3::ZERO)).unwrap();
    scene.order(arm(own, "mk82", Some(fuze))).unwrap();
    scene.order(release(own, "mk82", 4, 1, 0.15, Aim::Nearest)).unwrap();
    scene
}

fn destroyed(events: &[Event]) -> usize {
    events.iter().filter(|event| matches!(event.what, Happening::Damage { state: Damage::Destroyed, .. })).count()
}

#[test]
fn a_struck_lorry_leaves_debris_that_comes_to_rest_on_the_ground_and_saves_go_on_to_the_bit() {
    let ground = slope(0.1);
    let mut whole = under_fire(0.0);
    let (mut saves, mut events, mut most_moving) = (Vec::new(), Vec::new(), 0);
    for second in 0..60 {
        let [_, moving] = whole.loose_counts();
        most_moving = most_moving.max(moving);
        if second % 3 == 0 {
            saves.push((second, whole.save(), whole.hash()));
        }
        events.extend(run(&mut whole, &ground, 120).1);
    }
    assert_eq!(destroyed(&events), 1);
    let [pieces, moving] = whole.loose_counts();
    assert!(pieces > 12 && moving == 0 && most_moving > 8, "{pieces} pieces, {moving} of {most_moving} still move");
    for view in whole.snapshot().loose.iter() {
        let over_m = view.position_m.y - ground.height_m(view.position_m.x, view.position_m.z).unwrap();
        assert!((0.0..1.6).contains(&over_m), "{view:?}");
    }
    let mut in_motion = 0;
    for (second, bytes, hash) in saves {
        let mut restored = Scene::restore(&bytes, catalogue()).unwrap();
        in_motion += usize::from(restored.loose_counts()[1] > 0);
        assert_eq!((restored.hash(), restored.save() == bytes), (hash, true), "saved at {second} s");
        (second * 120..60 * 120).for_each(|_| restored.step(&ground));
        assert_eq!(restored.hash(), whole.hash(), "saved at {second} s");
        assert_eq!(restored.snapshot().loose, whole.snapshot().loose);
    }
    assert!(in_motion > 0, "no save fell into the motion");
    let mut again = under_fire(0.0);
    (0..60 * 120).for_each(|_| again.step(&ground));
    assert_eq!(again.hash(), whole.hash());
}

#[test]
fn a_parked_lorry_does_not_creep_or_shake_on_a_slope_also_after_a_nudge() {
    let ground = slope(0.1);
    let hurt = |event: &Event| matches!(event.what, Happening::Damage { state: Damage::Damaged, .. });
    // The nearest pass whose bombs hurt it and do not destroy it; chances are the seed's.
    let passes = (4..30).map(|pass| 3.0 * f64::from(pass));
    let nudging = passes.filter(|aside_m| {
        let events = run(&mut under_fire(*aside_m), &ground, 120 * 10).1;
        events.iter().any(hurt) && destroyed(&events) == 0
    });
    let mut scene = under_fire(nudging.min_by(f64::total_cmp).unwrap());
    let pose = |scene: &Scene| (scene.snapshot().targets[0].position_m, scene.snapshot().targets[0].attitude);
    let mut events = run(&mut scene, &ground, 1).1;
    let before = pose(&scene);
    let (mut creep_m, mut jitter_m, mut last) = (0.0f64, 0.0f64, before.0);
    for second in 0..600 {
        if (60..120).contains(&second) {
            // A drum falls on it every second for a minute.
            let over = LooseStart { over_ground_m: 5.0, ..put(LooseKind::Barrel, DVec2::new(1.0, -50.0)) };
            scene.add_loose(&over).unwrap();
        }
        events.extend(run(&mut scene, &ground, 120).1);
        let now = pose(&scene).0;
        (creep_m, jitter_m) = (creep_m.max(now.distance(before.0)), jitter_m.max(now.distance(last)));
        last = now;
    }
    let bursts = events.iter().filter(|event| matches!(event.what, Happening::Burst { .. })).count();
    assert_eq!((destroyed(&events), bursts, events.iter().any(hurt)), (0, 4, true), "hurt, not destroyed");
    let lain = scene.snapshot().loose.iter().filter(|view| view.position_m.distance(before.0) < 8.0).count();
    assert!(lain > 10 && scene.loose_counts()[1] == 0, "{lain} drums lie about it, {:?}", scene.loose_counts());
    println!("creep {creep_m} m, jitter {jitter_m} m in 600 s");
    // Asked: 1 mm and 0.1 mm. It stands by three points on the exact ground, so nothing at all moves it.
    assert!(creep_m == 0.0 && jitter_m == 0.0 && pose(&scene) == before, "{creep_m} {jitter_m}");
}

#[test]
fn a_driving_lorry_knocks_over_poles_on_its_way_and_keeps_its_way() {
    let ground = slope(0.0);
    let drive = |poles: bool| {
        let mut scene = armed(DVec3::new(0.0, 3_000.0, 900.0), 150.0);
        let route_m = vec![DVec2::new(0.0, -100.0)];
        let start = TargetStart { route_m, speed_mps: 10.0, ..TargetStart::standing("truck", DVec2::ZERO) };
        scene.add_target(&start).unwrap();
        for number in 0..if poles { 10 } else { 0 } {
            let at = DVec2::new([-0.8, 0.9, 6.0][number % 3], -12.0 - 7.0 * number as f64);
            scene.add_loose(&put(if number == 4 { LooseKind::Crate } else { LooseKind::Pole }, at)).unwrap();
        }
        run(&mut scene, &ground, 120 * 20);
        scene
    };
    let (with, without) = (drive(true), drive(false));
    assert_eq!(with.snapshot().targets[0].position_m, without.snapshot().targets[0].position_m);
    let upright = |view: &sim::scene::EntityView| (view.attitude * DVec3::Y).y > 0.99;
    let views = with.snapshot().loose;
    let standing = views.iter().filter(|view| upright(view) && view.of == LooseKind::Pole.number()).count();
    // Three stand 6 m aside.
    assert_eq!((views.len(), standing, with.loose_counts()[1]), (10, 3, 0), "{views:#?}");
}

#[test]
fn a_body_knocks_over_what_it_flies_into_and_strews_debris_where_it_crashes() {
    let ground = slope(0.0);
    let mut scene = armed(DVec3::new(0.0, 3_000.0, 900.0), 150.0);
    scene.add_body(&brick(DVec3::new(0.0, 500.9, 0.0))).unwrap();
    for (x_m, z_m) in [(0.0, -10.0), (8.0, -10.0)] {
        scene.add_loose(&put(LooseKind::Barrel, DVec2::new(x_m, z_m))).unwrap();
    }
    let (last, events) = run(&mut scene, &ground, 120 * 30);
    assert!(events.iter().any(|event| matches!(event.what, Happening::Crash { .. })));
    let (struck, beside) = (&last.loose[0], &last.loose[1]);
    assert!(struck.position_m.z < -20.0 && beside.position_m.z == -10.0, "{struck:?} {beside:?}");
    // Twelve parts, all at rest ahead of where it came down.
    assert_eq!(scene.loose_counts(), [14, 0]);
    assert!(last.loose[2..].iter().all(|view| view.position_m.z < -15.0), "{:#?}", last.loose);
}

#[test]
fn what_cannot_be_put_is_refused_and_numbers_are_limited() {
    let mut scene = armed(DVec3::Y * 3_000.0, 150.0);
    let refused = |scene: &mut Scene, start: LooseStart| scene.add_loose(&start).unwrap_err().to_string();
    let good = put(LooseKind::Barrel, DVec2::ZERO);
    assert!(refused(&mut scene, LooseStart { plan_m: DVec2::NAN, ..good }).contains("loose.plan_m"));
    assert!(refused(&mut scene, LooseStart { over_ground_m: -1.0, ..good }).contains("loose.over_ground_m: expected"));
    let flat = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    assert!(refused(&mut scene, LooseStart { attitude: flat, ..good }).contains("loose.attitude"));
    for _ in 0..MOST_LOOSE {
        scene.add_loose(&good).unwrap();
    }
    assert!(refused(&mut scene, good).contains("expected at most 512 things"));
    // Many in one place: they stand until something moves them.
    scene.step(&slope(0.0));
    assert_eq!(scene.loose_counts(), [MOST_LOOSE, 0]);
}
