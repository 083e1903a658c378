//! Commands of a scene: what each does, and that one with a bad number does nothing.

mod proving_ground;

use glam::{DQuat, DVec2, DVec3};
use proving_ground::{busy, empty, fire, gun, light, mountains, plain};
use sim::lockstep;
use sim::scene::{
    Command, Failure, Freeze, Fuel, FuelChange, Happening, Muzzle, Scene, SceneGround, Stamped, Surroundings,
    TargetStart,
};
use sim::snapshot::StableId;

fn calm() -> (Scene, StableId) {
    let mut scene = empty(Surroundings::default());
    let id = scene.add_body(&light(DVec3::new(0.0, 3_000.0, 0.0))).unwrap();
    (scene, id)
}

fn control(id: StableId, name: &str, value: f64) -> Command {
    Command::Control { id, control: name.to_owned(), value }
}

fn fail(id: StableId, failure: Failure, in_steps: u64) -> Command {
    Command::Fail { id, name: "it".to_owned(), failure, in_steps }
}

#[test]
fn a_bad_number_in_any_command_is_refused_and_the_scene_stays() {
    let ground = mountains();
    let mut scene = busy();
    for _ in 0..30 {
        scene.step(&ground);
    }
    let (own, body, target) = (scene.own_id(), StableId(2), StableId(6));
    let before = scene.hash();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let off = DVec3::new(0.0, bad, 0.0);
        let mut all = vec![
            Command::SeekTrack(bad),
            Command::DayRate(bad),
            Command::Controls(sim::Controls { pitch: bad, ..Default::default() }),
            Command::Wind(vec![(0.0, off)]),
            Command::Wind(vec![(bad, DVec3::X)]),
            Command::Turbulence(bad),
            control(body, "aileron_norm", bad),
            Command::Fuel { id: body, change: FuelChange::Set(bad) },
            Command::Fuel { id: body, change: FuelChange::Consume(bad) },
            fail(body, Failure::FuelLeak(bad), 0),
            fire(own, "shell", Muzzle { offset_m: off, ..gun() }, 1, 0.0),
            fire(own, "shell", Muzzle { direction: off, ..gun() }, 1, 0.0),
            fire(own, "shell", Muzzle { speed_mps: bad, ..gun() }, 1, 0.0),
            fire(own, "shell", Muzzle { sigma_rad: bad, ..gun() }, 1, 0.0),
            fire(own, "shell", Muzzle { speed_sigma_mps: bad, ..gun() }, 1, 0.0),
            fire(own, "shell", gun(), 5, bad),
            Command::Place(Box::new(sim::AircraftState { alpha_rad: bad, ..scene.aircraft() })),
        ];
        for id in [own, body, target] {
            let (p, v, q) = (DVec3::Y * 5_000.0, DVec3::X, DQuat::IDENTITY);
            let turn = DQuat::from_xyzw(0.0, bad, 0.0, 1.0);
            for (position_m, velocity_mps, attitude) in [(off, v, q), (p, off, q), (p, v, turn)] {
                all.push(Command::Reposition { id, position_m, velocity_mps, attitude });
            }
        }
        for command in all {
            let why = scene.order(command.clone()).expect_err("refused").to_string();
            assert!(why.contains("expected"), "{command:?}: {why}");
            assert!(scene.schedule(Stamped { step: 40, command: command.clone() }).is_err(), "{command:?}");
            assert_eq!(scene.hash(), before, "{command:?}");
        }
    }
}

