//! Entities of a scene: determinism, impacts, crashes, guns, what a snapshot tells of them.

mod proving_ground;

use glam::{DQuat, DVec2, DVec3};
use proving_ground::{busy, empty, fire, gun, light, mountains, plain, surroundings};
use sim::atmosphere::Atmosphere;
use sim::ballistics::motion::{ShellMotion, advance};
use sim::frame::{ned_from_world, world_from_ned};
use sim::integrate::{Integrator, rk4};
use sim::planet::STANDARD_GRAVITY_MPS2;
use sim::rigid::motion::{self, RigidMotion};
use sim::scene::{
    Command, EndReason, Event, Happening, Height, Muzzle, Scene, SceneGround, Strike, Surroundings, TargetStart,
};
use sim::snapshot::StableId;
use sim::{Condition, Snapshot, lockstep};
use std::sync::Arc;
use terrain::edit::{Crater, Edit};

/// Runs a scene and keeps all events.
fn run(scene: &mut Scene, ground: &SceneGround, steps: u32) -> (Arc<Snapshot>, Vec<Event>) {
    let (mut last, mut events) = (Arc::new(scene.snapshot()), Vec::new());
    for _ in 0..steps {
        let next = lockstep(scene, ground, 1);
        events.extend_from_slice(next.events_since(&last));
        last = next;
    }
    (last, events)
}

fn airless() -> Surroundings {
    let mut around = Surroundings::default();
    around.atmosphere = Atmosphere::None;
    around
}

fn impacts(events: &[Event]) -> Vec<Strike> {
    let strike = |event: &Event| if let Happening::Impact(strike) = &event.what { Some(*strike) } else { None };
    events.iter().filter_map(strike).collect()
}

#[test]
fn the_same_inputs_give_the_same_hash_and_one_bit_another() {
    let ground = mountains();
    let flown = |nudge: u64| {
        let mut scene = busy();
        let mut start = light(DVec3::new(300.0, 5_500.0, 50.0));
        start.velocity_mps.x = f64::from_bits(nudge);
        scene.add_body(&start).unwrap();
        let (last, events) = run(&mut scene, &ground, 360);
        (scene.hash(), last.hash(), events)
    };
    let one = flown(0);
    assert_eq!(one, flown(0));
    let impacts = impacts(&one.2).len();
    assert!(impacts > 10, "{impacts} impacts: a busy scene is one");
    let other = flown(1f64.to_bits() + 1);
    assert!(one.0 != other.0 && one.1 != other.1);
    assert_ne!(flown(1f64.to_bits()).0, other.0, "one bit of one velocity");
}

#[test]
fn the_record_replays_to_the_same_hash() {
    let ground = mountains();
    let (mut first, start) = (busy(), busy().save());
    first.start_record();
    let nobody = Command::Clear { id: StableId(99), name: "jam".to_owned() };
    first.schedule(sim::scene::Stamped { step: 33, command: nobody }).unwrap();
    for step in 0..300 {
        if step % 50 == 7 {
            first.order(Command::Turbulence(f64::from(step) * 0.01)).unwrap();
            first.command(sim::Command::Freeze);
        }
        first.step(&ground);
    }
    let record = first.record().to_vec();
    assert!(record.len() > 20);
    // From the bytes of the start without what was scheduled on it: the record has that, stamped.
    let mut again = Scene::restore(&start, first.catalogue().clone()).unwrap();
    let scheduled = again.pending().len();
    assert!(scheduled > 10);
    let mut bare = empty(surroundings());
    for x_m in [-900.0, 0.0, 900.0] {
        bare.add_body(&light(DVec3::new(x_m, 5_600.0, 100.0))).unwrap();
    }
    for i in 0..6 {
        let at = DVec2::new(-1_500.0 + 500.0 * f64::from(i), -900.0);
        let route_m =
            if i % 2 == 0 { vec![at + DVec2::new(40.0, 0.0), at + DVec2::new(40.0, 60.0)] } else { Vec::new() };
        let start = TargetStart { route_m, speed_mps: 12.0, loops: i == 4, ..TargetStart::standing("tank", at) };
        bare.add_target(&start).unwrap();
    }
    for stamped in record {
        bare.schedule(stamped).unwrap();
    }
    for _ in 0..300 {
        bare.step(&ground);
        again.step(&ground);
    }
    assert_eq!(bare.hash(), first.hash());
    assert_ne!(again.hash(), first.hash(), "the orders given by hand count");
}

#[test]
fn one_gun_more_changes_no_other_guns_shots() {
    let ground = plain();
    let shots = |more: bool| {
        let mut scene = empty(Surroundings::default());
        let first = scene.add_target(&TargetStart::standing("ball", DVec2::new(0.0, 0.0))).unwrap();
        let second = scene.add_target(&TargetStart::standing("ball", DVec2::new(400.0, 0.0))).unwrap();
        let up = Muzzle { direction: DVec3::new(0.4, 1.0, 0.0), ..gun() };
        scene.order(fire(first, "shell", up, 20, 1_200.0)).unwrap();
        if more {
            scene.order(fire(second, "shell", up, 50, 6_000.0)).unwrap();
        }
        let (_, events) = run(&mut scene, &ground, 120 * 60);
        impacts(&events).into_iter().filter(|strike| strike.owner == first).collect::<Vec<_>>()
    };
    // Ids of shells tell who fired them in between; everything else must be the same to the bit.
    let nameless = |strike: Strike| Strike { projectile: StableId(0), ..strike };
    let (alone, together) = (shots(false), shots(true));
    assert_eq!(alone.len(), 20);
    assert!(alone.into_iter().map(nameless).eq(together.into_iter().map(nameless)));
}

#[test]
fn a_body_and_a_shell_fly_as_they_do_alone() {
    let mut around = surroundings();
    around.turbulence_mps = 0.0;
    let mut scene = empty(around.clone());
    let start = light(DVec3::new(500.0, 6_000.0, -700.0));
    scene.add_body(&sim::scene::BodyStart { fuel: None, ..start.clone() }).unwrap();
    scene.order(fire(scene.own_id(), "shell", Muzzle::ahead(800.0), 1, 0.0)).unwrap();
    let own = scene.aircraft();
    let model = sim::rigid::Model::from_text(std::path::Path::new("light.toml"), proving_ground::LIGHT).unwrap();
    let (air, wind) = (around.atmosphere.clone(), around.wind.clone());
    let alone = RigidMotion::new(Arc::new(model), around.planet(), air.clone(), wind.clone());
    let turned = sim::frame::ned_attitude_from_world(start.attitude).normalize();
    let rates = turned.conjugate() * around.planet().rotation();
    let mut y = motion::normalised(motion::state(
        ned_from_world(start.position_m),
        turned,
        0.0,
        ned_from_world(start.velocity_mps),
        rates,
    ));
    let text = "mass_kg = 0.36\ndiameter_m = 0.03\ndrag = \"G1\"\nform_factor = 1.0";
    let projectile = sim::ballistics::projectile::Projectile::from_text(std::path::Path::new("p.toml"), text).unwrap();
    let shell = ShellMotion::new(&projectile, around.planet(), &air, &wind, DVec3::X);
    let nose = own.attitude * DVec3::X;
    let velocity = ned_from_world(own.velocity_mps + nose * 800.0);
    let mut shot = sim::ballistics::motion::state(ned_from_world(own.position_m), velocity);
    let dt_s = scene.clock.step_s();
    for step in 0..240 {
        scene.step(&SceneGround::void());
        y = motion::normalised(rk4(0.0, &y, dt_s, |t, y| sim::integrate::Motion::rate(&alone, t, y)));
        (shot, _) = advance(Integrator::Rk4, &shell, f64::from(step) * dt_s, &shot, dt_s, &mut None).unwrap();
    }
    let snapshot = scene.snapshot();
    assert_eq!(snapshot.bodies[0].position_m, world_from_ned(motion::position(&y)), "to the bit");
    let off = snapshot.projectiles[0].position_m.distance(world_from_ned(sim::ballistics::motion::parts(&shot).0));
    // The muzzle's own arithmetic turns the bore once more: a rounding of 1e3 m/s over 2 s, some ten of them.
    assert!(off < 10.0 * 2.0 * 2f64.powi(-43), "{off}");
}