#[test]
fn what_does_not_exist_or_cannot_be_is_refused_by_name() {
    let (mut scene, body) = calm();
    let target = scene.add_target(&TargetStart::standing("tank", DVec2::ZERO)).unwrap();
    let before = scene.hash();
    let nobody = StableId(99);
    let (far, still, level) = (DVec3::X * 2e7, DVec3::ZERO, DQuat::IDENTITY);
    for (command, told) in [
        (control(nobody, "aileron_norm", 0.0), "expected a rigid body of the scene, found 99"),
        (control(target, "aileron_norm", 0.0), "expected a rigid body"),
        (control(body, "flaps", 0.0), "expected one of [aileron_norm, elevator_norm, throttle_norm], found flaps"),
        (fail(body, Failure::ControlStuck("flaps".to_owned()), 0), "found flaps"),
        (fail(body, Failure::FuelLeak(-1.0), 0), "expected a leak of 0 or more"),
        (Command::Clear { id: body, name: "it".to_owned() }, "found it"),
        (Command::Fuel { id: body, change: FuelChange::Set(-1.0) }, "expected 0 or more kg, found -1"),
        (fire(nobody, "shell", gun(), 1, 0.0), "expected an entity that can fire"),
        (fire(body, "brick", gun(), 1, 0.0), "expected one of [shell, rocket], found brick"),
        (fire(body, "shell", gun(), 0, 60.0), "expected at least 1"),
        (Command::Turbulence(-1.0), "expected 0..=500"),
        (Command::Wind(vec![(5.0, DVec3::X), (5.0, DVec3::X)]), "expected a height above 5"),
        (
            Command::Reposition { id: body, position_m: far, velocity_mps: still, attitude: level },
            "expected a place within a world",
        ),
        (Command::Reposition { id: nobody, position_m: still, velocity_mps: still, attitude: level }, "found 99"),
    ] {
        let why = scene.order(command).expect_err("refused").to_string();
        assert!(why.contains(told), "{why}");
        assert_eq!(scene.hash(), before);
    }
    let heavy =
        sim::scene::BodyStart { fuel: Some(Fuel { fuel_kg: 1_000.0, flow_kgps: 0.1 }), ..light(DVec3::Y * 3e3) };
    assert!(scene.add_body(&heavy).unwrap_err().to_string().contains("less than the model's mass of 1000 kg"));
    assert!(scene.add_target(&TargetStart::standing("barn", DVec2::ZERO)).is_err());
    assert_eq!(scene.hash(), before);
    // What is seen only when it is due becomes an event.
    scene.schedule(Stamped { step: 5, command: control(nobody, "aileron_norm", 0.0) }).unwrap();
    let last = lockstep(&mut scene, &plain(), 10);
    assert!(matches!(&last.events[0].what, Happening::Refused { why } if why.contains("found 99")));
    assert!(scene.schedule(Stamped { step: 3, command: Command::Turbulence(0.0) }).is_err(), "that step is gone");
}

#[test]
fn each_freeze_holds_what_it_says() {
    for freeze in [Freeze::Position, Freeze::Flight, Freeze::Total] {
        let (mut scene, body) = calm();
        let drive = TargetStart {
            route_m: vec![DVec2::new(500.0, 0.0)],
            speed_mps: 10.0,
            ..TargetStart::standing("tank", DVec2::ZERO)
        };
        scene.add_target(&drive).unwrap();
        scene.order(fire(body, "shell", Muzzle::ahead(300.0), 1, 0.0)).unwrap();
        let before = lockstep(&mut scene, &plain(), 12);
        scene.order(Command::Freeze(freeze)).unwrap();
        let after = lockstep(&mut scene, &plain(), 120);
        assert!(after.flags.frozen && after.step == 132);
        let plan = |at: DVec3| DVec2::new(at.x, at.z);
        let (own, other) = (before.aircraft, after.aircraft);
        let (a, b) = (before.bodies[0], after.bodies[0]);
        assert_eq!(plan(own.position_m), plan(other.position_m), "{freeze:?}");
        assert_eq!(plan(a.position_m), plan(b.position_m), "{freeze:?}");
        let climbs = freeze == Freeze::Position;
        assert_eq!(a.position_m.y != b.position_m.y, climbs, "{freeze:?}");
        assert_eq!(a.velocity_mps != b.velocity_mps, climbs, "{freeze:?}");
        let runs = freeze != Freeze::Total;
        assert_eq!(before.targets[0].position_m != after.targets[0].position_m, runs, "{freeze:?}");
        assert_eq!(before.projectiles[0].position_m != after.projectiles[0].position_m, runs, "{freeze:?}");
        assert_eq!(before.date != after.date, runs, "{freeze:?}");
        scene.order(Command::Freeze(Freeze::None)).unwrap();
        let freed = lockstep(&mut scene, &plain(), 12);
        assert!(freed.bodies[0].position_m.z < b.position_m.z - 1.0, "{freeze:?}: flies north again");
        assert_eq!(freed.date, after.date.plus_s(0.1), "{freeze:?}");
    }
}