#[test]
fn a_fall_without_air_is_the_worlds_down_and_east_is_east() {
    let mut scene = empty(airless());
    let target = scene.add_target(&TargetStart::standing("ball", DVec2::new(-300.0, 200.0))).unwrap();
    // Identity faces north, so right is east: the shape's own X.
    scene
        .order(fire(target, "shell", Muzzle { direction: DVec3::new(1.0, 1.0, 0.0), ..Muzzle::ahead(200.0) }, 1, 0.0))
        .unwrap();
    let (last, _) = run(&mut scene, &SceneGround::void(), 600);
    let (t, side) = (5.0, 200.0 / 2f64.sqrt());
    let expected = DVec3::new(-300.0 + side * t, side * t - 0.5 * STANDARD_GRAVITY_MPS2 * t * t, 200.0);
    // 600 steps of roundings of numbers below 2^10: 2^-43 m each.
    let off = last.projectiles[0].position_m.distance(expected);
    assert!(off < 600.0 * 2f64.powi(-43), "{off}");
}

#[test]
fn shells_strike_targets_that_stand_and_drive_but_not_their_owner() {
    let ground = plain();
    let mut scene = empty(airless());
    let ball = |plan_m| TargetStart { height: Height::OverGround(2.0), ..TargetStart::standing("ball", plan_m) };
    let shooter = scene.add_target(&ball(DVec2::ZERO)).unwrap();
    let still = scene.add_target(&ball(DVec2::new(0.0, -400.0))).unwrap();
    let driver =
        TargetStart { route_m: vec![DVec2::new(400.0, 300.0)], speed_mps: 20.0, ..ball(DVec2::new(400.0, -300.0)) };
    let driver = scene.add_target(&driver).unwrap();
    let aim = |x_m: f64, z_m: f64| Muzzle { direction: DVec3::new(x_m, 0.002, z_m), ..Muzzle::ahead(1_000.0) };
    scene.order(fire(shooter, "shell", aim(0.0, -1.0), 1, 0.0)).unwrap();
    // The driver passes abreast after 15 s; a round takes 0.4 s to it.
    for step in (0..2_400).step_by(6) {
        let command = fire(shooter, "shell", aim(1.0, 0.0), 1, 0.0);
        scene.schedule(sim::scene::Stamped { step, command }).unwrap();
    }
    let (last, events) = run(&mut scene, &ground, 2_500);
    let strikes = impacts(&events);
    assert!(strikes.iter().all(|strike| strike.target != Some(shooter)));
    let on = |id| strikes.iter().filter(|strike| strike.target == Some(id)).count();
    assert_eq!(on(still), 1);
    // A ball of 3 m radius at 20 m/s is before the gun for 0.3 s: six rounds of 0.05 s, one more or less at the rim.
    assert!((5..=7).contains(&on(driver)), "{}", on(driver));
    let hits: Vec<u32> = last.targets.iter().map(|target| target.hits).collect();
    assert_eq!(hits, [0, 1, on(driver) as u32]);
    for strike in strikes.iter().filter(|strike| strike.target == Some(still)) {
        // On the ball to the chord's nanometre and the roundings of 400 m.
        assert!((strike.point_in_target_m.length() - 3.0).abs() < 1e-8);
        assert!(strike.normal.dot(strike.velocity_mps) < 0.0);
        assert!(strike.point_m.distance(strike.point_in_target_m + DVec3::new(0.0, 2.0, -400.0)) < 1e-9);
    }
    let relative = strikes.iter().find(|strike| strike.target == Some(driver)).unwrap().velocity_mps;
    assert!((relative.z + 20.0).abs() < 1e-6, "the driver's own speed counts: {relative}");
}

#[test]
fn a_body_that_meets_the_ground_ends_there_and_flies_again_when_put_elsewhere() {
    let ground = mountains();
    let mut scene = empty(surroundings());
    let over_m = ground.height_m(0.0, 0.0).unwrap() + 200.0;
    let mut start = light(DVec3::new(0.0, over_m, 0.0));
    start.velocity_mps = DVec3::new(0.0, -150.0, -100.0);
    let id = scene.add_body(&start).unwrap();
    let (last, events) = run(&mut scene, &ground, 120 * 40);
    let crash = events.iter().find_map(|event| match &event.what {
        Happening::Crash { id: of, reason, point_m, velocity_mps, .. } if *of == id => {
            Some((*reason, *point_m, *velocity_mps))
        }
        _ => None,
    });
    let (reason, point_m, velocity_mps) = crash.expect("it dives into the mountains");
    assert_eq!(reason, EndReason::Ground);
    let ground_m = ground.height_m(point_m.x, point_m.z).unwrap();
    assert!((point_m.y - ground_m).abs() < 1e-6, "on its triangle");
    assert!(velocity_mps.length() > 50.0);
    let view = last.bodies[0];
    assert_eq!((view.condition, view.velocity_mps), (Condition::Crashed, DVec3::ZERO));
    assert_eq!(view.position_m, point_m);
    assert!(scene.order(fire(id, "shell", gun(), 1, 0.0)).is_err(), "a wreck does not fire");
    let high = DVec3::new(100.0, 6_500.0, 100.0);
    scene
        .order(Command::Reposition { id, position_m: high, velocity_mps: DVec3::X * 60.0, attitude: start.attitude })
        .unwrap();
    let again = lockstep(&mut scene, &ground, 12);
    assert_eq!(again.bodies[0].condition, Condition::Flying);
    assert!(again.bodies[0].position_m.distance(high) > 4.0 && again.bodies[0].jumps == 1);
}

#[test]
fn interpolation_goes_by_id_and_not_across_jumps() {
    let ground = mountains();
    let mut scene = busy();
    let a = lockstep(&mut scene, &ground, 30);
    let b = lockstep(&mut scene, &ground, 30);
    let middle = Snapshot::interpolate(&a, &b, 0.5);
    let ids = |list: &[sim::scene::EntityView]| list.iter().map(|view| view.id).collect::<Vec<_>>();
    let mut union = [ids(&a.projectiles), ids(&b.projectiles)].concat();
    union.sort();
    union.dedup();
    assert_eq!(ids(&middle.projectiles), union);
    assert!(union.len() > a.projectiles.len(), "some are new");
    for view in &*middle.projectiles {
        let of = |list: &[sim::scene::EntityView]| list.iter().find(|other| other.id == view.id).copied();
        match (of(&a.projectiles), of(&b.projectiles)) {
            (Some(one), Some(other)) => {
                assert!((view.position_m - 0.5 * (one.position_m + other.position_m)).length() < 1e-9);
            }
            (only, None) | (None, only) => assert_eq!(Some(*view), only),
        }
    }
    let id = StableId(2);
    let (position_m, attitude) = (DVec3::new(0.0, 9_000.0, 0.0), DQuat::IDENTITY);
    scene.order(Command::Reposition { id, position_m, velocity_mps: DVec3::ZERO, attitude }).unwrap();
    let c = lockstep(&mut scene, &ground, 1);
    assert_eq!(Snapshot::interpolate(&b, &c, 0.5).bodies[0], c.bodies[0]);
    assert_eq!(Snapshot::interpolate(&b, &c, f64::NAN), *c);
}