#[test]
fn failures_set_in_when_armed_for_and_end_when_cleared() {
    let roll = |orders: &[(u64, Command)]| {
        let (mut scene, _) = calm();
        for (step, command) in orders {
            scene.schedule(Stamped { step: *step, command: command.clone() }).unwrap();
        }
        let last = lockstep(&mut scene, &SceneGround::void(), 240);
        (sim::frame::angles(last.bodies[0].attitude).roll_rad, last)
    };
    let id = StableId(2);
    let stick = |step, value| (step, control(id, "aileron_norm", value));
    let stuck = Failure::ControlStuck("aileron_norm".to_owned());
    let free = Failure::ControlFree("aileron_norm".to_owned());
    let (straight, _) = roll(&[]);
    let (right, _) = roll(&[stick(0, 0.2)]);
    assert!(straight.abs() < 1e-9 && right > 0.2, "{straight} {right}");
    // Stuck at neutral before the stick moves; stuck at the deflection while the stick goes back.
    assert_eq!(roll(&[(0, fail(id, stuck.clone(), 0)), stick(1, 0.2)]).0, straight);
    assert_eq!(roll(&[stick(0, 0.2), (0, fail(id, stuck.clone(), 10)), stick(20, -0.2)]).0, right);
    assert_eq!(roll(&[stick(0, 0.2), (0, fail(id, free, 0))]).0, straight);
    // Cleared before it sets in, it never was.
    let cleared = (5, Command::Clear { id, name: "it".to_owned() });
    assert_eq!(roll(&[stick(0, 0.2), (0, fail(id, stuck.clone(), 10)), cleared]).0, right);
    let (_, told) = roll(&[(200, fail(id, stuck, 30))]);
    assert!(matches!(&told.events[0].what, Happening::Failure { name, .. } if name == "it"));
    // Armed at step 200 for 30 steps later: it sets in before the step that follows the 230th.
    assert_eq!(told.events[0].time_s, 230.0 / 120.0);
}

#[test]
fn fuel_burns_leaks_freezes_and_its_end_is_the_engines() {
    let (mut scene, id) = calm();
    scene.order(control(id, "throttle_norm", 0.5)).unwrap();
    let minute = 120 * 20;
    lockstep(&mut scene, &SceneGround::void(), minute);
    // 20 s at half of 0.05 kg/s; 2,400 differences of numbers below 128: a rounding of 2^-46 kg each.
    let left = scene.fuel_kg(id).unwrap();
    assert!((left - (100.0 - 20.0 * 0.025)).abs() < 2_400.0 * 2f64.powi(-46), "{left}");
    scene.order(Command::Fuel { id, change: FuelChange::Freeze(true) }).unwrap();
    scene.order(fail(id, Failure::FuelLeak(50.0), 0)).unwrap();
    lockstep(&mut scene, &SceneGround::void(), 120);
    assert_eq!(scene.fuel_kg(id), Some(left));
    scene.order(Command::Fuel { id, change: FuelChange::Freeze(false) }).unwrap();
    let dry = lockstep(&mut scene, &SceneGround::void(), 120 * 3);
    assert_eq!(scene.fuel_kg(id), Some(0.0));
    assert!(dry.events.is_empty(), "told more than half a second ago");
    assert_eq!(dry.events_counted, 2, "the leak, and the end of the fuel");
    // Without fuel there is no thrust: the same as with the engine out, where the mass is the same.
    let speed = |change: Command| {
        let (mut scene, id) = calm();
        scene.order(Command::Fuel { id, change: FuelChange::Set(0.0) }).unwrap();
        scene.order(control(id, "throttle_norm", 1.0)).unwrap();
        scene.order(change).unwrap();
        lockstep(&mut scene, &SceneGround::void(), 240).bodies[0].velocity_mps.length()
    };
    let (empty, out) = (speed(Command::Turbulence(0.0)), speed(fail(StableId(2), Failure::EngineOut, 0)));
    assert_eq!(empty, out);
    let full = speed(Command::Fuel { id: StableId(2), change: FuelChange::Set(50.0) });
    assert!(full > empty + 3.0, "3,000 N on 950 kg for 2 s are 6 m/s less what drag takes: {full} {empty}");
}

#[test]
fn lighter_by_its_fuel_a_body_is_faster_by_the_ratio_of_masses() {
    // Weightless and without air: thrust alone.
    let gained = |fuel_kg: f64| {
        let mut around = Surroundings::default().weightless();
        around.atmosphere = sim::atmosphere::Atmosphere::None;
        let mut scene = empty(around);
        let fuel = Some(Fuel { fuel_kg: 400.0, flow_kgps: 0.0 });
        let id = scene.add_body(&sim::scene::BodyStart { fuel, ..light(DVec3::Y * 3_000.0) }).unwrap();
        scene.order(control(id, "throttle_norm", 1.0)).unwrap();
        scene.order(Command::Fuel { id, change: FuelChange::Set(fuel_kg) }).unwrap();
        lockstep(&mut scene, &SceneGround::void(), 120).bodies[0].velocity_mps.length() - 60.0
    };
    // 3,000 N for a second on 1,000 kg and on 600 kg; 120 sums below 128 m/s: 2^-46 m/s each.
    for (fuel_kg, expected) in [(400.0, 3.0), (0.0, 0.0), (200.0, 3_000.0 / 800.0)] {
        assert!((gained(fuel_kg) - expected).abs() < 120.0 * 2f64.powi(-46), "{fuel_kg}: {}", gained(fuel_kg));
    }
}