#[test]
fn an_empty_scene_has_no_lists_and_lists_are_shared_until_something_changes() {
    let mut scene = empty(Surroundings::default());
    let snapshot = lockstep(&mut scene, &plain(), 10);
    assert!(snapshot.bodies.is_empty() && snapshot.projectiles.is_empty() && snapshot.targets.is_empty());
    assert!(snapshot.events.is_empty() && snapshot.events_counted == 0);
    scene.add_target(&TargetStart::standing("tank", DVec2::ZERO)).unwrap();
    let (a, b) = (lockstep(&mut scene, &plain(), 3), lockstep(&mut scene, &plain(), 5));
    assert!(Arc::ptr_eq(&a.targets, &b.targets), "a target that stands is not copied");
    assert!(Arc::ptr_eq(&Snapshot::interpolate(&a, &b, 0.3).targets, &b.targets));
}

#[test]
fn the_thread_flies_entities_and_takes_orders() {
    let thread = sim::SimThread::start(busy(), mountains()).unwrap();
    let order = |command| assert!(thread.send(sim::run::Message::Order(Box::new(command))));
    order(Command::Turbulence(f64::NAN));
    order(fire(StableId(5), "rocket", Muzzle { direction: DVec3::Y, ..Muzzle::ahead(40.0) }, 1, 0.0));
    // A thread that has no processor yet takes longer.
    let patience = std::time::Instant::now();
    while thread.last_two().1.projectiles.is_empty() && patience.elapsed().as_secs() < 10 {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let now = thread.now();
    assert!(!now.projectiles.is_empty() && now.bodies.len() == 3 && now.targets.len() == 6);
    let scene = thread.stop().unwrap();
    // That of the start, or that of the scheduled command if the thread has come so far.
    assert!([1.5, 4.0].contains(&scene.surroundings().turbulence_mps), "what is refused changes nothing");
}

#[test]
fn an_edited_ground_is_met_from_the_step_that_names_it() {
    let before = mountains();
    let craters: Vec<Edit> = (0..361)
        .map(|at| DVec2::new(f64::from(at % 19 - 9), f64::from(at / 19 - 9)) * 600.0)
        .map(|centre_m| Edit::Crater(Crater { centre_m, radius_m: 300.0, depth_m: 150.0 }))
        .collect();
    let after = before.edited(&craters).unwrap();
    assert_eq!((before.version(), after.version()), (0, 1));
    // What an edit cannot be leaves no trace.
    let wrong = Edit::Crater(Crater { centre_m: DVec2::NAN, radius_m: 1.0, depth_m: 1.0 });
    assert!(before.edited(&[wrong]).is_err());
    let flown = |ground: &SceneGround| {
        // Twenty shells straight down while the ground is the old one, sixty over the new one.
        let mut scene = empty(surroundings());
        let down = Muzzle { direction: DVec3::Z, ..gun() };
        scene.order(fire(scene.own_id(), "shell", down, 20, 600.0)).unwrap();
        let (half, early) = run(&mut scene, &before, 2_400);
        assert_eq!(half.ground_version, 0);
        scene.order(fire(scene.own_id(), "shell", down, 60, 600.0)).unwrap();
        let (last, late) = run(&mut scene, ground, 3_000);
        assert_eq!(last.ground_version, ground.version());
        (scene.hash(), impacts(&early), impacts(&late))
    };
    let (unedited, edited) = (flown(&before), flown(&after));
    assert_eq!(unedited.1, edited.1);
    assert!(unedited.2 != edited.2, "no shell met a crater");
    // Every one that met the ground met that of its step.
    let on = |ground: &SceneGround, strikes: &[Strike]| {
        let grounded: Vec<&Strike> = strikes.iter().filter(|s| s.target.is_none() && s.object.is_none()).collect();
        assert!(grounded.len() > 3, "{}", grounded.len());
        grounded
            .iter()
            .all(|s| ground.height_m(s.point_m.x, s.point_m.z).is_some_and(|h| (h - s.point_m.y).abs() < 1e-6))
    };
    assert!(on(&before, &edited.1) && on(&after, &edited.2) && !on(&before, &edited.2));
}
